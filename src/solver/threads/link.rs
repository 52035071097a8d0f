//! One spring of a thread, in the system of equations of all springs of that thread.

use crate::cloth::{ClothGrid, Compliances, DX, DY, DZ, LANES, Lanes, Layout, View, W, X, Y, Z};

/// What keeps a spring between two pins from dividing by zero (1/kg).
pub(super) const HOLD: f32 = 1.0e-18;

/// ε: what is added to a thread that is rigid, as a part of its diagonal. Straight between two pins it would have no solution.
const REGULARISATION: f32 = 1.0e-3;

/// And for each part by which a squared length is off: a thread between pins too far apart pulls with C/ε, and what is off its
/// line by y would be thrown beyond it, by C/ε × y.
const STRAINED: f32 = 0.2;

/// Eight springs that begin in the lanes of one block, between the forward and the backward pass.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Link {
    /// From its first to its second particle, in rest lengths; after the backward pass what it pulls with (m kg).
    pub way: [Lanes; 3],
    /// One over the pivot of its row of the system (kg).
    pub pivot: Lanes,
    /// Right side, eliminated (m kg).
    pub right: Lanes,
}

impl Link {
    /// No spring.
    pub const NONE: Self = Self {
        way: [[0.0; LANES]; 3],
        pivot: [0.0; LANES],
        right: [0.0; LANES],
    };

    /// Each lane holds what its left neighbour did.
    #[inline(always)]
    pub fn moved_right(&self) -> Self {
        self.each(from_left)
    }

    /// Each lane holds what its right neighbour did.
    #[inline(always)]
    pub fn moved_left(&self) -> Self {
        self.each(from_right)
    }

    #[inline(always)]
    fn each(&self, f: fn(&Lanes) -> Lanes) -> Self {
        let [x, y, z] = &self.way;
        Self {
            way: [f(x), f(y), f(z)],
            pivot: f(&self.pivot),
            right: f(&self.right),
        }
    }
}

#[inline(always)]
pub(super) fn from_left([a, b, c, d, e, f, g, _]: &Lanes) -> Lanes {
    [0.0, *a, *b, *c, *d, *e, *f, *g]
}

#[inline(always)]
pub(super) fn from_right([_, a, b, c, d, e, f, g]: &Lanes) -> Lanes {
    [*a, *b, *c, *d, *e, *f, *g, 0.0]
}

/// Springs that lie alike: those that begin in the blocks of a row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Family {
    /// Length at rest (m).
    pub rest: f32,
    /// One over it.
    pub inverse_rest: f32,
    /// m/N; 0 where there is none.
    compliance: Vec<Lanes>,
    /// Compliance over c Δt² (1/kg).
    pub softness: Vec<Lanes>,
    /// 0, or infinity where there is no spring (1/kg).
    pub hold: Vec<Lanes>,
}

impl Family {
    /// The springs of this step that begin in `row` of `grid`; one row stands for all like it.
    pub fn new(
        grid: &ClothGrid,
        layout: Layout,
        of: &Compliances,
        step: (u32, i32),
        row: u32,
    ) -> Self {
        let compliance = |block: usize, lane: usize| {
            let column = layout.column(block, lane)?;
            let end = column.checked_add_signed(step.1)?;
            let row = row.min(grid.rows().saturating_sub(1));
            (end < grid.columns()).then_some(())?;
            of.of_strip(grid, step, (row, column))
        };
        let all = |number: &dyn Fn(Option<f32>) -> f32| -> Vec<Lanes> {
            let lanes = |block| std::array::from_fn(|lane| number(compliance(block, lane)));
            (0..layout.strip as usize).map(lanes).collect()
        };
        let rest = grid.step_length(step);
        Self {
            rest,
            inverse_rest: 1.0 / rest,
            compliance: all(&|compliance| compliance.unwrap_or(0.0)),
            softness: all(&|_| 0.0),
            hold: all(&|compliance| compliance.map_or(f32::INFINITY, |_| HOLD)),
        }
    }

    /// The largest of its springs (N/m), where they give; else 0.
    pub fn stiffness(&self) -> f32 {
        let all = self.compliance.iter().flatten();
        let least = all
            .filter(|compliance| **compliance > 0.0)
            .fold(f32::INFINITY, |least, compliance| least.min(*compliance));
        1.0 / least
    }

    /// Takes over c Δt² (s²).
    pub fn soften(&mut self, weight_dt2: f32) {
        let inverse = 1.0 / weight_dt2;
        for (softness, compliance) in self.softness.iter_mut().zip(&self.compliance) {
            *softness = compliance.map(|compliance| compliance * inverse);
        }
    }
}

/// The row of the system for eight springs: their ways, and diagonal (1/kg) and right side (m).
#[derive(Debug, Clone, Copy)]
pub(super) struct Equation {
    pub way: [Lanes; 3],
    pub diagonal: Lanes,
    pub right: Lanes,
}

/// So far apart are no two neighbours of a cloth (rest lengths): farther, and products of lengths would be infinite.
const FARTHEST: f32 = 1.0e4;

#[inline(always)]
pub(super) fn clamped(way: f32) -> f32 {
    let way = if way > FARTHEST { FARTHEST } else { way };
    if way < -FARTHEST { -FARTHEST } else { way }
}

/// Diagonal (1/kg) and right side (m) of a spring with this way, between particles of these inverse masses together (1/kg).
#[inline(always)]
pub(super) fn terms(
    [x, y, z]: [f32; 3],
    weight: f32,
    softness: f32,
    hold: f32,
    rest: f32,
) -> [f32; 2] {
    let p = x * x + y * y + z * z;
    let soft = softness * p;
    let off = if p > 1.0 { p - 1.0 } else { 1.0 - p };
    let least = (REGULARISATION + STRAINED * off) * weight;
    let soft = if soft > least { soft } else { least };
    // Halley's step for the root, as in a sweep. Between two pins, however far apart, nothing is to be done.
    let right = -rest * p * ((p - 1.0) / (1.5 * p + 0.5));
    let right = if weight > 0.0 { right } else { 0.0 };
    [weight * p + (soft + hold), right]
}

/// From views of the first and the second particles.
#[inline(always)]
pub(super) fn equation(a: &View, b: &View, family: &Family, block: usize) -> Equation {
    let mut row = Equation {
        way: [[0.0; LANES]; 3],
        diagonal: [0.0; LANES],
        right: [0.0; LANES],
    };
    let (softness, hold) = (&family.softness[block], &family.hold[block]);
    for l in 0..LANES {
        let x = clamped(((b[X + l] - a[X + l]) + (b[DX + l] - a[DX + l])) * family.inverse_rest);
        let y = clamped(((b[Y + l] - a[Y + l]) + (b[DY + l] - a[DY + l])) * family.inverse_rest);
        let z = clamped(((b[Z + l] - a[Z + l]) + (b[DZ + l] - a[DZ + l])) * family.inverse_rest);
        let weight = a[W + l] + b[W + l];
        [row.way[0][l], row.way[1][l], row.way[2][l]] = [x, y, z];
        [row.diagonal[l], row.right[l]] =
            terms([x, y, z], weight, softness[l], hold[l], family.rest);
    }
    row
}

/// Raises `largest` to the squares of what springs give at their pull (m²).
#[inline(always)]
pub(crate) fn measure_given(pulls: &[[Lanes; 3]], softness: &[Lanes], largest: &mut Lanes) {
    for ([x, y, z], softness) in pulls.iter().zip(softness) {
        for l in 0..LANES {
            let pull = x[l] * x[l] + y[l] * y[l] + z[l] * z[l];
            let given = pull * softness[l] * softness[l];
            largest[l] = if given > largest[l] {
                given
            } else {
                largest[l]
            };
        }
    }
}
