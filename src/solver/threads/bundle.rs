//! Threads that lead anywhere, as those of a mesh: eight at a time, each in a lane.
//!
//! # The floor
//! A spring is three loads and one store of a particle's four numbers, two turns of four by four numbers for four of them,
//! and two divisions for eight. What one pivot waits for of the one before is a division and three multiplications: some 25
//! cycles for eight springs, while the particles of the next are on their way.

use std::sync::Arc;

use bevy::math::{Mat4, Vec4};

use super::link::{HOLD, terms};
use crate::{
    cloth::{LANES, Lanes, SpringList, Thread},
    solver::{kernel::Kernels, packet::Row},
};

/// The next spring of each thread of a bundle.
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

/// What is known of a step between the forward and the backward pass.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Solved {
    way: [Lanes; 3],
    /// Inverse mass of the second particle (1/kg).
    weight: Lanes,
    pivot: Lanes,
    right: Lanes,
}

impl Solved {
    const NONE: Self = Self {
        way: [[0.0; LANES]; 3],
        weight: [0.0; LANES],
        pivot: [0.0; LANES],
        right: [0.0; LANES],
    };
}

/// Up to eight threads that share no particle.
#[derive(Debug)]
struct Bundle {
    /// The rows of the particles that they begin at.
    heads: [u32; LANES],
    /// As many as the longest has springs.
    steps: Vec<Step>,
}

/// All threads of a list of springs, colour by colour.
#[derive(Debug, Default, Clone)]
pub(in crate::solver) struct Bundles {
    all: Arc<[Bundle]>,
    /// Room for the longest.
    solved: Vec<Solved>,
}

impl Bundles {
    /// Of the threads in `list`. `row_of` says in which row a particle is; in row `none` there is no particle.
    pub fn new(list: &SpringList, row_of: impl Fn(u32) -> u32, none: u32) -> Self {
        let bundle = |threads: &[Thread]| {
            let mut at = threads.iter().map(|thread| thread.first);
            let mut at: [u32; LANES] = std::array::from_fn(|_| at.next().unwrap_or(u32::MAX));
            let row = |particle: u32| if particle == u32::MAX { none } else { row_of(particle) };
            let heads = at.map(row);
            let steps = (0..threads.iter().map(|thread| thread.edges.len()).max().unwrap_or(0)).map(|index| {
                let mut step = Step {
                    to: [none; LANES],
                    rest: [1.0; LANES],
                    inverse_rest: [1.0; LANES],
                    compliance: [0.0; LANES],
                    hold: [f32::INFINITY; LANES],
                };
                for (lane, thread) in threads.iter().enumerate() {
                    let Some(&edge) = thread.edges.get(index) else {
                        continue;
                    };
                    let spring = &list.springs[edge as usize];
                    let [a, b] = spring.ends;
                    at[lane] = if a == at[lane] { b } else { a };
                    step.to[lane] = row_of(at[lane]);
                    step.rest[lane] = spring.rest_length;
                    step.inverse_rest[lane] = 1.0 / spring.rest_length;
                    step.compliance[lane] = spring.compliance;
                    step.hold[lane] = HOLD;
                }
                step
            });
            Bundle { heads, steps: steps.collect() }
        };
        let all: Arc<[Bundle]> = list
            .threads
            .colours
            .iter()
            .rev()
            .flat_map(|threads| threads.chunks(LANES))
            .map(bundle)
            .collect();
        let longest = all.iter().map(|bundle| bundle.steps.len()).max();
        Self {
            all,
            solved: vec![Solved::NONE; longest.unwrap_or(0)],
        }
    }

    /// Whether there is no thread.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Solves thread after thread. `inverse_weight` is 1/(c Δt²) (1/s²).
    pub fn solve(&mut self, rows: &mut [Row], inverse_weight: f32, kernels: &Kernels) {
        for Bundle { heads, steps } in self.all.iter() {
            (kernels.bundle_forward)(rows, heads, steps, &mut self.solved, inverse_weight);
            (kernels.bundle_backward)(rows, heads, steps, &self.solved);
        }
    }
}

/// The coordinates of eight vectors.
#[inline(always)]
fn turned(vectors: &[Vec4; LANES]) -> [Lanes; 4] {
    let [a, b, c, d, e, f, g, h] = *vectors;
    let low = Mat4::from_cols(a, b, c, d).transpose().to_cols_array_2d();
    let high = Mat4::from_cols(e, f, g, h).transpose().to_cols_array_2d();
    std::array::from_fn(|axis| {
        let ([a, b, c, d], [e, f, g, h]) = (low[axis], high[axis]);
        [a, b, c, d, e, f, g, h]
    })
}

/// Eight vectors of these coordinates, and 0.
#[inline(always)]
fn vectors(coordinates: &[Lanes; 3]) -> [Vec4; LANES] {
    let of = |from: usize| {
        let [x, y, z] = [0, 1, 2].map(|axis| Vec4::from_slice(&coordinates[axis][from..from + 4]));
        let turned = Mat4::from_cols(x, y, z, Vec4::ZERO).transpose();
        [turned.x_axis, turned.y_axis, turned.z_axis, turned.w_axis]
    };
    let ([a, b, c, d], [e, f, g, h]) = (of(0), of(4));
    [a, b, c, d, e, f, g, h]
}

/// Forward over the springs of a bundle: eliminates each spring before.
#[inline(always)]
pub(crate) fn bundle_forward(
    rows: &[Row],
    heads: &[u32; LANES],
    steps: &[Step],
    solved: &mut [Solved],
    inverse_weight: f32,
) {
    let is_weight = Vec4::W.cmpgt(Vec4::ZERO);
    let mut from = heads;
    let mut weight_a = heads.map(|head| rows[head as usize].place.w);
    let mut previous = Solved::NONE;
    for (step, solved) in steps.iter().zip(solved) {
        let offsets: [Vec4; LANES] = std::array::from_fn(|l| {
            let (a, b) = (&rows[from[l] as usize], &rows[step.to[l] as usize]);
            let offset = (b.place - a.place) + (b.moved - a.moved);
            Vec4::select(is_weight, b.place, offset)
        });
        let [x, y, z, weight] = turned(&offsets);
        let mut link = Solved { way: [x, y, z], weight, ..Solved::NONE };
        for l in 0..LANES {
            let [x, y, z] = [0, 1, 2].map(|axis| link.way[axis][l] * step.inverse_rest[l]);
            let both = weight_a[l] + weight[l];
            let softness = step.compliance[l] * inverse_weight;
            let [diagonal, right] = terms([x, y, z], both, softness, step.hold[l], step.rest[l]);
            let before = &previous.way;
            let along = before[0][l] * x + before[1][l] * y + before[2][l] * z;
            let off = -weight_a[l] * along;
            let pivot = 1.0 / (diagonal - off * (off * previous.pivot[l]));
            [link.way[0][l], link.way[1][l], link.way[2][l]] = [x, y, z];
            link.pivot[l] = pivot;
            link.right[l] = (right - off * previous.right[l]) * pivot;
        }
        *solved = link;
        previous = link;
        weight_a = weight;
        from = &step.to;
    }
}

/// Backward: puts in the spring after each, and moves the particle between them.
#[inline(always)]
pub(crate) fn bundle_backward(
    rows: &mut [Row],
    heads: &[u32; LANES],
    steps: &[Step],
    solved: &[Solved],
) {
    let mut next = [[0.0; LANES]; 3];
    for (step, link) in steps.iter().zip(solved).rev() {
        let mut change = [[0.0; LANES]; 3];
        for l in 0..LANES {
            let way = [0, 1, 2].map(|axis| link.way[axis][l]);
            let along = way[0] * next[0][l] + way[1] * next[1][l] + way[2] * next[2][l];
            let multiplier = link.right[l] + link.pivot[l] * (link.weight[l] * along);
            for axis in 0..3 {
                let own = way[axis] * multiplier;
                change[axis][l] = link.weight[l] * (own - next[axis][l]);
                next[axis][l] = own;
            }
        }
        for (to, change) in step.to.iter().zip(vectors(&change)) {
            rows[*to as usize].moved += change;
        }
    }
    for (head, pull) in heads.iter().zip(vectors(&next)) {
        let row = &mut rows[*head as usize];
        row.moved -= pull * row.place.w;
    }
}
