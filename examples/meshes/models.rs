//! The models that are made here: a pennant's triangles, and a poncho's mesh.

use std::f32::consts::TAU;

use bevy::prelude::*;
use examples_shared::surfaces::{rings_of_triangles, surface};

/// A pennant: from its staff, `height` m along −y, to a point `length` m along +x, with `count` triangles along either side.
pub fn pennant(height: f32, length: f32, count: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    // One particle fewer in each column than in the one before.
    let mut first = 0;
    for column in 0..=count {
        let here = count - column;
        let x = length * column as f32 / count as f32;
        for row in 0..=here {
            let y = -height * (row as f32 + column as f32 / 2.0) / count as f32;
            positions.push(Vec3::new(x, y, 0.0));
        }
        let next = first + here + 1;
        for row in 0..here {
            let (a, b) = (first + row, next + row);
            triangles.push([a, a + 1, b]);
            if row + 1 < here {
                triangles.push([a + 1, b + 1, b]);
            }
        }
        first = next;
    }
    (positions, triangles)
}

/// A poncho: a square of `side` m in the horizontal plane with a round hole in its middle, in `rings` rings. It begins and
/// ends along a seam with vertices of its own on either side, as its texture does.
pub fn poncho(side: f32, hole: f32, rings: u32) -> Mesh {
    let around = 4 * rings;
    let (mut positions, mut uvs) = (Vec::new(), Vec::new());
    for ring in 0..=rings {
        for step in 0..=around {
            let (sin, cos) = if step == around {
                (0.0, 1.0)
            } else {
                (TAU * step as f32 / around as f32).sin_cos()
            };
            // From the circle to the square.
            let to_square = side / 2.0 / sin.abs().max(cos.abs());
            let radius = hole.lerp(to_square, ring as f32 / rings as f32);
            positions.push([radius * cos, 0.0, radius * sin]);
            uvs.push([step as f32 / around as f32, ring as f32 / rings as f32]);
        }
    }
    let normals = vec![[0.0, 1.0, 0.0]; positions.len()];
    surface(positions, uvs, rings_of_triangles(rings, around))
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
}
