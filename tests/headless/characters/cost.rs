//! What a pose costs.

use std::time::Instant;

use bevy::{mesh::VertexAttributeValues, prelude::*};
use bevy_drape::prelude::*;

use super::rig::*;
use crate::{meshes::sheets::*, support::*};

/// Vertices along either side: 5,041 in all.
const MANY: u32 = 71;

/// Run with `--nocapture` it prints the medians of a tick of 5,041 vertices whose bones move: without a pose, with one that
/// nothing but pins follow, with max distances, and those with a backstop, all held.
#[test]
fn a_pose_costs() {
    let red = Pins::new([Pin::at_rest(|place| place.z < 0.01)]);
    let within = || ClothSkin::within(ClothPaint::at_rest(|place| 0.05 * place.z));
    let none = ClothSkin {
        blend: 0.0,
        ..within()
    };
    for (name, skin) in [
        ("no pose", None),
        ("pins in a pose", Some(ClothSkin::default())),
        ("max distances", Some(within())),
        ("and a backstop", Some(within().with_backstop(0.01, 1.0))),
        ("all held", Some(none)),
    ] {
        let mut app = app_that_draws(FixedUpdate);
        let of = |vertex: u32| weights(vertex / MANY * SIDE / MANY * SIDE);
        let (joints, weights): (Vec<_>, Vec<_>) = (0..MANY * MANY).map(of).unzip();
        let mesh = sheet_asset(MANY, MANY)
            .with_inserted_attribute(
                Mesh::ATTRIBUTE_JOINT_INDEX,
                VertexAttributeValues::Uint16x4(joints),
            )
            .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights);
        let rig = rig_of(&mut app, mesh, (red.clone(), ClothSettings::substeps(20)));
        if let Some(skin) = skin {
            app.world_mut().entity_mut(rig.cloth).insert(skin);
        }
        let (mut times, mut substeps) = (Vec::new(), Vec::new());
        for count in 0..60 {
            pose(&mut app, &rig, 0.2 * count as f32 * TICK);
            let start = Instant::now();
            tick(&mut app, 1);
            times.push(start.elapsed().as_secs_f64() * 1.0e3);
            substeps.push(stats(&app, rig.cloth).integrate_ms);
        }
        assert_eq!(fault(&app, rig.cloth), None);
        assert_eq!(particles(&app, rig.cloth).len(), 5041);
        let median = |times: &mut Vec<f64>| {
            times.sort_unstable_by(f64::total_cmp);
            times[times.len() / 2]
        };
        println!(
            "{name}: {:.2} ms a tick and frame, {:.2} ms of it sub-steps",
            median(&mut times),
            median(&mut substeps)
        );
    }
}
