//! What was found to hold when it was looked for from outside, and has to go on holding.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A hundred kilometres from the origin a cloth moves as at the origin, to the last bit: it is simulated in its own frame.
#[test]
fn a_hundred_kilometres_away_it_moves_as_at_the_origin() {
    let run = |place: Vec3| {
        let mut app = app();
        let cloth = (Cloth::new(12, 9, 0.1), Transform::from_translation(place));
        let cloth = app.world_mut().spawn(cloth).id();
        tick(&mut app, 256);
        particles(&app, cloth).clone()
    };
    let truth = run(Vec3::ZERO);
    for far in [Vec3::X * 1.0e5, Vec3::new(-3.0e4, 8.0e4, 5.0e4)] {
        assert!(run(far) == truth, "{far}");
    }
}

/// However candidates are searched for, the same particles touch, and go the same way to the last bit.
#[test]
fn every_search_leads_to_the_same_bits() {
    let run = |method: SearchMethod| {
        let mut app = app_with_moving_balls();
        let (cloth, _) = spawn_pass(&mut app);
        app.world_mut().entity_mut(cloth).insert(method);
        tick(&mut app, 96);
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        (
            particles(&app, cloth).clone(),
            contacts.iter().copied().collect::<Vec<_>>(),
        )
    };
    let truth = run(SearchMethod::Scan);
    for method in SearchMethod::ALL {
        assert!(run(method) == truth, "{method:?}");
    }
}

/// A sheet on a slope of the angle θ, in the plane of the slope: how far it has come down after `ticks`, all of it, in the mean (m).
fn slid(angle: f32, friction: f32, ticks: usize) -> f32 {
    let mut app = app();
    let turn = Quat::from_rotation_z(-angle);
    let material = ClothMaterial {
        friction,
        damping: 0.0,
        ..default()
    };
    let slope = Transform::from_rotation(turn);
    let settings = ClothSettings {
        particle_radius: 0.01,
        sleeps: false,
        substepping: Substepping::Fixed(20),
        ..default()
    };
    let lying = Transform::from_translation(turn * Vec3::Y * 0.01).with_rotation(turn);
    let sheet = (Cloth::new(9, 9, 0.05).lying().centred(), Pins::none());
    let cloth = app
        .world_mut()
        .spawn((sheet, material, settings, lying))
        .id();
    app.world_mut().spawn((ClothCollider::plane(), slope));
    tick(&mut app, ticks);
    let count = particles(&app, cloth).len() as f32;
    let sum: Vec3 = particles(&app, cloth).positions().sum();
    sum.x / count
}

/// Coulomb's law on a slope: within a thousandth of tan θ = μ it sticks below and slides above, and goes ½ g (sin θ − μ cos θ) t². A
/// cloth that begins has no past, so that its first sub-step is of first order: by that the way is longer by Δt/t, 1/2560 in 2 s.
#[test]
fn it_slides_by_coulombs_law() {
    for angle in [0.2_f32, 0.5, 0.8] {
        let sticks = slid(angle, angle.tan() * 1.001, 64);
        let slides = slid(angle, angle.tan() * 0.999, 64);
        let seconds = 128.0 * TICK;
        let friction = 0.5 * angle.tan();
        let way = 0.5 * GRAVITY * (angle.sin() - friction * angle.cos()) * seconds * seconds;
        let error = slid(angle, friction, 128) / way - 1.0;
        let due = 0.5 * GRAVITY * 1.0e-3 * angle.sin();
        // Places of 0.2 m are rounded by 10⁻⁸ m, a hundredth of what gravity moves them by in a sub-step.
        assert!(sticks.abs() < 0.1 * due, "{angle}: {sticks} m");
        let part = slides / due;
        assert!((0.5..2.0).contains(&part), "{angle}: {slides} m, {due}");
        assert!(error.abs() < 1.0e-3, "{angle}: {error}");
    }
}

/// Undamped, nothing that falls onto a slope, a ball or a box comes higher than it fell from: the middle of its mass, in any bounce.
#[test]
fn no_bounce_is_higher_than_its_fall() {
    for (name, collider, place) in [
        ("plane", ClothCollider::plane(), Transform::IDENTITY),
        (
            "ball",
            ClothCollider::ball(0.4),
            Transform::from_xyz(0.0, -0.4, 0.0),
        ),
        (
            "box",
            ClothCollider::cuboid(0.3, 0.3, 0.3),
            Transform::from_xyz(0.0, -0.3, 0.0),
        ),
    ] {
        for (height, friction) in [(0.2, 0.0), (1.0, 0.5), (3.0, 0.0)] {
            let mut app = app();
            let material = ClothMaterial {
                friction,
                damping: 0.0,
                ..default()
            };
            let sheet = (Cloth::new(11, 11, 0.06).lying().centred(), Pins::none());
            let at =
                Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_x(0.2));
            let cloth = app.world_mut().spawn((sheet, material, at)).id();
            app.world_mut().spawn((collider.clone(), place));
            let mut highest = f32::MIN;
            let mut has_touched = false;
            for _ in 0..256 {
                tick(&mut app, 1);
                has_touched |= stats(&app, cloth).contacts > 0;
                let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
                let count = particles(&app, cloth).len() as f32;
                let sum: Vec3 = particles(&app, cloth).positions().sum();
                let middle = frame.to_world(sum / count).y;
                if has_touched {
                    highest = highest.max(middle);
                }
            }
            assert!(
                has_touched && highest < height,
                "{name} from {height}: {highest}"
            );
        }
    }
}
