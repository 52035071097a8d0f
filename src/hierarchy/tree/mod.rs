//! The quadtree: the particles of each node.

mod grid;
mod halving;
mod network;
mod node;
mod refit;
mod shape;
mod stored;
#[cfg(test)]
mod tests;

use std::{ops::Range, sync::Arc};

use bevy::{
    math::{Vec3, bounding::BoundingSphere},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::{ClothGrid, ClothParticles, Surface};
use network::NetworkTree;
use shape::Tree;

pub use node::Node;
pub(crate) use stored::{Volumes, each, growth};

use halving::GridTree;

/// A tree over the particles of a cloth. Each node's patch is split into up to four, down to one particle in each leaf.
/// It depends only on the rest shape, is built once, and is shared by its clones.
///
/// Nodes are numbered level by level from the root, 0. A grid's tree stores no nodes, only the halves of its rows and
/// columns on each level.
#[derive(Reflect, Debug, Clone)]
#[type_path = "bevy_drape"]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone)]
pub struct QuadTree(Arc<dyn Tree>);

impl Default for QuadTree {
    /// A tree without particles.
    fn default() -> Self {
        Self(Arc::new(NetworkTree::default()))
    }
}

impl QuadTree {
    /// Builds the tree of a surface: of a [grid](Self::of_grid) by rows and columns, of a mesh by patches. `diagonals`
    /// states whether shear springs run along the diagonals of a grid.
    pub fn of_surface(surface: &Surface, diagonals: bool) -> Self {
        match surface.as_grid() {
            Some(grid) => Self::of_grid(grid, diagonals),
            None => {
                let (layout, graph) = (surface.layout(), surface.graph());
                let tree = NetworkTree::new(surface.rest_positions(), layout, graph);
                Self(Arc::new(tree))
            }
        }
    }

    /// Builds the tree of a grid, by halving its rows and columns. `diagonals` states whether shear springs run along
    /// the diagonals, which shortens distances along the springs.
    pub fn of_grid(grid: &ClothGrid, diagonals: bool) -> Self {
        Self(Arc::new(GridTree::new(grid, diagonals)))
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.levels().last().map_or(0, |level| level.end as usize)
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The nodes of each level, the root's first. All leaves are on the last level; above it, a patch of one particle
    /// has itself as its only child.
    pub fn levels(&self) -> &[Range<u32>] {
        &self.0.outline().levels
    }

    /// The level of a node, 0 for the root.
    pub fn level_of(&self, node: u32) -> usize {
        self.levels().partition_point(|level| level.end <= node)
    }

    /// The node with an index.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn node(&self, node: u32) -> Node {
        self.0.node(self.level_of(node), node)
    }

    /// Largest distance at rest from a particle to a corner of its faces, along the springs (m).
    pub(crate) fn face_reach(&self, surface: &Surface) -> f32 {
        surface.face_reach(self.0.outline().diagonals)
    }

    /// A sphere around all particle centres, from the root's rest shape at a stretch
    /// ([`Stretch::bound`](crate::solver::Stretch)). It reads only one particle for each piece of the cloth.
    pub fn root_sphere(&self, particles: &ClothParticles, stretch: f32) -> BoundingSphere {
        let none = BoundingSphere::new(Vec3::ZERO, 0.0);
        if !self.matches(particles) {
            return none;
        }
        let sphere = |&top: &u32| {
            let node = self.node(top);
            let radius = (node.rest_radius * growth(stretch)).max(0.0);
            (particles.position_at(node.middle as usize), radius)
        };
        let mut tops = self.0.outline().tops.iter().map(sphere);
        let Some((centre, radius)) = tops.next() else {
            return none;
        };
        let first = BoundingSphere::new(centre, radius);
        tops.fold(first, |around, (centre, radius)| {
            merged(&around, centre, radius)
        })
    }

    /// Numbers of nodes and columns, which identify the volumes of a tree.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.len(), self.0.outline().layout.columns as usize]
    }

    /// Whether the tree belongs to `particles`: the same number and layout.
    pub fn matches(&self, particles: &ClothParticles) -> bool {
        self.0.outline().layout == particles.layout()
    }

    /// Whether it may be a surface's tree: its particles have the same layout.
    pub(crate) fn is_of(&self, surface: &Surface) -> bool {
        self.0.outline().layout == surface.layout()
    }

    pub(super) fn shape(&self) -> &dyn Tree {
        &*self.0
    }
}

/// The sphere around both. Pieces may be as far apart as numbers go, or lost, so no length overflows: `f64`.
fn merged(around: &BoundingSphere, centre: Vec3, radius: f32) -> BoundingSphere {
    let (from, to) = (around.center.as_dvec3(), centre.as_dvec3());
    let [one, other] = [around.radius(), radius].map(f64::from);
    let apart = from.distance(to);
    if one >= apart + other {
        return *around;
    }
    // Another that contains it is the whole.
    let whole = ((one + other + apart) / 2.0).max(other);
    let part = match whole > other {
        true => (whole - one) / apart,
        false => 1.0,
    };
    let middle = from.lerp(to, part).as_vec3();
    // More than the rounding errors of its middle and radius.
    let rounding = f64::from(middle.abs().max_element() * f32::EPSILON);
    let radius = (whole * (1.0 + 1.0e-6) + rounding) as f32;
    BoundingSphere::new(middle, radius.max(0.0))
}
