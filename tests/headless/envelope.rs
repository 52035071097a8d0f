//! Beyond the envelope in which cloth is simulated well: reported once for each cloth and limit, with the quantity.

use bevy::prelude::*;
use bevy_drape::{plugin::ClothBuilt, prelude::*};

use crate::support::*;

/// Ticks a cloth beside a valid one and expects a report of that limit, once, with a quantity beyond it, and of nothing
/// else; not again when its settings change.
fn expect_reported(mut app: App, cloth: Entity, limit: ClothLimit) {
    let valid = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 64);
    let reported = messages::<ClothLimitExceeded>(&mut app);
    // Once, or again where it got ten times worse.
    let [reported, ..] = reported[..] else {
        panic!("not reported");
    };
    assert_eq!((reported.cloth, reported.limit), (cloth, limit));
    assert!(reported.quantity > reported.good_up_to, "{reported:?}");
    assert_eq!(exceeded(&app, cloth), Some(limit));
    assert_eq!(exceeded(&app, valid), None);
    change::<ClothSettings>(&mut app, cloth, |settings| settings.particle_radius *= 2.0);
    tick(&mut app, 64);
    assert_eq!(messages::<ClothLimitExceeded>(&mut app), []);
}

fn exceeded(app: &App, cloth: Entity) -> Option<ClothLimit> {
    let stats = app.world().get::<ClothStats>(cloth).expect("figures");
    stats.exceeded
}

/// Hung by one particle without tethers, in three sub-steps: threads that are solved once can't hold it.
#[test]
fn a_cloth_that_its_sub_steps_do_not_hold() {
    let mut app = app();
    let settings = ClothSettings {
        tethers: false,
        sleeps: false,
        ..ClothSettings::substeps(3)
    };
    let pins = Pins::new([Pin::Corner(Corner::TopLeft)]);
    let cloth = (Cloth::new(32, 32, 0.05), pins, settings, solved_once());
    let cloth = app.world_mut().spawn(cloth).id();
    expect_reported(app, cloth, ClothLimit::Stretch);
}

#[test]
fn a_tolerance_that_the_cap_does_not_hold() {
    let mut app = app();
    let settings = ClothSettings {
        substepping: Substepping::Adaptive {
            stretch: 0.001,
            max_substeps: 30,
        },
        sleeps: false,
        ..default()
    };
    let cloth = (Cloth::default(), ClothMaterial::RUBBER, settings);
    let cloth = app.world_mut().spawn(cloth).id();
    expect_reported(app, cloth, ClothLimit::Tolerance);
}

/// Twenty thousand times as heavy as others is too much, with tethers or without.
#[test]
fn a_mass_of_many_others() {
    for tethers in [false, true] {
        let mut app = app();
        let awake = ClothSettings {
            sleeps: false,
            tethers,
            ..ClothSettings::substeps(60)
        };
        let cloth = app.world_mut().spawn((Cloth::new(4, 4, 0.1), awake)).id();
        tick(&mut app, 1);
        change::<ClothParticles>(&mut app, cloth, |particles| {
            let light = particles.inverse_mass((2, 1)).expect("it exists");
            particles
                .set_inverse_mass((3, 1), light / 2.0e4)
                .expect("it exists");
        });
        assert_eq!(messages::<ClothLimitExceeded>(&mut app), []);
        expect_reported(app, cloth, ClothLimit::MassRatio);
    }
}

/// It falls away from its frame, faster and faster.
#[test]
fn a_cloth_far_from_its_own_frame() {
    let mut app = app();
    let settings = ClothSettings {
        gravity: Some(Vec3::NEG_Y * 2000.0),
        sleeps: false,
        ..default()
    };
    let cloth = (Cloth::new(4, 4, 0.01), Pins::none(), settings);
    let cloth = app.world_mut().spawn(cloth).id();
    expect_reported(app, cloth, ClothLimit::Distance);
}

#[test]
fn damping_that_the_sub_steps_decide() {
    let mut app = app();
    let settings = ClothSettings {
        sleeps: false,
        ..ClothSettings::substeps(4)
    };
    let material = ClothMaterial {
        damping: 0.9,
        ..default()
    };
    let cloth = (Cloth::new(8, 8, 0.1), material, settings);
    let cloth = app.world_mut().spawn(cloth).id();
    expect_reported(app, cloth, ClothLimit::Damping);
}

/// A pellet of a quarter of a spacing at 1,000 m/s is reported in the tick in which it comes.
#[test]
fn a_small_fast_collider() {
    let mut app = app_with_moving_balls();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 2);
    let start = Transform::from_xyz(0.73, -0.76, -20.0);
    app.world_mut()
        .spawn((ClothCollider::ball(0.025), Moving(1000.0), start));
    tick(&mut app, 4);
    let reported = messages::<ClothLimitExceeded>(&mut app);
    assert!(
        matches!(reported[..], [reported] if reported.limit == ClothLimit::SmallFastCollider && reported.cloth == cloth),
        "{reported:?}"
    );
}

/// What is crammed into a tenth of a spacing has no layers: that is said, and the tick ends.
#[test]
fn layers_that_are_too_much_to_look_for() {
    let mut app = app();
    let cloth = (Cloth::new(48, 48, 0.03), ClothSelfCollision::default());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    let mut particles = app
        .world_mut()
        .get_mut::<ClothParticles>(cloth)
        .expect("particles");
    for index in 0..particles.len() {
        let turn = |k: f32| 0.003 * (k * index as f32).sin();
        let at = Vec3::new(turn(1.1), turn(2.3), turn(3.7));
        particles.set_position(index, at).expect("it exists");
    }
    tick(&mut app, 1);
    let reported = messages::<ClothLimitExceeded>(&mut app);
    assert!(
        matches!(reported[..], [reported] if reported.limit == ClothLimit::Layers && reported.cloth == cloth),
        "{reported:?}"
    );
}

/// A blow that stretches a cloth for an instant is no reason to report anything.
#[test]
fn an_instant_is_not_reported() {
    let mut app = app();
    let settings = ClothSettings {
        tethers: false,
        ..ClothSettings::substeps(3)
    };
    let cloth = (Cloth::default(), settings, solved_once());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 8);
    change::<ClothParticles>(&mut app, cloth, |particles| {
        let pulled = particles.position((8, 8)).expect("it exists") + Vec3::Z * 20.0;
        particles.set_position((8, 8), pulled).expect("it exists");
    });
    let mut beyond = 0;
    for _ in 0..64 {
        tick(&mut app, 1);
        beyond += usize::from(exceeded(&app, cloth).is_some());
    }
    assert!((1..8).contains(&beyond), "{beyond} ticks");
    assert_eq!(messages::<ClothLimitExceeded>(&mut app), []);
}

/// Once, although gravity comes from another side in every tick, seen from the cloth.
#[test]
fn a_cloth_that_turns_is_reported_once() {
    let mut app = app();
    app.add_systems(
        FixedFirst,
        |mut cloths: Query<&mut Transform, With<Cloth>>| {
            cloths.iter_mut().for_each(|mut place| place.rotate_y(0.01));
        },
    );
    let heavy = ClothMaterial {
        damping: 0.99,
        ..default()
    };
    let settings = ClothSettings {
        sleeps: false,
        ..ClothSettings::substeps(4)
    };
    let tilted = Transform::from_rotation(Quat::from_rotation_x(0.5));
    app.world_mut()
        .spawn((Cloth::new(8, 8, 0.1), heavy, settings, tilted));
    tick(&mut app, 64);
    assert_eq!(messages::<ClothLimitExceeded>(&mut app).len(), 1);
}

/// Gravity swings between nothing and six times the usual, and turns all around, for 200 ticks, of all cloths or of one: rubber
/// that it stretched is no fault as it lets go, what is a fault is reported once, nothing is built again, and nothing sleeps before
/// it is over.
#[test]
fn animated_gravity_builds_and_reports_nothing_again() {
    for of_one in [false, true] {
        let mut app = app();
        let settings = |tethers: bool| ClothSettings {
            tethers,
            ..ClothSettings::substeps(20)
        };
        let damped = ClothMaterial {
            damping: 0.99,
            ..default()
        };
        let cloth = Cloth::new(16, 16, 0.05);
        let rubber = (cloth.clone(), ClothMaterial::RUBBER, settings(true));
        let cotton = (cloth.clone(), ClothMaterial::COTTON, settings(true));
        let faulty = (cloth, damped, settings(false));
        let cloths = [rubber, cotton, faulty].map(|cloth| app.world_mut().spawn(cloth).id());
        tick(&mut app, 1);
        let surfaces = |app: &App| {
            let built = cloths.map(|cloth| app.world().get::<ClothBuilt>(cloth));
            built.map(|built| std::sync::Arc::as_ptr(built.expect("built").surface()))
        };
        let before = surfaces(&app);
        let mut reported = Vec::new();
        for count in 0..200 {
            let turn = 0.13 * count as f32;
            let size = 30.0 * (1.0 - (0.2 * count as f32).cos());
            let gravity = size * Vec3::new(0.5 * turn.sin(), -1.0, 0.5 * turn.cos());
            if of_one {
                for cloth in cloths {
                    change::<ClothSettings>(&mut app, cloth, |own| own.gravity = Some(gravity));
                }
            } else {
                app.insert_resource(ClothGravity(gravity));
            }
            tick(&mut app, 1);
            assert!(cloths.iter().all(|&cloth| !stats(&app, cloth).is_asleep));
            reported.extend(messages::<ClothLimitExceeded>(&mut app));
        }
        assert!(
            matches!(reported[..], [reported] if reported.limit == ClothLimit::Damping && reported.cloth == cloths[2]),
            "{reported:?}"
        );
        assert_eq!(surfaces(&app), before);
        // It hangs to one side, and comes to rest there.
        tick(&mut app, 64 * 40);
        assert!(cloths.iter().all(|&cloth| stats(&app, cloth).is_asleep));
        assert_eq!(messages::<ClothLimitExceeded>(&mut app), []);
    }
}

/// A bullet that passes beside a cloth is none of its business.
#[test]
fn a_small_fast_collider_beside_is_not_reported() {
    let mut app = app_with_moving_balls();
    app.world_mut().spawn(Cloth::default());
    tick(&mut app, 2);
    let start = Transform::from_xyz(4.0, -0.76, -20.0);
    app.world_mut()
        .spawn((ClothCollider::ball(0.025), Moving(1000.0), start));
    tick(&mut app, 4);
    assert_eq!(messages::<ClothLimitExceeded>(&mut app), []);
}

/// What is fine, large, soft or finely stepped, but valid.
#[test]
fn a_fine_rubber_and_a_large_cotton_are_within() {
    let corners = || Pins::new([Pin::Corner(Corner::TopLeft), Pin::Corner(Corner::TopRight)]);
    for cloth in [
        (
            Cloth::new(40, 40, 0.03),
            ClothMaterial::RUBBER,
            ClothSettings::default(),
        ),
        (
            Cloth::new(64, 64, 0.125),
            ClothMaterial::COTTON,
            ClothSettings::substeps(60),
        ),
        (
            Cloth::new(33, 33, 0.03),
            ClothMaterial::COTTON,
            ClothSettings::substeps(640),
        ),
    ] {
        let mut app = app();
        let spawned = app.world_mut().spawn((cloth.clone(), corners())).id();
        tick(&mut app, 128);
        let stretch = app
            .world()
            .get::<ClothStats>(spawned)
            .map(|stats| stats.stretch);
        assert_eq!(
            messages::<ClothLimitExceeded>(&mut app),
            [],
            "{cloth:?}: {stretch:?}"
        );
    }
}

/// The materials with all defaults, hung and struck by a ball: nothing to report.
#[test]
fn the_usual_is_within() {
    for (name, material) in ClothMaterial::PRESETS {
        let mut app = app_with_moving_balls();
        let cloth = app
            .world_mut()
            .spawn((Cloth::new(24, 24, 0.1), material))
            .id();
        let start = Transform::from_xyz(1.2, -1.2, -1.5);
        app.world_mut()
            .spawn((ClothCollider::ball(0.5), Moving(1.5), start));
        tick(&mut app, 192);
        let reported = messages::<ClothLimitExceeded>(&mut app);
        let stretch = app
            .world()
            .get::<ClothStats>(cloth)
            .map(|stats| stats.stretch);
        assert_eq!(reported, [], "{name}: {stretch:?}");
    }
}

/// How far the defaults carry, and what more sub-steps give: the stretch of a cloth that has come to rest after 10 s, as
/// README says it: the material gives less than a per cent in all of them, and what is not solved grows with the particles that
/// hang from one thread.
#[test]
fn what_the_defaults_hold() {
    let rest_stretch = |name: &str, substeps: u32, spawn: &dyn Fn(&mut App) -> Entity| {
        let mut app = app();
        let cloth = spawn(&mut app);
        app.world_mut()
            .entity_mut(cloth)
            .insert(ClothSettings::substeps(substeps));
        tick(&mut app, 640);
        let stretch = stats(&app, cloth).stretch.structural;
        println!("{name}, {substeps} sub-steps: {:.1} %", 100.0 * stretch);
        stretch
    };
    let curtain = |app: &mut App| app.world_mut().spawn(Cloth::new(32, 32, 0.05)).id();
    let tablecloth = |app: &mut App| {
        let table = ClothCollider::cuboid(1.0, 0.1, 1.0);
        app.world_mut()
            .spawn((table, Transform::from_xyz(0.0, -0.4, 0.0)));
        let cloth = (Cloth::new(64, 64, 0.025).lying().centred(), Pins::none());
        app.world_mut().spawn(cloth).id()
    };
    let flag = |app: &mut App| {
        let flag = (Cloth::new(48, 32, 0.03), Pins::new([Pin::Column(0)]));
        app.world_mut().spawn(flag).id()
    };
    assert!(rest_stretch("curtain of 32²", 20, &curtain) < 0.05);
    let cloth = rest_stretch("tablecloth of 64²", 20, &tablecloth);
    assert!(rest_stretch("tablecloth of 64²", 40, &tablecloth) < cloth);
    assert!(rest_stretch("flag of 48 × 32", 20, &flag) < 0.02);
}
