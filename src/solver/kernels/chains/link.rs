//! One spring of a chain, in the system of equations of all springs of that chain.

use crate::{
    cloth::{ClothGrid, Compliances, DX, LANES, Lanes, Layout, MapInline, View, W, X},
    solver::kernels::{each::three, step_scale::StepScale},
};

/// Keeps a spring between two pins from dividing by zero (1/kg).
pub(crate) const HOLD: f32 = 1.0e-18;

/// ε: added to a rigid chain, as a fraction of its diagonal. Straight between two pins it would have no solution.
const REGULARISATION: f32 = 1.0e-3;

/// Added for the relative error of a squared length: a chain between pins too far apart pulls with C/ε, and a particle
/// beside its line by y would be thrown beyond it, by C/ε × y.
const STRAINED: f32 = 0.2;

/// Eight springs, each of a chain of its own, between the forward and the backward pass.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Link {
    /// From its first to its second particle, in rest lengths.
    pub span: [Lanes; 3],
    /// The fraction of its multiplier that is passed to the spring before it.
    pub share: Lanes,
    /// Right side, eliminated; after the backward pass the multiplier (m kg).
    pub right: Lanes,
}

impl Link {
    /// No spring.
    pub const NONE: Self = Self {
        span: [[0.0; LANES]; 3],
        share: [0.0; LANES],
        right: [0.0; LANES],
    };
}

/// The data that a spring needs of the one before it in its chain.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Before {
    /// In rest lengths.
    pub span: [Lanes; 3],
    /// One over the pivot of its row of the system (kg).
    pub pivot: Lanes,
    /// Right side, eliminated (m kg).
    pub right: Lanes,
}

impl Before {
    /// No spring.
    pub const NONE: Self = Self {
        span: [[0.0; LANES]; 3],
        pivot: [0.0; LANES],
        right: [0.0; LANES],
    };
}

/// The data that a spring needs of the one behind it in its chain.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Behind {
    /// Its pull (m kg).
    pub pull: [Lanes; 3],
    /// The part of its multiplier for the spring before it (m kg).
    pub given: Lanes,
}

impl Behind {
    /// No spring.
    pub const NONE: Self = Self {
        pull: [[0.0; LANES]; 3],
        given: [0.0; LANES],
    };
}

/// Springs that lie alike: those that begin in the blocks of a row, or of each row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SpringBand {
    /// Length at rest (m).
    pub rest: f32,
    /// One over it.
    pub inverse_rest: f32,
    /// One over its square, 0 where there is no spring.
    pub inverse_square: Vec<Lanes>,
    /// m/N; 0 where there is none.
    compliance: Vec<Lanes>,
    /// Compliance over c Δt² (1/kg).
    pub softness: Vec<Lanes>,
    /// 0, or infinity where there is no spring (1/kg).
    pub hold: Vec<Lanes>,
    /// From the springs of a row to those of the next; 0 where one row stands for all.
    stride: usize,
    /// The part of a spring's stretch that a sub-step answers; the rest is damping's, for what changes in it. 1 without.
    pub kept: f32,
}

impl SpringBand {
    /// The springs of this step that begin in `row` of `grid`; one row stands for all like it.
    pub fn new(
        grid: &ClothGrid,
        layout: Layout,
        of: &Compliances,
        step: (u32, i32),
        row: u32,
    ) -> Self {
        Self::of_rows(grid.step_length(step), layout, 1, |_, column| {
            let end = column.checked_add_signed(step.1)?;
            let row = row.min(grid.rows().saturating_sub(1));
            (end < grid.columns()).then_some(())?;
            of.of_strip(grid, step, (row, column))
        })
    }

    /// Springs of this length at rest (m), with a compliance (m/N) by the row and column that each begins in; `None` where there is
    /// none. One row stands for all, or there are `rows`.
    pub fn of_rows(
        rest: f32,
        layout: Layout,
        rows: usize,
        compliance: impl Fn(usize, u32) -> Option<f32>,
    ) -> Self {
        let strip = layout.strip as usize;
        let at = |block: usize, lane: usize| {
            let column = layout.column(block % strip, lane)?;
            compliance(block / strip, column)
        };
        let all = |number: &dyn Fn(Option<f32>) -> f32| -> Vec<Lanes> {
            let lanes = |block| std::array::from_fn(|lane| number(at(block, lane)));
            (0..rows * strip).map(lanes).collect()
        };
        Self {
            stride: if rows > 1 { strip } else { 0 },
            rest,
            inverse_rest: 1.0 / rest,
            inverse_square: all(&|compliance| compliance.map_or(0.0, |_| 1.0 / (rest * rest))),
            compliance: all(&|compliance| compliance.unwrap_or(0.0)),
            softness: all(&|_| 0.0),
            hold: all(&|compliance| compliance.map_or(f32::INFINITY, |_| HOLD)),
            kept: 1.0,
        }
    }

    /// Where the springs that begin in a row are.
    #[inline(always)]
    pub fn first_of(&self, row: usize) -> usize {
        row * self.stride
    }

    /// The values of `hold` along a row, whose number of blocks is `strip`.
    #[inline(always)]
    pub fn holds_of(&self, row: usize, strip: usize) -> &[Lanes] {
        &self.hold[self.first_of(row)..][..strip]
    }

    /// The largest of its springs (N/m), where they give; else 0.
    pub fn stiffness(&self) -> f32 {
        let all = self.compliance.iter().flatten();
        let least = all
            .filter(|compliance| **compliance > 0.0)
            .fold(f32::INFINITY, |least, compliance| least.min(*compliance));
        1.0 / least
    }

    /// Takes over the parameters of a sub-step.
    pub fn soften(&mut self, step_scale: StepScale) {
        for (softness, compliance) in self.softness.iter_mut().zip(&self.compliance) {
            *softness = compliance.map_inline(|compliance| compliance * step_scale.inverse_weight);
        }
        self.kept = if self.is_elastic() {
            step_scale.kept
        } else {
            1.0
        };
    }

    /// Whether a spring of it gives.
    pub fn is_elastic(&self) -> bool {
        self.compliance.as_flattened().iter().any(|of| *of > 0.0)
    }
}

/// So far apart are no two neighbours of a cloth (rest lengths): farther, and products of lengths would be infinite.
const FARTHEST: f32 = 1.0e4;

#[inline(always)]
pub(crate) fn clamped(span: f32) -> f32 {
    let span = if span > FARTHEST { FARTHEST } else { span };
    if span < -FARTHEST { -FARTHEST } else { span }
}

/// Diagonal (1/kg) and right side (m) of a spring with this span, between particles of these inverse masses together (1/kg).
#[inline(always)]
pub(crate) fn terms(
    [x, y, z]: [f32; 3],
    weight: f32,
    softness: f32,
    hold: f32,
    rest: f32,
) -> [f32; 2] {
    terms_at([x, y, z], weight, softness, hold, rest, [1.0; 2])
}

/// The same of a spring without a force at another length: its square, and one over it, in squared lengths at rest.
#[inline(always)]
pub(crate) fn terms_at(
    [x, y, z]: [f32; 3],
    weight: f32,
    softness: f32,
    hold: f32,
    rest: f32,
    [square, inverse_square]: [f32; 2],
) -> [f32; 2] {
    let p = x * x + y * y + z * z;
    let soft = softness * p;
    let off = p - square;
    let least = (REGULARISATION + STRAINED * (off * inverse_square).abs()) * weight;
    let soft = if soft > least { soft } else { least };
    // Halley's step for the root, as in a sweep. Between two pins, however far apart, nothing is to be done.
    let right = -rest * p * (off / (1.5 * p + 0.5 * square));
    let right = if weight > 0.0 { right } else { 0.0 };
    [weight * p + (soft + hold), right]
}

/// The stretch of a spring in a sub-step, times its length at the end (m): the right side of [`terms`] against the length at the start.
/// It is 0 where the spring only turns. `end` is its span at the end, `moved` how far that has moved (rest lengths): small, so that its
/// rounding is, too.
#[inline(always)]
pub(crate) fn opening(end: [f32; 3], moved: [f32; 3], rest: f32) -> f32 {
    let moved = three(|axis| clamped(moved[axis]));
    let start = three(|axis| end[axis] - moved[axis]);
    let twice = three(|axis| end[axis] + start[axis]);
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (p, square, longer) = (dot(end, end), dot(start, start), dot(twice, moved));
    rest * p * (longer / (1.5 * p + 0.5 * square + HOLD))
}

/// The right side of one lane's spring with damping along it: a force of τ/α times the speed of its stretch, `C − C₀` in a sub-step,
/// makes `C + (τ/Δt)(C − C₀)` of C in its equation, which is divided by 1 + τ/Δt = 1/κ: `κ C + (1 − κ)(C − C₀)`, with a softness
/// of κ α/(c Δt²).
#[inline(always)]
pub(crate) fn damped(
    right: f32,
    [a, b]: [&View; 2],
    span: [f32; 3],
    springs: &SpringBand,
    l: usize,
) -> f32 {
    let moved = three(|axis| {
        let at = DX + axis * LANES + l;
        (b[at] - a[at]) * springs.inverse_rest
    });
    let opening = opening(span, moved, springs.rest);
    let kept = springs.kept;
    let opening = if a[W + l] + b[W + l] > 0.0 {
        opening
    } else {
        0.0
    };
    kept * right - (1.0 - kept) * opening
}

/// The span of one lane's spring from the first to the second particle, in rest lengths.
#[inline(always)]
pub(crate) fn span(a: &View, b: &View, inverse_rest: f32, l: usize) -> [f32; 3] {
    three(|axis| {
        let (at, moved) = (X + axis * LANES, DX + axis * LANES);
        clamped(((b[at + l] - a[at + l]) + (b[moved + l] - a[moved + l])) * inverse_rest)
    })
}

/// Raises `largest` to the springs' elongations at their pull (m), from their multipliers. They are as parts of lengths without
/// elongation.
#[inline(always)]
pub(crate) fn measure_given(pulled: &[Lanes], softness: &[Lanes], largest: &mut Lanes) {
    for (pulled, softness) in pulled.iter().zip(softness) {
        for l in 0..LANES {
            let given = (pulled[l] * softness[l]).abs();
            largest[l] = if given > largest[l] {
                given
            } else {
                largest[l]
            };
        }
    }
}

/// The right side that a spring which has pulled already has left, of that without a pull.
#[inline(always)]
pub(crate) fn after(right: f32, [x, y, z]: [f32; 3], softness: f32, pulled: f32) -> f32 {
    right - softness * (x * x + y * y + z * z) * pulled
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the change from a length of b to one of a in f64, times a. Halley's step leaves out the part (a − b)²/(3 a² + b²) of it, at
    /// small stretches ε²/4. Where the spring only turns, all of it is 0.
    #[test]
    fn what_opens_is_a_change_of_length() {
        // Farther apart, displacements are cut.
        let lengths = [0.0, 0.3, 0.95, 1.0, 1.05, 5.0, 0.4 * FARTHEST];
        for (long, before, turn) in lengths
            .iter()
            .flat_map(|long| lengths.map(|before| (*long, before)))
            .flat_map(|(long, before)| (0..8).map(move |turn| (long, before, turn as f32)))
        {
            let (sin, cos) = turn.sin_cos();
            let (end, start) = ([long, 0.0, 0.0], [cos, 0.6 * sin, 0.8 * sin]);
            let moved = three(|axis| end[axis] - before * start[axis]);
            let found = f64::from(opening(end, moved, 0.5));
            let [long, before] = [long, before].map(f64::from);
            let truth = 0.5 * long * (long - before);
            let square = 3.0 * long * long + before * before;
            let left_out = (long - before).powi(2) / square.max(f64::MIN_POSITIVE);
            let expected = (1.0 - left_out) * truth;
            let rounding = 4.0e-7 * (long * long + before * before);
            assert!((found - expected).abs() <= rounding, "{found} {expected}");
        }
    }
}
