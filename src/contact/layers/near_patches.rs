//! Pairs of patches that are near each other, but for [neighbours](super::folds).
//!
//! A box around each patch leaves it clearance to move. A patch that leaves its box gets another one, for which the trees
//! are searched from the top down.

use bevy::math::Vec3A;

use super::{bounds::Bounds, motion::Motion, participant::Participant, sheet::Node};
use crate::cloth::MapInline;

/// Room around a patch, as a fraction of the shortest spacing, and the number of sub-steps of motion ahead.
const ROOM: f32 = 0.25;
const AHEAD: f32 = 8.0;

/// A box around each patch, in which it may move, and the boxes of the trees' nodes.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PatchBoxes {
    /// Of each patch, without the motion that all have in common.
    boxes: Vec<Bounds>,
    /// Of the nodes of each cloth's tree.
    nodes: Vec<Vec<Bounds>>,
    /// The patches that have left their boxes, and those boxes.
    left: Vec<(u32, Bounds)>,
    #[cfg_attr(feature = "serialize", serde(skip))]
    stack: Vec<u32>,
}

/// Which patches may touch each other.
pub(super) struct Meets<'a, F> {
    pub cloths: &'a [Participant<'a>],
    pub meets: F,
}

impl<F: Fn(usize, usize) -> bool> Meets<'_, F> {
    #[inline]
    pub fn of(&self, a: usize, b: usize) -> bool {
        let [first, second] = [a, b].map_inline(|cloth| &self.cloths[cloth]);
        if a == b {
            first.settings.with_itself && !first.is_fixed
        } else {
            (self.meets)(a, b) && !(first.is_fixed && second.is_fixed)
        }
    }
}

impl PatchBoxes {
    /// Begins with patches that have no boxes.
    pub fn reset(&mut self, cloths: &[Participant], patches: usize) {
        self.boxes.clear();
        self.boxes.resize(patches, Bounds::EMPTY);
        self.nodes.resize_with(cloths.len(), Vec::new);
        for (nodes, cloth) in self.nodes.iter_mut().zip(cloths) {
            nodes.clear();
            nodes.resize(cloth.sheet.nodes().len(), Bounds::EMPTY);
        }
    }

    /// Makes boxes for patches that have left theirs, but for a `reserve` (m). Returns whether there are any, and how far
    /// any patch may move before it leaves its box (m).
    pub fn renew(&mut self, cloths: &[Participant], motion: &Motion, reserve: f32) -> (bool, f32) {
        let (before, after) = (motion.drift - motion.drifted, motion.drift);
        self.left.clear();
        let mut free = f32::INFINITY;
        for (index, (patch, clearance)) in motion.patches.iter().zip(&mut self.boxes).enumerate() {
            let cloth = &cloths[patch.cloth as usize];
            let half = Vec3A::splat(0.5 * cloth.settings.thickness);
            let at_end = patch.bounds_at_end();
            let at_end = Bounds {
                min: at_end.min - after - half,
                max: at_end.max - after + half,
            };
            let inside = (at_end.min - clearance.min).min(clearance.max - at_end.max);
            // False for NaN.
            if inside.min_element() >= reserve {
                free = free.min(inside.min_element());
                continue;
            }
            self.left.push((index as u32, *clearance));
            let at_start = patch.bounds_at_start();
            let at_start = Bounds {
                min: at_start.min - before - half,
                max: at_start.max - before + half,
            };
            let moved = patch.end - patch.start - motion.drifted;
            let ahead = moved * AHEAD;
            let around = ROOM * cloth.sheet.surface().spacing().shortest;
            free = free.min(around);
            let both = at_start.join(&at_end);
            *clearance = Bounds {
                min: both.min - around + ahead.min(Vec3A::ZERO),
                max: both.max + around + ahead.max(Vec3A::ZERO),
            };
        }
        if self.left.is_empty() {
            return (false, free);
        }
        for (index, cloth) in cloths.iter().enumerate() {
            let boxes = &self.boxes[motion.firsts[index][1] as usize..];
            let bounds = &mut self.nodes[index];
            // Children come after their parents.
            for (index, node) in cloth.sheet.nodes().iter().enumerate().rev() {
                bounds[index] = match node.children() {
                    [] => boxes[node.patch as usize],
                    children => children.iter().fold(Bounds::EMPTY, |joined, &child| {
                        joined.join(&bounds[child as usize])
                    }),
                };
            }
        }
        (true, free)
    }

    /// Whether the boxes of two patches overlap.
    #[inline]
    pub fn overlap(&self, [a, b]: [u32; 2]) -> bool {
        a == b || self.boxes[a as usize].overlaps(&self.boxes[b as usize])
    }

    /// Finds the pairs of patches whose boxes have begun to overlap. Subtracts the visited nodes from `work`.
    pub fn search(
        &mut self,
        among: &Meets<impl Fn(usize, usize) -> bool>,
        motion: &Motion,
        work: &mut usize,
        mut found: impl FnMut([u32; 2]),
    ) {
        // Boxes that they had, in the order of patches.
        let before = |patch: u32| {
            let index = self.left.binary_search_by_key(&patch, |left| left.0);
            index.ok().map(|index| self.left[index].1)
        };
        for &(patch, had) in &self.left {
            let clearance = self.boxes[patch as usize];
            let own = motion.patches[patch as usize].cloth as usize;
            for (other, cloth) in among.cloths.iter().enumerate() {
                if !among.of(own, other) {
                    continue;
                }
                let first = motion.firsts[other][1];
                self.stack.clear();
                self.stack
                    .extend((!cloth.sheet.nodes().is_empty()).then_some(0));
                while let Some(node) = self.stack.pop() {
                    *work = work.saturating_sub(1);
                    if !self.nodes[other][node as usize].overlaps(&clearance) {
                        continue;
                    }
                    let node: &Node = &cloth.sheet.nodes()[node as usize];
                    self.stack.extend(node.children().iter().rev());
                    if !node.children().is_empty() {
                        continue;
                    }
                    let second = first + node.patch;
                    let (is_first, had_second) = match before(second) {
                        Some(had) => (patch <= second, had),
                        None => (true, self.boxes[second as usize]),
                    };
                    // Only a fold makes neighbours a pair.
                    let are_neighbours = || {
                        let of =
                            || [patch.min(second), patch.max(second)].map_inline(|of| of - first);
                        other == own && cloth.sheet.windows().pair_of(of()).is_some()
                    };
                    if is_first && !had.overlaps(&had_second) && !are_neighbours() {
                        found([patch.min(second), patch.max(second)]);
                    }
                }
            }
        }
    }
}
