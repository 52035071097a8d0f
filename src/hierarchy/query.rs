//! The top-down query.

use std::ops::Range;

use bevy::{math::Vec3, reflect::Reflect};

use super::{BoundRule, QuadTree, SphereBounds, bounds::ROUNDING};
use crate::cloth::ClothParticles;

/// What is searched for: a ball, in the cloth's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// Centre of the ball (m).
    pub centre: Vec3,
    /// Radius of the ball (m), with all that it is inflated by: how far it and the cloth may move.
    pub radius: f32,
    /// Radius of each particle (m).
    pub particle_radius: f32,
}

impl Probe {
    /// Equation (4): whether a particle at `position` is nearer to the ball's centre than both radii together.
    /// In f64, so that it is the same wherever it is asked.
    pub fn meets(&self, position: Vec3) -> bool {
        let reach = f64::from(self.radius) + f64::from(self.particle_radius);
        position.as_dvec3().distance_squared(self.centre.as_dvec3()) < reach * reach
    }
}

/// What the last search made of a node.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NodeState {
    /// An ancestor did not touch: the node was not looked at.
    #[default]
    Unvisited,
    /// Looked at; no ball touches it, and its children were not looked at.
    Untouched,
    /// Looked at; a ball touches it, or may within the tick.
    Touching,
}

/// A top-down search through a tree, level by level, with what it found. Reused from tick to tick without
/// allocating once it has grown.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
pub struct TopDownQuery {
    state: Vec<NodeState>,
    /// Nodes whose state is set, so that clearing costs what the search did and not what the tree does.
    marked: Vec<u32>,
    frontier: Vec<u32>,
    candidates: Vec<u32>,
    nodes_visited: usize,
    leaf_tests: usize,
}

impl TopDownQuery {
    /// Forgets what was found, for a new tick of `tree`.
    pub fn clear(&mut self, tree: &QuadTree) {
        if self.state.len() == tree.nodes().len() {
            for node in self.marked.drain(..) {
                self.state[node as usize] = NodeState::Unvisited;
            }
        } else {
            self.marked.clear();
            self.state.clear();
            self.state.resize(tree.nodes().len(), NodeState::Unvisited);
        }
        self.candidates.clear();
        self.nodes_visited = 0;
        self.leaf_tests = 0;
    }

    /// Searches for `probe`, adds to what was found since [`clear`](Self::clear), and says which of the
    /// [`candidates`](Self::candidates) are the probe's.
    pub fn search(
        &mut self,
        tree: &QuadTree,
        bounds: &SphereBounds,
        particles: &ClothParticles,
        probe: &Probe,
    ) -> Range<usize> {
        match bounds.rule() {
            BoundRule::RestShape => self.descend(tree, particles, probe, |node| {
                bounds.rest_sphere(tree, particles, node)
            }),
            BoundRule::Refit | BoundRule::Paper => {
                self.descend(tree, particles, probe, |node| bounds.stored_sphere(node))
            }
        }
    }

    /// Whether `probe` meets any particle. Leaves what was found as it is.
    pub fn finds_any(
        &self,
        tree: &QuadTree,
        bounds: &SphereBounds,
        particles: &ClothParticles,
        probe: &Probe,
    ) -> bool {
        // Each level adds three siblings at most, and halving 2²⁴ particles ends after 24 levels and a leaf.
        let mut stack = [0; 3 * 25 + 1];
        let mut count = usize::from(!tree.nodes().is_empty());
        while count > 0 {
            count -= 1;
            let index = stack[count];
            let node = &tree.nodes()[index as usize];
            let sphere = bounds.sphere(tree, particles, index);
            let reach = (sphere.radius() + probe.radius) * ROUNDING;
            if Vec3::from(sphere.center).distance_squared(probe.centre) > reach * reach {
                continue;
            }
            if node.is_leaf() && probe.meets(particles.position_at(node.middle as usize)) {
                return true;
            }
            for child in node.children.clone() {
                stack[count] = child;
                count += 1;
            }
        }
        false
    }

    fn descend(
        &mut self,
        tree: &QuadTree,
        particles: &ClothParticles,
        probe: &Probe,
        sphere: impl Fn(u32) -> (Vec3, f32),
    ) -> Range<usize> {
        let first = self.candidates.len();
        self.frontier.clear();
        if !tree.nodes().is_empty() {
            self.frontier.push(0);
        }
        let mut next = 0;
        // Children are put behind what is still to be looked at: level by level.
        while let Some(&index) = self.frontier.get(next) {
            next += 1;
            let node = &tree.nodes()[index as usize];
            let (centre, radius) = sphere(index);
            let reach = (radius + probe.radius) * ROUNDING;
            let touching = centre.distance_squared(probe.centre) <= reach * reach;
            if node.is_leaf() {
                self.leaf_tests += 1;
                if touching && probe.meets(particles.position_at(node.middle as usize)) {
                    self.candidates.push(node.middle);
                }
            } else if touching {
                self.frontier.extend(node.children.clone());
            }
            self.mark(index, touching);
        }
        self.nodes_visited += next;
        first..self.candidates.len()
    }

    /// Touched by any ball is touched.
    fn mark(&mut self, node: u32, touching: bool) {
        let state = &mut self.state[node as usize];
        if *state == NodeState::Unvisited {
            self.marked.push(node);
        }
        if touching {
            *state = NodeState::Touching;
        } else if *state == NodeState::Unvisited {
            *state = NodeState::Untouched;
        }
    }

    /// Particles that a ball may meet, in the order of the searches.
    pub fn candidates(&self) -> &[u32] {
        &self.candidates
    }

    /// What became of each node of the tree.
    pub fn states(&self) -> &[NodeState] {
        &self.state
    }

    /// Nodes of `level` that were looked at, and those of them that a ball touches.
    pub fn level(&self, tree: &QuadTree, level: usize) -> (usize, usize) {
        let nodes = tree.levels().get(level).cloned().unwrap_or_default();
        let states = self
            .state
            .get(nodes.start as usize..nodes.end as usize)
            .unwrap_or_default();
        let count = |wanted: &dyn Fn(NodeState) -> bool| {
            states.iter().filter(|&&state| wanted(state)).count()
        };
        (
            count(&|state| state != NodeState::Unvisited),
            count(&|state| state == NodeState::Touching),
        )
    }

    /// Nodes looked at since [`clear`](Self::clear), leaves included, once for each ball.
    pub fn nodes_visited(&self) -> usize {
        self.nodes_visited
    }

    /// Leaves among them.
    pub fn leaf_tests(&self) -> usize {
        self.leaf_tests
    }
}
