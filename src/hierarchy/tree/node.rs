//! A node of a tree.

use std::ops::Range;

use bevy::reflect::Reflect;

use crate::cloth::Layout;

/// Facts about a tree.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Outline {
    /// The layout of its particles.
    pub layout: Layout,
    /// The nodes of each level, the root's first.
    pub levels: Vec<Range<u32>>,
    /// Whether distances are also along the diagonals of a grid's cells.
    pub diagonals: bool,
    /// Nodes that together contain all particles: the root, unless no path leads from it to all of them.
    pub tops: Vec<u32>,
}

/// A node of a [`QuadTree`](crate::hierarchy::QuadTree): a patch of the cloth.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
pub struct Node {
    /// Its level, 0 for the root.
    pub level: usize,
    /// Index of the patch's middle particle; for a leaf, its only one.
    pub middle: u32,
    /// Largest distance at rest, along the springs, from the middle particle to another one of the patch (m). Infinite
    /// without a path.
    pub rest_radius: f32,
    pub(super) children: [u32; 4],
    pub(super) child_count: u8,
}

impl Node {
    /// Whether the node holds one particle.
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }

    /// Indices of its one to four children; empty for a leaf.
    pub fn children(&self) -> &[u32] {
        &self.children[..usize::from(self.child_count)]
    }
}
