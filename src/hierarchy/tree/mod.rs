//! The quad-tree: which particles each node holds.

mod grid;
mod halving;
mod network;
mod node;
mod shape;
#[cfg(test)]
mod tests;

use std::{ops::Range, sync::Arc};

use bevy::{
    math::{
        Vec3,
        bounding::{BoundingSphere, BoundingVolume},
    },
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::stored::growth;
use crate::cloth::{ClothError, ClothGrid, ClothParticles, Graph, Spring, SpringKind, Surface};

use network::NetworkTree;
use shape::Tree;

pub use node::Node;

pub(super) use halving::{GridTree, Level, Part};

/// A tree over the particles of a cloth: each node's patch is split into up to four, down to one particle a
/// leaf. It depends on the rest shape alone, is made once, and is shared by its clones.
///
/// Nodes are numbered level by level from the root, 0. A grid's tree stores no nodes at all, just how its rows and
/// its columns are halved on each level.
#[derive(Reflect, Debug, Clone)]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone)]
pub struct QuadTree(Arc<dyn Tree>);

impl Default for QuadTree {
    /// Of no particles.
    fn default() -> Self {
        Self(Arc::new(NetworkTree::default()))
    }
}

impl QuadTree {
    /// Over a surface: of a [grid](Self::of_grid) by rows and columns, of a mesh by patches. `diagonals` says whether shear
    /// springs run along the diagonals of a grid.
    pub fn of_surface(surface: &Surface, diagonals: bool) -> Self {
        match surface.as_grid() {
            Some(grid) => Self::of_grid(grid, diagonals),
            None => Self(Arc::new(NetworkTree::new(
                surface.rest_positions(),
                surface.graph(),
            ))),
        }
    }

    /// Over `grid`, by halving its rows and columns. `diagonals` says whether shear springs run along them:
    /// distances along the springs are shorter then.
    pub fn of_grid(grid: &ClothGrid, diagonals: bool) -> Self {
        Self(Arc::new(GridTree::new(grid, diagonals)))
    }

    /// Over any particles: `rest` are their positions at rest (m), `springs` what joins them, of which bend springs don't
    /// count as paths. Takes O(n log² n) time.
    ///
    /// # Errors
    /// [`ClothError::BadSpring`] for the first with an end that is no particle, or with a rest length that is not from
    /// 10⁻⁹ to 10¹² m: what has no length at rest says nothing of how far it stretches; [`ClothError::ParticleNotFinite`] for a position that is not.
    pub fn of_network(rest: &[Vec3], springs: &[Spring]) -> Result<Self, ClothError> {
        if let Some(index) = rest.iter().position(|position| !position.is_finite()) {
            return Err(ClothError::ParticleNotFinite {
                index,
                position: rest[index],
                displacement: Vec3::ZERO,
                inverse_mass: 0.0,
            });
        }
        let is_valid = |spring: &Spring| {
            spring.ends.iter().all(|&end| (end as usize) < rest.len())
                && (1.0e-9..=1.0e12).contains(&spring.rest_length)
        };
        if let Some(index) = springs.iter().position(|spring| !is_valid(spring)) {
            return Err(ClothError::BadSpring {
                index,
                spring: springs[index],
                particles: rest.len(),
            });
        }
        // What a bend spring allows is not measured.
        let paths = springs
            .iter()
            .filter(|spring| spring.kind != SpringKind::Bend);
        let graph = Graph::new(
            rest.len(),
            paths.map(|spring| (spring.ends, spring.rest_length)),
        );
        Ok(Self(Arc::new(NetworkTree::new(rest, &graph))))
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.levels().last().map_or(0, |level| level.end as usize)
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The nodes of each level, the root's first. All leaves are on the last; a patch of one particle further up has
    /// itself as its only child.
    pub fn levels(&self) -> &[Range<u32>] {
        self.0.levels()
    }

    /// The level that a node is on, 0 for the root.
    pub fn level_of(&self, node: u32) -> usize {
        self.levels().partition_point(|level| level.end <= node)
    }

    /// A node.
    ///
    /// # Panics
    /// If there are not that many.
    pub fn node(&self, node: u32) -> Node {
        self.0.node(self.level_of(node), node)
    }

    /// A sphere around all of its particles' centres, without touching more than one of them for each piece of the cloth:
    /// the root's rest shape at a stretch ([`Stretch::bound`](crate::solver::Stretch)).
    pub fn root_sphere(&self, particles: &ClothParticles, stretch: f32) -> BoundingSphere {
        let none = BoundingSphere::new(Vec3::ZERO, 0.0);
        if !self.matches(particles) {
            return none;
        }
        let sphere = |&top: &u32| {
            let node = self.node(top);
            let radius = (node.rest_radius * growth(stretch)).max(0.0);
            BoundingSphere::new(particles.position_at(node.middle as usize), radius)
        };
        let mut tops = self.0.tops().iter().map(sphere);
        let Some(first) = tops.next() else {
            return none;
        };
        tops.fold(first, |around, sphere| {
            let merged = around.merge(&sphere);
            // More than the rounding of a merge.
            BoundingSphere::new(merged.center, merged.radius() * (1.0 + 1.0e-5))
        })
    }

    /// Of a grid, how the nodes of each level lie in rows: the first of them, and how many a row has.
    pub(crate) fn lattice(&self) -> Option<Vec<(u32, u32)>> {
        let levels = self.levels().iter().enumerate();
        levels
            .map(|(level, nodes)| Some((nodes.start, self.0.columns(level)?)))
            .collect()
    }

    /// Indices of the particles that a node holds.
    pub fn particles_of(&self, node: u32) -> Vec<u32> {
        let level = self.level_of(node);
        let mut nodes = vec![node];
        for _ in level + 1..self.levels().len() {
            nodes = nodes
                .into_iter()
                .flat_map(|node| self.node(node).children().to_vec())
                .collect();
        }
        nodes
            .into_iter()
            .map(|leaf| self.node(leaf).middle)
            .collect()
    }

    /// Nodes and columns: what says which volumes are whose.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.len(), self.0.layout().columns as usize]
    }

    /// Whether the tree is one of `particles`: as many, laid out alike.
    pub fn matches(&self, particles: &ClothParticles) -> bool {
        self.0.layout() == particles.layout()
    }

    pub(super) fn shape(&self) -> &dyn Tree {
        &*self.0
    }

    /// Whether each node's children part its patch among them and each of this many particles is in one leaf.
    ///
    /// # Errors
    /// A sentence that names the node at fault.
    pub fn validate(&self, particles: usize) -> Result<(), String> {
        let last = self.levels().len().saturating_sub(1);
        let mut parent_of = vec![None; self.len()];
        let mut leaf_of = vec![None; particles];
        for (level, nodes) in self.levels().iter().enumerate() {
            for index in nodes.clone() {
                let node = self.node(index);
                if node.is_leaf() != (level == last) {
                    return Err(format!(
                        "node {index} of level {level} of {last} is a leaf too early"
                    ));
                }
                if level > 0 && parent_of[index as usize].is_none() {
                    return Err(format!("node {index} has no parent"));
                }
                for &child in node.children() {
                    let is_below = self.levels()[level + 1].contains(&child);
                    if !is_below || parent_of[child as usize].replace(index).is_some() {
                        return Err(format!(
                            "node {child} is not node {index}'s alone, a level below"
                        ));
                    }
                }
                if node.is_leaf() {
                    match leaf_of.get_mut(node.middle as usize) {
                        Some(leaf @ None) => *leaf = Some(index),
                        _ => {
                            return Err(format!(
                                "leaf {index} is not the one of particle {}",
                                node.middle
                            ));
                        }
                    }
                }
                if !self.particles_of(index).contains(&node.middle) {
                    return Err(format!("the middle of node {index} is not in it"));
                }
            }
        }
        match leaf_of.iter().position(Option::is_none) {
            None => Ok(()),
            Some(particle) => Err(format!("particle {particle} is in no leaf")),
        }
    }
}
