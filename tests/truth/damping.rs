//! Damping along springs: a Kelvin-Voigt solid's, and no other.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface, TriangleMesh},
    solver::{DampingFrame, Solver, TickStep, TimeOrder},
};
use examples_shared::sheet::{Sheet, threads};

use crate::meshes;

/// Time in which a stretch dies away (s).
const RETARDATION: f32 = 2.0e-3;

/// Compliance of threads (m/N): one cell of 1 m and 0.15 kg bounces on two of them with ω² = 2 · 500/0.075, ω = 115/s.
const COMPLIANCE: f32 = 1.0e-3;

/// How far the lower row of one cell that hangs by its upper row swings out after three bounces, as a part of the first 1 mm.
fn left(material: ClothMaterial, substeps: u32) -> f64 {
    let step = TickStep {
        substeps,
        ..TickStep::default()
    };
    let place = |row: u32, column: u32| Vec3::new(column as f32, -1.001 * row as f32, 0.0);
    let mut sheet = Sheet::new((2, 2), 1.0, material, step, place, |row, _| row == 0);
    sheet.step.acceleration = Vec3::ZERO;
    // The farthest on each side, one after the other.
    let (mut farthest, mut sides) = (vec![1.0e-3_f64], 1.0_f64);
    for _ in 0..64 {
        sheet.tick(|particles, _| {
            let y = particles.position((1, 0)).expect("it exists").y;
            let longer = f64::from(-1.0 - y);
            if longer * sides < 0.0 {
                sides = -sides;
                farthest.push(0.0);
            }
            let last = farthest.last_mut().expect("the first");
            *last = last.max(longer.abs());
        });
    }
    farthest[6] / farthest[0]
}

/// With ζ = τ ω/2 = 0.115 of the critical damping a bounce is left with `exp(−2π ζ/√(1 − ζ²))` of itself, after three of them with
/// 0.112; of that a first-order damping term in sub-steps of 1/10,240 s, ω Δt = 0.011, is off by some ω Δt/2 of its exponent, 1.2 %.
/// Without damping along springs it bounces for ever, but for the solver's own part of (ω Δt)³ a sub-step.
#[test]
fn a_bounce_dies_away_as_that_of_a_kelvin_voigt_solid() {
    let undamped = threads(COMPLIANCE, f32::INFINITY);
    let damped = ClothMaterial {
        stretch_damping: RETARDATION,
        ..undamped
    };
    let omega = (2.0 * 500.0 / 0.075_f64).sqrt();
    let zeta = 0.5 * f64::from(RETARDATION) * omega;
    let truth = (-6.0 * std::f64::consts::PI * zeta / (1.0 - zeta * zeta).sqrt()).exp();
    let [found, without] = [left(damped, 160), left(undamped, 40)];
    println!("damped: {found:.4} of a bounce left, truly {truth:.4}; undamped {without:.4}");
    assert!(
        (found.ln() / truth.ln() - 1.0).abs() < 0.03,
        "{found} {truth}"
    );
    assert!(without > 0.99, "{without}");
}

/// A grid of 9 × 9.
fn grid() -> Surface {
    let grid = Cloth::new(9, 9, 0.1).grid(Vec3::ONE);
    Surface::of_grid(&grid.expect("a valid grid"))
}

/// The surface of a mesh.
fn mesh(mesh: &TriangleMesh) -> Surface {
    Surface::of_mesh(mesh, 1.0e-5, Vec3::ONE).expect("a surface")
}

/// A cloth in free flight, with its lengths times `stretched`.
fn flying(surface: &Surface, stretched: f32, stretch_damping: f32) -> (ClothParticles, Solver) {
    let material = ClothMaterial {
        stretch_damping,
        ..threads(COMPLIANCE, 2.0 * COMPLIANCE)
    };
    let mut particles = ClothParticles::at_rest(surface, &material).expect("a valid material");
    for index in 0..particles.len() {
        let place = particles.position(index).expect("it exists");
        particles
            .set_position(index, stretched * place)
            .and_then(|()| particles.set_velocity(index, Vec3::new(1.0, 2.0, -0.5)))
            .expect("it exists");
    }
    let springs = Springs::of_surface(surface, &material);
    let mut solver = Solver::of_surface(surface, &springs);
    solver.set_stretch_damping(stretch_damping);
    (particles, solver)
}

/// It takes what stretches, not what flies: after half a second nothing bounces any more, and the cloth is as fast as it was.
#[test]
fn it_takes_no_momentum() {
    for surface in [grid(), mesh(&meshes::irregular(0.8, 0.8, 0.1, 0.3))] {
        let bouncing = |stretch_damping: f32| {
            let (mut particles, mut solver) = flying(&surface, 1.05, stretch_damping);
            let masses: Vec<f32> = particles.inverse_masses().map(f32::recip).collect();
            for _ in 0..32 {
                solver.advance(&mut particles, TickStep::default(), &[], |_, _| false);
            }
            let velocity = |at| particles.velocity(at).expect("it exists");
            let all: f32 = masses.iter().sum();
            let momentum: Vec3 = (0..masses.len()).map(|at| masses[at] * velocity(at)).sum();
            let mean = momentum / all;
            let apart = mean.distance(Vec3::new(1.0, 2.0, -0.5));
            assert!(apart < 1.0e-4, "{surface}: {mean}");
            let each = (0..masses.len()).map(|at| masses[at] * velocity(at).distance_squared(mean));
            (each.sum::<f32>() / all).sqrt()
        };
        let [damped, undamped] = [RETARDATION, 0.0].map(bouncing);
        println!("{surface}: {damped:.1e} m/s of bounce left, {undamped:.1e} m/s without");
        assert!(
            damped < 0.05 * undamped && damped < 0.02,
            "{damped} {undamped}"
        );
    }
}

/// What a cloth is damped against is not slowed down: all that flies evenly with it goes on, to five roundings in each of 640 sub-steps, 2⁻²⁴ of
/// the velocity each, and so does what falls while it is damped against its centre of mass. In each order, pushed by forces or solved; even
/// where all is lost that can be.
#[test]
fn what_carries_a_cloth_takes_nothing_from_it() {
    let (velocity, gravity) = (Vec3::new(7.0, -2.0, 3.0), Vec3::new(1.0, -9.81, 0.5));
    for damping in [0.02, 0.5, 1.0] {
        for (order, compliance) in [
            (TimeOrder::First, 1.0e-5),
            (TimeOrder::Second, 1.0e-5),
            (TimeOrder::Second, COMPLIANCE),
        ] {
            for (damped_against, acceleration) in [
                (DampingFrame::Moving(velocity), Vec3::ZERO),
                (DampingFrame::CentreOfMass, Vec3::ZERO),
                (DampingFrame::CentreOfMass, gravity),
            ] {
                let step = TickStep {
                    substeps: 20,
                    damping,
                    damped_against,
                    order,
                    ..TickStep::default()
                };
                let place =
                    |row: u32, column: u32| Vec3::new(column as f32, -(row as f32), 0.0) * 0.1;
                let material = threads(compliance, 2.0 * compliance);
                let mut sheet = Sheet::new((5, 5), 0.1, material, step, place, |_, _| false);
                (sheet.step.acceleration, sheet.step.damping) = (acceleration, damping);
                (0..25).for_each(|index: usize| {
                    let known = sheet.particles.set_velocity(index, velocity);
                    known.expect("it exists");
                });
                for _ in 0..32 {
                    sheet.tick(|_, _| {});
                }
                let expected = velocity + 0.5 * acceleration;
                for index in 0..25_usize {
                    let found = sheet.particles.velocity(index).expect("it exists");
                    let off = found.distance(expected);
                    let context = format!("{damping} {order:?} {compliance} {damped_against:?}");
                    assert!(
                        off < 2.0e-4 * expected.length(),
                        "{context}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// And what moves otherwise comes to go along: the part (1 − D)^(60 t) of its velocity relative to that is left. Of second order
/// within 1 %, by half a sub-step of the loss.
#[test]
fn what_moves_otherwise_comes_to_go_along() {
    let (damping, carrier) = (0.02_f32, Vec3::X * 5.0);
    for compliance in [1.0e-5, COMPLIANCE] {
        let step = TickStep {
            damping,
            damped_against: DampingFrame::Moving(carrier),
            ..TickStep::default()
        };
        let place = |row: u32, column: u32| Vec3::new(column as f32, -(row as f32), 0.0) * 0.1;
        let material = threads(compliance, 2.0 * compliance);
        let mut sheet = Sheet::new((5, 5), 0.1, material, step, place, |_, _| false);
        (sheet.step.acceleration, sheet.step.damping) = (Vec3::ZERO, damping);
        for _ in 0..32 {
            sheet.tick(|_, _| {});
        }
        let left = carrier * (1.0 - (1.0 - damping).powf(30.0));
        let found = sheet.particles.velocity(12).expect("it exists");
        assert!(
            found.distance(left) < 0.01 * left.length(),
            "{found} {left}"
        );
    }
}

/// A cloth that spins freely is stretched by its own rotation, and by nothing else: with ten times the damping it is as large.
///
/// If turning counted as stretching, damping of τ would make it smaller by `ω² τ Δt/2`, which is 3.5·10⁻⁴ more for the larger τ. A third
/// of that is allowed: springs are solved one after the other, and those solved last open those before.
#[test]
fn what_turns_is_not_damped() {
    const SPIN: f32 = 20.0;
    // A triangle has no chains.
    let triangle = TriangleMesh {
        positions: vec![Vec3::ZERO, 0.1 * Vec3::X, 0.1 * Vec3::Y],
        triangles: vec![[0, 1, 2]],
        ..TriangleMesh::default()
    };
    for surface in [grid(), mesh(&meshes::regular(9, 9, 0.1)), mesh(&triangle)] {
        let size = |stretch_damping: f32| {
            let (mut particles, mut solver) = flying(&surface, 1.0, stretch_damping);
            let positions: Vec<Vec3> = particles.positions().collect();
            let middle = positions.iter().sum::<Vec3>() / positions.len() as f32;
            for (index, place) in positions.iter().enumerate() {
                let velocity = SPIN * Vec3::Z.cross(*place - middle);
                particles.set_velocity(index, velocity).expect("it exists");
            }
            let step = TickStep {
                substeps: 80,
                ..TickStep::default()
            };
            for _ in 0..96 {
                solver.advance(&mut particles, step, &[], |_, _| false);
            }
            let middle = particles.positions().sum::<Vec3>() / particles.len() as f32;
            let squares = particles.positions().map(|at| at.distance_squared(middle));
            (squares.sum::<f32>() / particles.len() as f32).sqrt()
        };
        let [more, less] = [1.0e-2, 1.0e-3].map(size);
        println!("{surface}: {more} m with more damping, {less} with less");
        assert!((more / less - 1.0).abs() < 1.17e-4, "{more} {less}");
    }
}
