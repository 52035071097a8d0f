//! With which power of the sub-step errors fall.

use bevy_drape::solver::TickStep;
use examples_shared::smooth::Smooth;

/// Below this, rounding counts (m).
const ROUNDING: f64 = 4.0e-6;

/// Slope of ln error over ln sub-step, by least squares.
fn order(motion: &Smooth) -> f64 {
    let (reference, apart) = motion.reference();
    println!(
        "{}: the reference is {:.1e} m from half as many steps",
        motion.name, apart
    );
    assert!(apart < ROUNDING, "{}: {apart}", motion.name);
    let mut points = Vec::new();
    for substeps in motion.substeps {
        let step = TickStep {
            substeps,
            ..TickStep::default()
        };
        let error = motion.error(step, false, &reference).expect("threads");
        println!(
            "{}, {substeps} sub-steps: {:.4} mm",
            motion.name,
            1.0e3 * error
        );
        if error > ROUNDING {
            points.push([-f64::from(substeps).ln(), error.ln()]);
        }
    }
    assert!(points.len() > 2, "{points:?}");
    let mean = |axis: usize| points.iter().map(|at| at[axis]).sum::<f64>() / points.len() as f64;
    let middle = [mean(0), mean(1)];
    let (mut across, mut both) = (0.0, 0.0);
    for point in points {
        across += (point[0] - middle[0]).powi(2);
        both += (point[0] - middle[0]) * (point[1] - middle[1]);
    }
    println!("{}: order {:.2}", motion.name, both / across);
    both / across
}

/// Half of the sub-step, a quarter of the error where one direction of threads moves. In a fall of soft cloth rows, columns and
/// diagonals pull at the same time and are solved one after the other: what each leaves to the next falls with the sub-step
/// alone, and is all that is left of the error.
#[test]
fn errors_fall_with_the_square_of_the_sub_step() {
    let orders: Vec<(&str, f64)> = Smooth::ALL
        .iter()
        .map(|motion| (motion.name, order(motion)))
        .collect();
    for (name, order) in &orders {
        let least = if name.starts_with("fall") { 0.9 } else { 1.7 };
        assert!(*order >= least, "{name}: {orders:?}");
    }
}
