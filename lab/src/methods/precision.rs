//! What single precision costs: the swinging cloth against f64.

use super::{GRAVITY, MassSpring, Method, Scene, Stepper};

/// The part of a second that the cloth swings, in ticks of 1/60 s.
const TICKS: u32 = 30;

/// The swing in f64, with the exact root.
fn in_f64(scene: &Scene, substeps: u32) -> MassSpring<f64> {
    let mut network = MassSpring::of_scene(scene).expect("a valid network");
    let method = Method::SmallSteps { substeps };
    let seconds = f64::from(scene.seconds);
    let mut stepper = Stepper::new(method, &network, seconds).expect("a valid method");
    for _ in 0..TICKS {
        stepper.step(&mut network, GRAVITY.as_dvec3().to_array(), 0.0);
    }
    network
}

/// RMS distance (m) of the library's own swing from another state.
fn ours(scene: &Scene, substeps: u32, truth: &MassSpring<f64>) -> f64 {
    let mut particles = scene.particles.clone();
    let mut solver = scene.solver(false);
    for _ in 0..TICKS {
        solver.advance(&mut particles, scene.step(substeps), &[], |_, _| false);
    }
    let squares = particles
        .positions()
        .zip(&truth.positions)
        .map(|(found, truth)| found.as_dvec3().distance_squared((*truth).into()));
    (squares.sum::<f64>() / particles.len() as f64).sqrt()
}

/// With the displacement stored as such, single precision costs nothing that counts: the error against a converged run is
/// below that of an f64 run of first order, and beyond 40 sub-steps it goes on falling instead of rising.
#[test]
fn single_precision_holds_up_to_320_sub_steps() {
    let scene = Scene::swinging(17, 2.0, 0.5, 1.0e-3).expect("a valid scene");
    let truth = in_f64(&scene, 2560);
    let mut at_40 = f64::INFINITY;
    for substeps in [5, 10, 20, 40, 80, 160, 320] {
        let exact = in_f64(&scene, substeps).rms_distance(&truth);
        let error = ours(&scene, substeps, &truth);
        println!(
            "swing, {substeps} sub-steps: {:.3} mm off, f64 {:.3} mm",
            1.0e3 * error,
            1.0e3 * exact
        );
        if substeps <= 40 {
            assert!(error < exact, "{substeps}: {error} {exact}");
            at_40 = error;
        } else {
            assert!(error < at_40, "{substeps}: {error} {at_40}");
        }
    }
}
