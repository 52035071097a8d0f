//! Wind of the world, of zones and of a cloth's own; what is wrong with it, and when cloth sleeps in it.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A small curtain of heavy damping.
fn curtain(app: &mut App, place: Transform) -> Entity {
    let material = ClothMaterial {
        damping: 0.1,
        ..default()
    };
    let cloth = (Cloth::new(9, 9, 0.1), material, place);
    app.world_mut().spawn(cloth).id()
}

fn sleep(app: &mut App, cloth: Entity) {
    let ticks = (0..64 * 30).find(|_| {
        tick(app, 1);
        stats(app, cloth).is_asleep
    });
    assert!(ticks.is_some(), "it never sleeps: {:?}", stats(app, cloth));
}

/// How far the middle of its lower edge is along z in the world (m).
fn leans(app: &App, cloth: Entity) -> f32 {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let place = frame.to_world(position(app, cloth, (8, 4)));
    let origin: Vec3 = frame.isometry().translation.into();
    place.z - origin.z
}

#[test]
fn without_wind_there_is_no_air() {
    let mut plain = app();
    let mut with_own = app();
    let cloth = curtain(&mut plain, default());
    let other = curtain(&mut with_own, default());
    let air = ClothAir {
        drag: 9.0,
        ..default()
    };
    with_own.world_mut().entity_mut(other).insert(air);
    let far = Transform::from_xyz(50.0, 0.0, 0.0);
    let zone = ClothWindZone::ball(3.0, Vec3::Z * 9.0);
    with_own.world_mut().spawn((zone, far));
    for app in [&mut plain, &mut with_own] {
        tick(app, 30);
    }
    assert_eq!(particles(&plain, cloth), particles(&with_own, other));
    assert_eq!(stats(&with_own, other).air_impulse, Vec3::ZERO);
}

/// The world's wind, one's own in its place, and a zone on top of either, in the same place and however the cloth is turned and scaled.
#[test]
fn each_cloth_feels_its_own_air() {
    let mut app = app();
    app.insert_resource(ClothWind::new(Vec3::Z * 1.5));
    let turned = Transform::from_xyz(10.0, 0.0, 0.0)
        .with_rotation(Quat::from_rotation_y(std::f32::consts::PI))
        .with_scale(Vec3::splat(0.5));
    let world = curtain(&mut app, default());
    let turned = curtain(&mut app, turned);
    let [own, still, blown] = [20.0, 30.0, 40.0].map(|x| {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        curtain(&mut app, place)
    });
    for (cloth, velocity) in [(own, Vec3::NEG_Z * 1.5), (still, Vec3::ZERO)] {
        let air = ClothAir {
            velocity: Some(velocity),
            ..default()
        };
        app.world_mut().entity_mut(cloth).insert(air);
    }
    // As strong as the wind, against it, all over the cloth.
    let zone = ClothWindZone {
        softness: 0.1,
        ..ClothWindZone::cuboid(Vec3::splat(2.0), Vec3::NEG_Z * 1.5)
    };
    let place = Transform::from_xyz(40.4, -0.4, 0.0);
    let zone = app.world_mut().spawn((zone, place)).id();
    tick(&mut app, 1);
    assert!(stats(&app, world).air_impulse.z > 0.0);
    assert!(stats(&app, own).air_impulse.z < 0.0);
    tick(&mut app, 64 * 8);
    let lean = leans(&app, world);
    assert!((0.3..0.8).contains(&lean), "{lean}");
    assert!((leans(&app, turned) / lean - 0.5).abs() < 0.01);
    assert!((leans(&app, own) / lean + 1.0).abs() < 0.01);
    assert!(leans(&app, still).abs() < 0.01 && leans(&app, blown).abs() < 0.01);
    // Turned around it blows along.
    change::<Transform>(&mut app, zone, |t| t.rotate_y(std::f32::consts::PI));
    tick(&mut app, 64 * 8);
    let twice = leans(&app, blown);
    assert!(twice > 1.05 * lean, "{twice} {lean}");
}

/// Sheets lie in the air and fall at ``√(2 ρ_s g/(ρ C_d))`` = 1.43 m/s in the end, in still air too; after a second, 7 times V ⁄ g, by a part of 10⁻⁵ less.
#[test]
fn still_air_holds_a_sheet_that_falls() {
    for damping in [0.0, 0.01, 0.05] {
        let mut app = app();
        app.insert_resource(ClothWind::default());
        let material = ClothMaterial {
            damping,
            ..default()
        };
        let sheet = (Cloth::new(9, 9, 0.1).lying(), Pins::none(), material);
        let sheet = app.world_mut().spawn(sheet).id();
        tick(&mut app, 64);
        let speed = particles(&app, sheet).velocity((4, 4)).expect("it exists");
        println!("damping {damping}: {} m/s", speed.y);
        assert!((speed.y / -1.43 - 1.0).abs() < 0.01, "{damping}: {speed}");
    }
}

/// A fan blows at what is before it, and not at what is behind or beside.
#[test]
fn a_fan_blows_forward() {
    let mut app = app();
    let [before, behind, beside] = [-1.0, 1.0, 3.0].map(|z| {
        let place = Vec3::new(if z == 3.0 { 4.0 } else { -0.4 }, 0.4, z);
        curtain(&mut app, Transform::from_translation(place))
    });
    let fan = ClothWindZone::fan(4.0, 0.6, 5.0);
    app.world_mut().spawn((fan, Transform::default()));
    tick(&mut app, 64);
    assert!(leans(&app, before) < -0.05, "{}", leans(&app, before));
    assert!(leans(&app, behind).abs() < 1.0e-3 && leans(&app, beside).abs() < 1.0e-3);
    assert_eq!(stats(&app, beside).air_impulse, Vec3::ZERO);
}

/// Each is named, on the cloth or on the zone; the others go on, and what is mended comes back.
#[test]
fn bad_air_is_a_fault() {
    let mut app = app();
    app.insert_resource(ClothWind::new(Vec3::new(0.0, f32::NAN, 0.0)));
    let cloth = curtain(&mut app, default());
    tick(&mut app, 2);
    let fault = |app: &App, entity: Entity| {
        let fault = app.world().get::<ClothFault>(entity);
        fault.map(|fault| fault.error.to_string())
    };
    let text = fault(&app, cloth).expect("a fault");
    assert!(
        text.contains("velocity of the air") && text.contains("NaN"),
        "{text}"
    );
    let bad: [fn(&mut ClothWind); 5] = [
        |wind| wind.density = -1.0,
        |wind| wind.gusts = f32::INFINITY,
        |wind| wind.gust_period = 0.0,
        |wind| wind.turbulence = -0.1,
        |wind| wind.turbulence_length = 0.0,
    ];
    for spoil in bad {
        let mut wind = ClothWind::gusty(Vec3::Z);
        app.insert_resource(wind);
        tick(&mut app, 1);
        assert_eq!(fault(&app, cloth), None);
        spoil(&mut wind);
        app.insert_resource(wind);
        tick(&mut app, 1);
        assert!(fault(&app, cloth).is_some(), "{wind:?}");
    }
    app.insert_resource(ClothWind::new(Vec3::Z));
    let own = ClothAir {
        lift: f32::NAN,
        ..default()
    };
    app.world_mut().entity_mut(cloth).insert(own);
    let zone = ClothWindZone::ball(-1.0, Vec3::Z);
    let zone = app.world_mut().spawn((zone, Transform::default())).id();
    tick(&mut app, 1);
    assert!(fault(&app, cloth).is_some() && fault(&app, zone).is_some());
    app.world_mut().entity_mut(cloth).remove::<ClothAir>();
    change::<ClothWindZone>(&mut app, zone, |zone| {
        zone.shape = ClothWindShape::Ball { radius: 1.0 };
    });
    tick(&mut app, 1);
    assert_eq!((fault(&app, cloth), fault(&app, zone)), (None, None));
}

/// In steady wind it sleeps where it leans; what changes the air wakes it in that tick, and a zone that does not reach it does not.
#[test]
fn it_sleeps_in_steady_wind_and_wakes_for_another() {
    let wake: [(&str, fn(&mut App, Entity, Entity)); 5] = [
        ("another wind", |app, _, _| {
            app.insert_resource(ClothWind::new(Vec3::X));
        }),
        ("no wind", |app, _, _| {
            app.world_mut().remove_resource::<ClothWind>();
        }),
        ("gusts", |app, _, _| {
            app.insert_resource(ClothWind::gusty(Vec3::Z));
        }),
        ("a zone", |app, _, zone| {
            change::<Transform>(app, zone, |t| t.translation.x = 1.0);
        }),
        ("other coefficients", |app, cloth, _| {
            let air = ClothAir {
                drag: 0.5,
                ..default()
            };
            app.world_mut().entity_mut(cloth).insert(air);
        }),
    ];
    for (name, wake) in wake {
        let mut app = app();
        app.insert_resource(ClothWind::new(Vec3::Z));
        let cloth = curtain(&mut app, default());
        let zone = ClothWindZone::ball(1.0, Vec3::X * 5.0);
        let far = Transform::from_xyz(20.0, 0.0, 0.0);
        let zone = app.world_mut().spawn((zone, far)).id();
        sleep(&mut app, cloth);
        assert!(leans(&app, cloth) > 0.1);
        change::<Transform>(&mut app, zone, |t| t.translation.x = 10.0);
        let before = particles(&app, cloth).clone();
        tick(&mut app, 10);
        assert!(stats(&app, cloth).is_asleep && particles(&app, cloth) == &before);
        wake(&mut app, cloth, zone);
        tick(&mut app, 1);
        assert!(!stats(&app, cloth).is_asleep, "{name}");
        tick(&mut app, 8);
        assert_ne!(particles(&app, cloth), &before, "{name}");
    }
}

#[test]
fn it_does_not_sleep_in_turbulence() {
    let mut app = app();
    app.insert_resource(ClothWind::gusty(Vec3::Z * 0.5));
    let cloth = curtain(&mut app, default());
    for _ in 0..64 * 10 {
        tick(&mut app, 1);
        assert!(!stats(&app, cloth).is_asleep);
    }
}

/// The same seed is the same wind to the last bit; another one is another.
#[test]
fn a_run_replays_by_its_seed() {
    let run = |seed: i32| {
        let mut app = app();
        let wind = ClothWind {
            seed,
            ..ClothWind::gusty(Vec3::new(6.0, 0.0, 2.0))
        };
        app.insert_resource(wind);
        let flag = (Cloth::new(24, 16, 0.06), Pins::new([Pin::Column(0)]));
        let flag = app.world_mut().spawn(flag).id();
        tick(&mut app, 100);
        particles(&app, flag).clone()
    };
    let first = run(1);
    assert_eq!(run(1), first);
    assert_ne!(run(2), first);
}

/// A grid has a border, and so does a mesh with a hole: no pressure holds there.
#[test]
fn pressure_needs_a_closed_mesh() {
    for pressure in [ClothPressure::Gauge(10.0), ClothPressure::gas(0.1)] {
        let mut app = app();
        let cloth = curtain(&mut app, default());
        app.world_mut().entity_mut(cloth).insert(pressure);
        tick(&mut app, 1);
        let fault = app.world().get::<ClothFault>(cloth).expect("a fault");
        assert_eq!(fault.error, MeshError::NotClosed.into());
        app.world_mut().entity_mut(cloth).remove::<ClothPressure>();
        tick(&mut app, 1);
        assert!(app.world().get::<ClothFault>(cloth).is_none());
    }
}

/// No gas, less than none and what is no number is a fault that names it; a good amount mends it.
#[test]
fn gas_has_an_amount() {
    let mut app = app_that_draws(FixedUpdate);
    let ball = Sphere::new(0.2).mesh().ico(3).expect("few");
    let ball = app.world_mut().resource_mut::<Assets<Mesh>>().add(ball);
    let cloth = (Cloth::mesh(), Mesh3d(ball), Pins::none());
    let cloth = app.world_mut().spawn(cloth).id();
    let gas = |volume, outside| ClothPressure::Gas { volume, outside };
    for (bad, name) in [
        (gas(0.0, 1.0e5), "volume of the gas"),
        (gas(-1.0, 1.0e5), "volume of the gas"),
        (gas(f32::NAN, 1.0e5), "volume of the gas"),
        (gas(0.03, 0.0), "pressure outside"),
        (gas(0.03, f32::INFINITY), "pressure outside"),
        (ClothPressure::Gauge(f32::NAN), "gauge pressure"),
    ] {
        app.world_mut().entity_mut(cloth).insert(bad);
        tick(&mut app, 1);
        let fault = app.world().get::<ClothFault>(cloth).expect("a fault");
        assert!(fault.error.to_string().contains(name), "{}", fault.error);
    }
    app.world_mut().entity_mut(cloth).insert(gas(0.03, 1.0e5));
    tick(&mut app, 8);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    let stats = app.world().get::<ClothStats>(cloth).expect("figures");
    assert!((stats.enclosed_volume - 0.03).abs() < 1.0e-3, "{stats:?}");
}

/// The least eddies, the fastest wind and the longest time are no fault and make nothing that is not finite.
#[test]
fn the_wildest_turbulence_is_finite() {
    for (velocity, turbulence, length) in [
        (Vec3::X * 5.0, 0.5, 1.0e-6),
        (Vec3::splat(1.0e6), 1.0e6, 1.0e-6),
        (Vec3::new(-1.0e6, 3.0, 0.0), 0.2, 1.0e12),
    ] {
        let mut app = app();
        let wind = ClothWind {
            turbulence,
            turbulence_length: length,
            gusts: turbulence,
            gust_period: length,
            ..ClothWind::new(velocity)
        };
        app.insert_resource(wind);
        let far = Transform::from_xyz(4.0e5, -3.0, 1.0e5);
        let cloth = app.world_mut().spawn((Cloth::new(9, 9, 0.1), far)).id();
        for _ in 0..40 {
            tick(&mut app, 1);
            let fault = app.world().get::<ClothFault>(cloth);
            assert!(fault.is_none(), "{wind:?}: {fault:?}");
            let speed = particles(&app, cloth).largest_speed();
            assert!(speed < 1.0e7, "{wind:?}: {speed} m/s");
        }
    }
}

/// A tolerance that does a tick again lets gas begin it as it began the first time: the same as with that many sub-steps at once.
#[test]
fn what_is_done_again_begins_with_the_same_gas() {
    let run = |substepping: Substepping| {
        let mut app = app_that_draws(FixedUpdate);
        let ball = Sphere::new(0.2).mesh().ico(3).expect("few");
        let ball = app.world_mut().resource_mut::<Assets<Mesh>>().add(ball);
        let cloth = (
            Cloth::mesh(),
            Mesh3d(ball),
            Pins::none(),
            ClothPressure::gas(0.04),
        );
        let settings = ClothSettings {
            substepping: Substepping::Fixed(8),
            ..default()
        };
        let cloth = app.world_mut().spawn((cloth, settings)).id();
        tick(&mut app, 8);
        change::<ClothSettings>(&mut app, cloth, |known| known.substepping = substepping);
        tick(&mut app, 1);
        (particles(&app, cloth).clone(), stats(&app, cloth).substeps)
    };
    let (again, all) = run(Substepping::Adaptive {
        stretch: 1.0e-6,
        max_substeps: 64,
    });
    // All that may be taken: what the runs before the last one leave of 64.
    let (once, last) = run(Substepping::Fixed(34));
    assert_eq!((all, last), (64, 34));
    assert!(again == once, "others than in one go");
}
