//! Where the corners of each particle's own faces are in memory.

use super::faces::Faces;
use crate::cloth::arrays::MapInline;
use crate::cloth::lanes::{Layout, Slot};

/// The corners of all faces, by the owners of the faces.
#[derive(Debug, Default, Clone)]
pub(crate) struct Fans {
    corners: Vec<Slot>,
    /// Corners of each face, counted from its owner's first.
    faces: Vec<[u32; 3]>,
    /// First corner and first face of each particle; one more entry than particles.
    first: Vec<[u32; 2]>,
}

/// The faces that a particle owns.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Fan<'a> {
    /// Their corners without repetition, first the particle itself; empty without faces.
    pub corners: &'a [Slot],
    /// Three of the corners for each face.
    pub faces: &'a [[u32; 3]],
}

impl Fans {
    pub fn new(faces: &Faces, layout: Layout) -> Self {
        let mut fans = Self {
            first: vec![[0; 2]],
            ..Self::default()
        };
        for particle in 0..layout.len() as u32 {
            let start = fans.corners.len();
            let own = faces.of(particle);
            if !own.is_empty() {
                fans.corners.push(layout.slot_of(particle as usize));
            }
            for face in own {
                let of =
                    face.map_inline(|corner| fans.corner(start, layout.slot_of(corner as usize)));
                fans.faces.push(of);
            }
            let ends = [fans.corners.len() as u32, fans.faces.len() as u32];
            fans.first.push(ends);
        }
        fans
    }

    /// The number of a corner from `start` on, which is added if it is new.
    fn corner(&mut self, start: usize, slot: Slot) -> u32 {
        let mut known = self.corners[start..].iter();
        let known = known.position(|&known| known == slot);
        if known.is_none() {
            self.corners.push(slot);
        }
        known.unwrap_or(self.corners.len() - start - 1) as u32
    }

    /// The faces that a particle owns.
    #[inline]
    pub fn of(&self, particle: u32) -> Fan<'_> {
        let particle = particle as usize;
        let [from, to] = [self.first[particle], self.first[particle + 1]];
        Fan {
            corners: &self.corners[from[0] as usize..to[0] as usize],
            faces: &self.faces[from[1] as usize..to[1] as usize],
        }
    }
}

impl Fan<'_> {
    /// Where the corners of a face are.
    pub fn slots(&self, face: [u32; 3]) -> [Slot; 3] {
        face.map_inline(|corner| self.corners[corner as usize])
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;

    use crate::cloth::Cloth;

    /// Each face is found again from its owner, and the owner is its fan's first corner.
    #[test]
    fn a_fan_holds_the_faces_of_its_particle() {
        let surface = Cloth::new(9, 5, 0.1).surface(Vec3::ONE).expect("a grid");
        let layout = surface.layout();
        for particle in 0..surface.len() as u32 {
            let (fan, faces) = (surface.fans().of(particle), surface.faces().of(particle));
            assert_eq!(fan.faces.len(), faces.len());
            let own = fan.corners.first().copied();
            let slot = (!faces.is_empty()).then(|| layout.slot_of(particle as usize));
            assert_eq!(own, slot);
            for (&of, face) in fan.faces.iter().zip(faces) {
                let slots = face.map(|corner| layout.slot_of(corner as usize));
                assert_eq!(fan.slots(of), slots);
            }
        }
    }
}
