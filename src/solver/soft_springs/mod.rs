//! Soft springs, explicitly: by forces and Verlet, as in the paper.
//!
//! If a sub-step is short beside the fastest oscillation of a cloth, nothing has to be solved. The forces of the
//! springs accelerate each particle, and velocity Verlet moves it:
//!
//! ```text
//!   v += a Δt/2,   x += v Δt,   v += a Δt/2         a = g + w Σ k (1 − L/ℓ) (x_j − x_i)
//! ```
//!
//! This is of second order. It is symplectic, so it keeps momentum to the last bits, and energy for ever but for a
//! ripple. The end of one sub-step and the beginning of the next are a single kick. Only the first and the last kick of
//! a tick are halves, so that a tick ends with positions and velocities of the same instant.
//!
//! # The limit
//! It is stable as long as ω Δt < 2 for all modes. However a cloth is folded or stretched, a spring's tangent stiffness
//! is at most k in any direction. Each of its two particles takes at most the double, so no ω² is more than `2 max_i
//! w_i Σ_j k_ij`. That is twice the value of a flat lattice; it holds for a crumpled one, where springs lie side by
//! side.
//!
//! A cloth must not be too far from the origin of its frame either. At a distance of r m, each step rounds positions by
//! u = 2⁻²³ r ⁄ √12 in the mean, and forces from positions alone take each rounding for a stretch. With 4 springs per
//! particle, these gain ½ k u² twice in a step, which is `ω² m u²/(4 Δt)` a second. It is limited to 2 % of the work of
//! the weight over a spacing h: u² < 0.08 g h Δt/ω². That is 6 m for 64² of 1 mm/N, 2 m wide. (Chains use
//! displacements as well, and may be 150 times as far away.)
//!
//! # Cost
//! 9 µs for a sub-step of 64² (16,000 springs), where solving chains takes 24. So if it needs at most twice the
//! sub-steps, it is as cheap, and far more exact. An example is a 64² of 1 mm/N that falls, hung by its upper row.
//! After half a second it is off by 0.01 mm with 92 sub-steps in 1/60 s; chains with 80 are off by 0.05 mm.

mod list;
#[cfg(test)]
mod tests;

use std::array;

use super::{
    bending::Bending,
    damping_reference::DampingReference,
    free_pieces::FreePieces,
    kernels::{ElasticGrid, Force, Kernels, Kick, LinearForce},
    partitions::{MAX_PARTITIONS, in_partitions, take},
    step::{DAMPING_REFERENCE, SubStep, TickStep},
};
use crate::cloth::{Block, ClothGrid, Compliances, LANES, Lanes, Layout, SpringList, W, X, Y, Z};
use list::ForceList;

/// Of the largest stable sub-step. The rest is for bending, which pushes with them.
const MARGIN: f32 = 0.95;

/// Mean rounding of a number, as a fraction of it: 2⁻²³ ⁄ √12.
const ROUNDING: f32 = f32::EPSILON * 0.288_675;

/// Four times the fraction of the work of the weight over a spacing that rounding may add in a second.
const NOISE: f32 = 0.08;

/// Gravity of this estimate (m/s²), whatever the cloth's own.
const GRAVITY: f32 = 9.81;

/// Fewer rows a partition than this, and waiting for the others would take longer than the work.
const MIN_ROWS: usize = 32;

/// The springs of a grid, torn or not, none of them rigid.
#[derive(Debug, Clone)]
pub(super) struct SoftSprings {
    springs: ElasticGrid,
    /// Of the particles that tears made.
    list: ForceList,
    /// Of all springs of a particle together (N/m): in a row at an end and in others, or in each row.
    sums: [Vec<Lanes>; 2],
    /// Of two rows, for each partition.
    scratch: Vec<[Vec<Force>; 2]>,
    /// The rows on either side of each border between partitions.
    borders: Vec<Block>,
    partitions: usize,
}

impl SoftSprings {
    /// `None` if a spring is rigid.
    pub fn new(grid: &ClothGrid, compliances: &Compliances) -> Option<Self> {
        let springs = ElasticGrid::new(grid, compliances)?;
        let sums = sums(&springs);
        Some(Self::of(springs, sums, ForceList::default()))
    }

    /// Of the springs of a torn or mapped grid, between particles that lie as `layout` says. `None` if one is rigid.
    pub fn of_list(grid: &ClothGrid, layout: Layout, list: &SpringList) -> Option<Self> {
        let springs = ElasticGrid::of_list(grid, layout, list)?;
        let mut sums = vec![[0.0; LANES]; layout.blocks()];
        for spring in &list.springs {
            for end in spring.ends {
                let slot = layout.slot_of(end as usize);
                sums[slot.block][slot.lane] += 1.0 / spring.compliance;
            }
        }
        let list = ForceList::new(list, grid.len() as u32, layout)?;
        Some(Self::of(springs, [sums, Vec::new()], list))
    }

    fn of(springs: ElasticGrid, sums: [Vec<Lanes>; 2], list: ForceList) -> Self {
        let strip = springs.layout.strip as usize;
        Self {
            springs,
            list,
            sums,
            scratch: vec![array::from_fn(|_| vec![Force::default(); strip])],
            borders: Vec::new(),
            partitions: 1,
        }
    }

    /// The stiffness of all springs of the particles of a row together (N/m).
    fn sums_of(&self, row: usize) -> &[Lanes] {
        let Layout { rows, strip, .. } = self.springs.layout;
        let [border, inner] = &self.sums;
        if self.springs.is_by_row() {
            return &border[row * strip as usize..][..strip as usize];
        }
        let is_end = row == 0 || row + 1 == rows as usize;
        if is_end { border } else { inner }
    }

    /// With this many partitions of rows from now on, or fewer where there is too little to do.
    pub fn set_partitions(&mut self, wanted: usize) {
        let most = self.springs.layout.rows as usize / MIN_ROWS;
        self.partitions = wanted.min(most).clamp(1, MAX_PARTITIONS);
    }

    /// How many partitions there are.
    pub fn partitions(&self) -> usize {
        self.partitions
    }

    /// The longest sub-step that is safe for particles of these masses, there (s); 0 if they are too far away for any.
    pub fn longest_substep(&self, blocks: &[Block]) -> f32 {
        let (mut largest, mut farthest) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        let each = blocks.chunks_exact(self.springs.layout.strip as usize);
        for (row, blocks) in each.enumerate() {
            for (block, sum) in blocks.iter().zip(self.sums_of(row)) {
                let view = block.view();
                for l in 0..LANES {
                    let own = view[W + l] * sum[l];
                    largest[l] = if own > largest[l] { own } else { largest[l] };
                    for at in [X, Y, Z] {
                        let away = view[at + l].abs();
                        farthest[l] = if away > farthest[l] {
                            away
                        } else {
                            farthest[l]
                        };
                    }
                }
            }
        }
        let greatest = |of: [f32; LANES]| of.into_iter().fold(0.0, f32::max);
        let square = 2.0 * greatest(largest);
        let longest = MARGIN * 2.0 / square.sqrt();
        let rounding = ROUNDING * greatest(farthest);
        let most = NOISE * GRAVITY * self.springs.spacing() * longest / square;
        if rounding * rounding < most {
            longest
        } else {
            0.0
        }
    }

    /// A sub-step of particles that remember nothing but their velocity: springs, what bends, and `linearized` forces of a game. The
    /// one after the last only ends the tick. It bends for that many sub-steps. Returns the largest displacement (m).
    pub fn substep(
        &mut self,
        blocks: &mut [Block],
        step: &TickStep,
        SubStep { index, count, .. }: SubStep,
        damping_reference: &mut DampingReference,
        bending: Option<(&mut Bending, f32)>,
        linearized: Option<&[LinearForce]>,
        free_pieces: &mut FreePieces,
        kernels: &Kernels,
    ) -> f32 {
        let dt = step.seconds / count as f32;
        let kept = (1.0 - step.damping).powf(dt / DAMPING_REFERENCE);
        // The end of one sub-step is the beginning of the next.
        let (part, kept) = match index == 0 || index == count {
            true => (0.5, kept.sqrt()),
            false => (1.0, kept),
        };
        let weight = part * dt * dt;
        let [displacement, _] = damping_reference.follow(blocks);
        damping_reference.gain(part);
        let kick = Kick {
            kept,
            weight,
            pull: (step.acceleration * weight + (1.0 - kept) * displacement).to_array(),
            moves: index < count,
        };
        free_pieces.measure(blocks, step.damping);
        let lost = (1.0 - kept) / kept;
        free_pieces.shift(blocks, |own| lost * (own - displacement));
        // Before the kick, which keeps a part of it.
        self.list.push(blocks, weight / kept);
        if let Some((bending, bends_for)) = bending
            && bends_for > 0.0
        {
            bending.push(blocks, bends_for * dt * dt / kept, kernels);
        }
        if let Some(linearized) = linearized {
            (kernels.force_push)(blocks, linearized, weight / kept, 1.0 / dt);
        }
        let moved = self.kick(blocks, &kick, kernels);
        moved.into_iter().fold(0.0, f32::max).sqrt()
    }

    /// Whether each particle is heavy enough for a sub-step of `dt` (s). Ends with the first that is not.
    pub fn is_short(&self, blocks: &[Block], dt: f32) -> bool {
        let most = (MARGIN * 2.0 / dt).powi(2) / 2.0;
        let mut each = blocks
            .chunks_exact(self.springs.layout.strip as usize)
            .enumerate();
        each.all(|(row, blocks)| {
            let own = |(block, sum): (&Block, &Lanes)| {
                let view = block.view();
                (0..LANES).all(|l| view[W + l] * sum[l] <= most)
            };
            blocks.iter().zip(self.sums_of(row)).all(own)
        })
    }

    /// Has forces act, and moves the particles. Returns their squared displacements (m²), the largest of each lane.
    fn kick(&mut self, blocks: &mut [Block], kick: &Kick, kernels: &Kernels) -> Lanes {
        let mut moved = [[0.0; LANES]; MAX_PARTITIONS];
        let Self {
            springs,
            scratch,
            borders,
            partitions,
            ..
        } = self;
        let partitions = *partitions;
        if partitions == 1 {
            let around: [&[Block]; 2] = [&[], &[]];
            (kernels.kick)(
                blocks,
                0,
                around,
                springs,
                kick,
                &mut scratch[0],
                &mut moved[0],
            );
            return moved[0];
        }
        let (rows, strip) = (springs.layout.rows as usize, springs.layout.strip as usize);
        if scratch.len() < partitions {
            scratch.resize(partitions, scratch[0].clone());
        }
        // Another partition moves these rows in the meantime, so a copy is read.
        borders.clear();
        let first_row = |partition: usize| rows * partition / partitions;
        for partition in 1..partitions {
            let at = first_row(partition) * strip;
            borders.extend_from_slice(&blocks[at - strip..at + strip]);
        }
        let borders = &*borders;
        let mut rest = blocks;
        let each = scratch
            .iter_mut()
            .zip(&mut moved)
            .take(partitions)
            .enumerate();
        let parts = each.map(|(partition, (scratch, moved))| {
            let own = take(
                &mut rest,
                (first_row(partition + 1) - first_row(partition)) * strip,
            );
            // Of each border, the row above it and the row below it.
            let row = |at: usize| borders.get(at * strip..(at + 1) * strip).unwrap_or(&[]);
            let above: &[Block] = partition
                .checked_sub(1)
                .map_or(&[], |border| row(2 * border));
            let around = [above, row(2 * partition + 1)];
            (own, first_row(partition), around, scratch, moved)
        });
        in_partitions(parts, |(own, first, around, scratch, moved)| {
            (kernels.kick)(own, first, around, springs, kick, scratch, moved);
        });
        array::from_fn(|l| moved.iter().fold(0.0, |most, own| own[l].max(most)))
    }
}

/// The stiffness of all springs of each particle of a row, at an end of the grid and elsewhere (N/m).
fn sums(springs: &ElasticGrid) -> [Vec<Lanes>; 2] {
    let layout = springs.layout;
    let of = |is_inside: bool| {
        let stiffness = |of: &[Lanes], column: u32| {
            let slot = layout.slot(0, column);
            of[slot.block][slot.lane]
        };
        // A spring's own column, and the one that it leads to.
        let ends = |of: &[Lanes], column: u32| {
            stiffness(of, column)
                + column
                    .checked_sub(1)
                    .map_or(0.0, |from| stiffness(of, from))
        };
        let times = if is_inside { 2.0 } else { 1.0 };
        let sum = |column: u32| {
            let strip = layout.strip as usize;
            let across = &springs.across[usize::from(is_inside)];
            let across = ends(across.of_row(0, strip), column);
            let down = times * stiffness(springs.down.of_row(0, strip), column);
            let diagonal = times * ends(springs.falling.of_row(0, strip), column);
            across + down + diagonal
        };
        let lane = |block, lane| layout.column(block, lane).map_or(0.0, sum);
        let lanes = |block| array::from_fn(|l| lane(block, l));
        (0..layout.strip as usize).map(lanes).collect()
    };
    [of(false), of(true)]
}
