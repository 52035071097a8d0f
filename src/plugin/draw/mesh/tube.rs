//! The mesh of a rope: a tube around its particles.

use std::f32::consts::TAU;

use bevy::{
    asset::RenderAssetUsages,
    math::cubic_splines::{CubicCardinalSpline, CubicGenerator},
    mesh::{Indices, PrimitiveTopology, VertexAttributeValues},
    prelude::{Mesh, Quat, Vec3},
};

use crate::cloth::Surface;

/// Sides of the tube, and its rings from one particle to the next.
const SIDES: usize = 8;
const RINGS: usize = 3;

/// Distance by which its ends stand out, in radii: they are round.
const END: f32 = 0.5;

/// Vertices of a ring: the first and the last are at one place, with the texture's left and right border.
const RING: usize = SIDES + 1;

/// The radius of a rope in its entity's frame (m); `None` for what has faces.
pub(super) fn radius_of(surface: &Surface) -> Option<f32> {
    surface.as_grid()?.unscaled_rope_radius()
}

/// Number of vertices of a rope's tube.
pub(super) fn vertices(surface: &Surface) -> usize {
    RING * rings(surface.len())
}

/// Number of rings of so many particles, with one for each end.
fn rings(particles: usize) -> usize {
    RINGS * (particles - 1) + 3
}

/// The tube of a rope. The texture's u runs around it, v along it, both from 0 to 1. Its vertices are placed by [`write`].
pub(super) fn mesh_of(surface: &Surface) -> Mesh {
    let rings = rings(surface.len());
    let mut uvs = Vec::with_capacity(rings * RING);
    for ring in 0..rings {
        let along = ring.saturating_sub(1).min(rings - 3) as f32 / (rings - 3) as f32;
        uvs.extend((0..RING).map(|side| [side as f32 / SIDES as f32, along]));
    }
    let mut corners = Vec::with_capacity(6 * SIDES * (rings - 1));
    for ring in 0..rings - 1 {
        for side in 0..SIDES {
            let first = (ring * RING + side) as u32;
            let [a, b, c, d] = [0, 1, RING as u32, RING as u32 + 1].map(|step| first + step);
            corners.extend([a, b, c, b, d, c]);
        }
    }
    let usage = RenderAssetUsages::default();
    Mesh::new(PrimitiveTopology::TriangleList, usage)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; rings * RING])
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 1.0, 0.0]; rings * RING])
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
        .with_inserted_indices(Indices::U32(corners))
}

/// Writes a tube of this radius around the drawn positions of the particles (m), along a smooth curve through all of them.
pub(super) fn write(mesh: &mut Mesh, drawn: &[Vec3], radius: f32) {
    let spline = CubicCardinalSpline::new_catmull_rom(drawn.iter().copied());
    let Ok(curve) = spline.to_curve() else {
        return;
    };
    let count = rings(drawn.len());
    let mut along = curve.velocity(0.0).normalize_or(Vec3::NEG_Y);
    let mut across = along.any_orthonormal_vector();
    let (mut places, mut normals) = (Vec::new(), Vec::new());
    for ring in 0..count {
        let at = ring.saturating_sub(1).min(count - 3) as f32 / RINGS as f32;
        let before = along;
        along = curve.velocity(at).normalize_or(before);
        // It turns no more than the curve does.
        across = (Quat::from_rotation_arc(before, along) * across)
            .reject_from_normalized(along)
            .normalize_or(along.any_orthonormal_vector());
        let middle = curve.position(at);
        let end = match ring {
            0 => -1.0,
            ring if ring + 1 == count => 1.0,
            _ => 0.0,
        };
        for side in 0..RING {
            let turn = Quat::from_axis_angle(along, TAU * side as f32 / SIDES as f32);
            let (normal, distance) = match end == 0.0 {
                true => (turn * across, radius),
                false => (along * end, END * radius),
            };
            places.push((middle + normal * distance).to_array());
            normals.push(normal.to_array());
        }
    }
    for (attribute, new) in [
        (Mesh::ATTRIBUTE_POSITION, &places),
        (Mesh::ATTRIBUTE_NORMAL, &normals),
    ] {
        if let Ok(VertexAttributeValues::Float32x3(values)) = mesh.try_attribute_mut(attribute)
            && values.len() == new.len()
        {
            values.copy_from_slice(new);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;

    /// All vertices of rings are a radius from the line, all faces look outwards, and no number is lost in a knot.
    #[test]
    fn a_tube_is_as_thick_as_its_rope() {
        let rope = Cloth::rope(30, 0.1, 0.02).surface(Vec3::ONE);
        let surface = rope.expect("a valid rope");
        let mut mesh = mesh_of(&surface);
        let curl = |index: usize| {
            let angle = index as f32 * 0.2;
            Vec3::new(angle.cos(), 0.1 * angle, angle.sin()) * 0.5
        };
        let drawn: Vec<Vec3> = (0..30).map(curl).collect();
        write(&mut mesh, &drawn, 0.02);
        let read = |attribute| -> Vec<Vec3> {
            let values = mesh.attribute(attribute).and_then(|of| of.as_float3());
            values
                .expect("three numbers")
                .iter()
                .map(|value| Vec3::from(*value))
                .collect()
        };
        let (places, normals) = (read(Mesh::ATTRIBUTE_POSITION), read(Mesh::ATTRIBUTE_NORMAL));
        for (ring, particle) in (1..places.len() / RING).step_by(RINGS).zip(&drawn) {
            for place in &places[ring * RING..(ring + 1) * RING] {
                assert!((place.distance(*particle) - 0.02).abs() < 1.0e-5);
            }
        }
        let corners: Vec<usize> = mesh.indices().expect("triangles").iter().collect();
        for face in corners.chunks_exact(3) {
            let [a, b, c] = [face[0], face[1], face[2]].map(|corner| places[corner]);
            let out = (b - a).cross(c - a);
            let normal = normals[face[0]] + normals[face[1]] + normals[face[2]];
            assert!(out.length() < 1.0e-9 || out.dot(normal) > 0.0, "{face:?}");
        }
        write(&mut mesh, &[Vec3::ONE; 30], 0.02);
        let values = mesh
            .attribute(Mesh::ATTRIBUTE_POSITION)
            .and_then(|of| of.as_float3());
        assert!(
            values
                .expect("places")
                .iter()
                .flatten()
                .all(|number| number.is_finite())
        );
    }
}
