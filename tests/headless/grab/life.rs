//! Hands that let go, are lost, and have faults.

use super::*;

/// A hand lets go of a cloth that jumps, changes or goes, and the cloth of the hand.
#[test]
fn a_hand_lets_go_of_what_is_not_there_any_more() {
    type Change = fn(&mut App, Entity);
    let changes: [(&str, Change); 7] = [
        ("teleport", |app, cloth| {
            let away = Transform::from_xyz(30.0, 0.0, 0.0);
            app.world_mut()
                .entity_mut(cloth)
                .insert((ClothTeleport, away));
        }),
        ("another grid", |app, cloth| {
            app.world_mut()
                .entity_mut(cloth)
                .insert(Cloth::new(12, 7, 0.05));
        }),
        ("as many particles", |app, cloth| {
            app.world_mut()
                .entity_mut(cloth)
                .insert(Cloth::new(20, 5, 0.05));
        }),
        ("a smaller grid", |app, cloth| {
            app.world_mut()
                .entity_mut(cloth)
                .insert(Cloth::new(3, 3, 0.05));
        }),
        ("disabled", |app, cloth| {
            app.world_mut().entity_mut(cloth).insert(Disabled);
        }),
        ("no cloth", |app, cloth| {
            app.world_mut().entity_mut(cloth).remove::<Cloth>();
        }),
        ("despawned", |app, cloth| {
            app.world_mut().despawn(cloth);
        }),
    ];
    for (name, change) in changes {
        let mut app = app();
        let cloth = app.world_mut().spawn(Cloth::new(10, 10, 0.05)).id();
        tick(&mut app, 1);
        let hand = take(&mut app, cloth, 55);
        tick(&mut app, 2);
        assert!(pinned(&app, cloth).contains(&55));
        change(&mut app, cloth);
        tick(&mut app, 3);
        assert!(app.world().get::<ClothGrab>(hand).is_none(), "{name}");
        assert!(app.world().get::<ClothFault>(hand).is_none(), "{name}");
        app.world_mut().despawn(hand);
        let Ok(mut entity) = app.world_mut().get_entity_mut(cloth) else {
            continue;
        };
        entity.remove::<Disabled>();
        tick(&mut app, 2);
        let log = app.world().get::<ClothFault>(cloth);
        assert!(log.is_none(), "{name}: {log:?}");
        if app.world().entity(cloth).contains::<Cloth>() {
            assert!(!pinned(&app, cloth).contains(&55), "{name}");
            let held = app.world().get::<ClothAttachments>(cloth);
            assert!(held.is_none_or(|held| held.iter().len() == 0), "{name}");
            assert!(stats(&app, cloth).stretch.structural < 0.1, "{name}");
        }
    }
}

/// Nor does it hold what goes away with the target that it is attached to.
#[test]
fn a_hand_lets_go_where_a_carrier_teleports() {
    let mut app = app();
    let pole = app.world_mut().spawn(Transform::default()).id();
    let attached = ClothAttachments::new([(Pin::Row(0), pole)]);
    let cloth = (Cloth::new(10, 10, 0.05), Pins::none(), attached);
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    let hand = take(&mut app, cloth, 55);
    tick(&mut app, 2);
    assert!(pinned(&app, cloth).contains(&55));
    let away = (ClothTeleport, Transform::from_xyz(30.0, 0.0, 0.0));
    app.world_mut().entity_mut(pole).insert(away);
    tick(&mut app, 2);
    assert!(app.world().get::<ClothGrab>(hand).is_none());
    assert!(!pinned(&app, cloth).contains(&55));
    assert!(stats(&app, cloth).stretch.structural < 0.1);
}

/// However far it may pull, a hand stops where the springs at its particle are stretched by three tenths.
#[test]
fn a_hand_stops_where_it_stretches_the_cloth() {
    let mut app = app();
    let soft = ClothMaterial {
        stretch_compliance: 1.0e-2,
        ..ClothMaterial::COTTON
    };
    let cloth = app.world_mut().spawn((Cloth::new(10, 10, 0.05), soft)).id();
    tick(&mut app, 1);
    let hand = take(&mut app, cloth, 99);
    change::<ClothGrab>(&mut app, hand, |grab| grab.stretch = 9.0);
    tick(&mut app, 2);
    let target = place(&app, cloth, 99) + 3.0 * Vec3::NEG_Y;
    aim(&mut app, hand, target);
    tick(&mut app, 192);
    let at = place(&app, cloth, 99);
    let stretches = [89, 98].map(|beside| place(&app, cloth, beside).distance(at) / 0.05 - 1.0);
    let largest = stretches[0].max(stretches[1]);
    assert!((0.1..0.35).contains(&largest), "{largest}");
}

/// Of two hands on a cloth the same one yields, whichever was spawned first.
#[test]
fn hands_move_alike_in_any_order() {
    let run = |held: [usize; 2]| {
        let mut app = app();
        let cloth = (Cloth::new(16, 16, 0.05), Pins::none());
        let cloth = app.world_mut().spawn(cloth).id();
        tick(&mut app, 1);
        let hands = held.map(|particle| (take(&mut app, cloth, particle), particle));
        tick(&mut app, 2);
        for (hand, particle) in hands {
            let side = if particle == 0 { -5.0 } else { 5.0 };
            aim(&mut app, hand, side * Vec3::new(1.0, -1.0, 0.0));
        }
        tick(&mut app, 64);
        particles(&app, cloth).clone()
    };
    assert_eq!(run([0, 255]), run([255, 0]));
}

/// A hand whose place is lost goes to its target; the particles that a game pins stay where they are.
#[test]
fn a_hand_that_is_lost_is_at_its_target() {
    let mut app = app();
    let corner = Pins::new([Pin::Corner(Corner::TopLeft)]);
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(10, 10, 0.05), corner))
        .id();
    tick(&mut app, 1);
    let [hand, at_pin] = [55, 0].map(|particle| take(&mut app, cloth, particle));
    let before = place(&app, cloth, 0);
    tick(&mut app, 2);
    change::<Transform>(&mut app, hand, |place| place.translation = Vec3::NAN);
    aim(&mut app, at_pin, before + Vec3::Y);
    tick(&mut app, 32);
    let found = app.world().get::<Transform>(hand).expect("a place");
    let target = app.world().get::<ClothGrab>(hand).expect("a hand").target;
    assert_eq!(found.translation, target);
    assert_eq!(app.world().get::<ClothFault>(cloth), None);
    assert_eq!(place(&app, cloth, 0), before);
}

/// A hand that is told of another particle or another cloth takes hold of that, and lets the first one go.
#[test]
fn a_hand_takes_hold_anew() {
    let mut app = app();
    let cloths = [0.0, 2.0].map(|x| {
        let cloth = (Cloth::new(10, 10, 0.05), Transform::from_xyz(x, 0.0, 0.0));
        app.world_mut().spawn(cloth).id()
    });
    tick(&mut app, 4);
    let before = pinned(&app, cloths[0]);
    let hand = take(&mut app, cloths[0], 55);
    tick(&mut app, 2);
    let to = place(&app, cloths[0], 77);
    change::<ClothGrab>(&mut app, hand, |grab| {
        (grab.particle, grab.target) = (77, to);
    });
    tick(&mut app, 3);
    let held = pinned(&app, cloths[0]);
    assert!(held.contains(&77) && !held.contains(&55));
    let to = place(&app, cloths[1], 33);
    change::<ClothGrab>(&mut app, hand, |grab| {
        (grab.cloth, grab.particle, grab.target) = (cloths[1], 33, to);
    });
    tick(&mut app, 3);
    assert_eq!(pinned(&app, cloths[0]), before);
    assert!(pinned(&app, cloths[1]).contains(&33));
    assert!(place(&app, cloths[1], 33).distance(to) < 1.0e-6);
}

/// A particle goes from one hand to the next: the second one waits until the first lets go.
#[test]
fn a_particle_is_handed_over() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::new(10, 10, 0.05)).id();
    tick(&mut app, 4);
    let first = take(&mut app, cloth, 55);
    tick(&mut app, 2);
    let second = take(&mut app, cloth, 55);
    tick(&mut app, 2);
    let at = place(&app, cloth, 55);
    app.world_mut().despawn(first);
    tick(&mut app, 3);
    assert!(pinned(&app, cloth).contains(&55));
    // It fell for a tick at most.
    assert!(place(&app, cloth, 55).distance(at) < 0.01);
    app.world_mut().despawn(second);
    tick(&mut app, 2);
    assert!(!pinned(&app, cloth).contains(&55));
}

/// Hands and cloths that are despawned or disabled by systems in the middle of a tick leave nothing behind.
#[test]
fn hands_and_cloths_may_go_in_the_middle_of_a_tick() {
    for order in 0..4 {
        let mut app = app();
        let cloth = app.world_mut().spawn(Cloth::new(10, 10, 0.05)).id();
        tick(&mut app, 2);
        let target = place(&app, cloth, 55);
        let grab = ClothGrab {
            cloth,
            particle: 55,
            target,
            ..default()
        };
        let hand = app.world_mut().spawn(grab).id();
        let goes = move |mut commands: Commands, mut done: Local<bool>| {
            if !std::mem::replace(&mut *done, true) {
                let entity = if order % 2 == 0 { hand } else { cloth };
                commands.entity(entity).despawn();
            }
        };
        // Its commands wait beside those of the plugin.
        if order < 2 {
            app.add_systems(
                FixedUpdate,
                goes.before_ignore_deferred(ClothSystems::Prepare),
            );
        } else {
            app.add_systems(FixedUpdate, goes.ambiguous_with(ClothSystems::Prepare));
        }
        tick(&mut app, 4);
        if order % 2 == 0 {
            assert!(app.world().get::<ClothFault>(cloth).is_none(), "{order}");
            assert!(!pinned(&app, cloth).contains(&55), "{order}");
        }
    }
}

/// A hundred hands on random cloths, pulled anywhere: nothing is lost or torn far, and what is let go is as before.
#[test]
fn random_hands_hold_random_cloths() {
    let mut seed = 1_u64;
    let mut random = move |below: u64| {
        // Knuth's generator: its upper bits are random.
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) % below
    };
    let mut worst = [0.0_f32; 2];
    for number in 0..100 {
        let mut app = app();
        let [columns, rows] = [0; 2].map(|_| 4 + random(20) as u32);
        let kind = usize::from(random(3) == 0);
        let cloth = match kind {
            1 => {
                let mesh = irregular(0.05 * columns as f32, 0.05 * rows as f32, 0.05, 0.3);
                Cloth::triangles(mesh.positions, mesh.triangles)
            }
            _ => Cloth::new(columns, rows, 0.05),
        };
        let pins = match random(3) {
            0 => Pins::none(),
            1 => Pins::new([Pin::Index(0)]),
            _ => Pins::new([Pin::Index(0), Pin::Index(columns as usize - 1)]),
        };
        let turned = Transform::from_rotation(Quat::from_rotation_x(random(6) as f32));
        let cloth = app.world_mut().spawn((cloth, pins, turned)).id();
        tick(&mut app, 1 + random(40) as usize);
        let before = pinned(&app, cloth);
        let count = particles(&app, cloth).len() as u64;
        let held = random(count) as usize;
        // As by a mouse: through the particle, along a random ray.
        let at = place(&app, cloth, held);
        let from = Vec3::from([0; 3].map(|_| random(100) as f32 / 50.0 - 1.0)) + 2.0 * Vec3::Z;
        let ray = Ray3d::new(at + from, Dir3::new(-from).expect("1 m or more"));
        let hit = cast(&mut app, ray);
        let grab = hit.map_or_else(
            || ClothGrab {
                cloth,
                particle: held as u32,
                target: at,
                ..default()
            },
            |hit| hit.grab().0,
        );
        let hand = app.world_mut().spawn(grab).id();
        for _ in 0..6 {
            let target = at + Vec3::from([0; 3].map(|_| random(100) as f32 / 25.0 - 2.0));
            aim(&mut app, hand, target);
            for _ in 0..random(30) {
                tick(&mut app, 1);
                let stats = stats(&app, cloth);
                worst[kind] = worst[kind].max(stats.stretch.structural);
                let all = particles(&app, cloth);
                assert!(
                    all.positions().all(|place| place.length() < 20.0),
                    "{number}"
                );
            }
        }
        assert!(app.world().get::<ClothFault>(hand).is_none(), "{number}");
        app.world_mut().despawn(hand);
        tick(&mut app, 1);
        assert_eq!(pinned(&app, cloth), before, "{number}");
    }
    println!(
        "grids were stretched by {} at most, meshes by {}",
        worst[0], worst[1]
    );
    // An irregular mesh is less stiff (the guide's limits): where it is flung, it gives for some ticks.
    assert!(worst[0] < 0.1 && worst[1] < 1.5, "{worst:?}");
}

/// A hand holds on where the world's origin moves.
#[test]
fn a_hand_moves_with_the_origin() {
    let mut app = app();
    let cloth = Cloth::new(10, 10, 0.05);
    let cloth = app.world_mut().spawn((cloth, Transform::default())).id();
    tick(&mut app, 4);
    let hand = take(&mut app, cloth, 45);
    tick(&mut app, 2);
    let (before, by) = (place(&app, cloth, 45), Vec3::new(64.0, 0.0, -32.0));
    for moved in [cloth, hand] {
        change::<Transform>(&mut app, moved, |place| place.translation += by);
    }
    shift_cloths(app.world_mut(), by).expect("a finite jump");
    tick(&mut app, 8);
    // A float at 64 m is exact to 4 µm.
    assert!(place(&app, cloth, 45).distance(before + by) < 2.0e-5);
    assert!(stats(&app, cloth).stretch.structural < 0.05);
}

/// Rolled back in the middle of a pull that reaches no farther, and pulled again, cloth moves alike to the last bit.
#[test]
fn a_pull_is_rolled_back() {
    let mut app = app();
    app.insert_resource(ClothWind::gusty(Vec3::new(2.0, 0.0, 3.0)));
    let cloth = app.world_mut().spawn(Cloth::new(12, 12, 0.05)).id();
    tick(&mut app, 8);
    let hand = take(&mut app, cloth, 100);
    let start = place(&app, cloth, 100);
    let pull = |app: &mut App, ticks: std::ops::Range<u32>| {
        for step in ticks {
            aim(app, hand, start + Vec3::new(0.02, 0.01, 0.03) * step as f32);
            tick(app, 1);
        }
    };
    pull(&mut app, 0..20);
    let saved = ClothWorldSnapshot::of(app.world_mut());
    pull(&mut app, 20..40);
    let after = particles(&app, cloth).clone();
    saved.restore(app.world_mut()).expect("the same world");
    assert_ne!(particles(&app, cloth), &after);
    pull(&mut app, 20..40);
    assert_eq!(particles(&app, cloth), &after);
}
