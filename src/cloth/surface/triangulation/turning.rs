//! The choice of the edges to turn.

use std::collections::VecDeque;

use bevy::{
    math::{DVec3, Vec3},
    platform::collections::HashSet,
};

use super::faces::Triangulation;
use crate::cloth::{arrays::sorted, surface::springs::sides_of};

/// Sum of the cotangents of the two angles that an edge is seen under: below −`ALIKE`, the other diagonal is better; within
/// ±`ALIKE` for both, they are as good. Squares whose vertices are out of place by a fortieth of a side, in x and in y, reach 0.2.
pub(super) const ALIKE: f64 = 0.2;
/// Cosine of the largest angle between faces, and between their grains, that count as one plane and one grain.
const FLAT: f64 = 0.995;
/// Area of the smaller face after a turn, as a fraction of that of both.
const THINNEST: f64 = 0.02;

/// As many faces on the same vertices, with diagonals turned where that is better. None is turned between two grains.
pub(in crate::cloth::surface) fn turned(
    faces: &[[u32; 3]],
    places: &[DVec3],
    grain: &[Vec3],
) -> Triangulation {
    let of = Triangulation::of(faces, &sides_of(faces));
    let mut turning = Turning::new(of, places, grain);
    turning.turn_worse_ones();
    turning.align();
    turning.of
}

/// A triangulation while its edges are turned.
pub(super) struct Turning<'a> {
    pub of: Triangulation,
    edges: HashSet<[u32; 2]>,
    places: &'a [DVec3],
    grain: &'a [Vec3],
}

impl<'a> Turning<'a> {
    pub fn new(of: Triangulation, places: &'a [DVec3], grain: &'a [Vec3]) -> Self {
        let all = (0..of.faces.len()).flat_map(|face| [0, 1, 2].map(|edge| (face, edge)));
        let edges = all.map(|(face, edge)| sorted(of.edge(face, edge)));
        Self {
            edges: edges.collect(),
            places,
            grain,
            of,
        }
    }

    /// Turns an edge. Returns whether it did: on a surface with few faces, the corners opposite may have another edge.
    fn turn(&mut self, face: usize, edge: usize) -> bool {
        let Some([a, b, c, d]) = self.of.quad(face, edge) else {
            return false;
        };
        let is_new = self.edges.insert(sorted([c, d]));
        if is_new {
            self.edges.remove(&sorted([a, b]));
            self.of.turn(face, edge);
        }
        is_new
    }

    /// Sums of the cotangents of the angles that an edge is seen under, and the other diagonal; `None` if it cannot be turned.
    pub fn cotangents(&self, face: usize, edge: usize) -> Option<[f64; 2]> {
        let (other, _) = self.of.opposite(face, edge)?;
        if let [Some(own), Some(beyond)] = [face, other].map(|of| self.grain.get(of))
            && own.as_dvec3().dot(beyond.as_dvec3()) < FLAT
        {
            return None;
        }
        let [a, b, c, d] = self.of.quad(face, edge)?.map(|at| self.places[at as usize]);
        let [one, other] = [(b - a).cross(c - a), (d - a).cross(b - a)];
        let [made, beside] = [(a - c).cross(d - c), (d - c).cross(b - c)];
        let sizes = [one.length(), other.length()];
        let normal = (one + other).normalize_or_zero();
        let new = [made.dot(normal), beside.dot(normal)];
        let is_flat = one.dot(other) > FLAT * sizes[0] * sizes[1];
        let thinnest = THINNEST * (sizes[0] + sizes[1]);
        if !is_flat || !new.iter().all(|size| *size > thinnest) {
            return None;
        }
        Some([
            (a - c).dot(b - c) / sizes[0] + (a - d).dot(b - d) / sizes[1],
            (c - a).dot(d - a) / new[0] + (c - b).dot(d - b) / new[1],
        ])
    }

    /// Turns all edges that are worse than the other diagonal.
    pub fn turn_worse_ones(&mut self) {
        let all = |face: usize| [0, 1, 2].map(|edge| (face, edge));
        let count = self.of.faces.len();
        let mut open: Vec<(usize, usize)> = (0..count).rev().flat_map(all).collect();
        // In the plane this ends by itself.
        let mut left = 4 * count;
        while let Some((face, edge)) = open.pop() {
            let sums = self.cotangents(face, edge);
            if left == 0 || !sums.is_some_and(|[sum, _]| sum < -ALIKE) {
                continue;
            }
            let other = self.of.across[face][edge];
            if self.turn(face, edge) {
                left -= 1;
                open.extend(all(face));
                open.extend(other.into_iter().flat_map(|other| all(other as usize)));
            }
        }
    }

    /// The edge of each face that is a diagonal as good as the other one. It is the best of both its faces: in long cells,
    /// sides are nearly as good.
    fn diagonals(&self) -> Vec<Option<usize>> {
        let worst = |[one, other]: [f64; 2]| one.abs().max(other.abs());
        let best = |face: usize| {
            let of_edge = |edge: usize| Some((edge, worst(self.cotangents(face, edge)?)));
            let alike = (0..3)
                .filter_map(of_edge)
                .filter(|(_, worst)| *worst <= ALIKE);
            let best = alike.min_by(|a, b| a.1.total_cmp(&b.1));
            best.map(|(edge, _)| edge)
        };
        let mut diagonals: Vec<Option<usize>> = (0..self.of.faces.len()).map(best).collect();
        for face in 0..diagonals.len() {
            let of = diagonals[face].and_then(|edge| self.of.opposite(face, edge));
            if of.is_none_or(|(other, there)| diagonals[other] != Some(there)) {
                diagonals[face] = None;
            }
        }
        diagonals
    }

    /// Turns such diagonals to be parallel with those beside them: from a side of a quad, each has another end.
    pub fn align(&mut self) {
        let mut diagonals = self.diagonals();
        let across = |of: &Triangulation, face: usize, edge: usize| {
            of.across[face][edge].map(|other| other as usize)
        };
        let mut is_seen = vec![false; diagonals.len()];
        let mut open = VecDeque::new();
        for first in 0..diagonals.len() {
            if !is_seen[first] {
                open.push_back(first);
            }
            while let Some(face) = open.pop_front() {
                is_seen[face] = true;
                let Some(diagonal) = diagonals[face] else {
                    continue;
                };
                let Some(other) = across(&self.of, face, diagonal) else {
                    continue;
                };
                is_seen[other] = true;
                let ends = self.of.edge(face, diagonal);
                for (face, edge) in [0, 1, 2]
                    .into_iter()
                    .flat_map(|edge| [(face, edge), (other, edge)])
                {
                    let Some(next) = across(&self.of, face, edge) else {
                        continue;
                    };
                    let Some(theirs) = diagonals[next].filter(|_| !is_seen[next]) else {
                        continue;
                    };
                    let beyond = across(&self.of, next, theirs);
                    let side = self.of.edge(face, edge);
                    let crossing = self.of.edge(next, theirs);
                    let is_end = |corner: &u32| ends.contains(corner) && crossing.contains(corner);
                    if side.iter().any(is_end) && self.turn(next, theirs) {
                        for turned in [Some(next), beyond].into_iter().flatten() {
                            diagonals[turned] = Some(2);
                        }
                    }
                    for seen in [Some(next), beyond].into_iter().flatten() {
                        is_seen[seen] = true;
                    }
                    open.push_back(next);
                }
            }
        }
    }
}
