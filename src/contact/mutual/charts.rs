//! Neighbouring patches of a mesh, laid in a plane two by two: there [tangents](super::tangents) prove that they do not
//! touch, as on a grid.
//!
//! ```text
//!      ┌────────┬───┐        a chart: all triangles that cover the convex hull of both patches at rest,
//!     ╱   A    ╱ B   ╲       projected along their mean normal. The straight line between a point of A
//!    └────────┴───────┘      and one of B stays in them.
//! ```
//!
//! There is no chart if a border runs through the hull, if the rest shape is steep against the plane, or if both patches
//! do not hang together in it.

use std::ops::Range;

use bevy::math::{DVec2, DVec3, Vec2, Vec3, Vec3A};

use super::tangents::{LONGER, Tangents};
use crate::cloth::hull;

/// Largest number of triangles of a chart.
const LARGEST: usize = 64;

/// Smallest cosine of the angle between a triangle at rest and the plane.
const STEEPEST: f64 = 0.5;

/// How far a border may run inside of the hull, as a fraction of the shortest spacing: a path along it is
/// 1 / cos 0.1 = 1.005 times as long as the straight line, at most.
const HOLLOW: f64 = 0.1;

/// The charts of all neighbouring patches of a mesh.
#[derive(Debug, Default)]
pub(super) struct Charts {
    /// Those of each patch with itself and with later ones.
    of: Vec<Range<u32>>,
    charts: Vec<Chart>,
    triangles: Vec<Triangle>,
}

#[derive(Debug)]
struct Chart {
    with: u32,
    triangles: Range<u32>,
    /// A lower bound of the distance in the plane between two features without a common particle, one of each patch (m).
    apart: f32,
}

/// A triangle, and the weights of its two sides in the tangents along the plane's axes (1/m).
#[derive(Debug)]
struct Triangle {
    corners: [u32; 3],
    across: Vec2,
    down: Vec2,
}

/// A mesh at rest, in patches.
pub(super) struct Patches<'a> {
    pub rest: &'a [Vec3],
    pub shortest: f32,
    /// The particles and the faces of each patch, and the corners of all faces.
    pub particles: Vec<&'a [u32]>,
    pub faces: Vec<Range<u32>>,
    pub corners: Vec<[u32; 3]>,
}

impl Charts {
    pub fn new(patches: &Patches) -> Self {
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * patches.corners.len());
        for (face, &[a, b, c]) in (0..).zip(&patches.corners) {
            let named = [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
            sides.extend(named.map(|side| (side, face)));
        }
        sides.sort_unstable();
        let mut at: Vec<Vec<u32>> = vec![Vec::new(); patches.rest.len()];
        for (patch, particles) in (0..).zip(&patches.particles) {
            for &particle in *particles {
                at[particle as usize].push(patch);
            }
        }
        let mut charts = Self::default();
        let mut others = Vec::new();
        for (patch, particles) in (0..).zip(&patches.particles) {
            others.clear();
            let near = particles
                .iter()
                .flat_map(|&particle| &at[particle as usize]);
            others.extend(near.filter(|&&other| other >= patch));
            others.sort_unstable();
            others.dedup();
            let first = charts.charts.len() as u32;
            for &other in &others {
                charts.add(patches, &sides, [patch, other]);
            }
            charts.of.push(first..charts.charts.len() as u32);
        }
        charts
    }

    /// Adds the chart of two patches, if there is one.
    fn add(&mut self, patches: &Patches, sides: &[([u32; 2], u32)], of: [u32; 2]) {
        let Some(plane) = Plane::of(patches, of) else {
            return;
        };
        let Some((faces, closest)) = plane.cover(patches, sides, of) else {
            return;
        };
        let first = self.triangles.len() as u32;
        for face in faces {
            let corners = patches.corners[face as usize];
            let [a, b, c] = corners.map(|corner| plane.place(patches.rest, corner));
            let (b, c) = (b - a, c - a);
            let area = b.perp_dot(c);
            self.triangles.push(Triangle {
                corners,
                across: (DVec2::new(c.y, -b.y) / area).as_vec2(),
                down: (DVec2::new(-c.x, b.x) / area).as_vec2(),
            });
        }
        self.charts.push(Chart {
            with: of[1],
            triangles: first..self.triangles.len() as u32,
            apart: (closest * (1.0 - f64::from(LONGER))).max(plane.gap) as f32,
        });
    }

    /// A lower bound of the distance between two patches at these positions (m), but for features with a common particle.
    /// `None` for patches without a chart.
    pub fn unfolded(&self, [a, b]: [u32; 2], places: &[Vec3A]) -> Option<f32> {
        let Range { start, end } = self.of.get(a.min(b) as usize)?;
        let mut near = self.charts[*start as usize..*end as usize].iter();
        let chart = near.find(|chart| chart.with == a.max(b))?;
        let Range { start, end } = chart.triangles;
        let mut tangents = Tangents::EMPTY;
        for triangle in &self.triangles[start as usize..end as usize] {
            let [a, b, c] = triangle.corners.map(|corner| places[corner as usize]);
            let (b, c) = (b - a, c - a);
            let along = |weights: Vec2| b * weights.x + c * weights.y;
            tangents.add(along(triangle.across), along(triangle.down));
        }
        Some(tangents.unfolded() * chart.apart)
    }
}

/// The plane of two patches at rest, and their convex hull in it.
struct Plane {
    origin: DVec3,
    normal: DVec3,
    across: DVec3,
    down: DVec3,
    /// A closed polygon.
    hull: Vec<DVec2>,
    /// Distance of the boxes of both (m).
    gap: f64,
}

impl Plane {
    fn of(patches: &Patches, of: [u32; 2]) -> Option<Self> {
        let at = |particle: u32| patches.rest[particle as usize].as_dvec3();
        let faces = of.map(|patch| {
            let Range { start, end } = patches.faces[patch as usize];
            &patches.corners[start as usize..end as usize]
        });
        let normals = faces.iter().copied().flatten();
        let normals = normals.map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)));
        let normal = normals.sum::<DVec3>().try_normalize()?;
        let across = normal.any_orthonormal_vector();
        let mut plane = Self {
            origin: at(*patches.particles[of[0] as usize].first()?),
            normal,
            across,
            down: normal.cross(across),
            hull: Vec::new(),
            gap: 0.0,
        };
        let places = of.map(|patch| {
            let particles = patches.particles[patch as usize].iter();
            let places = particles.map(|&particle| plane.place(patches.rest, particle));
            places.collect::<Vec<_>>()
        });
        let [a, b] = places.each_ref().map(|of| {
            let low = of.iter().copied().fold(DVec2::INFINITY, DVec2::min);
            (
                low,
                of.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max),
            )
        });
        plane.gap = (a.0 - b.1).max(b.0 - a.1).max(DVec2::ZERO).length();
        plane.hull = hull(&places.concat());
        Some(plane)
    }

    fn place(&self, rest: &[Vec3], particle: u32) -> DVec2 {
        let offset = rest[particle as usize].as_dvec3() - self.origin;
        DVec2::new(offset.dot(self.across), offset.dot(self.down))
    }

    /// The faces that cover the hull of two patches, and the smallest height of one (m): no two features without a common
    /// particle are nearer. `None` if they do not cover it once.
    fn cover(
        &self,
        patches: &Patches,
        sides: &[([u32; 2], u32)],
        [a, b]: [u32; 2],
    ) -> Option<(Vec<u32>, f64)> {
        let mut faces: Vec<u32> = patches.faces[a as usize].clone().collect();
        let (mut next, mut closest) = (0, f64::INFINITY);
        let inset = HOLLOW * f64::from(patches.shortest);
        while let Some(&face) = faces.get(next) {
            next += 1;
            let corners = patches.corners[face as usize];
            let at = corners.map(|corner| patches.rest[corner as usize].as_dvec3());
            let area = (at[1] - at[0]).cross(at[2] - at[0]);
            if area.dot(self.normal) <= STEEPEST * area.length() || faces.len() > LARGEST {
                return None;
            }
            let places = corners.map(|corner| self.place(patches.rest, corner));
            for from in 0..3 {
                let to = (from + 1) % 3;
                let ends = [places[from], places[to]];
                closest = closest.min(area.dot(self.normal) / ends[0].distance(ends[1]));
                if !self.is_crossed_by(ends, inset) {
                    continue;
                }
                let side = [
                    corners[from].min(corners[to]),
                    corners[from].max(corners[to]),
                ];
                let first = sides.partition_point(|(other, _)| *other < side);
                let beside = sides[first..]
                    .iter()
                    .take_while(|(other, _)| *other == side);
                let [one, other] = beside.map(|(_, face)| *face).collect::<Vec<_>>()[..] else {
                    return None;
                };
                let beyond = if one == face { other } else { one };
                if !faces.contains(&beyond) {
                    faces.push(beyond);
                }
            }
        }
        let mut of_other = patches.faces[b as usize].clone();
        of_other
            .all(|face| faces.contains(&face))
            .then_some((faces, closest))
    }

    /// Whether a side runs through the hull, farther inside than `inset` (m).
    fn is_crossed_by(&self, [from, to]: [DVec2; 2], inset: f64) -> bool {
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for side in self.hull.windows(2) {
            let Some(inwards) = (side[1] - side[0]).perp().try_normalize() else {
                continue;
            };
            let [start, end] = [from, to].map(|at| inwards.dot(at - side[0]) - inset);
            if start <= 0.0 && end <= 0.0 {
                return false;
            }
            let at = start / (start - end);
            if start < 0.0 {
                first = first.max(at);
            } else if end < 0.0 {
                last = last.min(at);
            }
        }
        first < last
    }
}
