//! The prediction of particles without springs, of first and of second order in time.
//!
//! With v kept to the part κ in a sub-step, the paper's equation (2), `x' = x + κ (x − x_prev) + a Δt²`, is the first.
//! The second takes backward differences of second order (BDF2) for x and for v: with d₀, d₁, d₂ the last
//! displacements, `d = d₀ + (6 (d₀ − d₁) − (d₁ − d₂))/9 + (4/9) a Δt²` where nothing is damped. Forces and springs
//! count with a weight c in a sub-step: 1 in first order, 4/9 in second.
//!
//! Damping acts on velocities relative to the carrier of the cloth. This is a shift of all particles alike: the
//! velocity that they would lose by moving with the carrier is given back, so that they move on with it.
//!
//! A motion of second order begins with a sub-step of weight ½ from position and velocity, `d = d₀ + ½ a Δt²`. The two
//! displacements before are those of a constant acceleration. A sub-step of first order in its place would leave a
//! velocity that is off by a Δt/2, and make everything after it of first order.

use bevy::math::Vec3;

use super::{
    barrier::one_block_at_a_time,
    forces::{LinearForce, acceleration},
};
use crate::cloth::{Block, DX, DY, DZ, Earlier, LANES, StepKind, W};

/// The next displacement: `own d₀ + one (d₀ − d₁) + two (d₁ − d₂) + pull`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prediction {
    own: f32,
    one: f32,
    two: f32,
    /// c a Δt², and what damping gives back (m).
    pull: [f32; 3],
    /// The parts of the carrier's displacement and gain that damping gives back.
    lost: [f32; 2],
}

impl Prediction {
    /// With velocities kept to the part `kept`, and c a Δt² (m). They are relative to what has moved by `displacement` in the sub-step
    /// before, and gains `gain` in each (m).
    pub fn new(kind: StepKind, kept: f32, pull: Vec3, [displacement, gain]: [Vec3; 2]) -> Self {
        let k = f64::from(kept);
        let [own, one, two] = match kind {
            StepKind::First => [k, 0.0, 0.0],
            StepKind::Start => [k.sqrt(), 0.0, 0.0],
            // (8 κ u₀ − 2 κ² u₁)/9 + d₀/3 with velocities u₀ = (3 d₀ − d₁)/2 and u₁ = (3 d₁ − d₂)/2.
            StepKind::Second => [
                (3.0 + 8.0 * k - 2.0 * k * k) / 9.0,
                (4.0 * k + 2.0 * k * k) / 9.0,
                -k * k / 9.0,
            ],
        };
        // All of them together, as they are where nothing is lost, come to d₀ + 5/9 of the gain.
        let lost = (1.0 - own) as f32;
        let lost_gain = match kind {
            StepKind::First | StepKind::Start => 0.0,
            StepKind::Second => (5.0 / 9.0 - one - two) as f32,
        };
        Self {
            own: own as f32,
            one: one as f32,
            two: two as f32,
            pull: (pull + lost * displacement + lost_gain * gain).to_array(),
            lost: [lost, lost_gain],
        }
    }

    /// Damping gives this back (m) to particles that have moved by so much more than the carrier in the sub-step before, and gain so much
    /// more (m).
    pub fn given_back(&self, [displacement, gain]: [Vec3; 2]) -> Vec3 {
        let [lost, lost_gain] = self.lost;
        lost * displacement + lost_gain * gain
    }
}

/// The weight c of forces and springs.
pub(crate) fn weight(kind: StepKind) -> f32 {
    match kind {
        StepKind::First => 1.0,
        StepKind::Start => 0.5,
        StepKind::Second => 4.0 / 9.0,
    }
}

/// Without a past. Pinned particles keep the displacement that they were given.
#[inline(always)]
pub(crate) fn predict_first(row: &mut [Block], prediction: &Prediction) {
    for block in row {
        let view = block.view_mut();
        for (at, pull) in [DX, DY, DZ].into_iter().zip(prediction.pull) {
            for l in 0..LANES {
                let moved = view[at + l] * prediction.own + pull;
                view[at + l] = if view[W + l] > 0.0 {
                    moved
                } else {
                    view[at + l]
                };
            }
        }
        one_block_at_a_time();
    }
}

/// With a past, which moves on by a sub-step.
#[inline(always)]
pub(crate) fn predict(row: &mut [Block], past: &mut [Earlier], prediction: &Prediction) {
    let Prediction {
        own,
        one,
        two,
        pull,
        ..
    } = *prediction;
    for (block, Earlier(earlier)) in row.iter_mut().zip(past) {
        let view = block.view_mut();
        // Found once a block, as bits: compilers make much of a choice by numbers that lie elsewhere in the block.
        let mut free = [0; LANES];
        for l in 0..LANES {
            free[l] = if view[W + l] > 0.0 { u32::MAX } else { 0 };
        }
        for axis in 0..3 {
            let at = DX + axis * LANES;
            for l in 0..LANES {
                let (now, before, first) = (view[at + l], earlier[axis][l], earlier[axis + 3][l]);
                let moved = own * now + one * (now - before) + two * (before - first) + pull[axis];
                let chosen = (moved.to_bits() & free[l]) | (now.to_bits() & !free[l]);
                view[at + l] = f32::from_bits(chosen);
                earlier[axis + 3][l] = before;
                earlier[axis][l] = now;
            }
        }
        one_block_at_a_time();
    }
}

/// Parameters of forces in a sub-step: its weight (s²), and one over its length (1/s).
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForceStep {
    pub weight: f32,
    pub inverse_substep: f32,
}

/// Without a past, under forces.
#[inline(always)]
pub(crate) fn predict_first_forced(
    row: &mut [Block],
    linearized: &[LinearForce],
    prediction: &Prediction,
    force_step: &ForceStep,
) {
    for (block, linearized) in row.iter_mut().zip(linearized) {
        let view = block.view_mut();
        for l in 0..LANES {
            let now = [view[DX + l], view[DY + l], view[DZ + l]];
            let given = acceleration(linearized, now, force_step.inverse_substep, l);
            for axis in 0..3 {
                let at = DX + axis * LANES + l;
                let pull = prediction.pull[axis] + force_step.weight * given[axis];
                let moved = now[axis] * prediction.own + pull;
                view[at] = if view[W + l] > 0.0 { moved } else { now[axis] };
            }
        }
        one_block_at_a_time();
    }
}

/// With a past, which moves on by a sub-step, under forces.
#[inline(always)]
pub(crate) fn predict_forced(
    row: &mut [Block],
    past: &mut [Earlier],
    linearized: &[LinearForce],
    prediction: &Prediction,
    force_step: &ForceStep,
) {
    let Prediction {
        own,
        one,
        two,
        pull,
        ..
    } = *prediction;
    let ForceStep {
        weight,
        inverse_substep,
    } = *force_step;
    for ((block, Earlier(earlier)), linearized) in row.iter_mut().zip(past).zip(linearized) {
        let view = block.view_mut();
        let (mut free, mut given) = ([0; LANES], [[0.0; LANES]; 3]);
        for l in 0..LANES {
            free[l] = if view[W + l] > 0.0 { u32::MAX } else { 0 };
            let now = [view[DX + l], view[DY + l], view[DZ + l]];
            let [x, y, z] = acceleration(linearized, now, inverse_substep, l);
            (given[0][l], given[1][l], given[2][l]) = (x, y, z);
        }
        for axis in 0..3 {
            let at = DX + axis * LANES;
            for l in 0..LANES {
                let (now, before, first) = (view[at + l], earlier[axis][l], earlier[axis + 3][l]);
                let moved = own * now + one * (now - before) + two * (before - first);
                let moved = moved + (pull[axis] + weight * given[axis][l]);
                let chosen = (moved.to_bits() & free[l]) | (now.to_bits() & !free[l]);
                view[at + l] = f32::from_bits(chosen);
                earlier[axis + 3][l] = before;
                earlier[axis][l] = now;
            }
        }
        one_block_at_a_time();
    }
}

/// Ends the first sub-step: the past is what the acceleration in it would have made it.
#[inline(always)]
pub(crate) fn begin_past(row: &[Block], past: &mut [Earlier]) {
    for (block, Earlier(earlier)) in row.iter().zip(past) {
        let view = block.view();
        for axis in 0..3 {
            for l in 0..LANES {
                let (moved, came) = (view[DX + axis * LANES + l], earlier[axis][l]);
                earlier[axis][l] = came + (came - moved);
                earlier[axis + 3][l] = came + 3.0 * (came - moved);
            }
        }
        one_block_at_a_time();
    }
}
