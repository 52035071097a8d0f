//! The quad-tree: which particles each node holds.

mod grid;
mod network;
#[cfg(test)]
mod tests;

use std::ops::Range;

use bevy::{
    math::{Vec3, bounding::BoundingSphere},
    reflect::Reflect,
};

use super::bounds::{growth, middle, position};
use crate::cloth::{ClothError, ClothGrid, ClothParticles, Spring};

pub(super) use grid::{GridTree, Level, Part};
pub(super) use network::NetworkTree;

/// A node of a [`QuadTree`]: a patch of the cloth.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Its level, 0 for the root.
    pub level: usize,
    /// Index of the patch's middle particle; of a leaf, its only one.
    pub middle: u32,
    /// Largest distance at rest, along the springs, from the middle particle to one of the patch (m). Infinite
    /// where no way along the springs leads there.
    pub rest_radius: f32,
    children: [u32; 4],
    child_count: u8,
}

impl Node {
    /// Whether the node holds one particle.
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }

    /// Indices of its one to four children; none of a leaf.
    pub fn children(&self) -> &[u32] {
        &self.children[..usize::from(self.child_count)]
    }
}

/// A tree over the particles of a cloth: each node's patch is parted into up to four, down to one particle a
/// leaf. It depends on the rest shape alone and is made once.
///
/// Nodes are numbered level by level from the root, 0. A grid's tree stores no nodes at all, just how its rows and
/// its columns are halved on each level.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[reflect(opaque)]
pub struct QuadTree(pub(super) Shape);

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Grid(GridTree),
    Network(NetworkTree),
}

impl Default for QuadTree {
    /// Of no particles.
    fn default() -> Self {
        Self(Shape::Network(NetworkTree::default()))
    }
}

impl QuadTree {
    /// Over `grid`, by halving its rows and columns. `diagonals` says whether shear springs run along them:
    /// distances along the springs are shorter then.
    pub fn of_grid(grid: &ClothGrid, diagonals: bool) -> Self {
        Self(Shape::Grid(GridTree::new(grid, diagonals)))
    }

    /// Over particles of no grid: `rest` are their positions at rest (m), `springs` what joins them, of which bend
    /// springs don't count as ways. Patches are halved along their longest extents at rest; radii at rest come from
    /// shortest ways along the springs (Dijkstra 1959). Takes O(n log² n) time.
    ///
    /// # Errors
    /// [`ClothError::BadSpring`] for the first with an end that is no particle, or with a rest length that is not from
    /// 10⁻⁹ to 10¹² m: what has no length at rest says nothing of how far it stretches; [`ClothError::ParticleNotFinite`] for a position that is not.
    pub fn of_network(rest: &[Vec3], springs: &[Spring]) -> Result<Self, ClothError> {
        NetworkTree::new(rest, springs).map(|tree| Self(Shape::Network(tree)))
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
        match &self.0 {
            Shape::Grid(tree) => &tree.ranges,
            Shape::Network(tree) => &tree.ranges,
        }
    }

    /// The level that a node is on, 0 for the root.
    pub fn level_of(&self, node: u32) -> usize {
        self.levels().partition_point(|level| level.end <= node)
    }

    /// A node.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn node(&self, node: u32) -> Node {
        match &self.0 {
            Shape::Grid(tree) => tree.node(self.level_of(node), node),
            Shape::Network(tree) => tree.node(self.level_of(node), node),
        }
    }

    /// A sphere around all of its particles' centres, without touching more than one of them: the root's rest shape
    /// at a stretch ([`Stretch::bound`](crate::solver::Stretch)).
    pub fn root_sphere(&self, particles: &ClothParticles, stretch: f32) -> BoundingSphere {
        let root = match &self.0 {
            _ if !self.fits(particles) => None,
            Shape::Grid(tree) => tree.levels.first().map(|root| {
                let (rows, columns) = (&root.rows[0], &root.columns[0]);
                (
                    middle(particles, rows, columns),
                    root.rest_radius(rows, columns),
                )
            }),
            Shape::Network(tree) => tree.nodes.first().map(|root| {
                let slot = tree.slots[root.middle as usize];
                (position(particles, slot), root.rest_radius)
            }),
        };
        let (centre, rest_radius) = root.unwrap_or_default();
        BoundingSphere::new(centre, (rest_radius * growth(stretch)).max(0.0))
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

    /// Levels and nodes, or columns and rows: what says which volumes are whose.
    pub(super) fn size(&self) -> [usize; 2] {
        match &self.0 {
            Shape::Grid(tree) => [tree.layout.columns as usize, tree.layout.rows as usize],
            Shape::Network(tree) => [tree.nodes.len(), 0],
        }
    }

    /// Whether the tree is one of `particles`: as many, laid out alike.
    pub fn fits(&self, particles: &ClothParticles) -> bool {
        match &self.0 {
            Shape::Grid(tree) => tree.layout == particles.layout(),
            Shape::Network(tree) => tree.layout == particles.layout(),
        }
    }

    /// Whether each node's children part its patch among them and each of so many particles is in one leaf.
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
