//! One sub-step over springs that lie on no grid: the same arithmetic on eight springs of a colour at a time,
//! their ends gathered from wherever they are.

use std::ops::Range;

use super::{run::LEAST_SOFTNESS, wave::Motion};
use crate::cloth::{Block, LANES, Lanes, Layout, Slot, Spring};

/// Springs of one colour, at most eight.
#[derive(Debug, Clone, PartialEq)]
struct Bundle {
    ends: [[Slot; 2]; LANES],
    count: usize,
    rest_square: Lanes,
    /// Compliance (m/N), infinite where there is no spring.
    compliance: Lanes,
    /// α/Δt² (1/kg).
    softness: Lanes,
}

/// A list of springs as the sub-steps want them.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct ListSweep {
    bundles: Vec<Bundle>,
}

impl ListSweep {
    /// For particles that lie as `layout` says.
    pub fn new(springs: &[Spring], colours: &[Range<usize>], layout: Layout) -> Self {
        let bundle = |springs: &[Spring]| {
            let of = |lane: usize| springs.get(lane);
            Bundle {
                ends: std::array::from_fn(|lane| {
                    let ends = of(lane).map_or([0, 0], |spring| spring.ends);
                    ends.map(|end| layout.slot_of(end as usize))
                }),
                count: springs.len(),
                rest_square: std::array::from_fn(|lane| {
                    of(lane).map_or(1.0, |spring| spring.rest_length * spring.rest_length)
                }),
                compliance: std::array::from_fn(|lane| {
                    of(lane).map_or(f32::INFINITY, |spring| spring.compliance)
                }),
                softness: [0.0; LANES],
            }
        };
        let colours = colours.iter().map(|colour| &springs[colour.clone()]);
        Self {
            bundles: colours
                .flat_map(|colour| colour.chunks(LANES))
                .map(bundle)
                .collect(),
        }
    }

    /// Takes over the length of a sub-step (s).
    pub fn soften(&mut self, substep: f32) {
        for bundle in &mut self.bundles {
            for (softness, compliance) in bundle.softness.iter_mut().zip(&bundle.compliance) {
                *softness = compliance / (substep * substep) + LEAST_SOFTNESS;
            }
        }
    }

    /// One sub-step. Returns the largest squared displacements (m²).
    pub fn substep(&self, blocks: &mut [Block], motion: &Motion) -> Lanes {
        let kernels = motion.kernels;
        (kernels.integrate)(blocks, motion.kept, motion.acceleration_dt2);
        for bundle in &self.bundles {
            let [mut a, mut b] = [Block::EMPTY; 2];
            let copy = |from: &Block, lane: usize, into: &mut Block, to: usize| {
                into.set_position(to, from.position(lane));
                into.set_displacement(to, from.displacement(lane));
                into.set_inverse_mass(to, from.inverse_mass(lane));
            };
            for (lane, [from, to]) in bundle.ends.iter().enumerate().take(bundle.count) {
                copy(&blocks[from.block], from.lane, &mut a, lane);
                copy(&blocks[to.block], to.lane, &mut b, lane);
            }
            (kernels.springs)(&mut a, &mut b, &bundle.rest_square, &bundle.softness);
            for (lane, [from, to]) in bundle.ends.iter().enumerate().take(bundle.count) {
                blocks[from.block].set_displacement(from.lane, a.displacement(lane));
                blocks[to.block].set_displacement(to.lane, b.displacement(lane));
            }
        }
        motion.tethers.pull(motion.anchors, blocks, 0, kernels);
        let mut farthest = [0.0; LANES];
        (kernels.commit)(blocks, &mut farthest);
        farthest
    }
}
