//! The body: what is turned on a lathe, one piece a joint.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::math::{Quat, Vec2, Vec3};
use serde_json::{Value, json};

use super::{file::File, skeleton};

/// Corners around each piece.
const AROUND: usize = 20;

/// Materials of the file, in their order.
const SKIN: usize = 0;
const HAIR: usize = 1;
const TUNIC: usize = 2;
const TROUSERS: usize = 3;
const LEATHER: usize = 4;
pub const CAPE: usize = 5;

/// Their names, colours (linear) and roughness.
pub fn materials() -> Value {
    let material = |(name, [r, g, b], roughness): (&str, [f32; 3], f32)| {
        json!({ "name": name, "doubleSided": true, "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": roughness,
        } })
    };
    let all = [
        ("skin", [0.62, 0.36, 0.24], 0.7),
        ("hair", [0.09, 0.045, 0.025], 0.8),
        ("tunic", [0.78, 0.70, 0.55], 0.9),
        ("trousers", [0.10, 0.13, 0.20], 0.9),
        ("leather", [0.16, 0.075, 0.035], 0.55),
        ("cape", [0.45, 0.03, 0.05], 0.9),
    ];
    all.map(material).into()
}

/// Radii and heights (m) of a piece that is round at both ends: the radii there, and how long it is between them, downwards.
fn limb(upper: f32, lower: f32, length: f32) -> Vec<Vec2> {
    let end = |radius: f32, at: f32, from: f32| {
        (0..=5).map(move |step| {
            let angle = from - FRAC_PI_2 * step as f32 / 5.0;
            Vec2::new(radius * angle.cos(), at + radius * angle.sin())
        })
    };
    end(upper, 0.0, FRAC_PI_2)
        .chain(end(lower, -length, 0.0))
        .collect()
}

/// A ball's, from its top down to the height −1 ⁠≤ `lowest` of its radius.
fn ball(radius: f32, lowest: f32) -> Vec<Vec2> {
    let last = lowest.acos();
    let at = |step: usize| last * step as f32 / 12.0;
    let point = |angle: f32| radius * Vec2::new(angle.sin(), angle.cos());
    (0..=12).map(|step| point(at(step))).collect()
}

/// A curve through radii at heights, smoothly.
fn smooth(points: &[[f32; 2]]) -> Vec<Vec2> {
    let at = |index: isize| {
        let index = index.clamp(0, points.len() as isize - 1);
        Vec2::from(points[index as usize])
    };
    let mut curve = Vec::new();
    for index in 0..points.len() as isize - 1 {
        let [a, b, c, d] = [-1, 0, 1, 2].map(|step| at(index + step));
        for step in 0..4 {
            let t = step as f32 / 4.0;
            // Catmull and Rom's.
            let point = 0.5
                * (2.0 * b
                    + (c - a) * t
                    + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
                    + (3.0 * b - a - 3.0 * c + d) * t * t * t);
            curve.push(point.max(Vec2::new(0.0, f32::MIN)));
        }
    }
    curve.push(at(points.len() as isize - 1));
    curve
}

/// A surface of revolution around y through these radii and heights, pressed along z to a part of its depth.
fn lathe(file: &mut File, profile: &[Vec2], depth: f32, material: usize) -> usize {
    let (mut places, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for (ring, point) in profile.iter().enumerate() {
        let [before, after] = [ring.saturating_sub(1), (ring + 1).min(profile.len() - 1)];
        let along = profile[before] - profile[after];
        for step in 0..=AROUND {
            let (sin, cos) = (TAU * (step % AROUND) as f32 / AROUND as f32).sin_cos();
            places.push([point.x * cos, point.y, depth * point.x * sin]);
            let normal = Vec3::new(along.y * cos, -along.x, along.y * sin / depth);
            normals.push(normal.normalize_or(Vec3::Y * point.y.signum()).to_array());
        }
    }
    let width = AROUND + 1;
    for ring in 0..profile.len() - 1 {
        for step in 0..AROUND {
            let a = (ring * width + step) as u16;
            let (b, c, d) = (a + 1, a + width as u16, a + width as u16 + 1);
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    let attributes = json!({ "POSITION": file.floats(&places), "NORMAL": file.floats(&normals) });
    let indices = file.indices(&triangles);
    file.mesh(attributes, indices, material)
}

/// Adds the pieces, as children of their joints.
pub fn add(file: &mut File, nodes: &mut Vec<Value>) {
    let mut put = |joint: &str, mesh: usize, at: Vec3, turn: Quat| {
        let node = nodes.len();
        nodes.push(
            json!({ "mesh": mesh, "translation": at.to_array(), "rotation": turn.to_array() }),
        );
        let children = nodes[skeleton::of(joint)]["children"].as_array_mut();
        children.expect("a list").push(node.into());
    };
    let pelvis = lathe(file, &limb(0.128, 0.105, 0.08), 0.80, TROUSERS);
    put("hips", pelvis, Vec3::new(0.0, 0.0, 0.0), Quat::IDENTITY);
    // From the neck down to the skirt of the tunic.
    let torso = smooth(&[
        [0.0, 0.275],
        [0.055, 0.265],
        [0.115, 0.225],
        [0.172, 0.165],
        [0.178, 0.08],
        [0.160, -0.04],
        [0.142, -0.15],
        [0.146, -0.22],
        [0.158, -0.29],
        [0.165, -0.335],
        [0.150, -0.345],
    ]);
    let torso = lathe(file, &torso, 0.70, TUNIC);
    put("chest", torso, Vec3::ZERO, Quat::IDENTITY);
    let belt = lathe(
        file,
        &[
            Vec2::new(0.146, 0.02),
            Vec2::new(0.163, 0.015),
            Vec2::new(0.165, -0.02),
            Vec2::new(0.148, -0.028),
        ],
        0.72,
        LEATHER,
    );
    put("spine", belt, Vec3::new(0.0, 0.03, 0.0), Quat::IDENTITY);
    let neck = lathe(file, &limb(0.052, 0.058, 0.10), 1.0, SKIN);
    put("neck", neck, Vec3::Y * 0.08, Quat::IDENTITY);
    let face = smooth(&[
        [0.0, 0.125],
        [0.062, 0.108],
        [0.096, 0.055],
        [0.100, 0.0],
        [0.088, -0.06],
        [0.058, -0.112],
        [0.0, -0.132],
    ]);
    let face = lathe(file, &face, 1.08, SKIN);
    put("head", face, Vec3::Y * 0.105, Quat::IDENTITY);
    let nose = lathe(file, &ball(0.017, -1.0), 1.2, SKIN);
    put("head", nose, Vec3::new(0.0, 0.095, 0.107), Quat::IDENTITY);
    let eye = lathe(file, &ball(0.0125, -1.0), 0.6, HAIR);
    for x in [-0.036, 0.036] {
        put("head", eye, Vec3::new(x, 0.122, 0.095), Quat::IDENTITY);
    }
    let hair = lathe(file, &ball(0.122, -0.25), 1.08, HAIR);
    let back = Quat::from_rotation_x(-0.55);
    put("head", hair, Vec3::new(0.0, 0.128, -0.014), back);
    let sleeve = lathe(file, &limb(0.062, 0.048, 0.25), 1.0, TUNIC);
    let forearm = lathe(file, &limb(0.043, 0.033, 0.20), 1.0, SKIN);
    let cuff = lathe(file, &limb(0.047, 0.039, 0.09), 1.0, LEATHER);
    let hand = lathe(file, &limb(0.036, 0.024, 0.075), 0.55, SKIN);
    let thigh = lathe(file, &limb(0.092, 0.062, 0.40), 1.0, TROUSERS);
    let shin = lathe(file, &limb(0.062, 0.045, 0.16), 1.0, TROUSERS);
    let boot = lathe(file, &limb(0.066, 0.050, 0.27), 1.0, LEATHER);
    let foot = lathe(file, &limb(0.048, 0.040, 0.15), 0.75, LEATHER);
    let forwards = Quat::from_rotation_x(-FRAC_PI_2 + 0.12);
    for side in ["L", "R"] {
        let on = |joint: &str| format!("{joint}.{side}");
        put(&on("upper_arm"), sleeve, Vec3::ZERO, Quat::IDENTITY);
        put(&on("forearm"), forearm, Vec3::ZERO, Quat::IDENTITY);
        put(&on("forearm"), cuff, Vec3::Y * -0.11, Quat::IDENTITY);
        let turned = Quat::from_rotation_y(FRAC_PI_2);
        put(&on("hand"), hand, Vec3::ZERO, turned);
        put(&on("thigh"), thigh, Vec3::ZERO, Quat::IDENTITY);
        put(&on("shin"), shin, Vec3::ZERO, Quat::IDENTITY);
        put(&on("shin"), boot, Vec3::Y * -0.13, Quat::IDENTITY);
        put(&on("foot"), foot, Vec3::new(0.0, -0.035, -0.02), forwards);
    }
}
