//! Faces and what lies across their edges.

use crate::cloth::{
    arrays::sorted,
    surface::springs::{self, Side},
};

/// Faces, and the faces across their edges.
#[derive(Debug, Clone)]
pub(crate) struct Triangulation {
    pub(super) faces: Vec<[u32; 3]>,
    /// In the order of the edges: the first is that from the first corner to the second. None where an edge does not have two
    /// faces.
    pub(super) across: Vec<[Option<u32>; 3]>,
    /// In their order: a torn surface repeats them.
    pub(super) turns: Vec<Turn>,
}

/// The turn of an edge of a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    face: usize,
    edge: usize,
    /// Its ends, and the corners opposite of it.
    pub quad: [u32; 4],
}

impl Triangulation {
    /// The faces of a torn surface, turned as those of the whole one where they still hang together. `origin` is the particle of
    /// the whole surface that a particle was.
    pub(in crate::cloth::surface) fn torn(
        faces: &[[u32; 3]],
        sides: &[Side],
        whole: &Self,
        origin: impl Fn(u32) -> u32,
    ) -> Self {
        let mut new = Self::of(faces, sides);
        for turn in &whole.turns {
            let quad = new.quad(turn.face, turn.edge);
            if quad.is_some_and(|quad| quad.map(&origin) == turn.quad) {
                new.turn(turn.face, turn.edge);
            }
        }
        new
    }

    /// Those faces themselves. `sides` are all of theirs, those at one edge beside each other.
    pub(in crate::cloth::surface) fn of(faces: &[[u32; 3]], sides: &[Side]) -> Self {
        let mut across = vec![[None; 3]; faces.len()];
        for sides in sides.chunk_by(|a, b| a.ends == b.ends) {
            // Two faces of the same corners lie on each other.
            if let [one, other] = sides
                && one.opposite != other.opposite
            {
                for (own, beyond) in [(one, other), (other, one)] {
                    let face = own.face as usize;
                    let edges = springs::sides(faces[face]);
                    for (across, ends) in across[face].iter_mut().zip(edges) {
                        if ends == own.ends {
                            *across = Some(beyond.face);
                        }
                    }
                }
            }
        }
        Self {
            faces: faces.to_vec(),
            across,
            turns: Vec::new(),
        }
    }

    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The corner beyond each edge of a face.
    pub fn beside(&self, face: usize) -> [Option<u32>; 3] {
        [0, 1, 2].map(|edge| {
            let other = self.across[face][edge]?;
            let ends = self.edge(face, edge);
            let mut corners = self.faces[other as usize].into_iter();
            corners.find(|corner| !ends.contains(corner))
        })
    }

    pub(super) fn edge(&self, face: usize, edge: usize) -> [u32; 2] {
        [self.faces[face][edge], self.faces[face][(edge + 1) % 3]]
    }

    /// The face across an edge that runs the other way there, and the number of the edge there. None of faces that look to different
    /// sides.
    pub(super) fn opposite(&self, face: usize, edge: usize) -> Option<(usize, usize)> {
        let other = self.across[face][edge]? as usize;
        let [a, b] = self.edge(face, edge);
        let there = (0..3).find(|there| self.edge(other, *there) == [b, a])?;
        Some((other, there))
    }

    /// The ends of an edge, and the corners opposite of it.
    pub(super) fn quad(&self, face: usize, edge: usize) -> Option<[u32; 4]> {
        let (other, there) = self.opposite(face, edge)?;
        let [a, b] = self.edge(face, edge);
        let beyond = |face: usize, edge: usize| self.faces[face][(edge + 2) % 3];
        Some([a, b, beyond(face, edge), beyond(other, there)])
    }

    /// Turns the edge between two faces. It becomes the third of both.
    pub(super) fn turn(&mut self, face: usize, edge: usize) {
        let (Some(quad), Some((other, there))) = (self.quad(face, edge), self.opposite(face, edge))
        else {
            return;
        };
        self.turns.push(Turn { face, edge, quad });
        let [a, b, c, d] = quad;
        let [bc, ca] = [1, 2].map(|on| self.across[face][(edge + on) % 3]);
        let [ad, db] = [1, 2].map(|on| self.across[other][(there + on) % 3]);
        self.faces[face] = [c, a, d];
        self.faces[other] = [d, b, c];
        let [own, others] = [face as u32, other as u32];
        self.across[face] = [ca, ad, Some(others)];
        self.across[other] = [db, bc, Some(own)];
        for (moved, from, to, ends) in [(ad, others, own, [a, d]), (bc, own, others, [b, c])] {
            let Some(neighbour) = moved.map(|of| of as usize) else {
                continue;
            };
            for edge in 0..3 {
                let is_between = sorted(self.edge(neighbour, edge)) == sorted(ends);
                if is_between && self.across[neighbour][edge] == Some(from) {
                    self.across[neighbour][edge] = Some(to);
                }
            }
        }
    }
}
