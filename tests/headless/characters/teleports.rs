//! What jumps, and what goes with it.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::rig::*;
use crate::{meshes::sheets::*, support::*};

/// How far a jump goes: where f32 is as fine as at the origin, so that what follows is nearly the same.
const JUMP: Vec3 = Vec3::new(0.0, 0.0, 8.0);

/// A root with a cloth that hangs against a ball below the root, and a ball of others in the way of the jump.
fn scene(inertia: impl Bundle) -> (App, Entity, Entity, Entity) {
    let mut app = app();
    let root = app.world_mut().spawn((Transform::default(), inertia)).id();
    let cloth = (Cloth::new(12, 12, 0.08), ChildOf(root));
    let cloth = app.world_mut().spawn(cloth).id();
    let ball = (
        ClothCollider::ball(0.3),
        Transform::from_xyz(0.45, -0.5, -0.2),
        ChildOf(root),
    );
    let ball = app.world_mut().spawn(ball).id();
    let other = Transform::from_xyz(0.45, -0.5, 4.0);
    app.world_mut().spawn((ClothCollider::ball(0.4), other));
    tick(&mut app, 60);
    (app, root, cloth, ball)
}

fn shape(app: &App, cloth: Entity) -> Vec<Vec3> {
    particles(app, cloth).positions().collect()
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// A root beyond its distance, or with a `ClothTeleport`, takes cloth and colliders along as if nothing had happened; one that is
/// not sends the cloth flying.
#[test]
fn a_root_takes_along_all_that_is_below() {
    let (mut calm, _, cloth, _) = scene(());
    tick(&mut calm, 10);
    let truth = shape(&calm, cloth);
    for (inertia, is_marked, goes_along) in [
        (Some(ClothInertia::default()), false, true),
        (Some(ClothInertia::share(0.3)), false, true),
        (None, true, true),
        (None, false, false),
        (
            Some(ClothInertia {
                teleport_distance: f32::INFINITY,
                ..default()
            }),
            false,
            false,
        ),
    ] {
        let (mut app, root, cloth, _) = scene(());
        if let Some(inertia) = inertia {
            app.world_mut().entity_mut(root).insert(inertia);
            tick(&mut app, 1);
        }
        app.world_mut()
            .entity_mut(root)
            .insert(Transform::from_translation(JUMP));
        if is_marked {
            app.world_mut().entity_mut(root).insert(ClothTeleport);
        }
        tick(&mut app, if inertia.is_some() { 9 } else { 10 });
        assert!(app.world().get::<ClothTeleport>(root).is_none());
        let off = farthest(&shape(&app, cloth), &truth);
        assert_eq!(off < 2.0e-3, goes_along, "{inertia:?}: {off}");
    }
}

/// A collider by itself: with a `ClothTeleport` it meets nothing on its way.
#[test]
fn a_collider_that_jumps_meets_nothing_on_its_way() {
    let (mut calm, _, cloth, ball) = scene(());
    calm.world_mut().entity_mut(ball).despawn();
    tick(&mut calm, 3);
    let truth = shape(&calm, cloth);
    for (is_marked, meets) in [(true, false), (false, true)] {
        let (mut app, _, cloth, ball) = scene(());
        let beyond = Transform::from_xyz(0.45, -0.5, 3.0);
        app.world_mut().entity_mut(ball).insert(beyond);
        if is_marked {
            app.world_mut().entity_mut(ball).insert(ClothTeleport);
        }
        tick(&mut app, 3);
        let off = farthest(&shape(&app, cloth), &truth);
        assert_eq!(off > 0.05, meets, "{off}");
    }
}

/// A root beyond its angle takes cloth along that is turned with it.
#[test]
fn a_turn_may_be_a_teleport() {
    let inertia = ClothInertia {
        teleport_angle: 1.0,
        ..default()
    };
    let (mut app, root, cloth, _) = scene(inertia);
    let before = shape(&app, cloth);
    let turned = Transform::from_rotation(Quat::from_rotation_y(2.5));
    app.world_mut().entity_mut(root).insert(turned);
    tick(&mut app, 1);
    let off = farthest(&shape(&app, cloth), &before);
    assert!(off < 0.01, "{off}");
}

/// A pose that jumps by a metre and a half a turn in one tick, and a cut by 50 m: neither tears the cloth, and beyond the
/// distance it has no speed from that.
#[test]
fn a_pose_that_jumps_does_not_explode() {
    for (jump, most) in [(1.5, f32::INFINITY), (50.0, 1.0)] {
        let mut app = app_that_draws(FixedUpdate);
        let rig = rig(&mut app, ClothSkin::painted());
        tick(&mut app, 60);
        let fastest = |app: &App| {
            let particles = particles(app, rig.cloth);
            let speeds = (0..particles.len()).map(|index| particles.velocity(index));
            speeds
                .map(|speed| speed.expect("it exists").length())
                .fold(0.0, f32::max)
        };
        change::<Transform>(&mut app, rig.bones[0], |bone| {
            bone.translation.x += jump;
            bone.rotate_y(3.0);
        });
        tick(&mut app, 1);
        assert_eq!(fault(&app, rig.cloth), None);
        assert!(fastest(&app) < most, "{jump} m: {} m/s", fastest(&app));
        tick(&mut app, 100);
        let speed = fastest(&app);
        assert!(
            speed < 0.5,
            "{jump} m: {speed} m/s, {:?}",
            stats(&app, rig.cloth).stretch
        );
        let pairs = simulated(&app, rig.cloth)
            .into_iter()
            .zip(skinned(&app, &rig));
        for (vertex, (place, truth)) in pairs.enumerate() {
            let distance = 0.05 * (vertex as u32 / SIDE) as f32;
            assert!(
                place.distance(truth) <= distance + 1.0e-4,
                "{vertex}: {place} {truth}"
            );
        }
    }
}

/// A skinned cloth whose root jumps and turns keeps its shape, as seen from the skeleton.
#[test]
fn a_skinned_cloth_goes_with_its_skeleton() {
    for is_marked in [true, false] {
        let mut app = app_that_draws(FixedUpdate);
        let rig = rig(&mut app, ClothSkin::painted());
        tick(&mut app, 120);
        let before = simulated(&app, rig.cloth);
        let there = Transform::from_xyz(8.0, 0.0, 4.0).with_rotation(Quat::from_rotation_y(1.2));
        app.world_mut().entity_mut(rig.root).insert(there);
        if is_marked {
            app.world_mut().entity_mut(rig.root).insert(ClothTeleport);
        }
        tick(&mut app, 1);
        for (place, before) in simulated(&app, rig.cloth).iter().zip(before) {
            let truth = there * before;
            // It is all but at rest: what it goes on by in a tick.
            assert!(
                place.distance(truth) < 5.0e-3,
                "{is_marked}: {place} {truth}"
            );
        }
    }
}
