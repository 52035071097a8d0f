//! Sleep: a cloth at rest stays as it is, costs nothing, and wakes by whatever would move it.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A small curtain of heavy damping, with a ball far away, ticked until it sleeps.
fn asleep() -> (App, Entity, Entity) {
    let mut app = app();
    let material = ClothMaterial {
        damping: 0.1,
        ..default()
    };
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(9, 9, 0.1), material))
        .id();
    let far = Transform::from_xyz(0.4, -0.4, 5.0);
    let ball = app.world_mut().spawn((ClothCollider::ball(0.2), far)).id();
    sleep(&mut app, cloth);
    (app, cloth, ball)
}

fn sleep(app: &mut App, cloth: Entity) {
    let ticks = (0..64 * 30).find(|_| {
        tick(app, 1);
        stats(app, cloth).is_asleep
    });
    assert!(ticks.is_some(), "it never sleeps: {:?}", stats(app, cloth));
}

#[test]
fn a_sleeping_cloth_stays_as_it_is_to_the_last_bit() {
    let (mut app, cloth, _) = asleep();
    let before = particles(&app, cloth).clone();
    tick(&mut app, 300);
    assert_eq!(particles(&app, cloth), &before);
    let stats = stats(&app, cloth);
    assert!(stats.is_asleep && stats.substeps == 0 && stats.integrate_ms == 0.0);
    assert_eq!(app.world().get::<ClothFault>(cloth), None);
}

/// What wakes it, wakes it in the very tick.
#[test]
fn whatever_would_move_it_wakes_it() {
    let wake: [(&str, fn(&mut App, Entity, Entity)); 9] = [
        ("a touch", |app, _, ball| {
            change::<Transform>(app, ball, |t| t.translation.z = 0.15);
        }),
        ("its transform", |app, cloth, _| {
            change::<Transform>(app, cloth, |t| t.translation.x += 1.0e-4);
        }),
        ("a setting", |app, cloth, _| {
            change::<ClothSettings>(app, cloth, |s| s.particle_radius = 0.02);
        }),
        ("its material", |app, cloth, _| {
            change::<ClothMaterial>(app, cloth, |m| m.areal_density *= 2.0);
        }),
        ("its pins", |app, cloth, _| {
            change::<Pins>(app, cloth, |pins| *pins = Pins::new([Pin::Column(0)]));
        }),
        ("gravity", |app, _, _| {
            app.world_mut().resource_mut::<ClothGravity>().0.x = 0.1;
        }),
        ("its own gravity", |app, cloth, _| {
            change::<ClothSettings>(app, cloth, |s| s.gravity = Some(Vec3::X));
        }),
        ("a game's hand", |app, cloth, _| {
            change::<ClothParticles>(app, cloth, |p| {
                p.set_velocity(40, Vec3::Z).expect("a particle");
            });
        }),
        ("an attachment", |app, cloth, ball| {
            let attached = ClothAttachments::new([(Pin::Cell(8, 8), ball)]);
            app.world_mut().entity_mut(cloth).insert(attached);
        }),
    ];
    for (name, wake) in wake {
        let (mut app, cloth, ball) = asleep();
        let before = particles(&app, cloth).clone();
        wake(&mut app, cloth, ball);
        tick(&mut app, 1);
        assert!(!stats(&app, cloth).is_asleep, "{name}");
        tick(&mut app, 1);
        assert_ne!(particles(&app, cloth), &before, "{name}");
    }
}

/// A ball that moves about elsewhere, even inside of the cloth's bounding sphere, does not wake it.
#[test]
fn what_does_not_touch_it_lets_it_sleep() {
    let (mut app, cloth, ball) = asleep();
    for step in 0..50 {
        let z = 0.5 - 0.002 * step as f32;
        change::<Transform>(&mut app, ball, |t| t.translation.z = z);
        tick(&mut app, 1);
        assert!(stats(&app, cloth).is_asleep, "{z}");
    }
    change::<Transform>(&mut app, ball, |t| t.translation.z = 0.18);
    tick(&mut app, 1);
    assert!(!stats(&app, cloth).is_asleep);
}

/// Draped over a still ball it sleeps, keeps its contact, and wakes when the ball goes.
#[test]
fn it_sleeps_on_a_still_ball_until_that_goes() {
    let gone: [fn(&mut App, Entity); 3] = [
        |app, ball| {
            app.world_mut().despawn(ball);
        },
        |app, ball| change::<Transform>(app, ball, |t| t.translation.y -= 0.1),
        |app, ball| {
            let away = (ClothCollider::ball(0.2), Transform::from_xyz(9.0, 0.0, 0.0));
            app.world_mut().entity_mut(ball).insert(away);
        },
    ];
    for gone in gone {
        let (mut app, cloth, ball) = asleep();
        change::<Transform>(&mut app, ball, |t| t.translation.z = 0.1);
        tick(&mut app, 1);
        assert!(!stats(&app, cloth).is_asleep);
        sleep(&mut app, cloth);
        messages::<ClothTouchStopped>(&mut app);
        tick(&mut app, 100);
        assert!(stats(&app, cloth).contacts > 0);
        assert!(messages::<ClothTouchStopped>(&mut app).is_empty());
        gone(&mut app, ball);
        tick(&mut app, 1);
        assert!(!stats(&app, cloth).is_asleep);
        tick(&mut app, 64);
        assert_eq!(messages::<ClothTouchStopped>(&mut app).len(), 1);
    }
}

#[test]
fn one_that_may_not_sleep_does_not() {
    let (mut app, cloth, _) = asleep();
    change::<ClothSettings>(&mut app, cloth, |settings| settings.sleeps = false);
    for _ in 0..100 {
        tick(&mut app, 1);
        assert!(!stats(&app, cloth).is_asleep);
    }
}

/// A fault wakes it, so that its contacts are found again.
#[test]
fn a_fault_wakes_it() {
    let (mut app, cloth, ball) = asleep();
    change::<Transform>(&mut app, ball, |t| t.translation.z = 0.1);
    tick(&mut app, 1);
    sleep(&mut app, cloth);
    let gravity = app.world().resource::<ClothGravity>().0;
    app.world_mut().resource_mut::<ClothGravity>().0 = Vec3::NAN;
    tick(&mut app, 1);
    app.world_mut().resource_mut::<ClothGravity>().0 = gravity;
    tick(&mut app, 1);
    let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
    assert!(contacts.with(ball).is_some());
}

/// NaN is named, and once each particle is mended the cloth goes on.
#[test]
fn a_mended_cloth_goes_on() {
    let (mut app, cloth, _) = asleep();
    let valid = particles(&app, cloth).clone();
    change::<ClothParticles>(&mut app, cloth, |p| {
        p.set_position((3, 8), Vec3::splat(1.0e17))
            .expect("a particle");
    });
    tick(&mut app, 5);
    change::<ClothParticles>(&mut app, cloth, |p| {
        for index in 0..p.len() {
            let position = valid.position(index).expect("a particle");
            p.set_position(index, position)
                .and_then(|()| p.set_displacement(index, Vec3::Z * 1.0e-3))
                .expect("a particle");
        }
    });
    tick(&mut app, 2);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    assert!(position(&app, cloth, (8, 4)).z > 0.0);
}

/// Within three seconds after an eye sees no motion any more, and never while it does: an eye sees what moves by a
/// thousandth of the cloth's diagonal, a pixel where that fills the screen, within as long as the cloth is looked at. One that
/// looks for less does not see what still sinks slowly.
#[test]
fn it_sleeps_soon_after_an_eye_sees_no_motion() {
    let tablecloth = |app: &mut App| {
        let table = ClothCollider::cuboid(1.0, 0.1, 1.0);
        app.world_mut()
            .spawn((table, Transform::from_xyz(0.0, 0.7, 0.0)));
        app.world_mut().spawn(ClothCollider::plane());
        let cloth = (Cloth::new(63, 62, 0.0255).lying().centred(), Pins::none());
        let above = Transform::from_xyz(0.0, 0.9, 0.0);
        app.world_mut().spawn((cloth, above)).id()
    };
    let flag = |app: &mut App| {
        let flag = (Cloth::new(24, 16, 0.06), Pins::new([Pin::Column(0)]));
        app.world_mut().spawn(flag).id()
    };
    let spawns: [(&str, &dyn Fn(&mut App) -> Entity); 2] =
        [("tablecloth", &tablecloth), ("flag", &flag)];
    for (name, spawn) in spawns {
        let mut app = app();
        let cloth = spawn(&mut app);
        tick(&mut app, 1);
        let grid = app.world().get::<Cloth>(cloth).expect("a cloth");
        let pixel = 1.0e-3 * grid.width().hypot(grid.height());
        let mut history: Vec<Vec<Vec3>> = Vec::new();
        let mut last_seen = 0;
        while !stats(&app, cloth).is_asleep {
            tick(&mut app, 1);
            history.push(particles(&app, cloth).positions().collect());
            let now = history.len() - 1;
            // As long as half a swing and a pause: 1.25 s and 0.125 s for a diagonal of 2.25 m.
            let before = &history[now.saturating_sub(88)];
            let moves = |(a, b): (&Vec3, &Vec3)| a.distance_squared(*b) > pixel * pixel;
            if history[now].iter().zip(before).any(moves) {
                last_seen = now;
            }
            assert!(now < 64 * 30, "{name} never sleeps");
        }
        let waited = (history.len() - last_seen) as f32 / 64.0;
        println!(
            "{name}: an eye sees the last of it after {:.1} s, it sleeps {waited:.2} s later",
            last_seen as f32 / 64.0
        );
        // What moved by a pixel in that time before `last_seen` may have done so at its beginning.
        assert!((0.0..3.2).contains(&waited), "{name}: {waited} s");
        let still = &history[history.len() - 32];
        let end = &history[history.len() - 1];
        let moved = still.iter().zip(end).map(|(a, b)| a.distance(*b));
        assert!(moved.fold(0.0, f32::max) < pixel, "{name}");
    }
}

/// Who saves particles, or writes back what was there, does not wake a cloth; whoever moves one does.
#[test]
fn saved_particles_let_it_sleep() {
    let (mut app, cloth, _) = asleep();
    change::<ClothParticles>(&mut app, cloth, |particles| {
        let saved = particles.clone();
        *particles = saved;
    });
    tick(&mut app, 2);
    assert!(stats(&app, cloth).is_asleep);
    change::<ClothParticles>(&mut app, cloth, |particles| {
        let at = particles.position(40).expect("a particle");
        particles
            .set_position(40, at + Vec3::Z * 1.0e-3)
            .expect("a particle");
    });
    tick(&mut app, 1);
    assert!(!stats(&app, cloth).is_asleep);
}
