//! Cloth that starts flat leaves its plane: real cloth is never flat.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// How far from its plane z = 0 a cloth is (m), from the particle farthest on one side to that on the other.
fn thickness(app: &App, cloth: Entity) -> f32 {
    let depths = || particles(app, cloth).positions().map(|at| at.z);
    depths().fold(f32::MIN, f32::max) - depths().fold(f32::MAX, f32::min)
}

/// A flat cloth after two seconds, with a floor a metre below its lower edge.
fn after_two_seconds(cloth: Cloth, pins: Pins) -> f32 {
    let mut app = app();
    let floor = Transform::from_xyz(0.0, -cloth.height() - 1.0, 0.0);
    app.world_mut().spawn((ClothCollider::plane(), floor));
    let cloth = app.world_mut().spawn((cloth, pins)).id();
    tick(&mut app, 128);
    thickness(&app, cloth)
}

fn two_corners() -> Pins {
    Pins::new([Pin::Corner(Corner::TopLeft), Pin::Corner(Corner::TopRight)])
}

/// A flag by its column, a sheet by two corners, and one that falls and crumples: each is thicker than a tenth of its
/// width, but the sheet, whose folds are as deep as its sag, a few per cent of it.
#[test]
fn a_flag_a_sheet_and_a_falling_cloth_leave_their_plane() {
    let cloth = Cloth::new(24, 24, 0.05);
    let width = cloth.width();
    for (name, pins, least) in [
        ("flag", Pins::new([Pin::Column(0)]), 0.1),
        ("two corners", two_corners(), 0.02),
        ("falling", Pins::none(), 0.1),
    ] {
        let found = after_two_seconds(cloth.clone(), pins.clone());
        assert!(found > least * width, "{name}: {found} m");
        assert_eq!(
            after_two_seconds(cloth.clone().flat(), pins),
            0.0,
            "{name}, flat"
        );
    }
}

/// At the start it is off its plane by no more than it says; pinned particles are not; and twice the same.
#[test]
fn it_begins_as_uneven_as_it_says() {
    let start = |cloth: Cloth| {
        let mut app = app();
        let still = ClothSettings {
            gravity: Some(Vec3::ZERO),
            ..default()
        };
        let cloth = app.world_mut().spawn((cloth, still)).id();
        // Nothing moves without time, but the cloth is built.
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(
            std::time::Duration::ZERO,
        ));
        app.world_mut().run_schedule(FixedUpdate);
        particles(&app, cloth).clone()
    };
    let cloth = Cloth {
        unevenness: 0.02,
        ..Cloth::new(9, 7, 0.1)
    };
    let built = start(cloth.clone());
    let farthest = built.positions().map(|at| at.z.abs()).fold(0.0, f32::max);
    // Of 54 numbers spread evenly up to 1 the largest is above 0.9 but for a chance of 0.9⁵⁴ = 0.3 %.
    assert!((0.0018..=0.002).contains(&farthest), "{farthest}");
    assert!(built.positions().take(9).all(|at| at.z == 0.0), "pins");
    assert_eq!(built, start(cloth.clone()));
    let lying = start(cloth.lying());
    let above = |at: Vec3| at.y.abs();
    assert_eq!(lying.positions().map(above).fold(0.0, f32::max), farthest);
}

/// Its rest lengths are those of the plane: what is uneven is stretched by half of the square of its slope, which is
/// 2 × 10⁻⁴ at most, far less than by the rounding of places up to 1.2 m: 6 × 10⁻⁸ m at either end of 0.05 m, 2.4 × 10⁻⁶.
#[test]
fn rest_lengths_are_those_of_the_plane() {
    let mut app = app();
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(24, 24, 0.05), Pins::none()))
        .id();
    tick(&mut app, 1);
    assert!(stats(&app, cloth).stretch.structural < 3.0e-6);
}

/// What is attached from the start begins in the plane, as what is pinned does: a flag's edge is as straight as its pole.
#[test]
fn attached_particles_begin_in_the_plane() {
    let mut app = app();
    let pole = app.world_mut().spawn(Transform::default()).id();
    let cloth = Cloth {
        unevenness: 0.1,
        ..Cloth::new(9, 7, 0.1)
    };
    let attached = ClothAttachments::new([(Pin::Column(0), pole)]);
    let cloth = (cloth, Pins::none(), attached);
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    assert!((0..7).all(|row| position(&app, cloth, (row, 0)).z == 0.0));
    assert!((0..7).any(|row| position(&app, cloth, (row, 1)).z != 0.0));
}
