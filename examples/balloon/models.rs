//! The balloon's mesh.

use std::f32::consts::TAU;

use bevy::prelude::*;
use examples_shared::surfaces::smooth;

/// How far the discs are apart in their middle (m): vertices in the same place would be one particle.
const APART: f32 = 0.004;

/// Two discs of this radius (m), sewn together along their edge, of `rings` rings of triangles that are all about as large.
pub fn discs(radius: f32, rings: u32) -> Mesh {
    let (mut positions, mut uvs, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for side in [1.0, -1.0] {
        let first = positions.len() as u32;
        // Where a ring begins: each has six vertices more than the one before.
        let start = |ring: u32| {
            first
                + if ring == 0 {
                    0
                } else {
                    1 + 3 * ring * (ring - 1)
                }
        };
        for ring in 0..=rings {
            let count = (6 * ring).max(1);
            for step in 0..count {
                let (sin, cos) = (TAU * step as f32 / count as f32).sin_cos();
                let out = radius * ring as f32 / rings as f32;
                // The same to the last bit on either side.
                let part = ring as f32 / rings as f32;
                let bulge = 0.5 * APART * side * (1.0 - part * part);
                positions.push([out * cos, out * sin, bulge]);
                uvs.push([0.5 + 0.5 * part * cos, 0.5 - 0.5 * part * sin]);
            }
        }
        let mut triangle = |[a, b, c]: [u32; 3]| {
            indices.extend(if side > 0.0 { [a, b, c] } else { [a, c, b] });
        };
        for ring in 0..rings {
            let (inner, outer) = ((6 * ring).max(1), 6 * (ring + 1));
            for sector in 0..6 {
                for step in 0..=ring {
                    let inside = start(ring) + (sector * ring + step) % inner;
                    let outside = start(ring + 1) + sector * (ring + 1) + step;
                    let next = start(ring + 1) + (sector * (ring + 1) + step + 1) % outer;
                    triangle([inside, outside, next]);
                    if step < ring {
                        let beside = start(ring) + (sector * ring + step + 1) % inner;
                        triangle([inside, next, beside]);
                    }
                }
            }
        }
    }
    smooth(positions, uvs, indices)
}
