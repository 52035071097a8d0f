//! Triangles, each owned by one particle.

use std::ops::Range;

/// Triangles, sorted by their owner: a search finds particles, and these their faces.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Faces {
    all: Vec<[u32; 3]>,
    /// First face of each particle; one more entry than particles.
    first: Vec<u32>,
}

impl Faces {
    /// Faces in the order of their owners, with the number of faces of each.
    pub fn new(all: Vec<[u32; 3]>, counts: impl Iterator<Item = u32>) -> Self {
        let mut end = 0;
        let mut first = vec![0];
        first.extend(counts.map(|count| {
            end += count;
            end
        }));
        debug_assert_eq!(end as usize, all.len(), "each face needs an owner");
        Self { all, first }
    }

    /// Gives each face to the first of its corners; `particles` is the number of particles.
    pub fn by_first_corner(mut all: Vec<[u32; 3]>, particles: usize) -> Self {
        let first_corner = |face: &[u32; 3]| face[0].min(face[1]).min(face[2]);
        // Stable: the faces of a particle stay in the order of the mesh.
        all.sort_by_key(first_corner);
        let mut counts = vec![0; particles];
        for face in &all {
            counts[first_corner(face) as usize] += 1;
        }
        Self::new(all, counts.into_iter())
    }

    /// All faces.
    pub fn all(&self) -> &[[u32; 3]] {
        &self.all
    }

    /// The faces of a particle.
    pub fn of(&self, particle: u32) -> &[[u32; 3]] {
        &self.all[self.range_of(particle)]
    }

    /// The indices of a particle's faces.
    pub fn range_of(&self, particle: u32) -> Range<usize> {
        let particle = particle as usize;
        self.first[particle] as usize..self.first[particle + 1] as usize
    }
}
