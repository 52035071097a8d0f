//! The springs of a mesh, before there is a material.

use bevy::math::Vec3;

use crate::cloth::SpringKind;

/// An area is never taken as less than this part of the square over an edge.
const SMALLEST_AREA: f32 = 1.0e-6;

/// A spring of a mesh, before there is a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link {
    pub kind: SpringKind,
    pub ends: [u32; 2],
    /// Length at rest (m).
    pub rest_length: f32,
    /// Its compliance in those of a square patch: length over the width that it stands for.
    pub slenderness: f32,
}

/// The springs of faces: one along each edge, and one across each edge between the corners that face each other there.
///
/// A spring stands for the area of the faces at its edge, so that all along edges stand for the surface three times, and so
/// do those across. Evenly in all directions they then give as a square patch does: each has the patch's compliance times
/// its length² over that area (Van Gelder 1998, equation 20, for a Poisson's ratio of a third, the only one that springs of
/// all directions have).
pub(super) fn links(faces: &[[u32; 3]], sides: &[Side], rest: &[Vec3]) -> Vec<Link> {
    let distance = |[a, b]: [u32; 2]| rest[a as usize].distance(rest[b as usize]);
    let area = |side: &Side| face_area(faces[side.face as usize], rest);
    let link = |kind, ends: [u32; 2], area: f32| {
        let rest_length = distance(ends);
        let square = rest_length * rest_length;
        Link {
            kind,
            ends,
            rest_length,
            slenderness: square / area.max(SMALLEST_AREA * square),
        }
    };
    let (mut along, mut across) = (Vec::new(), Vec::new());
    for sides in sides.chunk_by(|a, b| a.ends == b.ends) {
        along.push(link(
            SpringKind::Structural,
            sides[0].ends,
            sides.iter().map(area).sum(),
        ));
        for (index, one) in sides.iter().enumerate() {
            for other in &sides[index + 1..] {
                let (a, b) = (one.opposite, other.opposite);
                let ends = [a.min(b), a.max(b)];
                // Two faces that lie on each other have nothing across.
                if distance(ends) > SMALLEST_AREA * distance(one.ends) {
                    across.push(link(SpringKind::Bend, ends, area(one) + area(other)));
                }
            }
        }
    }
    across.append(&mut along);
    across
}

/// One side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// Its particles, the first one first.
    pub ends: [u32; 2],
    pub face: u32,
    /// The corner that faces it.
    pub opposite: u32,
}

/// All sides of all faces, those of one edge together.
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

/// Both particles of each side of a face, the first one first.
pub(super) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
}

/// Whether a face at rest is more than a line, but for rounding.
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
