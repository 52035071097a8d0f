//! The triangles on which a mesh bends.
//!
//! The energy of a face is exact for any quadratic surface. But where diagonals alternate, a constant curvature leaves forces
//! on the particles, outwards where eight faces meet and inwards where four do. They give way to them, and the cloth bends a third too
//! easily. It does not where diagonals are parallel. On a flat quad, either diagonal may serve: so they are turned, for bending alone.
//!
//! ```text
//!  a ―― d          the diagonal a b of two faces is turned to c d: if the circle around a b c holds d
//!  | \  |          (Delaunay 1934), or to be parallel with the diagonal beside it, if the four lie about on
//!  c ―― b          one circle
//! ```

use std::collections::VecDeque;

use bevy::{math::DVec3, platform::collections::HashSet};

/// Sum of the cotangents of the two angles that an edge is seen under; below it, the other diagonal is better, and around 0 as good. Squares
/// whose vertices are a twentieth of a side out of place reach 0.2.
const ALIKE: f64 = 0.2;
/// Cosine of the largest angle between faces that count as flat.
const FLAT: f64 = 0.995;
/// Area of the smaller face that a turn makes, in parts of that of the two.
const THINNEST: f64 = 0.02;

/// Faces, and the faces across their edges.
#[derive(Debug)]
pub(super) struct Triangulation {
    faces: Vec<[u32; 3]>,
    /// In the order of the edges: the first is that from the first corner to the second. None where an edge does not have two
    /// faces.
    across: Vec<[Option<u32>; 3]>,
}

impl Triangulation {
    /// Of the same vertices as those faces, as many, with diagonals turned where that is better.
    pub fn new(faces: &[[u32; 3]], places: &[DVec3]) -> Self {
        let mut new = Self::of(faces);
        let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let mut edges: HashSet<[u32; 2]> = (0..faces.len())
            .flat_map(|face| [0, 1, 2].map(|edge| sorted(new.edge(face, edge))))
            .collect();
        let mut turn = |new: &mut Self, face: usize, edge: usize| {
            let ends = new.edge(face, edge);
            let Some(diagonal) = new.other_diagonal(face, edge) else {
                return false;
            };
            // On a surface with few faces, they may have another edge.
            let is_new = edges.insert(sorted(diagonal));
            if is_new {
                edges.remove(&sorted(ends));
                new.turn(face, edge);
            }
            is_new
        };
        new.turn_worse_ones(places, &mut turn);
        new.align(places, &mut turn);
        new
    }

    /// Those faces themselves.
    pub fn of(faces: &[[u32; 3]]) -> Self {
        let mut sides = Vec::with_capacity(3 * faces.len());
        for (face, corners) in faces.iter().enumerate() {
            for edge in 0..3 {
                let [a, b, opposite] = [0, 1, 2].map(|on| corners[(edge + on) % 3]);
                sides.push(([a.min(b), a.max(b)], face, edge, opposite));
            }
        }
        sides.sort_unstable();
        let mut across = vec![[None; 3]; faces.len()];
        for sides in sides.chunk_by(|a, b| a.0 == b.0) {
            if let [one, other] = sides {
                // Two faces of the same corners lie on each other.
                if one.3 != other.3 {
                    across[one.1][one.2] = Some(other.1 as u32);
                    across[other.1][other.2] = Some(one.1 as u32);
                }
            }
        }
        Self {
            faces: faces.to_vec(),
            across,
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
            let corners = &self.faces[other as usize];
            corners
                .iter()
                .copied()
                .find(|corner| !ends.contains(corner))
        })
    }

    fn edge(&self, face: usize, edge: usize) -> [u32; 2] {
        [self.faces[face][edge], self.faces[face][(edge + 1) % 3]]
    }

    /// The face across an edge that runs the other way there, and the number of the edge there. None of faces that look to different
    /// sides.
    fn opposite(&self, face: usize, edge: usize) -> Option<(usize, usize)> {
        let other = self.across[face][edge]? as usize;
        let [a, b] = self.edge(face, edge);
        let there = (0..3).find(|there| self.edge(other, *there) == [b, a])?;
        Some((other, there))
    }

    /// The corners opposite of an edge.
    fn other_diagonal(&self, face: usize, edge: usize) -> Option<[u32; 2]> {
        let (other, there) = self.opposite(face, edge)?;
        Some([(face, edge), (other, there)].map(|(face, edge)| self.faces[face][(edge + 2) % 3]))
    }

    /// Turns the edge between two faces. It becomes the third of both.
    fn turn(&mut self, face: usize, edge: usize) {
        let Some((other, there)) = self.opposite(face, edge) else {
            return;
        };
        let [a, b, c] = [0, 1, 2].map(|on| self.faces[face][(edge + on) % 3]);
        let d = self.faces[other][(there + 2) % 3];
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
                let is_between = self
                    .edge(neighbour, edge)
                    .iter()
                    .all(|end| ends.contains(end));
                if is_between && self.across[neighbour][edge] == Some(from) {
                    self.across[neighbour][edge] = Some(to);
                }
            }
        }
    }

    /// Sum of the cotangents of the angles opposite of an edge; `None` if it cannot be turned.
    fn cotangents(&self, face: usize, edge: usize, places: &[DVec3]) -> Option<f64> {
        let [c, d] = self.other_diagonal(face, edge)?;
        let [a, b, c, d] = {
            let [a, b] = self.edge(face, edge);
            [a, b, c, d].map(|corner| places[corner as usize])
        };
        let [one, other] = [(b - a).cross(c - a), (d - a).cross(b - a)];
        let [made, beside] = [(a - c).cross(d - c), (d - c).cross(b - c)];
        let [size, twin] = [one.length(), other.length()];
        let normal = (one + other).normalize_or_zero();
        let is_flat = one.dot(other) > FLAT * size * twin;
        let thinnest = made.dot(normal).min(beside.dot(normal));
        if !is_flat || thinnest < THINNEST * (size + twin) {
            return None;
        }
        Some((a - c).dot(b - c) / size + (a - d).dot(b - d) / twin)
    }

    /// Turns all edges that are worse than the other diagonal.
    fn turn_worse_ones(
        &mut self,
        places: &[DVec3],
        turn: &mut impl FnMut(&mut Self, usize, usize) -> bool,
    ) {
        let all = |face: usize| [0, 1, 2].map(|edge| (face, edge));
        let mut open: Vec<(usize, usize)> = (0..self.faces.len()).rev().flat_map(all).collect();
        // In the plane this ends by itself.
        let mut left = 4 * self.faces.len();
        while let Some((face, edge)) = open.pop() {
            let is_worse = |sum: f64| sum < -ALIKE;
            if left == 0 || !self.cotangents(face, edge, places).is_some_and(is_worse) {
                continue;
            }
            let other = self.across[face][edge];
            if turn(self, face, edge) {
                left -= 1;
                open.extend(all(face));
                open.extend(other.into_iter().flat_map(|other| all(other as usize)));
            }
        }
    }

    /// Turns diagonals that are as good as the other one to be parallel with those beside them.
    fn align(&mut self, places: &[DVec3], turn: &mut impl FnMut(&mut Self, usize, usize) -> bool) {
        // The diagonal of each face that belongs to such a quad.
        let mut diagonals: Vec<Option<usize>> = vec![None; self.faces.len()];
        for face in 0..self.faces.len() {
            for edge in 0..3 {
                let Some((other, there)) = self.opposite(face, edge) else {
                    continue;
                };
                let is_alike = |sum: f64| sum.abs() <= ALIKE;
                let is_free = diagonals[face].is_none() && diagonals[other].is_none();
                if is_free && self.cotangents(face, edge, places).is_some_and(is_alike) {
                    diagonals[face] = Some(edge);
                    diagonals[other] = Some(there);
                }
            }
        }
        let mut is_seen = vec![false; self.faces.len()];
        let mut open = VecDeque::new();
        for first in 0..self.faces.len() {
            if !is_seen[first] && diagonals[first].is_some() {
                open.push_back(first);
            }
            while let Some(face) = open.pop_front() {
                let Some(diagonal) = diagonals[face] else {
                    continue;
                };
                let ends = self.edge(face, diagonal);
                let Some(other) = self.across[face][diagonal].map(|other| other as usize) else {
                    continue;
                };
                is_seen[face] = true;
                is_seen[other] = true;
                for (face, edge) in [face, other]
                    .into_iter()
                    .flat_map(|of| [0, 1, 2].map(|edge| (of, edge)))
                {
                    let Some(next) = self.across[face][edge].map(|next| next as usize) else {
                        continue;
                    };
                    let Some(theirs) = diagonals[next].filter(|_| !is_seen[next]) else {
                        continue;
                    };
                    let side = self.edge(face, edge);
                    let end = side.into_iter().find(|corner| ends.contains(corner));
                    let crossing = self.edge(next, theirs);
                    let beyond = self.across[next][theirs].map(|beyond| beyond as usize);
                    if end.is_some_and(|end| crossing.contains(&end)) && turn(self, next, theirs) {
                        diagonals[next] = Some(2);
                        if let Some(beyond) = beyond {
                            diagonals[beyond] = Some(2);
                        }
                    }
                    is_seen[next] = true;
                    if let Some(beyond) = beyond {
                        is_seen[beyond] = true;
                    }
                    open.push_back(next);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 12;

    /// A square of `SIDE` cells whose inner vertices are moved by up to `jitter` sides of one. `is_other` says which diagonal a cell
    /// has.
    fn square(
        jitter: f64,
        seed: u32,
        is_other: impl Fn(u32, u32) -> bool,
    ) -> (Vec<[u32; 3]>, Vec<DVec3>) {
        let mut state = seed;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 23) - 1.0
        };
        let (mut faces, mut places) = (Vec::new(), Vec::new());
        for row in 0..=SIDE {
            for column in 0..=SIDE {
                let is_inner = (1..SIDE).contains(&row) && (1..SIDE).contains(&column);
                let moved = if is_inner { jitter } else { 0.0 };
                places.push(
                    DVec3::new(f64::from(column), f64::from(row), 0.0)
                        + moved * DVec3::new(noise(), noise(), 0.0),
                );
                if row < SIDE && column < SIDE {
                    let a = row * (SIDE + 1) + column;
                    let (b, c, d) = (a + 1, a + SIDE + 1, a + SIDE + 2);
                    faces.extend(if is_other(column, row) {
                        [[a, b, d], [a, d, c]]
                    } else {
                        [[a, b, c], [b, d, c]]
                    });
                }
            }
        }
        (faces, places)
    }

    fn random(seed: u32) -> impl Fn(u32, u32) -> bool {
        move |column, row| (column * 7 + row * 13 + seed * 5) * 2_654_435_761 % 7 < 3
    }

    /// Number of faces around each inner vertex.
    fn valences(faces: &[[u32; 3]]) -> Vec<usize> {
        let is_inner = |at: &u32| {
            let [column, row] = [at % (SIDE + 1), at / (SIDE + 1)];
            (1..SIDE).contains(&column) && (1..SIDE).contains(&row)
        };
        let of = |at: u32| {
            faces
                .iter()
                .flatten()
                .filter(|corner| **corner == at)
                .count()
        };
        (0..(SIDE + 1).pow(2)).filter(is_inner).map(of).collect()
    }

    /// Squares, and squares that are not quite square: whatever their diagonals were, they become parallel, and parallel ones stay.
    #[test]
    fn diagonals_of_squares_become_parallel() {
        for jitter in [0.0, 0.02] {
            let (regular, places) = square(jitter, 1, |_, _| true);
            assert_eq!(Triangulation::new(&regular, &places).faces(), regular);
            let made: [Box<dyn Fn(u32, u32) -> bool>; 4] = [
                Box::new(|column, row| (column + row) % 2 == 0),
                Box::new(|_, row| row % 2 == 0),
                Box::new(random(1)),
                Box::new(random(2)),
            ];
            for is_other in made {
                let (faces, places) = square(jitter, 1, is_other);
                let found = Triangulation::new(&faces, &places);
                assert!(valences(found.faces()).iter().all(|count| *count == 6));
            }
        }
    }

    /// The same vertices, as many faces, none turned over, the same area; no edge much worse than the other diagonal; and what lies
    /// beside each is what a new look at the faces finds.
    #[test]
    fn irregular_faces_become_about_delaunay() {
        for seed in 0..40 {
            let (faces, places) = square(0.35, seed, random(seed));
            let found = Triangulation::new(&faces, &places);
            let area = |[a, b, c]: &[u32; 3]| {
                let [a, b, c] = [a, b, c].map(|corner| places[*corner as usize]);
                (b - a).cross(c - a).z / 2.0
            };
            let areas: Vec<f64> = found.faces().iter().map(area).collect();
            let all = f64::from(SIDE * SIDE);
            assert!(areas.iter().all(|area| *area > 0.0));
            assert_eq!(areas.len(), faces.len());
            // A sum of 288 numbers.
            assert!((areas.iter().sum::<f64>() - all).abs() < 1.0e-12 * all);
            let again = Triangulation::of(found.faces());
            for face in 0..faces.len() {
                assert_eq!(found.beside(face), again.beside(face));
                for edge in 0..3 {
                    let sum = found.cotangents(face, edge, &places);
                    // Those that are turned to be parallel may be worse by as much as they were better.
                    assert!(sum.is_none_or(|sum| sum > -2.0 * ALIKE), "{seed}: {sum:?}");
                }
            }
            let edges = |faces: &[[u32; 3]]| {
                Triangulation::of(faces)
                    .across
                    .as_flattened()
                    .iter()
                    .flatten()
                    .count()
            };
            assert_eq!(edges(found.faces()), edges(&faces));
        }
    }

    /// A roof keeps its ridge, and a tetrahedron its edges.
    #[test]
    fn what_is_folded_stays() {
        let (faces, mut places) = square(0.0, 1, |column, row| (column + row) % 2 == 0);
        for place in &mut places {
            place.z = (place.x - place.y).abs();
        }
        let found = Triangulation::new(&faces, &places);
        let is_ridge = |[a, b]: [u32; 2]| a % (SIDE + 2) == 0 && b % (SIDE + 2) == 0;
        let ridges = |of: &Triangulation| {
            let each = (0..of.faces.len()).flat_map(|face| [0, 1, 2].map(|edge| (face, edge)));
            each.filter(|(face, edge)| is_ridge(of.edge(*face, *edge)))
                .count()
        };
        assert_eq!(ridges(&found), ridges(&Triangulation::of(&faces)));
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::splat(1.0e-3)];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert_eq!(Triangulation::new(&faces, &corners).faces(), faces);
    }
}
