//! The cape: a mesh of the skeleton's, with what an artist paints.

use bevy::math::Vec3;
use serde_json::json;

use super::{
    body,
    file::File,
    skeleton::{CHEST, HIPS},
};

/// Vertices across and down.
const ACROSS: usize = 21;
const DOWN: usize = 27;
/// From the middle of the back to either side (rad).
const SIDE: f32 = 1.25;
/// Height of the collar, and length below it (m).
const COLLAR: f32 = 1.475;
const LENGTH: f32 = 1.16;

/// Where it is at rest, `u` from −1 to 1 across and `v` from 0 to 1 down: around the back, the wider the lower.
fn place(u: f32, v: f32) -> Vec3 {
    let (sin, cos) = (SIDE * u).sin_cos();
    let width = 0.185 + 0.20 * v;
    let depth = 0.125 + 0.20 * v;
    // Shoulders slope.
    let slope = 0.045 * u * u * (1.0 - v);
    Vec3::new(width * sin, COLLAR - slope - LENGTH * v, -depth * cos)
}

/// Adds it; returns which mesh it is.
pub fn mesh(file: &mut File) -> usize {
    let mut places = Vec::new();
    let (mut normals, mut tangents, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let (mut joints, mut weights, mut distances) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..DOWN {
        for column in 0..ACROSS {
            let v = row as f32 / (DOWN - 1) as f32;
            let u = 2.0 * column as f32 / (ACROSS - 1) as f32 - 1.0;
            let step = 1.0e-3;
            let across = (place(u + step, v) - place(u - step, v)).normalize();
            let down = (place(u, v + step) - place(u, v - step)).normalize();
            let normal = across.cross(down).normalize();
            places.push(place(u, v).to_array());
            normals.push(normal.to_array());
            let handed = normal.cross(across).dot(down).signum();
            tangents.push(across.extend(handed).to_array());
            uvs.push([0.5 + 0.5 * u, v]);
            // The collar goes with the chest, the hem with the hips.
            let hips = ((v - 0.3) / 0.5).clamp(0.0, 1.0);
            joints.push([CHEST as u16, HIPS as u16, 0, 0]);
            weights.push([1.0 - hips, hips, 0.0, 0.0]);
            // The collar is held, the hem may fly as far as it is long.
            distances.push([if row == 0 { 0.0 } else { 0.03 + 2.0 * v }]);
        }
    }
    let mut triangles = Vec::new();
    for row in 0..DOWN - 1 {
        for column in 0..ACROSS - 1 {
            let a = (row * ACROSS + column) as u16;
            let (b, c, d) = (a + 1, a + ACROSS as u16, a + ACROSS as u16 + 1);
            // Diagonals in turns, so that no direction is favoured.
            if (row + column).is_multiple_of(2) {
                triangles.extend([[a, c, b], [b, c, d]]);
            } else {
                triangles.extend([[a, d, b], [a, c, d]]);
            }
        }
    }
    let attributes = json!({
        "POSITION": file.floats(&places),
        "NORMAL": file.floats(&normals),
        "TANGENT": file.floats(&tangents),
        "TEXCOORD_0": file.floats(&uvs),
        "JOINTS_0": file.joints(&joints),
        "WEIGHTS_0": file.floats(&weights),
        "_MAX_DISTANCE": file.floats(&distances),
    });
    let indices = file.indices(&triangles);
    file.mesh(attributes, indices, body::CAPE)
}
