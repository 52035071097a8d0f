//! Normals of a surface that has moved.

use bevy::math::Vec3;

use super::Surface;

impl Surface {
    /// The normal at each particle where the particles are at `positions`: the mean of its faces' normals, by their areas, of
    /// length 1. Where they cancel out it is the one at rest. `normals` become as many as there are positions.
    pub fn normals_at(&self, positions: &[Vec3], normals: &mut Vec<Vec3>) {
        normals.clear();
        normals.resize(positions.len(), Vec3::ZERO);
        for face in self.triangles() {
            let [a, b, c] = face.map(|corner| positions[corner as usize]);
            // Of twice its area: the larger a face is, the more it says.
            let normal = (b - a).cross(c - a);
            face.iter()
                .for_each(|corner| normals[*corner as usize] += normal);
        }
        for (particle, normal) in normals.iter_mut().enumerate() {
            *normal = normal.normalize_or(self.normal_of(particle));
        }
    }
}
