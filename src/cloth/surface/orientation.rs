//! Which side of each face is its front.

use bevy::{math::Vec3, platform::collections::HashMap};

/// Turns faces so that neighbours across an edge of two face the same side, piece by piece; each piece then faces the side
/// that `normals` of its corners are on, if there are any, else that of its first face. What cannot be turned so, as a
/// Möbius strip, keeps an edge where it faces both.
pub(super) fn orient(faces: &mut [[u32; 3]], rest: &[Vec3], normals: &[Vec3]) {
    let mut of_edge: HashMap<[u32; 2], Vec<u32>> = HashMap::default();
    for (index, face) in faces.iter().enumerate() {
        for [a, b] in edges(*face) {
            let edge = of_edge.entry([a.min(b), a.max(b)]).or_default();
            edge.push(index as u32);
        }
    }
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
            for [a, b] in edges(faces[index]) {
                // Where three faces or more meet none is the other side of another.
                let [one, other] = of_edge[&[a.min(b), a.max(b)]][..] else {
                    continue;
                };
                let other = if one as usize == index { other } else { one } as usize;
                if std::mem::replace(&mut is_seen[other], true) {
                    continue;
                }
                // Faces of one side run along their common edge in opposite directions.
                if edges(faces[other]).contains(&[a, b]) {
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
            let sum: Vec3 = faces[index].iter().map(|corner| normals[*corner as usize]).sum();
            (b - a).cross(c - a).dot(sum)
        };
        if piece.iter().map(agreement).sum::<f32>() < 0.0 {
            for &index in &piece {
                faces[index].swap(1, 2);
            }
        }
    }
}

fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normal(face: [u32; 3], rest: &[Vec3]) -> Vec3 {
        let [a, b, c] = face.map(|corner| rest[corner as usize]);
        (b - a).cross(c - a)
    }

    #[test]
    fn all_faces_of_a_piece_face_one_side() {
        let rest = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
        for mut faces in [[[0, 1, 2], [0, 2, 3]], [[0, 1, 2], [0, 3, 2]]] {
            orient(&mut faces, &rest, &[]);
            assert!(faces.iter().all(|face| normal(*face, &rest).y < 0.0), "as the first");
            orient(&mut faces, &rest, &[Vec3::Y; 4]);
            assert!(faces.iter().all(|face| normal(*face, &rest).y > 0.0), "as the normals");
        }
    }

    #[test]
    fn where_three_faces_meet_each_is_a_piece_of_its_own() {
        let rest = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Y];
        let mut faces = [[0, 1, 2], [0, 1, 3], [0, 1, 4]];
        orient(&mut faces, &rest, &[]);
        assert_eq!(faces, [[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    }
}
