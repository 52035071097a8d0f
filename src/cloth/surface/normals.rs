//! Normals of a moved surface.

use bevy::math::Vec3;

use super::Surface;
use crate::cloth::arrays::MapInline;

impl Surface {
    /// Computes the normal at each particle, of length 1, for particles at `positions`: the mean of its faces' normals,
    /// weighted by area. Where they cancel out, it is the normal at rest. `normals` is resized to the number of
    /// positions.
    pub fn normals_at(&self, positions: &[Vec3], normals: &mut Vec<Vec3>) {
        normals.clear();
        normals.resize(positions.len(), Vec3::ZERO);
        add_face_normals(self.triangles(), positions, normals);
        for (particle, normal) in normals.iter_mut().enumerate() {
            *normal = normal.normalize_or(self.normal_of(particle));
        }
    }
}

/// Adds the normal of each face to those of its corners. Its length is twice the area: larger faces weigh more.
pub(crate) fn add_face_normals<'a>(
    faces: impl IntoIterator<Item = &'a [u32; 3]>,
    places: &[Vec3],
    normals: &mut [Vec3],
) {
    for face in faces {
        let [a, b, c] = face.map_inline(|corner| places[corner as usize]);
        let normal = (b - a).cross(c - a);
        for corner in face {
            normals[*corner as usize] += normal;
        }
    }
}
