//! One collider of each shape.

use std::f32::consts::TAU;

use bevy::math::{Isometry3d, Vec3};
use bevy_drape::prelude::ClothCollider;

/// Heights along each side of a field, and how wide it is (m).
const HEIGHTS: u16 = 24;
const FIELD: f32 = 2.4;

/// Of a ring: around, and across, in points; and its radii (m).
const RING: [u16; 2] = [32, 16];
const RADII: [f32; 2] = [0.35, 0.12];

/// Some 0.8 m wide, each with its name: a ball first.
pub fn shapes() -> Vec<(&'static str, ClothCollider)> {
    let half = ClothCollider::cuboid(0.8, 0.4, 0.8);
    let cup = ClothCollider::cylinder(0.2, 0.4);
    let at = |y| Isometry3d::from_translation(Vec3::Y * y);
    vec![
        ("ball", ClothCollider::ball(0.4)),
        ("capsule", ClothCollider::capsule(0.4, 0.6)),
        ("plane", ClothCollider::plane()),
        ("box", ClothCollider::cuboid(0.8, 0.8, 0.8)),
        ("cylinder", ClothCollider::cylinder(0.4, 0.8)),
        ("cone", ClothCollider::cone(0.4, 0.8)),
        ("hull of 40 points", ClothCollider::convex_hull(stone())),
        (
            "box and cylinder in one",
            ClothCollider::compound([(at(-0.2), half), (at(0.2), cup)]),
        ),
        ("ring of 1,024 triangles", ring()),
        ("height field, 24²", field()),
    ]
}

/// Points evenly spread over a ball of 0.4 m, on a spiral.
fn stone() -> Vec<Vec3> {
    let turn = TAU / 1.618_034;
    (0..40_u16)
        .map(|index| {
            let y = 1.0 - (2.0 * f32::from(index) + 1.0) / 40.0;
            let (sine, cosine) = (turn * f32::from(index)).sin_cos();
            0.4 * (Vec3::new(cosine, 0.0, sine) * (1.0 - y * y).sqrt() + Vec3::Y * y)
        })
        .collect()
}

/// A closed mesh, lying flat.
fn ring() -> ClothCollider {
    let [around, across] = RING;
    let part = |index: u16, of: u16| TAU * f32::from(index) / f32::from(of);
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        let (sine, cosine) = part(i, around).sin_cos();
        for j in 0..across {
            let (up, out) = part(j, across).sin_cos();
            let from_middle = RADII[0] + RADII[1] * out;
            vertices.push(Vec3::new(
                cosine * from_middle,
                RADII[1] * up,
                sine * from_middle,
            ));
            let at = |i: u16, j: u16| u32::from(i % around * across + j % across);
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    ClothCollider::trimesh(vertices, triangles)
}

/// Hills 0.2 m high, up to 0.4 m above the middle.
fn field() -> ClothCollider {
    let wave = |index: u16| (TAU * 3.0 * f32::from(index) / f32::from(HEIGHTS - 1)).cos();
    let heights: Vec<f32> = (0..HEIGHTS)
        .flat_map(|row| (0..HEIGHTS).map(move |column| 0.3 + 0.1 * wave(row) * wave(column)))
        .collect();
    let size = Vec3::new(FIELD, 1.0, FIELD);
    ClothCollider::heightfield(heights, HEIGHTS.into(), size)
}
