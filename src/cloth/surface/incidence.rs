//! The sides of a surface's faces, and the faces at each particle.

use super::springs::{Side, sides_of};
use crate::cloth::grouped::Grouped;

/// The sides of all faces, and the faces at each particle.
#[derive(Debug, Default, Clone)]
pub(super) struct Incidence {
    pub sides: Vec<Side>,
    faces: Grouped<u32>,
}

impl Incidence {
    pub fn new(faces: &[[u32; 3]], particles: usize) -> Self {
        let corners = || {
            let faces = (0..).zip(faces);
            faces.flat_map(|(index, face)| face.map(|corner| (corner, index)))
        };
        Self {
            sides: sides_of(faces),
            faces: Grouped::new(particles, corners),
        }
    }

    /// The faces at a particle, ascending.
    pub fn around(&self, particle: u32) -> &[u32] {
        self.faces.of(particle)
    }

    /// The sides of the faces at an edge, whose smaller end comes first.
    pub fn at(&self, ends: [u32; 2]) -> &[Side] {
        let start = self.sides.partition_point(|side| side.ends < ends);
        let count = self.sides[start..].partition_point(|side| side.ends == ends);
        &self.sides[start..start + count]
    }
}
