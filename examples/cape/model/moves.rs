//! What the hero does: poses by formulas, sampled as key frames.

use std::f32::consts::TAU;

use bevy::math::{EulerRot, Quat, Vec3};
use serde_json::{Value, json};

use super::{
    file::File,
    skeleton::{HIPS, JOINTS},
};

/// Key frames of each animation, the first again as the last.
const KEYS: usize = 25;

/// A clip: how long it is (s), how the joint of a name is turned at a part of it, and how far the hips are moved (m).
struct Clip {
    name: &'static str,
    seconds: f32,
    turn: fn(&str, f32) -> Quat,
    hips: fn(f32) -> Vec3,
}

/// Turned about x, then y, then z (rad): forwards is +z, left +x.
fn turned(x: f32, y: f32, z: f32) -> Quat {
    Quat::from_euler(EulerRot::ZYX, z, y, x)
}

/// The joint without its side, and −1 for the right one.
fn sided(joint: &str) -> (&str, f32) {
    match joint.rsplit_once('.') {
        Some((name, "L")) => (name, 1.0),
        Some((name, _)) => (name, -1.0),
        None => (joint, 0.0),
    }
}

fn idle(joint: &str, part: f32) -> Quat {
    let breath = (TAU * part).sin();
    match sided(joint) {
        ("chest", _) => turned(-0.02 + 0.012 * breath, 0.0, 0.0),
        ("head", _) => turned(0.03, 0.25 * (TAU * part).cos(), 0.0),
        ("upper_arm", side) => turned(0.06, 0.0, side * (0.13 + 0.012 * breath)),
        ("forearm", _) => turned(-0.22, 0.0, 0.0),
        ("thigh", side) => turned(-0.02, side * 0.12, side * 0.05),
        ("shin", _) => turned(0.04, 0.0, 0.0),
        ("foot", _) => turned(-0.02, 0.0, 0.0),
        _ => Quat::IDENTITY,
    }
}

fn run(joint: &str, part: f32) -> Quat {
    let (name, side) = sided(joint);
    // The right leg is half a stride later.
    let at = TAU * part + if side < 0.0 { TAU / 2.0 } else { 0.0 };
    match (name, side) {
        ("hips", _) => turned(0.10, -0.14 * at.sin(), 0.0),
        ("spine", _) => turned(0.07, 0.12 * at.sin(), 0.0),
        ("chest", _) => turned(0.06, 0.18 * at.sin(), 0.0),
        ("head", _) => turned(-0.16, -0.12 * at.sin(), 0.0),
        ("upper_arm", side) => turned(0.12 + 0.85 * at.sin(), 0.0, side * 0.16),
        ("forearm", _) => turned(-1.45 + 0.25 * at.sin(), 0.0, 0.0),
        ("thigh", _) => turned(-0.34 - 0.80 * at.sin(), 0.0, 0.0),
        // Bent while the leg comes forwards.
        ("shin", _) => turned(0.35 + 1.35 * (at.cos() + 0.15).max(0.0), 0.0, 0.0),
        ("foot", _) => turned(0.20 + 0.25 * at.cos(), 0.0, 0.0),
        _ => Quat::IDENTITY,
    }
}

fn jump(joint: &str, part: f32) -> Quat {
    // Stretched as it leaves the ground and as it comes back.
    let tucked = (0.5 * TAU * part).sin();
    match sided(joint) {
        ("hips", _) => turned(0.12 * tucked, 0.0, 0.0),
        ("chest", _) => turned(0.10 * tucked, 0.0, 0.0),
        ("head", _) => turned(-0.15 * tucked, 0.0, 0.0),
        ("upper_arm", side) => turned(-0.5 * tucked, 0.0, side * (0.2 + 1.0 * tucked)),
        ("forearm", _) => turned(-0.3 - 0.5 * tucked, 0.0, 0.0),
        ("thigh", side) => turned(-(0.75 + 0.45 * side) * tucked, 0.0, 0.0),
        ("shin", side) => turned((1.15 + 0.25 * side) * tucked, 0.0, 0.0),
        ("foot", _) => turned(0.45 * tucked, 0.0, 0.0),
        _ => Quat::IDENTITY,
    }
}

const CLIPS: [Clip; 3] = [
    Clip {
        name: "idle",
        seconds: 3.2,
        turn: idle,
        hips: |part| Vec3::new(0.012 * (TAU * part).sin(), -0.006, 0.0),
    },
    Clip {
        name: "run",
        seconds: 0.62,
        turn: run,
        // Up twice a stride.
        hips: |part| Vec3::Y * (-0.05 + 0.03 * (2.0 * TAU * part + 0.6).sin()),
    },
    Clip {
        name: "jump",
        seconds: 0.9,
        turn: jump,
        hips: |_| Vec3::ZERO,
    },
];

/// Adds all clips.
pub fn all(file: &mut File) -> Vec<Value> {
    CLIPS.iter().map(|clip| animation(file, clip)).collect()
}

fn animation(file: &mut File, clip: &Clip) -> Value {
    let part = |key: usize| key as f32 / (KEYS - 1) as f32;
    let keys = || (0..KEYS).map(part);
    let times: Vec<[f32; 1]> = keys().map(|part| [part * clip.seconds]).collect();
    let times = file.floats(&times);
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    let mut add = |joint: usize, path: &str, output: usize| {
        samplers.push(json!({ "input": times, "output": output }));
        channels.push(json!({
            "sampler": samplers.len() - 1, "target": { "node": joint, "path": path },
        }));
    };
    for (joint, of) in JOINTS.iter().enumerate() {
        let turns: Vec<[f32; 4]> = keys()
            .map(|part| (clip.turn)(of.name, part).to_array())
            .collect();
        add(joint, "rotation", file.floats(&turns));
    }
    let at_rest = JOINTS[HIPS].at;
    let hips: Vec<[f32; 3]> = keys()
        .map(|part| (at_rest + (clip.hips)(part)).to_array())
        .collect();
    add(HIPS, "translation", file.floats(&hips));
    json!({ "name": clip.name, "samplers": samplers, "channels": channels })
}
