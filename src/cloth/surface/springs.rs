//! The springs of a mesh, without a material.

use bevy::math::Vec3;

use crate::cloth::{arrays::sorted, spring::SpringKind};

/// Lower limit of an area, as a fraction of the squared edge length.
const SMALLEST_AREA: f32 = 1.0e-6;

/// A spring of a mesh, without a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link {
    pub kind: SpringKind,
    pub ends: [u32; 2],
    /// Length at rest (m).
    pub rest_length: f32,
    /// Ratio of its compliance to that of a square patch: length over the width that it represents.
    pub slenderness: f32,
}

/// The springs of faces: one along each edge, and one across each edge between the two opposite corners.
///
/// A spring represents the area of the faces at its edge. So the springs along edges together represent the surface
/// three times, and so do those across. With even directions they then stretch like a square patch: each has the
/// patch's compliance times its length² over that area. This is Van Gelder 1998, equation 20, for a Poisson's ratio of
/// a third, the only one that isotropic springs have.
pub(super) fn links(faces: &[[u32; 3]], sides: &[Side], rest: &[Vec3]) -> Vec<Link> {
    let (mut along, mut across) = (Vec::new(), Vec::new());
    for_each_link(faces, sides, rest, |link, _| match link.kind {
        SpringKind::Structural => along.push(link),
        SpringKind::Shear | SpringKind::Bend => across.push(link),
    });
    across.append(&mut along);
    across
}

/// Calls `visit` with each of these springs and the sides of the faces that it represents.
pub(super) fn for_each_link(
    faces: &[[u32; 3]],
    sides: &[Side],
    rest: &[Vec3],
    mut visit: impl FnMut(Link, &[Side]),
) {
    let distance = |[a, b]: [u32; 2]| rest[a as usize].distance(rest[b as usize]);
    let mut visit = |kind, ends: [u32; 2], sides: &[Side]| {
        let rest_length = distance(ends);
        let square = rest_length * rest_length;
        let area = |side: &Side| face_area(faces[side.face as usize], rest);
        let area: f32 = sides.iter().map(area).sum();
        let link = Link {
            kind,
            ends,
            rest_length,
            slenderness: square / area.max(SMALLEST_AREA * square),
        };
        visit(link, sides);
    };
    for sides in sides.chunk_by(|a, b| a.ends == b.ends) {
        visit(SpringKind::Structural, sides[0].ends, sides);
        for_each_pair(sides, rest, |one, other| {
            let ends = sorted([one.opposite, other.opposite]);
            visit(SpringKind::Bend, ends, &[*one, *other]);
        });
    }
}

/// Calls `visit` with each two faces at an edge that have a spring across it.
pub(super) fn for_each_pair(sides: &[Side], rest: &[Vec3], mut visit: impl FnMut(&Side, &Side)) {
    let distance = |a: u32, b: u32| rest[a as usize].distance(rest[b as usize]);
    for (index, one) in sides.iter().enumerate() {
        for other in &sides[index + 1..] {
            // Two faces on top of each other have nothing across.
            let [a, b] = one.ends;
            if distance(one.opposite, other.opposite) > SMALLEST_AREA * distance(a, b) {
                visit(one, other);
            }
        }
    }
}

/// One side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// Its particles, the smaller index first.
    pub ends: [u32; 2],
    pub face: u32,
    /// The opposite corner.
    pub opposite: u32,
}

/// All sides of all faces, sorted by edge.
pub(super) fn sides_of(faces: &[[u32; 3]]) -> Vec<Side> {
    let mut all = Vec::with_capacity(3 * faces.len());
    for (face, &[a, b, c]) in faces.iter().enumerate() {
        for (ends, opposite) in sides([a, b, c]).into_iter().zip([c, a, b]) {
            all.push(Side {
                ends,
                face: face as u32,
                opposite,
            });
        }
    }
    all.sort_unstable();
    all
}

/// Both particles of each side of a face, the smaller index first.
pub(super) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(sorted)
}

/// Whether a face at rest has an area beyond rounding errors.
pub(super) fn has_area(face: [u32; 3], rest: &[Vec3]) -> bool {
    let square = |[a, b]: [u32; 2]| rest[a as usize].distance_squared(rest[b as usize]);
    let longest = sides(face).map(square).into_iter().fold(0.0, f32::max);
    face_area(face, rest) > SMALLEST_AREA * longest
}

/// Area of a face at rest (m²).
pub(super) fn face_area(face: [u32; 3], rest: &[Vec3]) -> f32 {
    let [a, b, c] = face.map(|corner| rest[corner as usize]);
    (b - a).cross(c - a).length() / 2.0
}
