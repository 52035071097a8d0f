//! The top-down query.

use std::ops::Range;

use bevy::reflect::Reflect;

use super::{
    BoundRule, NodeBounds, Probe, QuadTree,
    bounds::{Bounds, Kind, each, middle, position},
    scan::scan,
    tree::{GridTree, NetworkTree, Part, Shape},
    volume::Volume,
};
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
    /// Nodes in the order in which they were looked at, and whether they touched.
    visits: Vec<(u32, bool)>,
    /// Children of touching nodes on the level that is looked at, and on the next: from and to which row, from and to
    /// which column; of a network, from and to which node.
    frontier: [Vec<[u32; 4]>; 2],
    candidates: Vec<u32>,
    leaf_tests: usize,
}

impl TopDownQuery {
    /// Forgets what was found.
    pub fn clear(&mut self) {
        self.visits.clear();
        self.candidates.clear();
        self.leaf_tests = 0;
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
        let first = self.candidates.len();
        if tree.fits(particles) && bounds.fit(tree) {
            each!(&bounds.kind, bounds => match &tree.0 {
                Shape::Grid(tree) => self.search_grid(tree, bounds, particles, probe),
                Shape::Network(tree) => self.search_network(tree, bounds, particles, probe),
            });
        }
        first..self.candidates.len()
    }

    /// Tests every particle instead, eight at a time: for cloths so small that a tree does not pay.
    pub fn scan(&mut self, particles: &ClothParticles, probe: &Probe) -> Range<usize> {
        let first = self.candidates.len();
        scan(particles, probe, &mut self.candidates);
        self.leaf_tests += particles.len();
        first..self.candidates.len()
    }

    fn search_grid<V: Volume>(
        &mut self,
        tree: &GridTree,
        bounds: &Bounds<V>,
        particles: &ClothParticles,
        probe: &Probe,
    ) {
        let reach = probe.reach() as f32;
        match bounds.rule {
            BoundRule::RestShape => {
                self.descend(tree, particles, probe, |level, _, rows, columns| {
                    let radius = bounds.grown(tree.levels[level].rest_radius(rows, columns));
                    V::around(middle(particles, rows, columns), radius).may_reach(probe, reach)
                });
            }
            BoundRule::Refit => self.descend(tree, particles, probe, |level, at, _, _| {
                bounds
                    .stored(tree, particles, level, at)
                    .may_reach(probe, reach)
            }),
            // The paper's volumes are as large as they are, whatever the particles in them.
            BoundRule::Paper => self.descend(tree, particles, probe, |level, at, _, _| {
                bounds
                    .stored(tree, particles, level, at)
                    .may_reach(probe, probe.radius)
            }),
        }
    }

    fn descend(
        &mut self,
        tree: &GridTree,
        particles: &ClothParticles,
        probe: &Probe,
        touches: impl Fn(usize, [u32; 2], &Part, &Part) -> bool,
    ) {
        let Self {
            visits,
            frontier: [here, next],
            candidates,
            leaf_tests,
        } = self;
        here.clear();
        here.push([0, 1, 0, 1]);
        let leaves = tree.levels.len() - 1;
        for (level, parts) in tree.levels.iter().enumerate() {
            let before = visits.len();
            next.clear();
            for &[first_row, end_row, first_column, end_column] in here.iter() {
                for (row, rows) in (first_row..end_row).zip(&parts.rows[first_row as usize..]) {
                    for (column, columns) in
                        (first_column..end_column).zip(&parts.columns[first_column as usize..])
                    {
                        let touching = touches(level, [row, column], rows, columns);
                        visits.push((parts.index(row, column), touching));
                        if touching && level < leaves {
                            let (below, beside) = (&rows.children, &columns.children);
                            next.push([below.start, below.end, beside.start, beside.end]);
                        } else if touching && probe.meets(middle(particles, rows, columns)) {
                            candidates.push(rows.middle * tree.layout.columns + columns.middle);
                        }
                    }
                }
            }
            if level == leaves {
                *leaf_tests += visits.len() - before;
            }
            std::mem::swap(here, next);
        }
    }

    fn search_network<V: Volume>(
        &mut self,
        tree: &NetworkTree,
        bounds: &Bounds<V>,
        particles: &ClothParticles,
        probe: &Probe,
    ) {
        if tree.nodes.is_empty() {
            return;
        }
        let queue = &mut self.frontier[0];
        queue.clear();
        queue.push([0, 1, 0, 0]);
        let mut next = 0;
        // Children are put behind what is still to be looked at: level by level.
        while let Some(&[first, end, ..]) = queue.get(next) {
            next += 1;
            for index in first..end {
                let node = &tree.nodes[index as usize];
                let middle = position(particles, tree.slots[node.middle as usize]);
                let volume = match bounds.rule {
                    BoundRule::RestShape => V::around(middle, bounds.grown(node.rest_radius)),
                    BoundRule::Refit | BoundRule::Paper => bounds.stored_in_network(index),
                };
                let touching = volume.may_reach(probe, probe.reach() as f32);
                self.visits.push((index, touching));
                if node.children.is_empty() {
                    self.leaf_tests += 1;
                    if touching && probe.meets(middle) {
                        self.candidates.push(node.middle);
                    }
                } else if touching {
                    queue.push([node.children.start, node.children.end, 0, 0]);
                }
            }
        }
    }

    /// Particles that a probe meets, in the order of the searches.
    pub fn candidates(&self) -> &[u32] {
        &self.candidates
    }

    /// Nodes that were looked at, in that order, once for each search, and whether they touched.
    pub fn visits(&self) -> &[(u32, bool)] {
        &self.visits
    }

    /// What became of each node of the tree: touched by any collider is touched. Written to `states`.
    pub fn states_into(&self, tree: &QuadTree, states: &mut Vec<NodeState>) {
        states.clear();
        states.resize(tree.len(), NodeState::Unvisited);
        for &(node, touching) in &self.visits {
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
        let on_it = || self.visits.iter().filter(|(node, _)| nodes.contains(node));
        (
            on_it().count(),
            on_it().filter(|(_, touching)| *touching).count(),
        )
    }

    /// Nodes looked at since [`clear`](Self::clear), leaves included, once for each search.
    pub fn nodes_visited(&self) -> usize {
        self.visits.len()
    }

    /// Particles tested: leaves among the nodes, and all of a scan's.
    pub fn leaf_tests(&self) -> usize {
        self.leaf_tests
    }
}
