//! How parts of a surface are laid flat: by projection onto the plane of their mean normal at rest.

use std::ops::Range;

use bevy::math::{Vec2, Vec3};

use super::flattened::{EightFaces, Flattened, LOWERED, MOST_PARTICLES};
use crate::cloth::{Grouped, Surface};

/// Faces that leave the plane by more than the angle of this cosine are not laid flat.
const LEAST_COSINE: f32 = 2.0 / 3.0;

/// Part of a window's size by which what is missing at its border does not count.
const BORDER: f32 = 1.0e-5;

/// No face may be lower than this multiple of what is missing. A line that goes around it is off by that much to the side, past some two
/// faces, whose gradients differ by twice the largest: four times, and as much again for the norm of a gradient over its numbers. So the
/// bound of a line, as long as a face is high, falls by less than it is [lowered](LOWERED).
const LOWEST: f32 = 10.0 / LOWERED;

/// Most faces of a window: Euler's two for each particle.
const MOST_FACES: usize = 2 * MOST_PARTICLES;

/// Memory for laying one part after the other.
pub(super) struct Flattening<'a> {
    surface: &'a Surface,
    /// The faces around each particle.
    around: Grouped<u32>,
    /// The last stamp that each face and each particle got, and the particle's place in that part. Each part has its own.
    last_of_face: Vec<u32>,
    last_of_particle: Vec<[u32; 2]>,
    stamp: u32,
    faces: Vec<u32>,
}

impl<'a> Flattening<'a> {
    pub fn new(surface: &'a Surface) -> Self {
        let faces = surface.faces().all();
        let each = faces.iter().zip(0..);
        Self {
            surface,
            around: Grouped::new(surface.len(), || {
                let each = each.clone();
                each.flat_map(|(corners, face)| corners.iter().map(move |&of| (of, face)))
            }),
            last_of_face: vec![0; faces.len()],
            last_of_particle: vec![[0; 2]; surface.len()],
            stamp: 0,
            faces: Vec::new(),
        }
    }

    /// Lays these faces and vertices flat, with the faces between them; `None` if they are not flat enough, or not whole.
    pub fn flatten(
        &mut self,
        of: impl Iterator<Item = [u32; 3]>,
        vertices: &[u32],
    ) -> Option<Flattened> {
        self.stamp += 1;
        self.faces.clear();
        let (rest, all) = (self.surface.rest_positions(), self.surface.faces().all());
        let mut normal = Vec3::ZERO;
        let corners = |face: [u32; 3]| face.map(|corner| rest[corner as usize]);
        for face in of {
            let [a, b, c] = corners(face);
            normal += (b - a).cross(c - a);
            let around = self.around.of(face[0]).iter();
            let index = *around.clone().find(|&&index| all[index as usize] == face)?;
            self.last_of_face[index as usize] = self.stamp;
            self.faces.push(index);
            if self.faces.len() > MOST_FACES {
                return None;
            }
        }
        let normal = normal.try_normalize()?;
        let [across, down] = normal.any_orthonormal_pair().into();
        let origin = rest[all[*self.faces.first()? as usize][0] as usize];
        let place = |particle: u32| {
            let at = rest[particle as usize] - origin;
            Vec2::new(across.dot(at), down.dot(at))
        };
        let points = self.faces.iter().flat_map(|&face| all[face as usize]);
        let points = points.chain(vertices.iter().copied());
        let hull = Hull::of(points.map(place).collect());
        self.fill(&hull, place)?;
        let laid = self.laid(place, normal)?;
        if laid.closest < LOWEST * hull.tolerance {
            return None;
        }
        let is_laid = |vertex: &u32| self.last_of_particle[*vertex as usize][0] == self.stamp;
        vertices.iter().all(is_laid).then_some(laid)
    }

    /// Adds the faces between those that there are, until they cover their hull; `None` if some are missing.
    fn fill(&mut self, hull: &Hull, place: impl Fn(u32) -> Vec2) -> Option<()> {
        let all = self.surface.faces().all();
        let mut next = 0;
        while next < self.faces.len() {
            let index = self.faces[next];
            next += 1;
            let [a, b, c] = all[index as usize];
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let around = self.around.of(from).iter();
                let has = |other: &&u32| **other != index && all[**other as usize].contains(&to);
                let mut others = around.copied().filter(|other| has(&other));
                let other = others.next();
                let is_known = other.is_some_and(|of| self.last_of_face[of as usize] == self.stamp);
                // Faces on both sides of an edge run it in opposite directions, or it has no two sides.
                let is_opposite = |other: u32| {
                    let [a, b, c] = all[other as usize];
                    [[a, b], [b, c], [c, a]].contains(&[to, from])
                };
                if others.next().is_some() || !other.is_none_or(is_opposite) {
                    return None;
                }
                if is_known || !hull.is_crossed(place(from), place(to)) {
                    continue;
                }
                let other = other?;
                self.last_of_face[other as usize] = self.stamp;
                self.faces.push(other);
            }
            if self.faces.len() > MOST_FACES {
                return None;
            }
        }
        Some(())
    }

    /// The faces in the plane; `None` if one of them does not lie there face up, or two of them one over the other.
    fn laid(&mut self, place: impl Fn(u32) -> Vec2, normal: Vec3) -> Option<Flattened> {
        let (rest, all) = (self.surface.rest_positions(), self.surface.faces().all());
        let mut particles = Vec::new();
        let mut laid = Vec::with_capacity(self.faces.len());
        let (mut closest, mut cosine) = (f32::INFINITY, 1.0_f32);
        let mut middle: Option<Vec2> = None;
        for &face in &self.faces {
            let corners = all[face as usize];
            let at = corners.map(&place);
            let [a, b, c] = corners.map(|corner| rest[corner as usize]);
            let area = (b - a).cross(c - a);
            let own_cosine = normal.dot(area) / area.length();
            let [first, second] = [at[1] - at[0], at[2] - at[0]];
            let double = first.perp_dot(second);
            let longest = [first, second, at[2] - at[1]].map(Vec2::length);
            let height = double / longest.into_iter().fold(0.0, f32::max);
            let is_up = own_cosine >= LEAST_COSINE && height > 0.0 && height.is_finite();
            // Not so for NaN.
            if !is_up {
                return None;
            }
            (cosine, closest) = (cosine.min(own_cosine), closest.min(height));
            // All faces are face up, with one on either side of each edge. So each point is covered as often as any other.
            match middle {
                None => middle = Some((at[0] + at[1] + at[2]) / 3.0),
                Some(middle) if contains(&at, middle) => return None,
                Some(_) => {}
            }
            let places = corners.map(|corner| {
                let last = &mut self.last_of_particle[corner as usize];
                if last[0] != self.stamp {
                    *last = [self.stamp, particles.len() as u32];
                    particles.push(corner);
                }
                last[1]
            });
            let inverse = [second.y, -first.y, -second.x, first.x].map(|of| of / double);
            laid.push((places, inverse));
        }
        if particles.len() > MOST_PARTICLES {
            return None;
        }
        let faces = laid.chunks(8).map(|eight| {
            let of = |l: usize| &eight[l.min(eight.len() - 1)];
            EightFaces {
                corners: [0, 1, 2].map(|corner| std::array::from_fn(|l| of(l).0[corner] as u8)),
                inverse: [0, 1, 2, 3].map(|at| std::array::from_fn(|l| of(l).1[at])),
            }
        });
        Some(Flattened {
            particles,
            faces: faces.collect(),
            closest,
            ratio: 1.0 / cosine,
        })
    }
}

/// Whether a triangle contains a point.
fn contains([a, b, c]: &[Vec2; 3], point: Vec2) -> bool {
    let is_left = |from: &Vec2, to: &Vec2| (*to - *from).perp_dot(point - *from) >= 0.0;
    is_left(a, b) && is_left(b, c) && is_left(c, a)
}

/// The convex hull of points, turned to the left.
struct Hull {
    corners: Vec<Vec2>,
    tolerance: f32,
}

impl Hull {
    /// By the chain of Andrew (1979).
    fn of(mut points: Vec<Vec2>) -> Self {
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let mut corners: Vec<Vec2> = Vec::new();
        let mut chain = |points: &mut dyn Iterator<Item = Vec2>| {
            let first = corners.len();
            for point in points {
                while let [.., a, b] = corners[first..] {
                    if (b - a).perp_dot(point - b) > 0.0 {
                        break;
                    }
                    corners.pop();
                }
                corners.push(point);
            }
            corners.pop();
        };
        chain(&mut points.iter().copied());
        chain(&mut points.iter().rev().copied());
        let ends: Range<f32> = points
            .iter()
            .fold(f32::INFINITY..f32::NEG_INFINITY, |ends, at| {
                ends.start.min(at.min_element())..ends.end.max(at.max_element())
            });
        Self {
            corners,
            tolerance: BORDER * (ends.end - ends.start),
        }
    }

    /// Whether a line passes through its inside, but for the tolerance.
    fn is_crossed(&self, from: Vec2, to: Vec2) -> bool {
        let (mut start, mut end) = (0.0_f32, 1.0_f32);
        for (at, &corner) in self.corners.iter().enumerate() {
            let along = self.corners[(at + 1) % self.corners.len()] - corner;
            let along = along.normalize_or_zero();
            let depth = |point: Vec2| along.perp_dot(point - corner) - self.tolerance;
            let (first, last) = (depth(from), depth(to));
            if first <= 0.0 && last <= 0.0 {
                return false;
            }
            let cut = first / (first - last);
            if first < 0.0 {
                start = start.max(cut);
            } else if last < 0.0 {
                end = end.min(cut);
            }
        }
        start < end
    }
}
