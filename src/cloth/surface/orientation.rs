//! Consistent winding order of the faces.

use bevy::math::Vec3;

use super::springs::Side;

/// Marks a side with no face beyond it, or with several.
const NONE: u32 = u32::MAX;

/// Flips faces so that two neighbours across an edge face the same side, piece by piece. Each piece then faces the side
/// of its corners' `normals`, or without any that of its first face. A piece that cannot be oriented, such as a Möbius
/// strip, keeps an inconsistent edge. `sides` are the sides of the faces.
pub(super) fn orient(faces: &mut [[u32; 3]], sides: &[Side], rest: &[Vec3], normals: &[Vec3]) {
    // The face beyond the side opposite each corner.
    let mut beyond = vec![[NONE; 3]; faces.len()];
    for pair in sides.chunk_by(|a, b| a.ends == b.ends) {
        // Where three or more faces meet, no face continues another.
        let [one, other] = pair else {
            continue;
        };
        for (from, to) in [(one, other), (other, one)] {
            let mut corners = faces[from.face as usize].iter();
            let at = corners
                .position(|corner| *corner == from.opposite)
                .unwrap_or(0);
            beyond[from.face as usize][at] = to.face;
        }
    }
    let before = faces.to_vec();
    let mut is_seen = vec![false; faces.len()];
    let mut piece: Vec<usize> = Vec::new();
    for start in 0..faces.len() {
        if is_seen[start] {
            continue;
        }
        piece.clear();
        piece.push(start);
        is_seen[start] = true;
        let mut next = 0;
        while let Some(&index) = piece.get(next) {
            next += 1;
            // `before` still has the corners in their first order.
            for (at, &other) in beyond[index].iter().enumerate() {
                let Some(is_seen) = is_seen.get_mut(other as usize) else {
                    continue;
                };
                if std::mem::replace(is_seen, true) {
                    continue;
                }
                let other = other as usize;
                let [a, b] = [before[index][(at + 1) % 3], before[index][(at + 2) % 3]];
                // Two faces of one orientation run along their common edge in opposite directions.
                let runs = |[c, d, e]: [u32; 3]| [[c, d], [d, e], [e, c]].contains(&[a, b]);
                if runs(faces[index]) == runs(faces[other]) {
                    faces[other].swap(1, 2);
                }
                piece.push(other);
            }
        }
        if normals.is_empty() {
            continue;
        }
        let agreement = |&index: &usize| {
            let [a, b, c] = faces[index].map(|corner| rest[corner as usize]);
            let around = faces[index].map(|corner| normals[corner as usize]);
            let sum: Vec3 = around.iter().sum();
            (b - a).cross(c - a).dot(sum)
        };
        if piece.iter().map(agreement).sum::<f32>() < 0.0 {
            for &index in &piece {
                faces[index].swap(1, 2);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::surface::springs::sides_of;

    fn normal(face: [u32; 3], rest: &[Vec3]) -> Vec3 {
        let [a, b, c] = face.map(|corner| rest[corner as usize]);
        (b - a).cross(c - a)
    }

    #[test]
    fn all_faces_of_a_piece_face_one_side() {
        let rest = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
        for mut faces in [[[0, 1, 2], [0, 2, 3]], [[0, 1, 2], [0, 3, 2]]] {
            let sides = sides_of(&faces);
            orient(&mut faces, &sides, &rest, &[]);
            assert!(
                faces.iter().all(|face| normal(*face, &rest).y < 0.0),
                "as the first"
            );
            orient(&mut faces, &sides, &rest, &[Vec3::Y; 4]);
            assert!(
                faces.iter().all(|face| normal(*face, &rest).y > 0.0),
                "as the normals"
            );
        }
    }

    #[test]
    fn where_three_faces_meet_each_is_a_piece_of_its_own() {
        let rest = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Y];
        let mut faces = [[0, 1, 2], [0, 1, 3], [0, 1, 4]];
        let sides = sides_of(&faces);
        orient(&mut faces, &sides, &rest, &[]);
        assert_eq!(faces, [[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    }
}
