//! A node of a tree.

use bevy::reflect::Reflect;

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
