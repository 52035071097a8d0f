//! How much of a cloth is inside, against closed forms.

use std::f32::consts::PI;

use bevy::math::{Quat, Vec3};

use super::{ONLY, all_of, at, build};
use crate::contact::{
    candidates::{ContactSettings, NarrowPhase},
    colliders::{ColliderShape, MovingCollider},
};

/// A flat grid of 2 m, 101 × 101, cut by a ball at height h: a disc of radius a = √(R² − h²), whose particles stand
/// for its area to a ring of half a spacing around its edge; they are as deep as the ball there, 0 at the edge, so
/// the volume's error is that ring times the depth half a spacing inside of it, at most R/a × spacing/2.
#[test]
fn a_ball_cuts_a_disc() {
    let spacing = 0.02;
    for (radius, height) in [(0.5_f32, 0.05_f32), (0.5, 0.1), (0.5, -0.3), (0.8, 0.45)] {
        let (surface, mut particles) = build(101, 101, spacing);
        let centre = Vec3::new(1.003, -0.996, height);
        let ball = MovingCollider::ball(radius, centre, centre);
        let settings = ContactSettings {
            narrow_phase: NarrowPhase::Particles,
            ..ContactSettings::default()
        };
        let mut detection = all_of(std::slice::from_ref(&ball), &settings, &surface, &particles);
        detection.respond(&mut particles, &settings, ONLY, |_| {});
        let touch = &detection.touches()[0];
        let (h, a) = (height.abs(), (radius * radius - height * height).sqrt());
        let area = PI * a * a;
        let volume = PI * radius * a * a - 2.0 / 3.0 * PI * (radius.powi(3) - h.powi(3));
        let ring = 2.0 * PI * a * spacing / 2.0;
        assert!((touch.area - area).abs() < ring, "{} {area}", touch.area);
        let error = ring * radius / a * spacing / 2.0;
        assert!(
            (touch.volume - volume).abs() < error,
            "{} {volume}",
            touch.volume
        );
        assert!((touch.deepest - (radius - h)).abs() < radius / a * spacing);
    }
}

/// A disc inside of a single triangle, by the triangle: its area to some roundings, and a volume of half of the height
/// all over it, as that of a paraboloid. The cap's own, π h² (R − h/3), is the disc of a² = h (2R − h) times
/// h (R − h/3) / (2R − h): from a half to two thirds of the height.
#[test]
fn a_small_ball_cuts_a_disc_out_of_a_triangle() {
    for height in [0.0_f32, 0.05, -0.12, 0.19] {
        let (surface, mut particles) = build(2, 2, 1.0);
        let centre = Vec3::new(0.25, -0.3, height);
        let ball = MovingCollider::ball(0.2, centre, centre);
        let settings = ContactSettings {
            narrow_phase: NarrowPhase::Triangles,
            ..ContactSettings::default()
        };
        let mut detection = all_of(std::slice::from_ref(&ball), &settings, &surface, &particles);
        detection.respond(&mut particles, &settings, ONLY, |_| {});
        let touch = &detection.touches()[0];
        let area = PI * (0.04 - height * height);
        assert!((touch.area - area).abs() < 1e-6, "{} {area}", touch.area);
        let cap = 0.2 - height.abs();
        let exact =
            PI * 0.2 * (0.04 - height * height) - 2.0 / 3.0 * PI * (0.008 - height.abs().powi(3));
        assert!((touch.volume - area * cap / 2.0).abs() < 1e-6);
        let ratio = touch.volume / exact;
        assert!(ratio < 1.51 && ratio > 0.99, "{ratio}");
    }
}

/// All of a flat cloth below a plane: its area, times the depth, to the rounding of 10⁴ sums, √10⁴ × 6e-8 on average
/// and below 10⁴ × 6e-8 for sure.
#[test]
fn a_half_space_holds_area_times_depth() {
    let (surface, mut particles) = build(101, 101, 0.02);
    let pose = bevy::math::Isometry3d {
        rotation: Quat::from_rotation_arc(Vec3::Y, Vec3::Z),
        ..at(Vec3::Z * 0.3)
    };
    let plane = MovingCollider::still(ColliderShape::HalfSpace, pose);
    let settings = ContactSettings {
        particle_radius: 0.05,
        ..ContactSettings::default()
    };
    let mut detection = all_of(
        std::slice::from_ref(&plane),
        &settings,
        &surface,
        &particles,
    );
    detection.respond(&mut particles, &settings, ONLY, |_| {});
    let touch = &detection.touches()[0];
    assert!((touch.area - 4.0).abs() < 4.0 * 6e-4, "{}", touch.area);
    assert!(
        (touch.volume - 4.0 * 0.35).abs() < 1.4 * 6e-4,
        "{}",
        touch.volume
    );
    assert!((touch.deepest - 0.35).abs() < 1e-6, "{}", touch.deepest);
}
