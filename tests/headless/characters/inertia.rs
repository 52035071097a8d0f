//! How much of a character's motion its cloth feels.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{mesh::vertices, meshes::sheets::fault, support::*};

/// A free sheet beside a root, without gravity: nothing but what carries it moves it.
fn beside_root(inertia: ClothInertia) -> (App, Entity, Entity) {
    beside_root_in(app(), inertia)
}

fn beside_root_in(mut app: App, inertia: ClothInertia) -> (App, Entity, Entity) {
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let root = app.world_mut().spawn((Transform::default(), inertia)).id();
    let cloth = (
        Cloth::new(6, 5, 0.1).flat(),
        Pins::none(),
        Transform::from_xyz(0.2, 0.1, 0.3),
        ChildOf(root),
    );
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    (app, root, cloth)
}

fn in_world(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let places = particles(app, cloth).positions();
    places.map(|place| frame.to_world(place)).collect()
}

/// Of a translation the part 1 − share is gone along with, whatever the root's speed, and none of the speed is kept: as the root
/// stops, the cloth stops. To the rounding of 60 ticks.
#[test]
fn a_translation_is_shared() {
    for share in [0.0, 0.5, 1.0] {
        let (mut app, root, cloth) = beside_root(ClothInertia {
            linear: share,
            ..default()
        });
        let start = in_world(&app, cloth);
        for count in 0_u32..60 {
            let seconds = count.min(40) as f32 * TICK;
            let gone = Vec3::new(
                6.0 * seconds * seconds,
                0.5 * seconds,
                (9.0 * seconds).sin(),
            );
            change::<Transform>(&mut app, root, |transform| transform.translation = gone);
            tick(&mut app, 1);
            for (place, start) in in_world(&app, cloth).iter().zip(&start) {
                let truth = *start + gone * (1.0 - share);
                assert!(place.distance(truth) < 1.0e-4, "{share}: {place} {truth}");
            }
        }
    }
}

/// Likewise of a rotation about the root.
#[test]
fn a_rotation_is_shared() {
    for share in [0.0, 0.5, 1.0] {
        let (mut app, root, cloth) = beside_root(ClothInertia {
            angular: share,
            ..default()
        });
        let start = in_world(&app, cloth);
        for count in 1_u32..60 {
            let angle = 0.05 * count as f32;
            change::<Transform>(&mut app, root, |transform| {
                transform.rotation = Quat::from_rotation_y(angle);
            });
            tick(&mut app, 1);
            let turn = Quat::from_rotation_y(angle * (1.0 - share));
            for (place, start) in in_world(&app, cloth).iter().zip(&start) {
                let truth = turn * *start;
                assert!(place.distance(truth) < 1.0e-4, "{share}: {place} {truth}");
            }
        }
    }
}

/// The nearest root above counts, and that of what a cloth is attached to.
#[test]
fn a_cloth_that_is_attached_is_carried_too() {
    for (share, goes_along) in [(0.0, true), (1.0, false)] {
        let mut app = app();
        app.insert_resource(ClothGravity(Vec3::ZERO));
        let root = (Transform::default(), ClothInertia::share(share));
        let root = app.world_mut().spawn(root).id();
        let bone = (Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(root));
        let bone = app.world_mut().spawn(bone).id();
        let attached = ClothAttachments::new([(Pin::Row(0), bone)]);
        let cape = (Cloth::new(6, 5, 0.1).flat(), Pins::none(), attached);
        let cape = app.world_mut().spawn(cape).id();
        tick(&mut app, 1);
        let start = in_world(&app, cape);
        let mut off = 0.0_f32;
        for count in 1_u32..40 {
            let gone = Vec3::new(0.002, 0.0, 0.001) * (count * count) as f32;
            change::<Transform>(&mut app, root, |transform| transform.translation = gone);
            tick(&mut app, 1);
            for (place, start) in in_world(&app, cape).iter().zip(&start) {
                off = off.max(place.distance(*start + gone));
            }
        }
        assert_eq!(off < 1.0e-4, goes_along, "{share}: {off}");
    }
}

/// A root that is moved while the clock stands still carries its cloth once it goes on.
#[test]
fn a_root_moved_in_a_pause_carries_when_time_goes_on() {
    let app = with_plugins(DrapePlugins::new(Update));
    let (mut app, root, cloth) = beside_root_in(app, ClothInertia::share(0.0));
    let start = in_world(&app, cloth);
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    app.update();
    change::<Transform>(&mut app, root, |transform| transform.translation.x = 0.5);
    (0..3).for_each(|_| app.update());
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    tick(&mut app, 1);
    for (place, start) in in_world(&app, cloth).iter().zip(&start) {
        let truth = *start + Vec3::X * 0.5;
        assert!(place.distance(truth) < 1.0e-4, "{place} {truth}");
    }
}

/// What is carried stops at a wall that stands still: seen from the cloth, the wall comes.
#[test]
fn what_is_carried_passes_through_nothing() {
    for share in [0.0, 0.5] {
        let (mut app, root, cloth) = beside_root(ClothInertia::share(share));
        let wall = Transform::from_xyz(0.0, 0.0, 1.0)
            .with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
        app.world_mut().spawn((ClothCollider::plane(), wall));
        let mut nearest = f32::INFINITY;
        for count in 1_u32..60 {
            change::<Transform>(&mut app, root, |transform| {
                transform.translation.z = 0.08 * count as f32;
            });
            tick(&mut app, 1);
            for place in in_world(&app, cloth) {
                nearest = nearest.min(1.0 - place.z);
            }
        }
        // It lies on the wall at the particles' radius, to what a contact is held by.
        assert!((0.005..0.0101).contains(&nearest), "{share}: {nearest}");
    }
}

/// What is carried is drawn between where it was in the world and where it is: with no overstep where it was a tick ago.
#[test]
fn what_is_carried_is_drawn_on_its_way() {
    for share in [0.0, 0.3, 1.0] {
        let inertia = ClothInertia::share(share);
        let (mut app, root, cloth) = beside_root_in(app_that_draws(FixedUpdate), inertia);
        tick(&mut app, 1);
        for count in 1_u32..30 {
            let before = in_world(&app, cloth);
            change::<Transform>(&mut app, root, |root| {
                root.translation.x = 0.003 * (count * count) as f32;
                root.rotation = Quat::from_rotation_y(0.05 * count as f32);
            });
            tick(&mut app, 1);
            let place = *app.world().get::<GlobalTransform>(cloth).expect("a place");
            let drawn = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION);
            for (drawn, before) in drawn.iter().zip(before) {
                let drawn = place.transform_point(*drawn);
                assert!(drawn.distance(before) < 1.0e-5, "{share}: {drawn} {before}");
            }
        }
    }
}

/// Of two roots above a cloth, the nearer one says what it feels.
#[test]
fn the_nearest_root_counts() {
    for (near, gone_along) in [(0.0, 1.0), (1.0, 0.0)] {
        let (mut app, root, cloth) = beside_root(ClothInertia::share(near));
        let above = (Transform::default(), ClothInertia::share(1.0 - near));
        let above = app.world_mut().spawn(above).id();
        app.world_mut().entity_mut(root).insert(ChildOf(above));
        let start = in_world(&app, cloth);
        for count in 1..=20 {
            let gone = Vec3::X * 0.01 * count as f32;
            change::<Transform>(&mut app, above, |transform| transform.translation = gone);
            tick(&mut app, 1);
            for (place, start) in in_world(&app, cloth).iter().zip(&start) {
                let truth = *start + gone * gone_along;
                assert!(place.distance(truth) < 1.0e-4, "{near}: {place} {truth}");
            }
        }
    }
}

/// What a root has moved while it was at fault is no motion of its own.
#[test]
fn a_mended_root_begins_where_it_is() {
    let good = ClothInertia::share(0.0);
    let (mut app, root, cloth) = beside_root(good);
    let start = in_world(&app, cloth);
    change::<ClothInertia>(&mut app, root, |inertia| {
        *inertia = ClothInertia::share(2.0);
    });
    tick(&mut app, 1);
    assert!(fault(&app, cloth).is_some());
    change::<Transform>(&mut app, root, |transform| transform.translation.x = 0.5);
    tick(&mut app, 1);
    change::<ClothInertia>(&mut app, root, |inertia| *inertia = good);
    tick(&mut app, 2);
    assert_eq!(fault(&app, cloth), None);
    for (place, start) in in_world(&app, cloth).iter().zip(&start) {
        assert!(place.distance(*start) < 1.0e-4, "{place} {start}");
    }
}

#[test]
fn bad_shares_are_faults_of_the_cloth_below() {
    let good = ClothInertia::default();
    let (mut app, root, cloth) = beside_root(good);
    for bad in [
        ClothInertia::share(1.1),
        ClothInertia::share(f32::NAN),
        ClothInertia {
            teleport_distance: 0.0,
            ..good
        },
        ClothInertia {
            teleport_angle: -1.0,
            ..good
        },
    ] {
        change::<ClothInertia>(&mut app, root, |inertia| *inertia = bad);
        change::<ClothMaterial>(&mut app, cloth, |material| material.damping = 0.02);
        tick(&mut app, 1);
        let error = fault(&app, cloth);
        assert!(
            matches!(error, Some(ClothError::Quantity(_))),
            "{bad:?}: {error:?}"
        );
        change::<ClothInertia>(&mut app, root, |inertia| *inertia = good);
        tick(&mut app, 1);
        assert_eq!(fault(&app, cloth), None);
    }
}
