//! All chains of a list of springs, eight at a time.
//!
//! In a lane one chain follows another, with a step between them that has no spring and leads to the next one's first particle:
//!
//! ```text
//! lane 0   o─o─o─o─o─o─o─o─o      a bundle of nine steps
//! lane 1   o─o─o─o─o   o─o─o
//! lane 2   o─o─o   o─o─o   o─o
//! ```

#[cfg(test)]
mod tests;

use std::{ops::Range, sync::Arc};

use crate::{
    cloth::{Chain, LANES, Lanes, SpringList},
    solver::kernels::{Kernels, Row, Solved, Step, StepScale},
};

/// Chains that share no particle, in eight lanes.
#[derive(Debug)]
struct Bundle {
    /// The rows of the particles that the lanes begin at.
    heads: [u32; LANES],
    /// As many as the longest chain has springs.
    steps: Range<usize>,
}

/// All chains of a list of springs, colour by colour.
#[derive(Debug, Default, Clone)]
pub(crate) struct Bundles {
    bundles: Arc<[Bundle]>,
    steps: Arc<[Step]>,
    /// The multipliers of the springs of each step from the forward pass (kg).
    pulled: Vec<Lanes>,
    /// Of one bundle.
    solved: Vec<Solved>,
}

impl Bundles {
    /// Of the chains in `list`. `row_of` says in which row a particle is; in row `none` there is no particle.
    pub fn new(list: &SpringList, row_of: impl Fn(u32) -> u32, none: u32) -> Self {
        let (mut bundles, mut steps) = (Vec::new(), Vec::<Step>::new());
        for lanes in list.chains.colours.iter().flat_map(|of| in_lanes(of)) {
            let begin = steps.len();
            let longest = lanes[0].first().map_or(0, |chain| chain.edges.len());
            steps.resize(begin + longest, Step::none(none));
            let mut heads = [none; LANES];
            for (lane, chains) in lanes.iter().enumerate() {
                let mut next = begin;
                for chain in chains {
                    let mut at = chain.first;
                    if next == begin {
                        heads[lane] = row_of(at);
                    } else {
                        steps[next].lead(lane, row_of(at));
                        next += 1;
                    }
                    for (edge, step) in chain.edges.iter().zip(&mut steps[next..]) {
                        let spring = &list.springs[*edge as usize];
                        let [a, b] = spring.ends;
                        at = if a == at { b } else { a };
                        step.set(lane, row_of(at), spring);
                    }
                    next += chain.edges.len();
                }
            }
            bundles.push(Bundle {
                heads,
                steps: begin..steps.len(),
            });
        }
        let longest = bundles.iter().map(|bundle| bundle.steps.len()).max();
        Self {
            bundles: bundles.into(),
            pulled: vec![[0.0; LANES]; steps.len()],
            steps: steps.into(),
            solved: vec![Solved::NONE; longest.unwrap_or(0)],
        }
    }

    /// Whether there is no chain.
    pub fn is_empty(&self) -> bool {
        self.bundles.is_empty()
    }

    /// Solves chain after chain.
    pub fn solve_there(&mut self, rows: &mut [Row], step_scale: &StepScale, kernels: &Kernels) {
        self.pulled.fill([0.0; LANES]);
        for index in 0..self.bundles.len() {
            self.solve(index, rows, step_scale, kernels);
        }
    }

    /// The same from the last to the first, after [`solve_there`](Self::solve_there): springs that give go on from what they
    /// have pulled with.
    pub fn solve_back(&mut self, rows: &mut [Row], step_scale: &StepScale, kernels: &Kernels) {
        for index in (0..self.bundles.len()).rev() {
            self.solve(index, rows, step_scale, kernels);
        }
    }

    fn solve(&mut self, index: usize, rows: &mut [Row], step_scale: &StepScale, kernels: &Kernels) {
        let Bundle { heads, steps } = &self.bundles[index];
        let pulled = &mut self.pulled[steps.clone()];
        let steps = &self.steps[steps.clone()];
        let solved = &mut self.solved;
        (kernels.bundle_forward)(rows, heads, steps, pulled, solved, step_scale);
        (kernels.bundle_backward)(rows, heads, steps, pulled, solved);
    }

    /// Calls `visit` with each spring as it was solved last: the rows of its ends, its length at rest (m), its compliance (m/N) and
    /// its pull (m kg).
    pub fn for_each_pull(&self, mut visit: impl FnMut([u32; 2], f32, f32, f32)) {
        for Bundle { heads, steps } in &*self.bundles {
            let mut from = *heads;
            for (step, pulled) in self.steps[steps.clone()]
                .iter()
                .zip(&self.pulled[steps.clone()])
            {
                for lane in 0..LANES {
                    let (to, spring) = step.lane(lane);
                    if let Some((rest, compliance)) = spring {
                        // A multiplier is negative where its spring is too long.
                        visit([from[lane], to], rest, compliance, -pulled[lane]);
                    }
                    from[lane] = to;
                }
            }
        }
    }
}

/// Distributes the chains of a colour, of which the longest is first, among the lanes of bundles. A bundle is as long as its longest
/// chain; each lane takes the longest chain that it has room for, until none is short enough.
fn in_lanes(colour: &[Chain]) -> Vec<[Vec<&Chain>; LANES]> {
    debug_assert!(colour.is_sorted_by_key(|chain| std::cmp::Reverse(chain.edges.len())));
    let mut left: Vec<&Chain> = colour.iter().collect();
    let mut bundles = Vec::new();
    while let Some(longest) = left.first().map(|chain| chain.edges.len()) {
        bundles.push(std::array::from_fn(|_| {
            let (mut lane, mut room) = (Vec::new(), longest);
            loop {
                let fits = left.partition_point(|chain| chain.edges.len() > room);
                if fits == left.len() {
                    return lane;
                }
                let chain = left.remove(fits);
                // A step leads to the next.
                room = room.saturating_sub(chain.edges.len() + 1);
                lane.push(chain);
            }
        }));
    }
    bundles
}
