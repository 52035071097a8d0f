//! The arithmetic of a sub-step on blocks of eight particles, in plain loops that the compiler vectorises.
//!
//! No operation is fused or reordered from lane to lane, so every instruction set gives the same bits.
//!
//! A kernel calls only what is inlined in any build profile: short arrays are made by [`each`], not by `array::map`.
//!
//! A kernel imports no caller. [`Kernels`] is the table of all of them, compiled for one instruction set.

mod air_areas;
mod barrier;
mod chains;
mod commit;
mod each;
mod elastic;
mod forces;
mod packet;
mod pentadiagonal;
mod plate;
mod predict;
mod step_scale;
mod twist;

use bevy::math::Vec4;
use multiversion::{inherit_target, multiversion};

use crate::cloth::{Block, DX, DY, DZ, Earlier, LANES, Lanes, View, X, Y, Z};

pub(crate) use air_areas::{Enclosed, Rows, Triangles, air_areas, between};
use barrier::one_block_at_a_time;
pub(crate) use chains::{
    Chains, Columns, Direction, GROUP, Residuals, RowChains, RowScratch, RowSprings, Scratch,
    Solved, SpringBand, Step, bundle_backward, bundle_forward, largest, measure_elastic_left,
    measure_elastic_left_at, measure_given, measure_left, measure_left_at, note_places,
    solve_chains, solve_columns, solve_columns_again, solve_damped_chains, solve_damped_rows,
    solve_rows, solve_rows_again,
};
#[cfg(test)]
pub(crate) use commit::MIN_MOVE;
pub(crate) use commit::commit;
pub(crate) use each::four;
pub(crate) use elastic::{ElasticGrid, Force, Kick, kick, share};
pub(crate) use forces::{AeroCoefficients, LinearForce, air_linearize, force_impulse, force_push};
pub(crate) use packet::{Packet, Row, SPRINGS, relax_packets_back, relax_packets_there, turned};
pub(crate) use pentadiagonal::{
    Factor, Vec3Lanes, chain_backward, chain_columns, chain_finish, chain_forward, chain_links,
    chain_moments, chain_rows,
};
pub(crate) use plate::{EDGE, Moments, Stiffness, plate_moments, plate_places, plate_push};
pub(crate) use predict::{
    ForceStep, Prediction, begin_past, predict, predict_first, predict_first_forced,
    predict_forced, weight,
};
pub(crate) use step_scale::{StepScale, Stiffer};
pub(crate) use twist::{twist_backward, twist_forward, twist_links};

/// Pulls each particle back that is farther from its anchor than its tether is long: a unilateral constraint
/// against a particle that nothing moves.
#[inline(always)]
fn tether(view: &mut View, anchor: &[Lanes; 3], length_square: &Lanes) {
    let mut is_beyond = false;
    for l in 0..LANES {
        let x = (view[X + l] - anchor[0][l]) + view[DX + l];
        let y = (view[Y + l] - anchor[1][l]) + view[DY + l];
        let z = (view[Z + l] - anchor[2][l]) + view[DZ + l];
        is_beyond |= x * x + y * y + z * z > length_square[l];
    }
    // Most of a cloth hangs slack.
    if !is_beyond {
        return;
    }
    for l in 0..LANES {
        let x = (view[X + l] - anchor[0][l]) + view[DX + l];
        let y = (view[Y + l] - anchor[1][l]) + view[DY + l];
        let z = (view[Z + l] - anchor[2][l]) + view[DZ + l];
        let q = x * x + y * y + z * z;
        let r2 = length_square[l];
        let beyond = q - r2;
        let beyond = if beyond > 0.0 { beyond } else { 0.0 };
        let share = beyond / (1.5 * q + 0.5 * r2);
        view[DX + l] -= share * x;
        view[DY + l] -= share * y;
        view[DZ + l] -= share * z;
    }
}

/// A row's tethers, each block's to those of `anchors` that `anchor_of` says.
#[inline(always)]
fn tethers(row: &mut [Block], anchors: &[[Lanes; 3]], anchor_of: &[u32], length_square: &[Lanes]) {
    for ((block, anchor), length_square) in row.iter_mut().zip(anchor_of).zip(length_square) {
        tether(block.view_mut(), &anchors[*anchor as usize], length_square);
        one_block_at_a_time();
    }
}

/// The largest squared lengths found (m²), lane by lane: of springs, and of displacements.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Longest {
    pub moved: Lanes,
    pub across: Lanes,
    pub down: Lanes,
    pub diagonal: Lanes,
}

impl Longest {
    pub fn merge(&mut self, other: &Self) {
        for (a, b) in [
            (&mut self.moved, &other.moved),
            (&mut self.across, &other.across),
            (&mut self.down, &other.down),
            (&mut self.diagonal, &other.diagonal),
        ] {
            for (a, b) in a.iter_mut().zip(b) {
                *a = a.max(*b);
            }
        }
    }
}

/// Raises `largest` to the squared lengths of eight springs; where `hold` is infinite there is none.
#[inline(always)]
fn measure(a: &View, b: &View, hold: &Lanes, largest: &mut Lanes) {
    for l in 0..LANES {
        let (x, y, z) = (
            b[X + l] - a[X + l],
            b[Y + l] - a[Y + l],
            b[Z + l] - a[Z + l],
        );
        let q = x * x + y * y + z * z;
        let q = if hold[l] < f32::INFINITY { q } else { 0.0 };
        largest[l] = if q > largest[l] { q } else { largest[l] };
    }
}

/// Measures a row's horizontal springs.
#[inline(always)]
fn measure_within(row: &[Block], holds: &[Lanes], longest: &mut Longest) {
    for (pair, hold) in row.windows(2).zip(holds) {
        measure(pair[0].view(), pair[1].view(), hold, &mut longest.across);
    }
    if let (Some(first), Some(last), Some(hold)) = (row.first(), row.last(), holds.last()) {
        measure(last.view(), first.shifted(), hold, &mut longest.across);
    }
}

/// Measures the vertical springs between two rows.
#[inline(always)]
fn measure_down(upper: &[Block], lower: &[Block], holds: &[Lanes], longest: &mut Longest) {
    for ((a, b), hold) in upper.iter().zip(lower).zip(holds) {
        measure(a.view(), b.view(), hold, &mut longest.down);
    }
}

/// Measures the springs from each column of one row to the next column of the other.
#[inline(always)]
fn measure_diagonal(left: &[Block], right: &[Block], holds: &[Lanes], longest: &mut Longest) {
    for ((a, b), hold) in left.iter().zip(&right[1..]).zip(holds) {
        measure(a.view(), b.view(), hold, &mut longest.diagonal);
    }
    if let (Some(a), Some(b), Some(hold)) = (left.last(), right.first(), holds.last()) {
        measure(a.view(), b.shifted(), hold, &mut longest.diagonal);
    }
}

/// The instruction set that a sub-step may use. Results are the same to the last bit.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SimdLevel {
    /// The widest of the machine, detected at run time: AVX2 on x86-64.
    #[default]
    Auto,
    /// The baseline of the architecture: SSE2 on x86-64.
    Baseline,
}

impl SimdLevel {
    pub(crate) fn kernels(self) -> Kernels {
        match self {
            Self::Auto => widest(),
            Self::Baseline => baseline(),
        }
    }
}

/// Makes the table of all row kernels, and both functions that fill it: each kernel is a function of its own, for
/// one large one would be too much for the compiler to vectorise evenly.
macro_rules! kernels {
    ($($name:ident($($argument:ident: $kind:ty),*)),* $(,)?) => {
        /// The arithmetic, compiled for one instruction set.
        #[derive(Clone, Copy)]
        pub(crate) struct Kernels {
            $(pub $name: fn($($kind),*),)*
        }

        #[multiversion(targets("x86_64+avx+avx2"))]
        fn widest() -> Kernels {
            $(
                #[inherit_target]
                fn $name($($argument: $kind),*) {
                    super::kernels::$name($($argument),*);
                }
            )*
            Kernels { $($name),* }
        }

        fn baseline() -> Kernels {
            Kernels { $($name),* }
        }
    };
}

kernels! {
    predict_first(row: &mut [Block], prediction: &Prediction),
    predict(row: &mut [Block], past: &mut [Earlier], prediction: &Prediction),
    predict_first_forced(row: &mut [Block], linearized: &[LinearForce], prediction: &Prediction, force_step: &ForceStep),
    predict_forced(row: &mut [Block], past: &mut [Earlier], linearized: &[LinearForce], prediction: &Prediction, force_step: &ForceStep),
    begin_past(row: &[Block], past: &mut [Earlier]),
    air_areas(rows: &Rows, areas: &mut [Vec3Lanes]),
    air_linearize(blocks: &[Block], areas: &[Vec3Lanes], winds: &[Vec3Lanes], coefficients: &AeroCoefficients, linearized: &mut [LinearForce], places: &mut [Lanes]),
    force_impulse(blocks: &[Block], linearized: &[LinearForce], places: &[Lanes], seconds: f32, sum: &mut Vec3Lanes),
    force_push(row: &mut [Block], linearized: &[LinearForce], weight: f32, inverse_substep: f32),
    solve_chains(chains: &mut Chains, springs: &SpringBand),
    solve_damped_chains(chains: &mut Chains, springs: &SpringBand),
    solve_rows(rows: &mut RowChains, springs: &[SpringBand; 2]),
    solve_damped_rows(rows: &mut RowChains, springs: &[SpringBand; 2]),
    solve_rows_again(rows: &mut RowChains, springs: &[SpringBand; 2]),
    solve_columns(columns: &mut Columns, springs: &SpringBand),
    solve_columns_again(columns: &mut Columns, springs: &SpringBand),
    note_places(row: &[Block], left: &mut Residuals),
    measure_left(row: &[Block], springs: &RowSprings, left: &mut Residuals),
    measure_elastic_left(row: &[Block], springs: &RowSprings, left: &mut Residuals),
    measure_left_at(row: &[Block], blocks: &[u32], springs: &RowSprings, left: &mut Residuals),
    measure_elastic_left_at(row: &[Block], blocks: &[u32], springs: &RowSprings, left: &mut Residuals),
    measure_given(pulled: &[Lanes], softness: &[Lanes], largest: &mut Lanes),
    bundle_forward(rows: &[Row], heads: &[u32; LANES], steps: &[Step], pulled: &[Lanes], solved: &mut [Solved], step_scale: &StepScale),
    bundle_backward(rows: &mut [Row], heads: &[u32; LANES], steps: &[Step], pulled: &mut [Lanes], solved: &[Solved]),
    commit(row: &mut [Block], farthest: &mut Lanes),
    kick(blocks: &mut [Block], first: usize, around: [&[Block]; 2], springs: &ElasticGrid, kick: &Kick, forces: &mut [Vec<Force>; 2], moved: &mut Lanes),
    relax_packets_there(rows: &mut [Row], packets: &[Packet], pulls: &mut [Vec4], step_scale: &StepScale),
    relax_packets_back(rows: &mut [Row], packets: &[Packet], pulls: &mut [Vec4], step_scale: &StepScale),
    plate_places(row: &[Block], origin: &[f32; 3], part: f32, places: &mut [Vec3Lanes]),
    plate_moments(places: [&[Vec3Lanes]; 3], stiffness: &[Stiffness], moments: &mut [Moments]),
    plate_push(moments: [&[Moments]; 3], weight: f32, row: &mut [Block]),
    chain_links(from: &[Block], to: &[Block], links: &mut [Vec3Lanes]),
    chain_moments(links: [&[Vec3Lanes]; 2], stiffness: &[Lanes], moments: &mut [Vec3Lanes]),
    chain_forward(moments: [&[Vec3Lanes]; 3], solved: [&[Vec3Lanes]; 2], factors: &[Factor], out: &mut [Vec3Lanes]),
    chain_backward(blocks: &mut [Block], own: &[Factor], solved: [&[Vec3Lanes]; 2], factors: [&[Factor]; 2], out: &mut [Vec3Lanes]),
    chain_columns(rows: &[Block], strip: usize, columns: &mut [Vec3Lanes]),
    chain_rows(columns: &mut [Vec3Lanes], stiffness: &Lanes, factors: &[Factor]),
    chain_finish(columns: &[Vec3Lanes], strip: usize, rows: &mut [Block]),
    twist_links(row: &[Block], is_odd: bool, links: &mut [Vec3Lanes]),
    twist_forward(links: [&[Vec3Lanes]; 2], stiffness: &[Lanes], moments: &mut [Vec3Lanes], before: &[Vec3Lanes], factors: &[Factor], out: &mut [Vec3Lanes]),
    twist_backward(row: &mut [Block], is_odd: bool, factors: [&[Factor]; 2], next: &[Vec3Lanes], out: &mut [Vec3Lanes]),
    tethers(row: &mut [Block], anchors: &[[Lanes; 3]], anchor_of: &[u32], length_square: &[Lanes]),
    measure_within(row: &[Block], holds: &[Lanes], longest: &mut Longest),
    measure_down(upper: &[Block], lower: &[Block], holds: &[Lanes], longest: &mut Longest),
    measure_diagonal(left: &[Block], right: &[Block], holds: &[Lanes], longest: &mut Longest),
}
