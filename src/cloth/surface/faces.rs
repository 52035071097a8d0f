//! Triangles, each owned by one particle.

use crate::cloth::grouped::Grouped;

/// Triangles by their owner: a search finds particles, and these their faces.
pub(crate) type Faces = Grouped<[u32; 3]>;

/// The first of a face's corners.
pub(super) fn first_corner(face: &[u32; 3]) -> u32 {
    face[0].min(face[1]).min(face[2])
}

impl Faces {
    /// Gives each face to the first of its corners; `particles` is the number of particles.
    pub fn by_first_corner(all: &[[u32; 3]], particles: usize) -> Self {
        let owned = || all.iter().map(|face| (first_corner(face), *face));
        Self::new(particles, owned)
    }
}
