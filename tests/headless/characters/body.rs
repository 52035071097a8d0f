//! Colliders of skinned meshes: cloth on an arm that bends.

use std::time::Instant;

use bevy::{
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    prelude::*,
};
use bevy_drape::prelude::*;

use super::arm::*;
use crate::{fuzz::random::Random, meshes::sheets::*, support::*};

/// Bent by up to 1.5 rad, so that the arm does not press the cloth against itself.
const MOST: f32 = 1.5;

fn within(random: &mut Random, limit: f32) -> Vec3 {
    Vec3::from([(); 3].map(|()| (2.0 * random.part() - 1.0) * limit))
}

fn arm(by: By) -> (App, Arm) {
    let mut app = app_that_draws(FixedUpdate);
    let arm = spawn_arm(&mut app, by, Transform::default());
    (app, arm)
}

/// Bends an arm over and over in these ticks, after a second in which it holds still.
fn go(
    app: &mut App,
    arm: &Arm,
    speed: f32,
    ticks: std::ops::Range<u32>,
    mut check: impl FnMut(&mut App, u32),
) {
    for count in ticks {
        let seconds = (count as f32 * TICK - 1.0).max(0.0);
        bend(app, arm, Vec3::Z, angle(MOST, speed, seconds));
        tick(app, 1);
        check(app, count);
    }
}

/// Of arms in any place, bent about any axis across at up to 7.5 rad/s, none passes through a sheet or a sleeve, of
/// grid and of mesh, with any friction. Every 16th tick is checked, every 8th where tests run at their full length.
#[test]
fn no_arm_passes_through_what_it_wears() {
    let (variants, every) = if is_long() { (100, 8) } else { (6, 16) };
    let mut random = Random(3);
    for variant in 0..variants {
        let mut app = app_that_draws(FixedUpdate);
        let turn = Quat::from_scaled_axis(within(&mut random, 1.8));
        let shoulder = Transform::from_translation(within(&mut random, 2.0)).with_rotation(turn);
        let arm = spawn_arm(&mut app, By::Mesh, shoulder);
        let worn = match variant % 2 {
            0 => Worn::Sheet,
            _ => Worn::Sleeve,
        };
        let material = ClothMaterial {
            friction: 0.8 * random.part(),
            ..ClothMaterial::COTTON
        };
        let cloth = dress(&mut app, &arm, worn, material);
        // Gravity presses a sheet on the arm, wherever its upper side is.
        let down = shoulder.rotation * Vec3::NEG_Y;
        app.insert_resource(ClothGravity(down * GRAVITY));
        let speed = 0.5 + 4.5 * random.part();
        let axis = Quat::from_rotation_x(3.0 * random.part() - 1.5) * Vec3::Z;
        for count in 0..200 {
            let seconds = (count as f32 * TICK - 0.5).max(0.0);
            bend(&mut app, &arm, axis, angle(MOST, speed, seconds));
            tick(&mut app, 1);
            if count % every == 0 {
                let inside = inside(&app, &arm, cloth);
                assert_eq!(
                    inside, 0,
                    "variant {variant}: {worn:?}, {speed}, tick {count}"
                );
            }
        }
        assert_eq!(fault(&app, arm.skin), None);
        assert_eq!(fault(&app, cloth), None);
    }
}

/// A cloth falls asleep on an arm that holds still, and wakes as soon as that bends.
#[test]
fn a_cloth_sleeps_on_an_arm_until_it_bends() {
    let (mut app, arm) = arm(By::Mesh);
    let damped = ClothMaterial {
        damping: 0.05,
        ..ClothMaterial::COTTON
    };
    let cloth = dress(&mut app, &arm, Worn::Sleeve, damped);
    let slept = (0..64 * 20).find(|_| {
        tick(&mut app, 1);
        stats(&app, cloth).is_asleep
    });
    assert!(slept.is_some(), "it sleeps within 20 s");
    bend(&mut app, &arm, Vec3::Z, 0.1);
    tick(&mut app, 1);
    assert!(!stats(&app, cloth).is_asleep);
}

/// How far a sheet on an arm is moved by an arm that jumps through it (m), with a `ClothTeleport` on these.
fn moved_by_jump(teleports: impl Fn(&Arm) -> Vec<Entity>) -> f32 {
    let (mut app, arm) = arm(By::Mesh);
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let cloth = dress(&mut app, &arm, Worn::Sheet, ());
    tick(&mut app, 1);
    let before = in_world(&app, cloth);
    for entity in teleports(&arm) {
        app.world_mut().entity_mut(entity).insert(ClothTeleport);
    }
    change::<Transform>(&mut app, arm.joints[0], |shoulder| {
        shoulder.translation.y += 1.0;
    });
    tick(&mut app, 10);
    let pairs = before.into_iter().zip(in_world(&app, cloth));
    pairs
        .map(|(before, after)| before.distance(after))
        .fold(0.0, f32::max)
}

/// An arm that is teleported does not throw what lies in its way: by its joints, or by its mesh.
#[test]
fn a_teleported_arm_has_no_speed() {
    assert!(moved_by_jump(|_| Vec::new()) > 0.1, "it is in the way");
    assert!(moved_by_jump(|arm| vec![arm.joints[0]]) < 1.0e-4);
    assert!(moved_by_jump(|arm| vec![arm.skin]) < 1.0e-4);
}

/// A mesh that loses its skin, or gets one, begins where it is then: it does not sweep from one place to the other. It is no
/// body that cloth pushes.
#[test]
fn a_skin_that_comes_or_goes_is_no_motion() {
    let (mut app, arm) = arm(By::Mesh);
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let skin = arm.skin;
    app.world_mut().entity_mut(skin).insert((
        ClothBody::ball(1.0, 0.1),
        Transform::from_xyz(0.0, 1.0, 0.0),
    ));
    let cloth = dress(
        &mut app,
        &arm,
        Worn::Sheet,
        Transform::from_xyz(0.3, 0.5, 0.0),
    );
    tick(&mut app, 1);
    let before = in_world(&app, cloth);
    let skinned = app.world_mut().entity_mut(skin).take::<SkinnedMesh>();
    tick(&mut app, 5);
    app.world_mut()
        .entity_mut(skin)
        .insert(skinned.expect("a skin"));
    tick(&mut app, 5);
    for (before, after) in before.into_iter().zip(in_world(&app, cloth)) {
        assert!(before.distance(after) < 1.0e-4, "{before} {after}");
    }
    assert_eq!(
        *app.world().get::<ClothPush>(skin).expect("a push"),
        ClothPush::default()
    );
}

/// A fault of the mesh or of its joints is one of the collider, which no cloth meets then. It is met again as soon as that is
/// mended.
#[test]
fn bad_skins_are_faults() {
    let (mut app, arm) = arm(By::Mesh);
    let cloth = dress(&mut app, &arm, Worn::Sheet, ());
    tick(&mut app, 1);
    let elbow = *app.world().get::<Transform>(arm.joints[1]).expect("a bone");
    for bad in [Vec3::NAN, Vec3::INFINITY] {
        change::<Transform>(&mut app, arm.joints[1], |bone| bone.translation = bad);
        tick(&mut app, 2);
        let error = fault(&app, arm.skin);
        assert!(
            matches!(
                error,
                Some(ClothError::Skin(SkinError::Joint { joint: 1, .. }))
            ),
            "{error:?}"
        );
        change::<Transform>(&mut app, arm.joints[1], |bone| *bone = elbow);
        tick(&mut app, 2);
        assert_eq!(fault(&app, arm.skin), None);
    }
    for scale in [0.0, 1.0e-20, -1.0, 1.0] {
        change::<Transform>(&mut app, arm.joints[0], |bone| {
            bone.scale = Vec3::splat(scale);
        });
        tick(&mut app, 2);
        assert_eq!(fault(&app, arm.skin), None, "a scale of {scale}");
    }
    let handle = mesh_of(&app, arm.skin);
    let whole = meshes(&app).get(&handle).expect("a mesh").clone();
    let plain = whole
        .clone()
        .with_removed_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
    let put = |app: &mut App, mesh: Mesh| {
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        meshes.insert(&handle, mesh).expect("a handle");
        tick(app, 2);
    };
    put(&mut app, plain);
    let error = fault(&app, arm.skin);
    assert!(
        matches!(
            error,
            Some(ClothError::Skin(SkinError::MissingJoints { .. }))
        ),
        "{error:?}"
    );
    put(&mut app, whole);
    assert_eq!(fault(&app, arm.skin), None);
    app.world_mut()
        .insert_resource(Assets::<SkinnedMeshInverseBindposes>::default());
    tick(&mut app, 2);
    assert!(fault(&app, arm.skin).is_some(), "no bind poses");
    assert_eq!(fault(&app, cloth), None);
    assert!(in_world(&app, cloth).iter().all(|at| at.is_finite()));
}

/// A mirrored arm, by a negative scale of its shoulder, keeps its outer side outside.
#[test]
fn a_mirrored_arm_is_no_less_solid() {
    let mut app = app_that_draws(FixedUpdate);
    let arm = spawn_arm(&mut app, By::Mesh, Transform::default());
    let cloth = dress(&mut app, &arm, Worn::Sheet, ());
    change::<Transform>(&mut app, arm.joints[0], |shoulder| shoulder.scale.z = -1.0);
    go(&mut app, &arm, 1.0, 0..160, |_, _| ());
    // It is alike on both sides.
    assert_eq!(inside(&app, &arm, cloth), 0);
    let lowest = in_world(&app, cloth)
        .iter()
        .fold(f32::MAX, |low, at| low.min(at.y));
    assert!(lowest > -0.5, "it lies on it, and has not fallen: {lowest}");
}

/// Run with `--nocapture`, it prints what a tick with an arm of 2,028 triangles takes, and with two capsules.
#[test]
fn a_body_costs() {
    for worn in [Worn::Sheet, Worn::Sleeve] {
        for speed in [0.5, 1.0, 2.0, 4.0] {
            for by in [By::Capsules, By::Mesh] {
                let (mut app, arm) = arm(by);
                let cloth = dress(&mut app, &arm, worn, ());
                let mut times = Vec::new();
                let mut start = Instant::now();
                go(
                    &mut app,
                    &arm,
                    speed,
                    0..if is_long() { 320 } else { 40 },
                    |_, _| {
                        times.push(start.elapsed().as_secs_f64() * 1.0e3);
                        start = Instant::now();
                    },
                );
                let first = times.remove(0);
                times.sort_unstable_by(f64::total_cmp);
                let mean = times.iter().sum::<f64>() / times.len() as f64;
                let at = |part: f64| times[((times.len() - 1) as f64 * part) as usize];
                println!(
                    "{worn:?}, {speed}, {by:?}: {mean:.2} ms a tick, median {:.2}, p99 {:.2}, worst {:.2}, first {first:.1}",
                    at(0.5),
                    at(0.99),
                    at(1.0)
                );
                assert_eq!(fault(&app, arm.skin), None);
                assert_eq!(inside(&app, &arm, cloth), 0);
            }
        }
    }
}
