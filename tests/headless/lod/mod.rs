//! Level of detail.

mod wakes;

use std::time::Duration;

use bevy::{prelude::*, time::TimeUpdateStrategy};
use bevy_drape::prelude::*;

use crate::{mesh::vertices, support::*};
use ClothLodLevel::{Every, Frozen, Full, Off};

/// A lying sheet that is held by one edge, and swings down.
fn sheet(substeps: u32) -> impl Bundle {
    let cloth = Cloth::new(9, 9, 0.1).lying();
    (
        cloth,
        Pins::new([Pin::Row(0)]),
        ClothSettings::substeps(substeps),
    )
}

fn places(app: &App, cloth: Entity) -> Vec<Vec3> {
    particles(app, cloth).positions().collect()
}

/// Where the particles are in the world.
fn in_world(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame = *app.world().get::<ClothFrame>(cloth).expect("a frame");
    places(app, cloth)
        .into_iter()
        .map(|at| frame.to_world(at))
        .collect()
}

fn set(app: &mut App, cloth: Entity, level: ClothLodLevel) {
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothLod::at(level));
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    let apart = a.iter().zip(b).map(|(a, b)| a.distance(*b));
    apart.fold(0.0, f32::max)
}

/// Of every n-th tick, n times as long and with as many sub-steps, comes the motion of sub-steps n times as long: that of a cloth with an
/// n-th of them in each tick. Not to the last digit, as the first three ticks have more: in that time it falls by g (3/64 s)²/2 = 11 mm, of
/// which sub-steps half or a quarter as long change a part.
#[test]
fn moves_as_with_as_many_longer_substeps() {
    for (ticks, substeps) in [(2, 16), (4, 32)] {
        let mut app = app();
        let full = app.world_mut().spawn(sheet(substeps / ticks)).id();
        let lod = (sheet(substeps), ClothLod::at(Every(ticks)));
        let lod = app.world_mut().spawn(lod).id();
        let (mut moves, mut done) = (0, 0);
        let mut apart = 0.0_f32;
        tick(&mut app, 8);
        for _ in 0..64 {
            tick(&mut app, 1);
            let stats = stats(&app, lod);
            assert_eq!(stats.level, Every(ticks));
            done += stats.substeps;
            if stats.substeps > 0 {
                moves += 1;
                apart = apart.max(farthest(&places(&app, lod), &places(&app, full)));
            }
        }
        assert_eq!((moves, done), (64 / ticks, 64 / ticks * substeps));
        assert!(places(&app, full)[80].y < -0.5, "it has swung");
        assert!(apart < 0.011, "{apart} m");
    }
}

/// The picture moves by no more in a frame than the cloth moves at its fastest, and what fades out is no more than the way of the ticks that
/// a level is drawn late: 1.5 × 4/64 s/0.125 s = 0.75 times as fast at most, and so 1.75 times in all. Without fading it would jump by the way
/// of several ticks in a third of one.
#[test]
fn nothing_that_is_drawn_jumps() {
    const SPEED: f32 = 2.0;
    for is_attached in [false, true] {
        let mut app = app_that_draws(FixedUpdate);
        let carrier = app
            .world_mut()
            .spawn((Transform::default(), Visibility::default()))
            .id();
        let cloth = if is_attached {
            let attached = ClothAttachments::new([(Pin::Row(0), carrier)]);
            let cloth = (
                Cloth::new(9, 9, 0.1).lying(),
                Pins::none(),
                attached,
                ClothSettings::substeps(8),
            );
            app.world_mut().spawn((cloth, Visibility::default())).id()
        } else {
            app.world_mut().entity_mut(carrier).insert(sheet(8));
            carrier
        };
        let drive = move |mut places: Query<&mut Transform>, time: Res<Time>| {
            let mut place = places.get_mut(carrier).expect("it is there");
            place.translation.x += SPEED * time.delta_secs();
        };
        // In each frame: it is drawn evenly.
        app.add_systems(Update, drive);
        tick(&mut app, 4);
        let part = Duration::from_secs_f32(TICK / 3.0);
        app.insert_resource(TimeUpdateStrategy::ManualDuration(part));
        let mut before: Option<Vec<Vec3>> = None;
        let mut fastest = 0.0_f32;
        let mut moved = Vec::new();
        for level in [
            Full,
            Every(4),
            Full,
            Frozen,
            Full,
            Every(2),
            Frozen,
            Every(4),
            Every(3),
            Full,
        ] {
            set(&mut app, cloth, level);
            for _ in 0..47 {
                app.update();
                let place = *app.world().get::<GlobalTransform>(cloth).expect("a place");
                let drawn: Vec<Vec3> = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION)
                    .into_iter()
                    .map(|at| place.transform_point(at))
                    .collect();
                fastest = fastest.max(particles(&app, cloth).largest_speed());
                if let Some(before) = before.replace(drawn.clone()) {
                    moved.push((farthest(&drawn, &before), level));
                }
            }
            assert_eq!(stats(&app, cloth).level, level);
        }
        let bound = 1.75 * (fastest + SPEED) * TICK / 3.0;
        for (moved, level) in moved {
            assert!(
                moved < bound,
                "{is_attached}: {moved} m at {level:?}, {bound} m"
            );
        }
    }
}

/// A frozen cloth whose carrier has no place that is a number stays where it was, and says why. It goes on once the carrier has one.
#[test]
fn a_carrier_without_a_place_is_a_fault() {
    for rotation in [
        Quat::from_xyzw(0.674, 0.733, f32::INFINITY, 0.466),
        Quat::NAN,
    ] {
        let mut app = app();
        let carrier = app.world_mut().spawn(Transform::default()).id();
        let attached = ClothAttachments::new([(Pin::Row(0), carrier)]);
        let cloth = (Cloth::new(9, 9, 0.1), Pins::none(), attached);
        let cloth = app.world_mut().spawn(cloth).id();
        tick(&mut app, 5);
        set(&mut app, cloth, Frozen);
        tick(&mut app, 2);
        let frame = |app: &App| {
            app.world()
                .get::<ClothFrame>(cloth)
                .expect("one")
                .isometry()
        };
        let was = frame(&app);
        change::<Transform>(&mut app, carrier, |place| place.rotation = rotation);
        tick(&mut app, 2);
        assert_eq!(frame(&app), was);
        assert!(app.world().get::<ClothFault>(cloth).is_some());
        change::<Transform>(&mut app, carrier, |place| *place = Transform::default());
        set(&mut app, cloth, Full);
        tick(&mut app, 2);
        assert!(app.world().get::<ClothFault>(cloth).is_none());
        assert!(stats(&app, cloth).air_impulse.is_finite() && frame(&app).rotation.is_finite());
    }
}

/// What is frozen costs no sub-step and changes no particle. Its world is that of its entity or, where it is attached, of its target, wherever
/// these go, and so is what is drawn.
#[test]
fn keeps_its_shape_with_what_carries_it() {
    for is_attached in [false, true] {
        for level in [Frozen, Off] {
            let mut app = app_that_draws(FixedUpdate);
            let start = Transform::from_xyz(0.3, 1.0, -0.2);
            let carrier = app.world_mut().spawn((start, Visibility::default())).id();
            let cloth = if is_attached {
                let attached = ClothAttachments::new([(Pin::Row(0), carrier)]);
                let cloth = (Cloth::new(9, 9, 0.1).lying(), Pins::none(), attached);
                app.world_mut().spawn((cloth, Visibility::default())).id()
            } else {
                app.world_mut().entity_mut(carrier).insert(sheet(8));
                carrier
            };
            tick(&mut app, 20);
            let own = |app: &App| -> Vec<Vec3> {
                let carrier = app
                    .world()
                    .get::<Transform>(carrier)
                    .expect("a place")
                    .compute_affine()
                    .inverse();
                in_world(app, cloth)
                    .into_iter()
                    .map(|at| carrier.transform_point3(at))
                    .collect()
            };
            let was = own(&app);
            set(&mut app, cloth, level);
            tick(&mut app, 1);
            let frozen = places(&app, cloth);
            for _ in 0..40 {
                change::<Transform>(&mut app, carrier, |place| {
                    place.translation += Vec3::new(0.5, 0.1, -0.2);
                    place.rotate_y(0.3);
                });
                tick(&mut app, 1);
                assert_eq!(stats(&app, cloth).substeps, 0);
                assert_eq!(particles(&app, cloth).largest_speed(), 0.0);
                assert_eq!(places(&app, cloth), frozen);
                // Of numbers up to 20 m, in some ten roundings of 10⁻⁶ m.
                let off = farthest(&own(&app), &was);
                assert!(off < 2.0e-5, "{off} m");
            }
            if level == Frozen {
                let place = *app.world().get::<GlobalTransform>(cloth).expect("a place");
                let drawn: Vec<Vec3> = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION)
                    .into_iter()
                    .map(|at| place.transform_point(at))
                    .collect();
                let off = farthest(&drawn, &in_world(&app, cloth));
                assert!(off < 2.0e-5, "{off} m");
            }
        }
    }
}

/// A mesh that is frozen to its own entity is not written while that moves.
#[test]
fn a_frozen_mesh_is_not_written() {
    let mut app = app_that_draws(FixedUpdate);
    let cloth = app
        .world_mut()
        .spawn((sheet(8), Visibility::default()))
        .id();
    tick(&mut app, 20);
    set(&mut app, cloth, Frozen);
    tick(&mut app, 20);
    let own = app.world().get::<Mesh3d>(cloth).expect("a mesh").0.id();
    let mut reader = app
        .world()
        .resource::<Messages<AssetEvent<Mesh>>>()
        .get_cursor_current();
    for _ in 0..10 {
        change::<Transform>(&mut app, cloth, |place| {
            place.translation.x += 0.3;
            place.rotate_z(0.1);
        });
        tick(&mut app, 1);
        let events = app.world().resource::<Messages<AssetEvent<Mesh>>>();
        assert!(reader.read(events).all(|event| !event.is_modified(own)));
    }
}
