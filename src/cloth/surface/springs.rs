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
pub(super) fn links(faces: &[[u32; 3]], rest: &[Vec3]) -> Vec<Link> {
    // Each side of each face with the corner that faces it, sides of one edge together.
    let mut of_edges: Vec<([u32; 2], u32, f32)> = Vec::with_capacity(3 * faces.len());
    for face in faces {
        let area = face_area(*face, rest);
        let [a, b, c] = *face;
        for (side, opposite) in sides(*face).into_iter().zip([c, a, b]) {
            of_edges.push((side, opposite, area));
        }
    }
    of_edges.sort_by_key(|(side, ..)| *side);
    let distance = |[a, b]: [u32; 2]| rest[a as usize].distance(rest[b as usize]);
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
    for sides in of_edges.chunk_by(|(a, ..), (b, ..)| a == b) {
        let area = sides.iter().map(|(.., area)| area).sum();
        along.push(link(SpringKind::Structural, sides[0].0, area));
        for (index, (_, a, area)) in sides.iter().enumerate() {
            for (_, b, other) in &sides[index + 1..] {
                let ends = [*a.min(b), *a.max(b)];
                // Two faces that lie on each other have nothing across.
                if distance(ends) > SMALLEST_AREA * distance(sides[0].0) {
                    across.push(link(SpringKind::Bend, ends, area + other));
                }
            }
        }
    }
    across.append(&mut along);
    across
}

/// Both particles of each side of a face, the first one first.
pub(super) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
}

/// Area of a face at rest (m²).
pub(super) fn face_area(face: [u32; 3], rest: &[Vec3]) -> f32 {
    let [a, b, c] = face.map(|corner| rest[corner as usize]);
    (b - a).cross(c - a).length() / 2.0
}
