//! The top-down query.

use std::ops::Range;

use bevy::reflect::Reflect;

use super::{
    bounds::NodeBounds, probe::Probe, scan::scan, search_buffers::SearchBuffers, tree::QuadTree,
};
use crate::cloth::ClothParticles;

/// The result of the last search for a node.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
pub enum NodeState {
    /// An ancestor did not touch: the node was not tested.
    #[default]
    Unvisited,
    /// Tested and pruned: no collider touches it, and its children were not tested.
    Untouched,
    /// Tested: a collider touches it, or may within the tick.
    Touching,
}

/// A top-down search through a tree, level by level, with its results. Reused from tick to tick; once it has grown, it
/// does not allocate.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
pub struct TopDownQuery {
    found: SearchBuffers,
}

impl TopDownQuery {
    /// Clears the results.
    pub fn clear(&mut self) {
        self.found.visits.clear();
        self.found.candidates.clear();
        self.found.leaf_tests = 0;
    }

    /// Keeps no [`visits`](Self::visits) from now on, where nobody reads them.
    pub(crate) fn silence(&mut self) {
        self.found.is_silent = true;
    }

    /// Searches for `probe`, and appends to the results since [`clear`](Self::clear). Returns the range of the probe's
    /// [`candidates`](Self::candidates). The tree and the bounds must belong to the particles, or nothing is found.
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

    /// Tests every particle instead, eight at a time: for cloths too small for a tree.
    pub fn scan(&mut self, particles: &ClothParticles, probe: &Probe) -> Range<usize> {
        let first = self.found.candidates.len();
        let (blocks, layout) = (particles.blocks(), particles.layout());
        scan(blocks, layout, probe, &mut self.found.candidates);
        self.found.leaf_tests += particles.len();
        first..self.found.candidates.len()
    }

    /// Particles that the probes meet, in the order of the searches.
    pub fn candidates(&self) -> &[u32] {
        &self.found.candidates
    }

    /// Tested nodes in the order of the tests, once for each search, and whether they touched.
    pub fn visits(&self) -> &[(u32, bool)] {
        &self.found.visits
    }

    /// Writes the state of each node of the tree to `states`. A node that any collider touches is `Touching`.
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

    /// The state of each node of the tree.
    pub fn states(&self, tree: &QuadTree) -> Vec<NodeState> {
        let mut states = Vec::new();
        self.states_into(tree, &mut states);
        states
    }

    /// Number of tested nodes of `level`, once for each search, and number of those that touched.
    pub fn level(&self, tree: &QuadTree, level: usize) -> (usize, usize) {
        let nodes = tree.levels().get(level).cloned().unwrap_or_default();
        let visits = self.found.visits.iter();
        let on_it = visits.filter(|(node, _)| nodes.contains(node));
        let touching = on_it.clone().filter(|(_, touching)| *touching);
        (on_it.count(), touching.count())
    }

    /// Number of nodes tested since [`clear`](Self::clear), including leaves, once for each search.
    pub fn nodes_visited(&self) -> usize {
        self.found.visits.len()
    }

    /// Number of particles tested: tested leaves, and all particles of a scan.
    pub fn leaf_tests(&self) -> usize {
        self.found.leaf_tests
    }
}
