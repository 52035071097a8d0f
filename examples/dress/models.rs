//! The mesh that is made here.

use std::f32::consts::TAU;

use bevy::prelude::*;

use crate::turned::turned;

/// Particles around the skirt for one from its waist to its hem.
pub const AROUND: u32 = 5;

/// A flared skirt: a cone of cloth from the radius `waist` down to the radius `hem` at `drop` below it (m), of `rings` rings of
/// triangles. It begins and ends along a seam with vertices of its own on either side, as its texture does.
pub fn skirt(waist: f32, hem: f32, drop: f32, rings: u32) -> Mesh {
    let profile: Vec<[f32; 2]> = (0..=rings)
        .map(|ring| ring as f32 / rings as f32)
        .map(|part| [waist.lerp(hem, part), -drop * part])
        .collect();
    turned(&profile, AROUND * rings, TAU)
}
