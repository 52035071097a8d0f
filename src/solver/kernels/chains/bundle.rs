//! Chains in any direction, such as those of a mesh: eight at a time, each in a lane.
//!
//! # The floor
//! Forward, eight springs take the 56 numbers of the particles that they lead to, one by one, and two divisions. The step before
//! knows those that they begin at. Each pivot waits for a division and three multiplications of the one before: some 25 cycles.
//! Eight springs take 64 cycles, 2.7 ns each: all numbers go through one port of the processor.

use bevy::math::Vec4;

use super::link::{HOLD, clamped, opening, terms_at};
use crate::{
    cloth::{LANES, Lanes, Spring},
    solver::kernels::{
        each::three,
        packet::{Row, turned},
        step_scale::StepScale,
    },
};

/// The next spring of each chain of a bundle.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Step {
    /// The row of the particle that it leads to.
    to: [u32; LANES],
    /// Length at rest (m).
    rest: Lanes,
    /// One over it.
    inverse_rest: Lanes,
    /// m/N.
    compliance: Lanes,
    /// 0, or infinity where there is no spring (1/kg).
    hold: Lanes,
}

impl Step {
    /// No springs, to row `none`.
    pub fn none(none: u32) -> Self {
        Self {
            to: [none; LANES],
            rest: [1.0; LANES],
            inverse_rest: [1.0; LANES],
            compliance: [0.0; LANES],
            hold: [f32::INFINITY; LANES],
        }
    }

    /// The row that one lane leads to, and its spring's length at rest (m) and compliance (m/N); `None` where there is no spring.
    pub fn lane(&self, lane: usize) -> (u32, Option<(f32, f32)>) {
        let is_there = self.hold[lane] < f32::INFINITY;
        let spring = is_there.then_some((self.rest[lane], self.compliance[lane]));
        (self.to[lane], spring)
    }

    /// Leads one lane to row `to`, without a spring.
    pub fn lead(&mut self, lane: usize, to: u32) {
        self.to[lane] = to;
    }

    /// The spring in one lane, to the particle in row `to`.
    pub fn set(&mut self, lane: usize, to: u32, spring: &Spring) {
        self.to[lane] = to;
        self.rest[lane] = spring.rest_length;
        self.inverse_rest[lane] = 1.0 / spring.rest_length;
        self.compliance[lane] = spring.compliance;
        self.hold[lane] = HOLD;
    }
}

/// The state of a step between the forward and the backward pass.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Solved {
    span: [Lanes; 3],
    /// Inverse mass of the second particle (1/kg).
    weight: Lanes,
    pivot: Lanes,
    right: Lanes,
}

impl Solved {
    pub const NONE: Self = Self {
        span: [[0.0; LANES]; 3],
        weight: [0.0; LANES],
        pivot: [0.0; LANES],
        right: [0.0; LANES],
    };
}

/// Eight particles, gathered number by number. Storing vectors of four and loading them as eight lanes stalls: that took as long as
/// all the rest.
#[derive(Clone, Copy)]
struct Particles {
    place: [Lanes; 3],
    moved: [Lanes; 3],
    /// Inverse masses (1/kg).
    weight: Lanes,
}

impl Particles {
    #[inline(always)]
    fn gather(rows: &[Row], at: &[u32; LANES]) -> Self {
        let mut particles = Self {
            place: [[0.0; LANES]; 3],
            moved: [[0.0; LANES]; 3],
            weight: [0.0; LANES],
        };
        for l in 0..LANES {
            let Row { place, moved } = &rows[at[l] as usize];
            let Self {
                place: [x, y, z],
                moved: [dx, dy, dz],
                weight,
            } = &mut particles;
            (x[l], y[l], z[l], weight[l]) = (place.x, place.y, place.z, place.w);
            (dx[l], dy[l], dz[l]) = (moved.x, moved.y, moved.z);
        }
        particles
    }
}

/// Eight vectors of these coordinates, and 0.
#[inline(always)]
fn vectors(coordinates: &[Lanes; 3]) -> [Vec4; LANES] {
    let [x, y, z] = coordinates;
    let half =
        |of: &Lanes, from: usize| Vec4::new(of[from], of[from + 1], of[from + 2], of[from + 3]);
    let of = |from: usize| turned([half(x, from), half(y, from), half(z, from), Vec4::ZERO]);
    let ([a, b, c, d], [e, f, g, h]) = (of(0), of(4));
    [a, b, c, d, e, f, g, h]
}

/// Forward over the springs of a bundle: eliminates each spring before.
#[inline(always)]
pub(crate) fn bundle_forward(
    rows: &[Row],
    heads: &[u32; LANES],
    steps: &[Step],
    pulled: &[Lanes],
    solved: &mut [Solved],
    step_scale: &StepScale,
) {
    if step_scale.kept < 1.0 || step_scale.stiffer.is_some() {
        forward::<true>(rows, heads, steps, pulled, solved, step_scale);
    } else {
        forward::<false>(rows, heads, steps, pulled, solved, step_scale);
    }
}

#[inline(always)]
fn forward<const DAMPED_OR_STIFFER: bool>(
    rows: &[Row],
    heads: &[u32; LANES],
    steps: &[Step],
    pulled: &[Lanes],
    solved: &mut [Solved],
    step_scale: &StepScale,
) {
    let mut a = Particles::gather(rows, heads);
    let mut previous = Solved::NONE;
    for ((step, pulled), solved) in steps.iter().zip(pulled).zip(solved) {
        let b = Particles::gather(rows, &step.to);
        let mut link = Solved {
            weight: b.weight,
            ..Solved::NONE
        };
        for l in 0..LANES {
            let [x, y, z] = three(|axis| {
                let moved = b.moved[axis][l] - a.moved[axis][l];
                let span = (b.place[axis][l] - a.place[axis][l]) + moved;
                clamped(span * step.inverse_rest[l])
            });
            let both = a.weight[l] + b.weight[l];
            let is_rigid = step.compliance[l] == 0.0;
            let kept = if is_rigid { 1.0 } else { step_scale.kept };
            let mut softness = step.compliance[l] * step_scale.inverse_weight;
            let mut squares = [1.0; 2];
            if DAMPED_OR_STIFFER {
                let stiffer = &step_scale.stiffer;
                let is_stiff = x * x + y * y + z * z > stiffer.from && !is_rigid;
                let part = if is_stiff { stiffer.compliance } else { 1.0 };
                softness *= kept * part;
                for (square, of_stiff) in squares.iter_mut().zip(stiffer.squares) {
                    *square = if is_stiff { of_stiff } else { 1.0 };
                }
            }
            let (hold, rest) = (step.hold[l], step.rest[l]);
            let [diagonal, right] = terms_at([x, y, z], both, softness, hold, rest, squares);
            let right = if DAMPED_OR_STIFFER {
                // The same as a grid's springs do.
                let moved =
                    three(|axis| (b.moved[axis][l] - a.moved[axis][l]) * step.inverse_rest[l]);
                let opening = opening([x, y, z], moved, rest);
                let opening = if both > 0.0 { opening } else { 0.0 };
                kept * right - (1.0 - kept) * opening
            } else {
                right
            };
            // What gives has pulled already.
            let right = right - softness * (x * x + y * y + z * z) * pulled[l];
            let before = &previous.span;
            let along = before[0][l] * x + before[1][l] * y + before[2][l] * z;
            let off = -a.weight[l] * along;
            let pivot = 1.0 / (diagonal - off * (off * previous.pivot[l]));
            [link.span[0][l], link.span[1][l], link.span[2][l]] = [x, y, z];
            link.pivot[l] = pivot;
            link.right[l] = (right - off * previous.right[l]) * pivot;
        }
        *solved = link;
        previous = link;
        a = b;
    }
}

/// Backward: puts in the spring after each, and moves the particle between them.
#[inline(always)]
pub(crate) fn bundle_backward(
    rows: &mut [Row],
    heads: &[u32; LANES],
    steps: &[Step],
    pulled: &mut [Lanes],
    solved: &[Solved],
) {
    let mut next = [[0.0; LANES]; 3];
    for ((step, pulled), link) in steps.iter().zip(pulled).zip(solved).rev() {
        let (mut own, mut change) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for l in 0..LANES {
            let [x, y, z] = [link.span[0][l], link.span[1][l], link.span[2][l]];
            let along = x * next[0][l] + y * next[1][l] + z * next[2][l];
            let multiplier = link.right[l] + link.pivot[l] * (link.weight[l] * along);
            pulled[l] += multiplier;
            [own[0][l], own[1][l], own[2][l]] = [x * multiplier, y * multiplier, z * multiplier];
            change[0][l] = link.weight[l] * (own[0][l] - next[0][l]);
            change[1][l] = link.weight[l] * (own[1][l] - next[1][l]);
            change[2][l] = link.weight[l] * (own[2][l] - next[2][l]);
        }
        for (to, change) in step.to.iter().zip(vectors(&change)) {
            rows[*to as usize].moved += change;
        }
        next = own;
    }
    for (head, pull) in heads.iter().zip(vectors(&next)) {
        let row = &mut rows[*head as usize];
        row.moved -= pull * row.place.w;
    }
}
