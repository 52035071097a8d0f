//! Heavy bodies on light cloth.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{push_back::*, support::*};

/// How deep the middle of a strip hangs below its clamped ends, 2 `half` apart, if a roller of a radius lies across it (m): it gives
/// `slack` (a part of its length for each newton of its pull), and goes straight from each end to where it touches the roller. What the strip
/// itself weighs acts as if half of it were the roller's: H s = W l/2 + w l/4, with the sag s, the pull H along it, and l half its length.
fn sag(weight: f64, half: f64, radius: f64, slack: f64) -> f64 {
    // So long is the straight part at an angle θ to the level: it ends r sin θ beside the middle.
    let straight = |angle: f64| (half - radius * angle.sin()) / angle.cos();
    let excess = |angle: f64| {
        let pull = weight / (2.0 * angle.sin());
        straight(angle) + radius * angle - half * (1.0 + slack * pull)
    };
    let (mut low, mut high) = (1.0e-4, 1.5);
    for _ in 0..100 {
        let middle = (low + high) / 2.0;
        if excess(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    straight(low) * low.sin() + radius * (1.0 - low.cos())
}

/// Columns of the strip, its mass (kg), and what it gives.
const COLUMNS: u32 = 41;
const ROWS: u32 = 13;
const LENGTH: f32 = 1.0;
const RADIUS: f32 = 0.05;

/// A roller of a mass (kg) across a strip of a compliance (m/N), in the middle, for so many seconds. How deep the strip hangs in the mean of
/// the last two, and how deep it is to hang (m).
fn sag_of_strip(mass: f32, compliance: f32, seconds: usize) -> [f64; 2] {
    let mut app = app_with_bodies();
    let spacing = LENGTH / (COLUMNS - 1) as f32;
    let material = ClothMaterial {
        stretch_compliance: compliance,
        shear_compliance: f32::INFINITY,
        ..ClothMaterial::COTTON
    };
    let pins = Pins::new([Pin::Column(0), Pin::Column(COLUMNS - 1)]);
    let strip = Cloth::new(COLUMNS, ROWS, spacing).lying().centred();
    app.world_mut().spawn((strip, pins, material));
    let roller = (
        ClothCollider::capsule(RADIUS, 0.3),
        ClothBody {
            locked_translation: BVec3::new(true, false, true),
            locked_rotation: BVec3::TRUE,
            ..ClothBody::new(mass, Vec3::ONE)
        },
        Body {
            gravity: GRAVITY,
            ..default()
        },
        Transform::from_xyz(0.0, RADIUS + 0.012, 0.0)
            .with_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)),
    );
    let roller = app.world_mut().spawn(roller).id();
    let mut heights = Vec::new();
    for _ in 0..seconds * 64 {
        tick(&mut app, 1);
        // As air would, so that it comes to rest.
        change::<Body>(&mut app, roller, |body| body.velocity *= 0.95);
        heights.push(f64::from(place(&app, roller).y));
    }
    let last = &heights[heights.len() - 128..];
    let particle_radius = ClothSettings::default().particle_radius;
    let reach = f64::from(RADIUS + particle_radius);
    let width = f64::from(spacing) * f64::from(ROWS);
    let strip = material.areal_density * LENGTH * spacing * (ROWS - 1) as f32;
    let expected = sag(
        f64::from((mass + strip / 2.0) * GRAVITY),
        f64::from(LENGTH) / 2.0,
        reach,
        f64::from(compliance) / width,
    );
    [reach - last.iter().sum::<f64>() / 128.0, expected]
}

/// Every second of these masses (kg), from the first or the second on; all of them where tests run at their full length.
fn in_turn(masses: [f32; 4], first: usize) -> impl Iterator<Item = f32> {
    let (first, step) = if is_long() { (0, 1) } else { (first, 2) };
    masses.into_iter().skip(first).step_by(step)
}

/// A roller of 2 to 220 times the mass of the strip that it lies across sags it as deep as its weight says: within 4 %, as what keeps its
/// equations soluble gives by some thousandths, which the sag shows some ten times as large.
#[test]
fn a_roller_sags_a_strip_as_its_weight_says() {
    for (index, compliance) in [1.0e-5, 1.0e-4].into_iter().enumerate() {
        for mass in in_turn([0.1, 0.5, 2.0, 10.0], index) {
            let [is, expected] = sag_of_strip(mass, compliance, 20);
            println!("{mass} kg, {compliance} m/N: {is:.4} m of {expected:.4}");
            let off = (is / expected - 1.0).abs();
            assert!(off < 0.04, "{mass} kg, {compliance} m/N: off by {off}");
        }
    }
}

/// Dropped from 0.2 m onto a square metre of cotton, 150 g, a ball of up to 70 kg is held, and ball and cloth never have more energy than
/// the ball began with: for 8 s, or 15 where tests run at their full length.
#[test]
fn a_heavy_ball_is_held_and_gains_nothing() {
    let narrow_phases = [NarrowPhase::Particles, NarrowPhase::Triangles];
    let seconds = if is_long() { 15 } else { 8 };
    for (index, narrow_phase) in narrow_phases.into_iter().enumerate() {
        for mass in in_turn([1.0, 5.0, 20.0, 70.0], index) {
            let mut app = app_with_bodies();
            let sheet = spawn_trampoline(&mut app, 33);
            app.world_mut().entity_mut(sheet).insert(narrow_phase);
            let radius = 0.15;
            let above = Vec3::new(0.02, radius + 0.2, 0.01);
            let ball = spawn_ball(&mut app, mass, radius, above);
            let start = f64::from(mass * GRAVITY * above.y);
            let (mut most, mut lowest) = (f64::MIN, f32::MAX);
            for _ in 0..seconds * 64 {
                tick(&mut app, 1);
                let (place, velocity) = (place(&app, ball), velocity(&app, ball));
                let speed = f64::from(velocity.length_squared());
                let energy = f64::from(mass) * (speed / 2.0 + f64::from(GRAVITY * place.y));
                most = most.max(energy + cloth_energy(&app, sheet));
                lowest = lowest.min(place.y);
            }
            let at = place(&app, ball);
            println!(
                "{narrow_phase:?}, {mass} kg: lowest {lowest:.3} m, at {at}, {:.4} of its energy",
                most / start
            );
            assert!(
                most < start,
                "{narrow_phase:?}, {mass} kg: {most} J of {start}"
            );
            // The cloth gives by a third of a metre at most.
            assert!(
                lowest > -0.35 && at.y < radius,
                "{narrow_phase:?}, {mass} kg: {at}"
            );
        }
    }
}

/// A ball of 0.2 kg rests in a canvas that hangs by its corners for a minute.
#[test]
fn a_ball_rests_in_a_hammock() {
    let mut app = app_with_bodies();
    let corners = [
        Corner::TopLeft,
        Corner::TopRight,
        Corner::BottomLeft,
        Corner::BottomRight,
    ];
    let corners = Pins::new(corners.map(Pin::Corner));
    let sheet = Cloth::new(25, 25, 0.05).centred();
    let sheet = (sheet, corners, ClothMaterial::CANVAS, flat(0.0, 0.0, 0.0));
    app.world_mut().spawn(sheet);
    let (mass, radius) = (0.2, 0.12);
    let ball = spawn_ball(&mut app, mass, radius, Vec3::new(0.02, radius + 0.05, 0.01));
    tick(&mut app, 50 * 64);
    let (mut low, mut high) = (Vec3::MAX, Vec3::MIN);
    for _ in 0..10 * 64 {
        tick(&mut app, 1);
        let at = place(&app, ball);
        (low, high) = (low.min(at), high.max(at));
    }
    println!("from {low} to {high}");
    assert!((high - low).length() < 5.0e-3, "from {low} to {high}");
}

/// A sheet that hangs by its edges, of a friction, and a ball of a mass (kg) that does not turn, right on it.
fn ball_on_taut_sheet(friction: f32, mass: f32, gravity: f32) -> (App, [Entity; 2]) {
    let mut app = app_with_bodies();
    app.insert_resource(ClothGravity(Vec3::NEG_Y * gravity));
    let material = ClothMaterial {
        friction,
        ..ClothMaterial::COTTON
    };
    let edge = |row: u32, column: u32| row == 0 || column == 0 || row == 32 || column == 32;
    let sheet = Cloth::new(33, 33, 1.0 / 32.0).lying().centred();
    let sheet = (sheet, Pins::filter(edge), material);
    let sheet = app.world_mut().spawn(sheet).id();
    let ball = spawn_ball(&mut app, mass, 0.15, Vec3::new(-0.1, 0.162, 0.0));
    change::<ClothBody>(&mut app, ball, |body| body.locked_rotation = BVec3::TRUE);
    change::<Body>(&mut app, ball, |body| body.gravity = gravity);
    (app, [sheet, ball])
}

/// Without friction particles slip aside from under what lies on them, were they not held; the ball stays on them.
#[test]
fn a_ball_lies_on_a_sheet_without_friction() {
    for mass in [0.05, 0.5, 5.0] {
        let (mut app, [_, ball]) = ball_on_taut_sheet(0.0, mass, GRAVITY);
        tick(&mut app, 5 * 64);
        let at = place(&app, ball);
        let from_start = at.distance(Vec3::new(-0.1, 0.15, 0.0));
        assert!(from_start < 0.15, "{mass} kg: {at}");
    }
}

/// A ball that is kicked off a sheet leaves it behind, and is not slowed down: cloth pushes, and never pulls.
#[test]
fn what_leaves_cloth_does_not_take_it_along() {
    for mass in [0.5_f32, 20.0] {
        let (mut app, [sheet, ball]) = ball_on_taut_sheet(0.4, mass, 0.0);
        // So slowly that the sheet does not throw it back by itself.
        change::<Body>(&mut app, ball, |body| body.velocity.y = -0.02);
        tick(&mut app, 12);
        let kick = 5.0;
        change::<Body>(&mut app, ball, |body| body.velocity.y = kick);
        tick(&mut app, 1);
        let is = velocity(&app, ball).y;
        assert!(is > kick - 1.0e-3, "{mass} kg: {is} m/s");
        let sheet = particles(&app, sheet);
        let speed = |index: usize| sheet.velocity(index).expect("it exists").y;
        let fastest = (0..sheet.len()).map(speed).fold(0.0_f32, f32::max);
        println!("{mass} kg: {is} m/s, cloth {fastest} m/s");
        assert!(fastest < 0.5 * kick, "{mass} kg: cloth {fastest} m/s");
    }
}
