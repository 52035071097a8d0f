//! The skeleton: which joint hangs on which, and where (m, y up, facing +z).

use bevy::math::{Mat4, Vec3};
use serde_json::{Value, json};

use super::file::File;

/// A joint.
pub struct Joint {
    pub name: &'static str,
    above: Option<usize>,
    /// Seen from the joint above it.
    pub at: Vec3,
}

const fn joint(name: &'static str, above: usize, x: f32, y: f32, z: f32) -> Joint {
    Joint {
        name,
        above: Some(above),
        at: Vec3::new(x, y, z),
    }
}

pub const HIPS: usize = 0;
pub const CHEST: usize = 2;

/// Nodes of the file, in their order.
pub const JOINTS: [Joint; 17] = [
    Joint {
        name: "hips",
        above: None,
        at: Vec3::new(0.0, 0.97, 0.0),
    },
    joint("spine", HIPS, 0.0, 0.10, 0.0),
    joint("chest", 1, 0.0, 0.18, 0.0),
    joint("neck", CHEST, 0.0, 0.26, 0.0),
    joint("head", 3, 0.0, 0.09, 0.01),
    joint("upper_arm.L", CHEST, 0.195, 0.19, 0.0),
    joint("forearm.L", 5, 0.0, -0.28, 0.0),
    joint("hand.L", 6, 0.0, -0.25, 0.0),
    joint("upper_arm.R", CHEST, -0.195, 0.19, 0.0),
    joint("forearm.R", 8, 0.0, -0.28, 0.0),
    joint("hand.R", 9, 0.0, -0.25, 0.0),
    joint("thigh.L", HIPS, 0.095, -0.04, 0.0),
    joint("shin.L", 11, 0.0, -0.43, 0.0),
    joint("foot.L", 12, 0.0, -0.43, 0.0),
    joint("thigh.R", HIPS, -0.095, -0.04, 0.0),
    joint("shin.R", 14, 0.0, -0.43, 0.0),
    joint("foot.R", 15, 0.0, -0.43, 0.0),
];

/// Which joint is called so.
pub fn of(name: &str) -> usize {
    let found = JOINTS.iter().position(|joint| joint.name == name);
    found.expect("a joint of the skeleton")
}

/// A node for each joint.
pub fn nodes() -> Vec<Value> {
    let children = |of: usize| -> Vec<usize> {
        (0..JOINTS.len())
            .filter(|&child| JOINTS[child].above == Some(of))
            .collect()
    };
    let node = |(index, joint): (usize, &Joint)| json!({ "name": joint.name, "translation": joint.at.to_array(), "children": children(index) });
    JOINTS.iter().enumerate().map(node).collect()
}

/// Of a mesh that is bound to all joints as they are at rest.
pub fn skin(file: &mut File) -> Value {
    let place = |mut joint: usize| {
        let mut place = JOINTS[joint].at;
        while let Some(above) = JOINTS[joint].above {
            place += JOINTS[above].at;
            joint = above;
        }
        place
    };
    let inverse: Vec<[f32; 16]> = (0..JOINTS.len())
        .map(|joint| Mat4::from_translation(-place(joint)).to_cols_array())
        .collect();
    let inverse = file.floats(&inverse);
    let joints: Vec<usize> = (0..JOINTS.len()).collect();
    json!({ "joints": joints, "inverseBindMatrices": inverse })
}
