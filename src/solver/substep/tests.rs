//! Ticks of sub-steps: free fall, damping, momentum, pins.

use bevy::math::Vec3;

use super::*;
use crate::{
    cloth::{Cloth, ClothMaterial, DensityFactors, Pins, Spring, SpringKind, Surface},
    solver::step::TimeOrder,
};

/// Beyond the end there is nothing to move, in the last block's unused lanes neither.
#[test]
fn a_pin_beyond_the_particles_moves_nothing() {
    let (mut particles, springs) = cloth(&ClothMaterial::COTTON, &Pins::top_row());
    let mut expected = particles.clone();
    let beyond = [30, 31, 1000, u32::MAX].map(|particle| PinMotion {
        particle,
        from: Vec3::ZERO,
        to: Vec3::splat(5.0),
    });
    advance(&mut particles, &springs, TickStep::default(), &beyond);
    advance(&mut expected, &springs, TickStep::default(), &[]);
    assert_eq!(particles, expected);
}

#[test]
#[should_panic(expected = "springs between particles that exist")]
fn springs_beyond_the_particles_are_refused_at_once() {
    let spring = Spring {
        kind: SpringKind::Structural,
        ends: [3, 9],
        rest_length: 1.0,
        compliance: 0.0,
    };
    let springs = Springs::of_list(&[spring], 10).expect("ten particles");
    let particles = ClothParticles::new(&[Vec3::ZERO; 5], &[1.0; 5]).expect("five particles");
    let _ = Solver::new(&springs, &particles);
}

/// Without responses.
fn advance(particles: &mut ClothParticles, springs: &Springs, step: TickStep, pins: &[PinMotion]) {
    Solver::new(springs, particles).advance(particles, step, pins, |_, _| false);
}

fn cloth(material: &ClothMaterial, pins: &Pins) -> (ClothParticles, Springs) {
    let grid = Cloth::new(6, 5, 0.1).grid(Vec3::ONE).expect("a valid grid");
    let surface = Surface::of_grid(&grid);
    let mut particles = ClothParticles::at_rest(&surface, material).expect("a valid material");
    particles
        .assign_masses(&surface, material, &DensityFactors::default(), pins)
        .expect("valid pins");
    (particles, Springs::of_grid(&grid, material))
}

/// Free fall. Of first order by the discrete formula: after n sub-steps a particle has fallen g Δt² n(n + 1)/2, which is
/// ½ g t² + ½ g t Δt. Of second order by ½ g t² itself, but for what the three sub-steps of first order do that follow on
/// masses being given: 3/2 g Δt². The rounding of n additions to a height of h is below n ε h.
#[test]
fn falls_by_the_discrete_formula() {
    let (time, dt, substeps) = (1.0_f32, 1.0 / 1280.0, 1280.0);
    for (order, expected, allowed) in [
        (TimeOrder::First, 0.5 * 9.81 * time * (time + dt), 0.0),
        (
            TimeOrder::Second,
            0.5 * 9.81 * time * time,
            1.5 * 9.81 * dt * dt,
        ),
    ] {
        let (mut particles, springs) = cloth(&ClothMaterial::COTTON, &Pins::none());
        let start = particles.position(7).expect("it exists");
        let step = TickStep {
            acceleration: Vec3::new(0.0, -9.81, 0.0),
            order,
            ..Default::default()
        };
        let mut solver = Solver::new(&springs, &particles);
        for _ in 0..64 {
            solver.advance(&mut particles, step, &[], |_, _| false);
        }
        let fallen = start.y - particles.position(7).expect("it exists").y;
        let allowed = allowed + substeps * f32::EPSILON * expected;
        assert!(
            (fallen - expected).abs() < allowed,
            "{order:?}: {fallen} {expected} ± {allowed}"
        );
    }
}

/// D is lost in each 1/60 s, whatever the sub-steps: after 1 s of a free flight the velocity is
/// (1 − D)⁶⁰ of what it was.
#[test]
fn damping_is_the_same_under_any_substeps() {
    for substeps in [1, 7, 40] {
        let (mut particles, springs) = cloth(&ClothMaterial::COTTON, &Pins::none());
        for index in 0..particles.len() {
            particles.set_velocity(index, Vec3::X).expect("it exists");
        }
        let step = TickStep {
            substeps,
            damping: 0.02,
            ..Default::default()
        };
        for _ in 0..64 {
            advance(&mut particles, &springs, step, &[]);
        }
        let velocity = particles.velocity(3).expect("it exists").x;
        let expected = 0.98_f32.powi(60);
        assert!(
            (velocity / expected - 1.0).abs() < 1e-3,
            "{substeps}: {velocity} {expected}"
        );
    }
}

/// Inner forces come in pairs: the centre of mass of a free cloth, crumpled and shaken, stays where it is
/// up to the rounding of each move, half an ε of a position below 1 m; 1280 × some 100 springs of moves in
/// all, whose roundings add up as a random walk: √128,000 × 6e-8 m ≈ 2e-5 m.
#[test]
fn a_free_cloth_keeps_its_centre_of_mass() {
    let (mut particles, springs) = cloth(&ClothMaterial::COTTON, &Pins::none());
    for index in 0..particles.len() {
        let phase = index as f32;
        let crumpled = Vec3::new(phase.sin(), (1.7 * phase).cos(), (0.3 * phase).sin()) * 0.2;
        particles.set_position(index, crumpled).expect("it exists");
    }
    let centre = |particles: &ClothParticles| {
        let masses = particles.inverse_masses().map(f32::recip);
        let total: f32 = particles.inverse_masses().map(f32::recip).sum();
        particles
            .positions()
            .zip(masses)
            .map(|(p, m)| p * m)
            .sum::<Vec3>()
            / total
    };
    let before = centre(&particles);
    for _ in 0..64 {
        advance(&mut particles, &springs, TickStep::default(), &[]);
    }
    let drift = centre(&particles).distance(before);
    assert!(drift < 2e-5, "{drift}");
}

#[test]
fn pins_are_exact_and_follow_their_motion() {
    let (mut particles, springs) = cloth(&ClothMaterial::SILK, &Pins::top_row());
    let before: Vec<Vec3> = particles.positions().take(6).collect();
    particles
        .set_velocity(2, Vec3::splat(9.0))
        .expect("it exists");
    let step = TickStep {
        acceleration: Vec3::new(3.0, -9.81, 5.0),
        ..Default::default()
    };
    for _ in 0..64 {
        advance(&mut particles, &springs, step, &[]);
    }
    assert_eq!(particles.positions().take(6).collect::<Vec<_>>(), before);

    let motion = PinMotion {
        particle: 2,
        from: before[2],
        to: before[2] + Vec3::Z,
    };
    let mut path = Vec::new();
    let mut solver = Solver::new(&springs, &particles);
    solver.advance(&mut particles, step, &[motion], |particles, substep| {
        path.push((substep.end(), particles.position(2).expect("it exists").z));
        false
    });
    assert_eq!(path.len(), 20);
    assert!(
        path.iter().all(|(end, z)| (end - z).abs() < 1e-6),
        "{path:?}"
    );
}

#[test]
fn coincident_and_pinned_ends_do_no_harm() {
    let rigid = ClothMaterial {
        stretch_compliance: 0.0,
        shear_compliance: 0.0,
        ..ClothMaterial::COTTON
    };
    let (mut particles, springs) = cloth(&rigid, &Pins::filter(|row, _| row < 2));
    for index in 12..particles.len() {
        particles
            .set_position(index, Vec3::ZERO)
            .expect("it exists");
    }
    for seconds in [1.0 / 64.0, 1.0, 100.0] {
        let step = TickStep {
            seconds,
            acceleration: Vec3::NEG_Y,
            ..Default::default()
        };
        for _ in 0..64 {
            advance(&mut particles, &springs, step, &[]);
        }
        assert_eq!(particles.validate(), Ok(()), "{seconds} s a tick");
    }
}
