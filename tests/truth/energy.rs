//! What is conserved: the period of a pendulum, energy, momentum.

use bevy::math::{DVec3, Vec3};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Solver, TickStep},
};

use crate::scene::{GRAVITY, Scene};

/// A cloth of one cell, hung by its top row, is a pendulum: T = 2π √(L/g) (1 + φ²/16) for a small amplitude φ. The
/// discrete motion is off by (ω Δt)²/24 of that, 10⁻⁶ here. Zero crossings are interpolated in a sub-step's
/// motion and averaged over ten periods, and damping is none; 10⁻⁴ leaves room for the rounding of positions
/// (6·10⁻⁸ m of 5 cm at each end).
#[test]
fn a_pendulum_has_its_period() {
    let (length, amplitude) = (1.0_f32, 0.05_f32);
    let material = ClothMaterial {
        stretch_compliance: 0.0,
        shear_compliance: 0.0,
        bend_rigidity: 0.0,
        damping: 0.0,
        ..ClothMaterial::COTTON
    };
    let grid = Cloth::new(2, 2, length)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let mut particles =
        ClothParticles::at_rest(&Surface::of_grid(&grid), &material).expect("a valid material");
    for column in 0..2 {
        let down = Vec3::new(0.0, -amplitude.cos(), amplitude.sin()) * length;
        let place = Vec3::X * column as f32 * length + down;
        particles
            .set_inverse_mass((0, column), 0.0)
            .and_then(|()| particles.set_position((1, column), place))
            .expect("it exists");
    }
    let springs = Springs::of_grid(&grid, &material);
    let mut solver = Solver::new(&springs, &particles);
    let step = TickStep {
        seconds: 1.0 / 1000.0,
        substeps: 1,
        acceleration: GRAVITY,
        damping: 0.0,
        ..TickStep::default()
    };
    let mut crossings = Vec::new();
    let mut before = amplitude * length;
    for tick in 1..=22_000_u32 {
        solver.advance(&mut particles, step, &[], |_, _| false);
        let z = particles.position((1, 0)).expect("it exists").z;
        if before.signum() != z.signum() {
            let part = f64::from(before) / (f64::from(before) - f64::from(z));
            crossings.push((f64::from(tick - 1) + part) / 1000.0);
        }
        before = z;
    }
    let period = (crossings[20] - crossings[0]) / 10.0;
    let small = std::f64::consts::TAU * (f64::from(length) / 9.81).sqrt();
    let exact = small * (1.0 + f64::from(amplitude).powi(2) / 16.0);
    println!("pendulum: {period} s, exact {exact} s");
    assert!((period / exact - 1.0).abs() < 1.0e-4, "{period} {exact}");
}

/// The energy of a state: kinetic, elastic and potential (J). Pins hold none.
fn energy(scene: &Scene, particles: &ClothParticles) -> f64 {
    let places: Vec<DVec3> = particles.positions().map(Vec3::as_dvec3).collect();
    let mut energy = 0.0;
    for (index, place) in places.iter().enumerate() {
        let velocity = particles.velocity(index).expect("it exists").as_dvec3();
        let inverse_mass = f64::from(particles.inverse_mass(index).expect("it exists"));
        if inverse_mass > 0.0 {
            let height = -GRAVITY.as_dvec3().dot(*place);
            energy += (0.5 * velocity.length_squared() + height) / inverse_mass;
        }
    }
    for spring in scene.springs.to_vec() {
        let [a, b] = spring.ends.map(|end| places[end as usize]);
        let extension = a.distance(b) - f64::from(spring.rest_length);
        energy += 0.5 * extension * extension / f64::from(spring.compliance);
    }
    energy
}

/// An undamped cloth swings for a minute. Energy is measured over the lowest that the cloth can have, hanging
/// still. A sweep is a backward Euler step for what is stiff, which takes energy from waves that a sub-step can't
/// resolve and gives none; velocities are those of half a sub-step before, which lets the sum waver by the part
/// g Δt/v of its kinetic part: 1 % at 20 sub-steps.
#[test]
fn an_undamped_swing_gains_no_energy() {
    for tethers in [false, true] {
        let scene = Scene::swinging(17, 2.0, 0.5, 1.0e-3).expect("a valid scene");
        let mut still = scene.particles.clone();
        let hanging = Scene::swinging(17, 2.0, 0.0, 1.0e-3).expect("a valid scene");
        still.clone_from(&hanging.particles);
        let mut solver = hanging.solver(false);
        let damped = TickStep {
            damping: 0.1,
            ..hanging.step(20)
        };
        for _ in 0..600 {
            solver.advance(&mut still, damped, &[], |_, _| false);
        }
        let floor = energy(&scene, &still);
        let start = energy(&scene, &scene.particles) - floor;
        let mut particles = scene.particles.clone();
        let mut solver = scene.solver(tethers);
        let (mut highest, mut at) = (0.0_f64, Vec::new());
        for frame in 1..=3600 {
            solver.advance(&mut particles, scene.step(20), &[], |_, _| false);
            let left = (energy(&scene, &particles) - floor) / start;
            highest = highest.max(left);
            if [60, 600, 3600].contains(&frame) {
                at.push(left);
            }
        }
        println!(
            "undamped swing, tethers {tethers}: {:.1} %, {:.1} %, {:.1} % of its energy left after 1, 10, 60 s; {:.2} % at most",
            100.0 * at[0],
            100.0 * at[1],
            100.0 * at[2],
            100.0 * highest
        );
        assert!(highest < 1.01, "{highest}");
        assert!(at[2] < at[0] && at[2] > 0.0, "{at:?}");
    }
}

/// Springs act in pairs: a free cloth, crumpled and shaken for a minute without gravity, keeps its momentum to the
/// rounding of displacements. A move of at most 1 cm is rounded to 6·10⁻¹⁰ m at either end; 20 × 3840 sweeps over 6
/// springs a particle add up as a random walk to √460,000 × 6·10⁻¹⁰ m = 4·10⁻⁷ m a sub-step for a particle, that is
/// 5·10⁻⁴ m/s, and over 144 particles' mean to a twelfth: 4·10⁻⁵ m/s.
#[test]
fn a_free_cloth_keeps_its_momentum() {
    let material = ClothMaterial {
        damping: 0.0,
        ..ClothMaterial::COTTON
    };
    let grid = Cloth::new(12, 12, 0.1)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let mut particles =
        ClothParticles::at_rest(&Surface::of_grid(&grid), &material).expect("a valid material");
    for index in 0..particles.len() {
        let phase = index as f32;
        let wave = Vec3::new(phase.sin(), (1.7 * phase).cos(), (0.3 * phase).sin());
        let position = particles.position(index).expect("it exists");
        particles
            .set_position(index, position + wave * 0.02)
            .and_then(|()| particles.set_velocity(index, Vec3::new(0.5, 0.2, -0.3) + wave))
            .expect("it exists");
    }
    let mean_velocity = |particles: &ClothParticles| {
        let (mut momentum, mut mass) = (DVec3::ZERO, 0.0);
        for index in 0..particles.len() {
            let own = 1.0 / f64::from(particles.inverse_mass(index).expect("it exists"));
            let velocity = particles.velocity(index).expect("it exists");
            momentum += velocity.as_dvec3() * own;
            mass += own;
        }
        momentum / mass
    };
    let before = mean_velocity(&particles);
    let springs = Springs::of_grid(&grid, &material);
    let mut solver = Solver::new(&springs, &particles);
    for _ in 0..64 * 60 {
        solver.advance(&mut particles, TickStep::default(), &[], |_, _| false);
    }
    let drift = mean_velocity(&particles).distance(before);
    println!(
        "momentum of a free cloth: off by {drift:e} m/s of {:.2} m/s after 60 s",
        before.length()
    );
    assert!(drift < 4.0e-5, "{drift}");
}
