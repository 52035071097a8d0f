//! Triangles, each stood for by one particle.

/// Triangles, sorted by the particle that stands for each: what a search finds is particles.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Faces {
    all: Vec<[u32; 3]>,
    /// Where each particle's begin; one more than there are particles.
    first: Vec<u32>,
}

impl Faces {
    /// Faces in the order of the particles that stand for them, each for as many as `counts` says.
    pub fn new(all: Vec<[u32; 3]>, counts: impl Iterator<Item = u32>) -> Self {
        let mut end = 0;
        let mut first = vec![0];
        first.extend(counts.map(|count| {
            end += count;
            end
        }));
        debug_assert_eq!(end as usize, all.len(), "each face is some particle's");
        Self { all, first }
    }

    /// Each face stood for by the first of its corners; `particles` are all there are.
    pub fn by_first_corner(mut all: Vec<[u32; 3]>, particles: usize) -> Self {
        let first_corner = |face: &[u32; 3]| face[0].min(face[1]).min(face[2]);
        // Stable: among one particle's they stay in the order of the mesh.
        all.sort_by_key(first_corner);
        let mut counts = vec![0; particles];
        for face in &all {
            counts[first_corner(face) as usize] += 1;
        }
        Self::new(all, counts.into_iter())
    }

    /// All of them.
    pub fn all(&self) -> &[[u32; 3]] {
        &self.all
    }

    /// Those that a particle stands for.
    pub fn of(&self, particle: u32) -> &[[u32; 3]] {
        let particle = particle as usize;
        &self.all[self.first[particle] as usize..self.first[particle + 1] as usize]
    }
}
