//! The top-down query.

use std::ops::Range;

use bevy::reflect::Reflect;

use super::{NodeBounds, Probe, QuadTree, found::Found, scan::scan};
use crate::cloth::ClothParticles;

/// What the last search made of a node.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NodeState {
    /// An ancestor did not touch: the node was not looked at.
    #[default]
    Unvisited,
    /// Looked at; no collider touches it, and its children were not looked at: pruned.
    Untouched,
    /// Looked at; a collider touches it, or may within the tick.
    Touching,
}

/// A top-down search through a tree, level by level, with what it found. Reused from tick to tick without
/// allocating once it has grown.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
pub struct TopDownQuery {
    found: Found,
}

impl TopDownQuery {
    /// Forgets what was found.
    pub fn clear(&mut self) {
        self.found.visits.clear();
        self.found.candidates.clear();
        self.found.leaf_tests = 0;
    }

    /// Searches for `probe`, adds to what was found since [`clear`](Self::clear), and says which of the
    /// [`candidates`](Self::candidates) are the probe's. The tree and the bounds must be those of the
    /// particles: in others nothing is found.
    pub fn search(
        &mut self,
        tree: &QuadTree,
        bounds: &NodeBounds,
        particles: &ClothParticles,
        probe: &Probe,
    ) -> Range<usize> {
        let first = self.found.candidates.len();
        if tree.matches(particles) && bounds.matches(tree) {
            tree.shape()
                .search(&bounds.volumes, particles, probe, &mut self.found);
        }
        first..self.found.candidates.len()
    }

    /// Tests every particle instead, eight at a time: for cloths so small that a tree does not pay.
    pub fn scan(&mut self, particles: &ClothParticles, probe: &Probe) -> Range<usize> {
        let first = self.found.candidates.len();
        scan(particles, probe, &mut self.found.candidates);
        self.found.leaf_tests += particles.len();
        first..self.found.candidates.len()
    }

    /// Particles that a probe meets, in the order of the searches.
    pub fn candidates(&self) -> &[u32] {
        &self.found.candidates
    }

    /// Nodes that were looked at, in that order, once for each search, and whether they touched.
    pub fn visits(&self) -> &[(u32, bool)] {
        &self.found.visits
    }

    /// What became of each node of the tree: touched by any collider is touched. Written to `states`.
    pub fn states_into(&self, tree: &QuadTree, states: &mut Vec<NodeState>) {
        states.clear();
        states.resize(tree.len(), NodeState::Unvisited);
        for &(node, touching) in &self.found.visits {
            if let Some(state) = states.get_mut(node as usize) {
                if touching {
                    *state = NodeState::Touching;
                } else if *state == NodeState::Unvisited {
                    *state = NodeState::Untouched;
                }
            }
        }
    }

    /// What became of each node of the tree.
    pub fn states(&self, tree: &QuadTree) -> Vec<NodeState> {
        let mut states = Vec::new();
        self.states_into(tree, &mut states);
        states
    }

    /// Nodes of `level` that were looked at, once for each search, and those of them that touched.
    pub fn level(&self, tree: &QuadTree, level: usize) -> (usize, usize) {
        let nodes = tree.levels().get(level).cloned().unwrap_or_default();
        let on_it = || {
            self.found
                .visits
                .iter()
                .filter(|(node, _)| nodes.contains(node))
        };
        (
            on_it().count(),
            on_it().filter(|(_, touching)| *touching).count(),
        )
    }

    /// Nodes looked at since [`clear`](Self::clear), leaves included, once for each search.
    pub fn nodes_visited(&self) -> usize {
        self.found.visits.len()
    }

    /// Particles tested: leaves among the nodes, and all of a scan's.
    pub fn leaf_tests(&self) -> usize {
        self.found.leaf_tests
    }
}
