//! Cloths that meet others at a lower rate, thaw, and share the work of ticks.

use super::*;

/// A cloth that thaws is not thrown, however far what carries it has gone meanwhile: it has the velocity of that, and then what gravity
/// gives in a tick, 0.15 m/s; what has been let go pulls at it with springs that are as long as they were.
#[test]
fn thaws_with_the_velocity_of_what_carries_it() {
    for is_attached in [false, true] {
        for (jump, speed) in [(100.0, 0.0), (0.0, 10.0)] {
            let mut app = app();
            let carrier = app.world_mut().spawn(Transform::default()).id();
            let cloth = if is_attached {
                let attached = ClothAttachments::new([(Pin::Row(0), carrier)]);
                let cloth = (Cloth::new(9, 9, 0.1), Pins::none(), attached);
                app.world_mut().spawn(cloth).id()
            } else {
                app.world_mut()
                    .entity_mut(carrier)
                    .insert(Cloth::new(9, 9, 0.1));
                carrier
            };
            tick(&mut app, 64);
            set(&mut app, cloth, Frozen);
            tick(&mut app, 2);
            change::<Transform>(&mut app, carrier, |place| place.translation.z += jump);
            let step = |app: &mut App| {
                change::<Transform>(app, carrier, |place| place.translation.x += speed * TICK);
                tick(app, 1);
            };
            (0..5).for_each(|_| step(&mut app));
            set(&mut app, cloth, Full);
            for ticks in 1..=3 {
                step(&mut app);
                let particles = particles(&app, cloth);
                for index in 9..particles.len() {
                    let velocity = particles.velocity(index).expect("a particle");
                    let off = velocity.distance(Vec3::X * speed);
                    let bound = 1.5 * GRAVITY * TICK * ticks as f32 + 0.02 * speed;
                    assert!(off < bound, "{is_attached} {jump} {speed}: {off} m/s");
                }
                let stretch = stats(&app, cloth).stretch.structural;
                assert!(stretch < 0.01, "{stretch}");
            }
        }
    }
}

/// Beside a ball that moves a cloth is moved in each tick, whatever its level, and half a second later no more; a floor that it lies on lets
/// it wait.
#[test]
fn what_moves_nearby_is_met_at_the_full_rate() {
    let mut app = app_with_moving_balls();
    let (cloth, ball) = spawn_pass(&mut app);
    set(&mut app, cloth, Every(4));
    app.world_mut()
        .spawn((ClothCollider::plane(), Transform::from_xyz(0.0, -1.51, 0.0)));
    let (mut touched, mut waited) = (0, 0);
    for _ in 0..300 {
        tick(&mut app, 1);
        let stats = stats(&app, cloth);
        let place = app
            .world()
            .get::<Transform>(ball)
            .expect("a place")
            .translation;
        if place.z.abs() < 0.5 {
            assert_eq!(stats.level, Full, "{place}");
            assert!(stats.substeps > 0);
        }
        let contacts = app.world().get::<ClothContacts>(cloth);
        touched += u32::from(contacts.expect("contacts").with(ball).is_some());
        waited += u32::from(stats.substeps == 0);
    }
    assert!(touched > 10 && waited > 20, "{touched} {waited}");
    app.world_mut().despawn(ball);
    tick(&mut app, 40);
    assert_eq!(stats(&app, cloth).level, Every(4));
}

/// A body may be pushed, so that a cloth beside it is moved in each tick, too. A ball of other layers, and one that stands still, let it
/// wait.
#[test]
fn a_body_nearby_is_met_at_the_full_rate() {
    let layers = |layer: u32| ClothLayers {
        memberships: layer,
        filters: layer,
    };
    let body = ClothBody::ball(1.0, 0.2);
    for (is_body, is_of_others, level) in [
        (false, false, Every(4)),
        (true, false, Full),
        (true, true, Every(4)),
    ] {
        let mut app = app();
        let cloth = app.world_mut().spawn((sheet(8), layers(1))).id();
        set(&mut app, cloth, Every(4));
        let place = Transform::from_xyz(0.4, -0.4, 0.5);
        let mut ball = app.world_mut().spawn((ClothCollider::ball(0.2), place));
        if is_body {
            ball.insert(body);
        }
        if is_of_others {
            ball.insert(layers(2));
        }
        tick(&mut app, 8);
        let stats = stats(&app, cloth);
        assert_eq!(stats.level, level, "{is_body} {is_of_others}");
    }
}

/// A cloth that is moved in each fourth tick teleports in the tick in which it is told to.
#[test]
fn a_teleport_does_not_wait_for_its_turn() {
    for wait in 0..4 {
        let mut app = app();
        let cloth = app
            .world_mut()
            .spawn((sheet(8), ClothLod::at(Every(4))))
            .id();
        tick(&mut app, 8 + wait);
        let before = places(&app, cloth)[80];
        change::<Transform>(&mut app, cloth, |place| place.translation.x = 5.0);
        app.world_mut().entity_mut(cloth).insert(ClothTeleport);
        tick(&mut app, 1);
        assert!(app.world().get::<ClothTeleport>(cloth).is_none(), "{wait}");
        let after = in_world(&app, cloth)[80] - Vec3::X * 5.0;
        assert!(after.distance(before) < 0.2, "{wait}: {before} {after}");
    }
}

/// What freezes in a collider no longer touches it, and says so.
#[test]
fn what_is_frozen_touches_nothing() {
    let mut app = app();
    let place = Transform::from_xyz(0.4, 0.1, 0.4);
    let lying = (Cloth::new(9, 9, 0.1).lying(), Pins::none());
    let cloth = app.world_mut().spawn(lying).id();
    app.world_mut().spawn((
        ClothCollider::ball(0.2),
        place.with_translation(Vec3::new(0.4, -0.25, 0.4)),
    ));
    tick(&mut app, 30);
    assert!(stats(&app, cloth).contacts > 0);
    assert_eq!(messages::<ClothTouchStarted>(&mut app).len(), 1);
    set(&mut app, cloth, Frozen);
    tick(&mut app, 2);
    assert_eq!(messages::<ClothTouchStopped>(&mut app).len(), 1);
    assert_eq!(
        app.world()
            .get::<ClothContacts>(cloth)
            .expect("contacts")
            .iter()
            .len(),
        0
    );
    set(&mut app, cloth, Full);
    tick(&mut app, 5);
    assert!(stats(&app, cloth).contacts > 0);
}

/// Cloths that touch cloth and are near each other are at the finest of their levels, in the same ticks; one that is far away is at its own.
#[test]
fn cloths_near_each_other_share_the_finest_level() {
    let mut app = app();
    let touching = || (Cloth::new(9, 9, 0.1), ClothSelfCollision::default());
    let at = |x: f32, z: f32| Transform::from_xyz(x, 0.0, z);
    let spawn = |app: &mut App, level, place| {
        let cloth = (touching(), ClothLod::at(level), place);
        app.world_mut().spawn(cloth).id()
    };
    let pairs = [
        [
            spawn(&mut app, Full, at(0.0, 0.0)),
            spawn(&mut app, Frozen, at(0.0, 0.1)),
        ],
        [
            spawn(&mut app, Every(3), at(20.0, 0.0)),
            spawn(&mut app, Every(2), at(20.0, 0.1)),
        ],
        [
            spawn(&mut app, Every(4), at(40.0, 0.0)),
            spawn(&mut app, Every(4), at(40.0, 0.1)),
        ],
    ];
    let alone = spawn(&mut app, Frozen, at(60.0, 0.0));
    tick(&mut app, 10);
    for _ in 0..12 {
        tick(&mut app, 1);
        for (pair, level) in pairs.iter().zip([Full, Every(2), Every(4)]) {
            let [a, b] = pair.map(|cloth| stats(&app, cloth));
            assert_eq!([a.level, b.level], [level; 2]);
            assert_eq!(a.substeps > 0, b.substeps > 0, "{level:?}");
        }
        assert_eq!(stats(&app, alone).level, Frozen);
    }
}

/// Sixteen cloths at a quarter of the rate: four of them are moved in each tick.
#[test]
fn ticks_share_the_work() {
    let mut app = app();
    app.insert_resource(GlobalClothLod(ClothLod::at(Every(4))));
    let cloths: Vec<Entity> = (0..16)
        .map(|_| app.world_mut().spawn(sheet(4)).id())
        .collect();
    tick(&mut app, 8);
    for _ in 0..16 {
        tick(&mut app, 1);
        let moved = cloths
            .iter()
            .filter(|cloth| stats(&app, **cloth).substeps > 0);
        assert_eq!(moved.count(), 4);
    }
}

/// Levels go by the distance of the nearest active camera, with hysteresis. Without a camera all is at the full rate.
#[test]
fn levels_go_by_the_nearest_camera() {
    let mut app = app();
    let lod = ClothLod::by_distance([(10.0, Every(2)), (30.0, Frozen)]);
    app.insert_resource(GlobalClothLod(lod));
    let cloth = app.world_mut().spawn(Cloth::new(5, 5, 0.1).centred()).id();
    let level = |app: &mut App| {
        // Cameras are where the last frame had them.
        tick(app, 3);
        stats(app, cloth).level
    };
    assert_eq!(level(&mut app), Full);
    let camera = app
        .world_mut()
        .spawn((Camera::default(), Transform::default()))
        .id();
    let far = (Camera::default(), Transform::from_xyz(500.0, 0.0, 0.0));
    app.world_mut().spawn(far);
    for (distance, expected) in [
        (5.0, Full),
        (10.5, Every(2)),
        (9.6, Every(2)),
        (8.0, Full),
        (31.0, Frozen),
        (28.0, Frozen),
        (26.0, Every(2)),
    ] {
        change::<Transform>(&mut app, camera, |place| place.translation.z = distance);
        assert_eq!(level(&mut app), expected, "{distance} m");
    }
    change::<Camera>(&mut app, camera, |camera| camera.is_active = false);
    assert_eq!(level(&mut app), Frozen);
    // Its own setting comes first; without any it is at the full rate again.
    set(&mut app, cloth, Every(3));
    assert_eq!(level(&mut app), Every(3));
    app.world_mut().entity_mut(cloth).remove::<ClothLod>();
    app.world_mut().remove_resource::<GlobalClothLod>();
    assert_eq!(level(&mut app), Full);
}

/// A value that is out of range is named, and the cloth is back when it is mended.
#[test]
fn a_bad_level_of_detail_is_a_fault() {
    let mut app = app();
    let lod = ClothLod::by_distance([(-1.0, Frozen)]);
    let cloth = app.world_mut().spawn((sheet(4), lod)).id();
    tick(&mut app, 3);
    let fault = app
        .world()
        .get::<ClothFault>(cloth)
        .map(|fault| fault.error.to_string());
    assert!(
        fault
            .as_ref()
            .is_some_and(|fault| fault.contains("`ClothLod`")),
        "{fault:?}"
    );
    set(&mut app, cloth, Every(2));
    tick(&mut app, 6);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    assert!(particles(&app, cloth).largest_speed() > 0.0);
}

/// Two runs of the same have the same bits.
#[test]
fn runs_are_alike() {
    let run = || {
        let mut app = app_with_moving_balls();
        let (cloth, _) = spawn_pass(&mut app);
        for level in [Every(3), Frozen, Every(2), Full, Every(4)] {
            set(&mut app, cloth, level);
            tick(&mut app, 17);
        }
        particles(&app, cloth).clone()
    };
    assert_eq!(run(), run());
}

/// What stands still stays where it is when what carries it goes, with a fault; what is taken off first stays without one, and falls
/// once it moves.
#[test]
fn what_stands_still_stays_where_its_target_goes() {
    for is_taken_off in [false, true] {
        let mut app = app();
        let pole = app
            .world_mut()
            .spawn(Transform::from_xyz(3.0, 2.0, 1.0))
            .id();
        let attached = ClothAttachments::new([(Pin::Row(0), pole)]);
        let cloth = (Cloth::new(9, 9, 0.1), Pins::none(), attached);
        let cloth = app.world_mut().spawn(cloth).id();
        tick(&mut app, 4);
        set(&mut app, cloth, Frozen);
        tick(&mut app, 4);
        change::<Transform>(&mut app, pole, |place| place.translation.x += 5.0);
        tick(&mut app, 1);
        let was = in_world(&app, cloth);
        if is_taken_off {
            app.world_mut()
                .entity_mut(cloth)
                .remove::<ClothAttachments>();
        }
        app.world_mut().despawn(pole);
        tick(&mut app, 4);
        assert_eq!(in_world(&app, cloth), was);
        let fault = app.world().get::<ClothFault>(cloth);
        let is_named = fault.is_some_and(|fault| fault.error.to_string().contains("Row(0)"));
        assert_eq!(is_named, !is_taken_off, "{fault:?}");
        app.world_mut()
            .entity_mut(cloth)
            .remove::<ClothAttachments>();
        set(&mut app, cloth, Full);
        tick(&mut app, 4);
        assert!(app.world().get::<ClothFault>(cloth).is_none());
        let fallen = farthest(&in_world(&app, cloth), &was);
        // By ½ g t² in four ticks, of which the first may begin a sub-step late.
        let free = 0.5 * GRAVITY * (4.0 * TICK).powi(2);
        let is_free = (fallen / free - 1.0).abs() < 0.3;
        assert!(is_free, "{fallen} {free}, {is_taken_off}");
    }
}

/// A level that changes while no time passes counts from the next tick on.
#[test]
fn a_level_may_change_while_time_stands_still() {
    let mut app = app();
    let cloth = app.world_mut().spawn(sheet(8)).id();
    tick(&mut app, 3);
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    set(&mut app, cloth, Every(4));
    app.update();
    // Of a schedule that runs without time.
    let clock = *app.world().resource::<Time>();
    app.insert_resource(Time::<()>::default());
    app.world_mut().run_schedule(FixedUpdate);
    app.insert_resource(clock);
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    let mut moves = Vec::new();
    for _ in 0..9 {
        app.update();
        moves.push(stats(&app, cloth).substeps > 0);
    }
    let count = moves.iter().filter(|moves| **moves).count();
    assert!((2..=4).contains(&count), "{moves:?}");
    assert_eq!(stats(&app, cloth).level, Every(4));
}
