//! Tethers limit the distance of each particle from a pin to the length of cloth between them.
//!
//! A sweep is as stiff as mass/Δt², so a spring that holds half of the cloth stretches far while all others are fine. A
//! unilateral constraint from each particle straight to a pin has no such problem (long range attachments, Kim,
//! Chentanez and Müller 2012). It never adds energy: it acts only beyond its length, and a pin does not move.

use bevy::math::Vec2;

use super::kernels::Kernels;
use crate::cloth::{
    Block, ClothMaterial, ClothParticles, Flat, Graph, LANES, Lanes, Layout, MapInline, Slot,
    Surface,
};

/// Each particle is tethered to all pins if there are up to this many, else to the nearest.
const FEW_PINS: usize = 4;

/// Tethers allow this many times the strain that the cloth's own weight could cause at its pins. So they leave elastic
/// stretch to the springs, since swings and colliders pull harder than weight.
const MARGIN: f32 = 4.0;

/// They also allow this fraction of their length: solved chains do not get that long, so tethers don't disturb a
/// correct motion.
const SLACK: f32 = 0.01;

/// Lower bound of the acceleration for a cloth's weight (m/s²), since there are forces without gravity, too.
const MIN_ACCELERATION: f32 = 9.81;

/// The length of a missing tether.
const ENDLESS: f32 = f32::MAX;

/// Tethers of a cloth: upper bounds of the distances of its particles from its pins.
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
    /// The pattern of each block.
    pattern_of: Vec<u32>,
    /// Squared length (m²), block by block.
    length_square: Vec<Lanes>,
}

/// Positions of the pins in a sub-step: x, y and z of the patterns, layer by layer.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Anchors {
    patterns: Vec<[Lanes; 3]>,
}

/// The tension that tethers allow (N/m): four times the weight of a cloth, over a number of pins side by side.
fn tension(surface: &Surface, material: &ClothMaterial, pins: usize, acceleration: f32) -> f32 {
    let width = match surface.rope_radius() {
        Some(radius) => 2.0 * radius,
        None => pins as f32 * surface.spacing().typical,
    };
    MARGIN * material.areal_density * surface.area() * acceleration.max(MIN_ACCELERATION) / width
}

/// The stretch of the material itself under four times the weight of the cloth, hung by a number of pins; without pins,
/// hung by its whole width.
pub(crate) fn material_stretch(
    surface: &Surface,
    material: &ClothMaterial,
    pins: usize,
    acceleration: f32,
) -> f32 {
    let pins = if pins == 0 {
        surface.particles_across()
    } else {
        pins
    };
    material.largest_strain(tension(surface, material, pins, acceleration))
}

/// Distances over a surface at rest from each particle to a pin, including the stretch of the material.
struct Lengths<'a> {
    surface: &'a Surface,
    material: &'a ClothMaterial,
    tension: f32,
}

impl Lengths<'_> {
    /// Straight, on a surface that is flat and convex.
    fn straight(&self, flat: &Flat, particle: usize, pin: usize) -> f32 {
        let [across, down] = flat.between(particle, pin);
        let square = across * across + down * down;
        let straight = square.sqrt();
        let stretch = 1.0 + SLACK + self.material.largest_strain(self.tension);
        let bias = 2.0 * across * down / square;
        // Along a chain there is nothing to shear, and infinite × 0 is NaN; nor where springs run in all directions.
        if !flat.has_chains || bias == 0.0 {
            return straight * stretch;
        }
        let sheared =
            straight * (stretch + self.material.shear_compliance * self.tension * bias * bias);
        let chains = (across + down) * stretch;
        sheared.min(chains)
    }

    /// Along edges, anywhere else.
    fn along(&self, path: f32) -> f32 {
        path * (1.0 + SLACK + self.material.largest_strain(self.tension))
    }

    /// The pin to which each particle is tethered in a layer, and the length of the tether.
    fn layers(&self, pinned: &[u32]) -> Vec<Vec<(u32, f32)>> {
        let particles = 0..self.surface.len();
        let is_few = pinned.len() <= FEW_PINS;
        let Some(flat) = self.surface.flat() else {
            let sources: Vec<&[u32]> = if is_few {
                pinned.chunks(1).collect()
            } else {
                vec![pinned]
            };
            let of_sources = |(first, sources): (usize, &[u32])| {
                let found = self.surface.graph().distances(sources.iter().copied());
                let tether = |(path, source): (f32, u32)| match source {
                    u32::MAX => (0, ENDLESS),
                    source => (first as u32 + source, self.along(path)),
                };
                found.into_iter().map(tether).collect()
            };
            return sources.into_iter().enumerate().map(of_sources).collect();
        };
        let tether = |particle: usize, pin: u32| {
            (
                pin,
                self.straight(flat, particle, pinned[pin as usize] as usize),
            )
        };
        if is_few {
            let to = |pin: u32| {
                particles
                    .clone()
                    .map(|particle| tether(particle, pin))
                    .collect()
            };
            return (0..pinned.len() as u32).map(to).collect();
        }
        let nearest = nearest_pins(flat, self.surface.graph(), pinned);
        vec![
            particles
                .map(|particle| tether(particle, nearest[particle]))
                .collect(),
        ]
    }
}

impl Tethers {
    /// Tethers from the particles of a surface to the pinned ones among them. The particles must be those of the
    /// surface.
    ///
    /// The length of a tether is that of the shortest path between both particles at rest, lengthened by the stretch of
    /// the material. That is its stretch under four times the weight of the whole cloth hung by its pins, with an
    /// `acceleration` (m/s²) of at least 9.81. If chains can shear, the tether may be as long as the path along the
    /// chains.
    ///
    /// On a flat and convex surface the path is a straight line. On any other it follows the edges of the triangles,
    /// which is a little longer than the shortest path across them.
    pub fn new(
        surface: &Surface,
        material: &ClothMaterial,
        particles: &ClothParticles,
        acceleration: f32,
    ) -> Self {
        let layout = particles.layout();
        let masses = particles.inverse_masses().enumerate();
        let pinned: Vec<u32> = masses
            .filter(|(_, inverse_mass)| *inverse_mass == 0.0)
            .map(|(index, _)| index as u32)
            .collect();
        let lengths = Lengths {
            surface,
            material,
            tension: tension(surface, material, pinned.len(), acceleration),
        };
        let layer = |tethers: &[(u32, f32)]| {
            let pins = by_block(layout, 0, tethers.iter().map(|(pin, _)| *pin));
            let mut patterns = pins.clone();
            patterns.sort_unstable();
            patterns.dedup();
            // Every block's pattern is among them.
            let index = |pins| patterns.binary_search(pins).unwrap_or(0) as u32;
            let squares = tethers.iter().zip(particles.inverse_masses());
            let squares = squares.map(|((_, length), inverse_mass)| {
                // Nothing moves a pin, however far it is from others.
                let is_pinned = inverse_mass == 0.0;
                if is_pinned {
                    ENDLESS
                } else {
                    (length * length).min(ENDLESS)
                }
            });
            Layer {
                pattern_of: pins.iter().map(index).collect(),
                patterns,
                length_square: by_block(layout, ENDLESS, squares),
            }
        };
        let layers = if pinned.is_empty() || pinned.len() == surface.len() {
            Vec::new()
        } else {
            let layers = lengths.layers(&pinned);
            layers.iter().map(|tethers| layer(tethers)).collect()
        };
        let slot = |pin: &u32| layout.slot_of(*pin as usize);
        Self {
            pins: pinned.iter().map(slot).collect(),
            layers,
        }
    }

    /// The acceleration (m/s²) for which tethers are made if `acceleration` acts: 9.81, doubled until it is at least
    /// four fifths of `acceleration`. So tethers outlast an acceleration that grows from tick to tick.
    pub(crate) fn made_for(acceleration: f32) -> f32 {
        let mut rounded = MIN_ACCELERATION;
        while rounded < 0.8 * acceleration {
            rounded *= 2.0;
        }
        rounded
    }

    /// Whether there are no tethers.
    pub fn is_empty(&self) -> bool {
        self.layers.is_empty()
    }

    /// The largest excess of a particle over its tether, as a fraction of the tether's length.
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

    /// Takes over the positions of the pins at the end of this sub-step.
    pub(super) fn locate(&self, blocks: &[Block], anchors: &mut Anchors) {
        let position = |pin: u32| {
            let slot = self.pins[pin as usize];
            let block = &blocks[slot.block];
            block.position(slot.lane) + block.displacement(slot.lane)
        };
        anchors.patterns.clear();
        for pattern in self.layers.iter().flat_map(|layer| &layer.patterns) {
            let at = pattern.map_inline(position);
            anchors.patterns.push([
                at.map_inline(|at| at.x),
                at.map_inline(|at| at.y),
                at.map_inline(|at| at.z),
            ]);
        }
    }

    /// Pulls particles back. `blocks` begin with number `first`.
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

/// A value for each particle, block by block.
fn by_block<T: Copy>(
    layout: Layout,
    none: T,
    of_particles: impl Iterator<Item = T>,
) -> Vec<[T; LANES]> {
    let mut values = vec![[none; LANES]; layout.blocks()];
    for (value, slot) in of_particles.zip(layout.slots()) {
        values[slot.block][slot.lane] = value;
    }
    values
}

/// For each particle the index in `pinned` of the nearest pin at rest: each takes the nearest among its neighbours'
/// pins, from the first to the last and back (after Danielsson 1980, whose distances are off by a fraction of a spacing
/// at worst).
fn nearest_pins(flat: &Flat, graph: &Graph, pinned: &[u32]) -> Vec<u32> {
    const UNKNOWN: u32 = u32::MAX;
    let mut nearest = vec![UNKNOWN; graph.len()];
    for (place, &pin) in pinned.iter().enumerate() {
        nearest[pin as usize] = place as u32;
    }
    let distance = |particle: usize, pin: u32| match pinned.get(pin as usize) {
        Some(&pin) => Vec2::from(flat.between(particle, pin as usize)).length_squared(),
        None => f32::INFINITY,
    };
    let mut visit = |particle: usize| {
        let known = nearest[particle];
        let mut best = known;
        for &(neighbour, _) in graph.of(particle as u32) {
            let theirs = nearest[neighbour as usize];
            if distance(particle, theirs) < distance(particle, best) {
                best = theirs;
            }
        }
        nearest[particle] = best;
        best != known
    };
    let mut changes = true;
    while changes {
        changes = false;
        for particle in (0..graph.len()).chain((0..graph.len()).rev()) {
            changes |= visit(particle);
        }
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
        let cloth = Cloth::new(37, 23, 0.1);
        let surface = cloth
            .surface(Vec3::new(1.0, 1.5, 1.0))
            .expect("a valid grid");
        let flat = surface.flat().expect("a grid is flat");
        for count in [1, 5, 17, 60] {
            let place = |pin: u32| (pin * 7919 + 3) % 23 * 37 + (pin * 104_729 + 11) % 37;
            let pinned: Vec<u32> = (0..count).map(place).collect();
            let nearest = nearest_pins(flat, surface.graph(), &pinned);
            let rest = surface.rest_positions();
            for (particle, nearest) in nearest.into_iter().enumerate() {
                let distance = |pin: u32| rest[pin as usize].distance(rest[particle]);
                let found = distance(pinned[nearest as usize]);
                let truth = pinned.iter().copied().map(distance);
                let truth = truth.fold(f32::INFINITY, f32::min);
                assert!(
                    found <= truth + 0.1,
                    "{count} pins, {particle}: {found} {truth}"
                );
            }
        }
    }
}
