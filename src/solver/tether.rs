//! Tethers: no particle may be farther from a pin than the cloth between them is long.
//!
//! A sweep is as stiff as mass/Δt², so a spring that holds half of the cloth stretches far while all others are
//! fine. A unilateral constraint from each particle straight to a pin, which nothing moves, has no such trouble
//! (long range attachments, Kim, Chentanez and Müller 2012). It takes away energy or none: it acts only against
//! what is beyond its length, and a pin does not move.

use bevy::math::{UVec2, Vec2};

use super::kernel::Kernels;
use crate::cloth::{Block, ClothGrid, ClothMaterial, ClothParticles, LANES, Lanes, Layout, Slot};

/// Up to so many pins each particle is tethered to all of them, with more to the nearest.
const FEW_PINS: usize = 4;

/// Tethers give way up to so many times the strain that the cloth's own weight could cause at its pins, so that
/// they leave to the springs what is elastic: swings and colliders pull harder than weight.
const MARGIN: f32 = 4.0;

/// What a cloth is taken to weigh at least (m/s²): without gravity it is pulled at, too.
const LEAST_ACCELERATION: f32 = 9.81;

/// The length of what has none.
const ENDLESS: f32 = f32::MAX;

/// Tethers of a cloth, and what they were made for.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Tethers {
    pins: Vec<Slot>,
    layers: Vec<Layer>,
}

/// One tether for each particle.
#[derive(Debug, Clone, PartialEq)]
struct Layer {
    /// Indices of the pins that the particles of a block are tethered to: most blocks of a column have the same.
    patterns: Vec<[u32; LANES]>,
    /// Which of these each block has.
    pattern_of: Vec<u32>,
    /// Squared length (m²), block by block.
    length_square: Vec<Lanes>,
}

/// Where the pins are in a sub-step: x, y and z of each layer's patterns, one layer's after the other's.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Anchors {
    patterns: Vec<[Lanes; 3]>,
}

/// The pull that threads are given room for (N/m): four times the weight of a cloth, over so many pins side by side.
fn tension(grid: &ClothGrid, material: &ClothMaterial, pins: usize, acceleration: f32) -> f32 {
    let sides = UVec2::new(grid.columns(), grid.rows()).saturating_sub(UVec2::ONE);
    let area = (sides.as_vec2() * grid.spacing()).element_product();
    let width = pins as f32 * grid.spacing().min_element();
    MARGIN * material.areal_density * area * acceleration.max(LEAST_ACCELERATION) / width
}

/// The stretch that the material itself gives under four times the weight of the cloth, hung by so many pins; without
/// any, by as many as it is wide.
pub(crate) fn given_stretch(
    grid: &ClothGrid,
    material: &ClothMaterial,
    pins: usize,
    acceleration: f32,
) -> f32 {
    let pins = if pins == 0 {
        grid.columns().min(grid.rows()) as usize
    } else {
        pins
    };
    material.stretch_compliance * tension(grid, material, pins, acceleration)
}

impl Tethers {
    /// Tethers from the particles of `grid` to those of them that are pinned. Each is as long as the straight line
    /// between them at rest, times what the material gives under four times the weight of the whole cloth hung
    /// by its pins, under an `acceleration` (m/s²) of at least 9.81; where threads can shear, up to the way along the
    /// threads. The particles must be those of `grid`.
    pub fn new(
        grid: &ClothGrid,
        material: &ClothMaterial,
        particles: &ClothParticles,
        acceleration: f32,
    ) -> Self {
        let layout = particles.layout();
        let pinned: Vec<(u32, u32, Slot)> = grid
            .cells()
            .zip(layout.slots())
            .filter(|(_, slot)| particles.blocks()[slot.block].inverse_mass(slot.lane) == 0.0)
            .map(|((row, column), slot)| (row, column, slot))
            .collect();
        let spacing = grid.spacing();
        let tension = tension(grid, material, pinned.len(), acceleration);
        let length = |(row, column): (u32, u32), pin: &(u32, u32, Slot)| {
            // Nothing moves a pin, however far it is from others.
            let slot = layout.slot(row, column);
            if particles.blocks()[slot.block].inverse_mass(slot.lane) == 0.0 {
                return ENDLESS;
            }
            let across = steps(column, pin.1) * spacing.x;
            let down = steps(row, pin.0) * spacing.y;
            let square = across * across + down * down;
            let straight = square.sqrt();
            let bias = 2.0 * across * down / square;
            let stretch = 1.0 + material.stretch_compliance * tension;
            let sheared = straight * (stretch + material.shear_compliance * tension * bias * bias);
            let threads = (across + down) * stretch;
            // Along a thread there is nothing to shear, and infinite × 0 is no number.
            let longest = if bias == 0.0 {
                straight * stretch
            } else {
                sheared.min(threads)
            };
            (longest * longest).min(ENDLESS)
        };
        let layer = |choose: &dyn Fn((u32, u32)) -> usize| {
            let pins = by_block(grid, layout, 0, |cell| choose(cell) as u32);
            let mut patterns = pins.clone();
            patterns.sort_unstable();
            patterns.dedup();
            // Every block's pattern is among them.
            let index = |pins| patterns.binary_search(pins).unwrap_or(0) as u32;
            Layer {
                pattern_of: pins.iter().map(index).collect(),
                patterns,
                length_square: by_block(grid, layout, ENDLESS, |cell| {
                    length(cell, &pinned[choose(cell)])
                }),
            }
        };
        let layers = if pinned.is_empty() || pinned.len() == grid.len() {
            Vec::new()
        } else if pinned.len() <= FEW_PINS {
            (0..pinned.len()).map(|pin| layer(&|_| pin)).collect()
        } else {
            let nearest = nearest_pins(grid, &pinned);
            vec![layer(&|(row, column)| {
                nearest[grid.index(row, column) as usize] as usize
            })]
        };
        Self {
            pins: pinned.iter().map(|&(.., slot)| slot).collect(),
            layers,
        }
    }

    /// The acceleration (m/s²) to make tethers for where `acceleration` acts: 9.81, doubled until four fifths of
    /// `acceleration` are no more, so that tethers outlast one that changes from tick to tick.
    pub(crate) fn made_for(acceleration: f32) -> f32 {
        let mut rounded = LEAST_ACCELERATION;
        while rounded < 0.8 * acceleration {
            rounded *= 2.0;
        }
        rounded
    }

    /// Whether nothing is tethered.
    pub fn is_empty(&self) -> bool {
        self.layers.is_empty()
    }

    /// Whether the same particles are pinned as when the tethers were made.
    pub(crate) fn are_of(&self, particles: &ClothParticles) -> bool {
        let slots = particles.layout().slots();
        let pinned =
            slots.filter(|slot| particles.blocks()[slot.block].inverse_mass(slot.lane) == 0.0);
        pinned.eq(self.pins.iter().copied())
    }

    /// How far the farthest particle is beyond its tether, as a part of it.
    #[cfg(test)]
    pub(super) fn largest_excess(&self, particles: &ClothParticles) -> f32 {
        let mut largest = 0.0_f32;
        for layer in &self.layers {
            for (index, lengths) in layer.length_square.iter().enumerate() {
                for (lane, length) in lengths.iter().enumerate() {
                    let pattern = layer.patterns[layer.pattern_of[index] as usize];
                    let pin = self.pins[pattern[lane] as usize];
                    let anchor = particles.blocks()[pin.block].position(pin.lane);
                    let position = particles.blocks()[index].position(lane);
                    let ratio = position.distance_squared(anchor) / length;
                    largest = largest.max(ratio.sqrt() - 1.0);
                }
            }
        }
        largest
    }

    /// Takes over where the pins are at the end of this sub-step.
    pub(super) fn locate(&self, blocks: &[Block], anchors: &mut Anchors) {
        let position = |pin: u32| {
            let slot = self.pins[pin as usize];
            let block = &blocks[slot.block];
            block.position(slot.lane) + block.displacement(slot.lane)
        };
        anchors.patterns.clear();
        for pattern in self.layers.iter().flat_map(|layer| &layer.patterns) {
            let at = pattern.map(position);
            anchors
                .patterns
                .push([at.map(|at| at.x), at.map(|at| at.y), at.map(|at| at.z)]);
        }
    }

    /// Pulls particles back. `blocks` are those from number `first` on.
    pub(super) fn pull(
        &self,
        anchors: &Anchors,
        blocks: &mut [Block],
        first: usize,
        kernels: &Kernels,
    ) {
        let mut patterns = &anchors.patterns[..];
        for layer in &self.layers {
            let (own, others) = patterns.split_at(layer.patterns.len());
            patterns = others;
            let these = first..first + blocks.len();
            let pattern_of = &layer.pattern_of[these.clone()];
            (kernels.tethers)(blocks, own, pattern_of, &layer.length_square[these]);
        }
    }
}

/// From one row or column to another.
fn steps(a: u32, b: u32) -> f32 {
    a.abs_diff(b) as f32
}

/// A value for each particle, laid out as the particles are.
fn by_block<T: Copy>(
    grid: &ClothGrid,
    layout: Layout,
    none: T,
    value: impl Fn((u32, u32)) -> T,
) -> Vec<[T; LANES]> {
    let mut values = vec![[none; LANES]; layout.blocks()];
    for (cell, slot) in grid.cells().zip(layout.slots()) {
        values[slot.block][slot.lane] = value(cell);
    }
    values
}

/// For each particle the index of the nearest pin at rest: each takes the nearest of what its neighbours know, up and
/// down the grid twice (after Danielsson 1980, whose distances are off by a fraction of a cell at worst).
fn nearest_pins(grid: &ClothGrid, pinned: &[(u32, u32, Slot)]) -> Vec<u32> {
    const UNKNOWN: u32 = u32::MAX;
    let mut nearest = vec![UNKNOWN; grid.len()];
    for (pin, &(row, column, _)) in pinned.iter().enumerate() {
        nearest[grid.index(row, column) as usize] = pin as u32;
    }
    let distance = |(row, column): (u32, u32), pin: u32| {
        let Some(&(pin_row, pin_column, _)) = pinned.get(pin as usize) else {
            return f32::INFINITY;
        };
        let steps = Vec2::new(steps(column, pin_column), steps(row, pin_row));
        (steps * grid.spacing()).length_squared()
    };
    let mut visit = |index: usize| {
        let (row, column) = (index as u32 / grid.columns(), index as u32 % grid.columns());
        let mut best = nearest[index];
        for row_there in row.saturating_sub(1)..(row + 2).min(grid.rows()) {
            for column_there in column.saturating_sub(1)..(column + 2).min(grid.columns()) {
                let known = nearest[grid.index(row_there, column_there) as usize];
                if distance((row, column), known) < distance((row, column), best) {
                    best = known;
                }
            }
        }
        nearest[index] = best;
    };
    for _ in 0..2 {
        (0..grid.len()).for_each(&mut visit);
        (0..grid.len()).rev().for_each(&mut visit);
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;
    use bevy::math::Vec3;

    #[test]
    fn tethers_outlast_small_changes_of_gravity() {
        let made_for = [0.0, 1.62, 9.81, 12.2, 12.3, 24.5, 24.6].map(Tethers::made_for);
        let [usual, double, fourfold] = [1.0, 2.0, 4.0].map(|times| times * 9.81);
        assert_eq!(
            made_for,
            [usual, usual, usual, usual, double, double, fourfold]
        );
    }

    /// Pins anywhere: what each particle gets is nearer than the next pin but for a fraction of a cell.
    #[test]
    fn each_particle_gets_its_nearest_pin() {
        let grid = Cloth::new(37, 23, 0.1)
            .grid(Vec3::new(1.0, 1.5, 1.0))
            .expect("a sound grid");
        let layout = Layout::new(37, 23);
        for count in [1, 5, 17, 60] {
            let place = |pin: u32| ((pin * 7919 + 3) % 23, (pin * 104_729 + 11) % 37);
            let pinned: Vec<_> = (0..count)
                .map(|pin| (place(pin).0, place(pin).1, layout.slot(0, 0)))
                .collect();
            let nearest = nearest_pins(&grid, &pinned);
            for (row, column) in grid.cells() {
                let distance = |pin: usize| {
                    let (pin_row, pin_column, _) = pinned[pin];
                    let (pin, own) = (
                        grid.rest_position(pin_row, pin_column),
                        grid.rest_position(row, column),
                    );
                    pin.distance(own)
                };
                let found = distance(nearest[grid.index(row, column) as usize] as usize);
                let truth = (0..pinned.len())
                    .map(distance)
                    .fold(f32::INFINITY, f32::min);
                assert!(
                    found <= truth + 0.1,
                    "{count} pins, {row} {column}: {found} {truth}"
                );
            }
        }
    }
}
