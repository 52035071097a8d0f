//! The sides of a surface's faces, and the faces at each particle.

use super::springs::{Side, sides_of};

/// The sides of all faces, and the faces at each particle.
#[derive(Debug, Default, Clone)]
pub(super) struct Incidence {
    pub sides: Vec<Side>,
    /// First face of each particle; one more entry than particles.
    first: Vec<u32>,
    faces: Vec<u32>,
}

impl Incidence {
    pub fn new(faces: &[[u32; 3]], particles: usize) -> Self {
        let mut first = vec![0; particles + 1];
        for corner in faces.iter().flatten() {
            first[*corner as usize + 1] += 1;
        }
        for particle in 0..particles {
            first[particle + 1] += first[particle];
        }
        let mut next = first.clone();
        let mut around = vec![0; 3 * faces.len()];
        for (index, face) in faces.iter().enumerate() {
            for corner in face {
                let next = &mut next[*corner as usize];
                around[*next as usize] = index as u32;
                *next += 1;
            }
        }
        Self {
            sides: sides_of(faces),
            first,
            faces: around,
        }
    }

    /// The faces at a particle, ascending.
    pub fn around(&self, particle: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|at| self.first[particle as usize + at] as usize);
        &self.faces[start..end]
    }

    /// The sides of the faces at an edge, whose smaller end comes first.
    pub fn at(&self, ends: [u32; 2]) -> &[Side] {
        let start = self.sides.partition_point(|side| side.ends < ends);
        let count = self.sides[start..].partition_point(|side| side.ends == ends);
        &self.sides[start..start + count]
    }
}
