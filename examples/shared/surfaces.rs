//! Surfaces of triangles, and those that are turned on a lathe.

use std::f32::consts::TAU;

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};

/// A mesh without normals.
pub fn surface(positions: Vec<[f32; 3]>, uvs: Vec<[f32; 2]>, indices: Vec<u32>) -> Mesh {
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_indices(Indices::U32(indices))
}

/// The same with smooth normals, and with tangents.
pub fn smooth(positions: Vec<[f32; 3]>, uvs: Vec<[f32; 2]>, indices: Vec<u32>) -> Mesh {
    // Bevy leaves out the corners of triangles of a few millimetres. A power of two rounds nothing.
    let mesh = surface(positions, uvs, indices)
        .scaled_by(Vec3::splat(128.0))
        .with_computed_smooth_normals()
        .scaled_by(Vec3::splat(1.0 / 128.0));
    mesh.clone().with_generated_tangents().unwrap_or(mesh)
}

/// Triangles between circles of `around` + 1 vertices each, `rings` times from one circle to the next. Their diagonals change
/// direction in turns, so that no direction is favoured.
pub fn rings_of_triangles(rings: u32, around: u32) -> Vec<u32> {
    let mut indices = Vec::new();
    let width = around + 1;
    for ring in 0..rings {
        for step in 0..around {
            let a = ring * width + step;
            let (b, c, d) = (a + 1, a + width, a + width + 1);
            if (ring + step) % 2 == 0 {
                indices.extend([a, b, c, c, b, d]);
            } else {
                indices.extend([a, b, d, a, d, c]);
            }
        }
    }
    indices
}

/// A surface of revolution through circles of these radii (m) at these heights (m), `arc` rad of it from +x towards +z, with `around`
/// edges on each circle. All of a turn is closed: it begins and ends along a seam with vertices of its own on either side, as its
/// texture does. Its texture's u runs from the first circle to the last, v around.
pub fn turned(profile: &[[f32; 2]], around: u32, arc: f32) -> Mesh {
    let rings = profile.len() as u32 - 1;
    let is_closed = arc == TAU;
    let (mut positions, mut uvs) = (Vec::new(), Vec::new());
    for (ring, [radius, height]) in profile.iter().enumerate() {
        for step in 0..=around {
            // The same to the last bit on both sides of a seam.
            let at = if is_closed { step % around } else { step };
            let angle = arc * at as f32 / around as f32;
            positions.push([radius * angle.cos(), *height, radius * angle.sin()]);
            uvs.push([ring as f32 / rings as f32, step as f32 / around as f32]);
        }
    }
    smooth(positions, uvs, rings_of_triangles(rings, around))
}
