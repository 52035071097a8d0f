//! The mesh that is made here.

use std::f32::consts::TAU;

use bevy::prelude::*;

use crate::turned::turned;

/// Particles around the skirt for one from its waist to its hem.
const AROUND: u32 = 5;

/// A circle skirt, laid flat: a ring of cloth in the horizontal plane from `waist` to `hem` m, of `rings` rings of triangles. It
/// begins and ends along a seam with vertices of its own on either side, as its texture does.
pub fn skirt(waist: f32, hem: f32, rings: u32) -> Mesh {
    let profile: Vec<[f32; 2]> = (0..=rings)
        .map(|ring| [waist.lerp(hem, ring as f32 / rings as f32), 0.0])
        .collect();
    turned(&profile, AROUND * rings, TAU)
}
