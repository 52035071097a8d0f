//! What every method must do. Tolerances are derived beside each test; the
//! numbers measured on x86-64 stand there too.

use super::{MassSpring, Method, MethodError, Real, Stepper, largest_frequency};
use bevy::math::Vec3;
use bevy_drape::cloth::{Spring, SpringKind};

/// m/s²
const GRAVITY: f64 = 9.81;
/// Width of every cloth, m.
const WIDTH: f32 = 2.0;
/// kg/m²
const AREAL_DENSITY: f32 = 0.15;
const EVERY_METHOD: [Method; 4] = [
    Method::Hooke,
    Method::PositionBased { iterations: 10 },
    Method::SmallSteps { substeps: 4 },
    Method::ProjectiveDynamics { iterations: 10 },
];

#[derive(Clone, Copy)]
enum Order {
    /// For each particle in reading order: right, down, down-right, down-left.
    Rows,
    /// Horizontal springs of even, then odd columns; vertical springs of even,
    /// then odd rows; each diagonal likewise. No two of a group share an end.
    Colours,
}

/// A square cloth of `side`² equal particles with structural and shear springs
/// at their rest length. `place` gives the position of a row and column.
fn cloth<R: Real>(
    side: u16,
    compliance: f32,
    order: Order,
    place: impl Fn(f32, f32) -> Vec3,
    pinned: impl Fn(u16, u16) -> bool,
) -> MassSpring<R> {
    let spacing = WIDTH / f32::from(side - 1);
    let index = |row, column| u32::from(row) * u32::from(side) + u32::from(column);
    let (mut positions, mut inverse_masses, mut springs) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..side {
        for column in 0..side {
            positions.push(place(f32::from(row) * spacing, f32::from(column) * spacing));
            let mass = AREAL_DENSITY * spacing * spacing;
            inverse_masses.push(if pinned(row, column) { 0.0 } else { 1.0 / mass });
            for (down, right, colour) in [
                (0, 1, column % 2),
                (1, 0, 2 + row % 2),
                (1, 1, 4 + row % 2),
                (1, -1, 6 + row % 2),
            ] {
                let (end_row, end_column) = (row + down, column.wrapping_add_signed(right));
                if end_row >= side || end_column >= side {
                    continue;
                }
                let diagonal = down != 0 && right != 0;
                let spring = Spring {
                    kind: if diagonal {
                        SpringKind::Shear
                    } else {
                        SpringKind::Structural
                    },
                    ends: [index(row, column), index(end_row, end_column)],
                    rest_length: if diagonal {
                        spacing.hypot(spacing)
                    } else {
                        spacing
                    },
                    compliance,
                };
                springs.push((colour, spring));
            }
        }
    }
    if let Order::Colours = order {
        springs.sort_by_key(|&(colour, _)| colour); // a stable sort
    }
    let springs: Vec<Spring> = springs.into_iter().map(|(_, spring)| spring).collect();
    MassSpring::new(&positions, &inverse_masses, &springs).expect("a valid cloth")
}

/// 9 × 9 particles, hung by the top row and turned about it by 0.5 rad.
fn hung<R: Real>() -> MassSpring<R> {
    let turned = |down: f32, x| Vec3::new(x, -down * 0.5_f32.cos(), down * 0.5_f32.sin());
    cloth(9, 1e-3, Order::Colours, turned, |row, _| row == 0)
}

/// A free, flat cloth.
fn free(side: u16) -> MassSpring<f64> {
    cloth(
        side,
        1e-3,
        Order::Colours,
        |y, x| Vec3::new(x, y, 0.0),
        |_, _| false,
    )
}

fn stepper<R: Real>(method: Method, state: &MassSpring<R>, seconds: f64) -> Stepper<R> {
    Stepper::new(method, state, seconds).expect("a method for this network")
}

/// `state` after `steps` undamped steps that together take `seconds`.
fn after<R: Real>(
    mut state: MassSpring<R>,
    method: Method,
    seconds: f64,
    steps: u32,
) -> MassSpring<R> {
    let mut stepper = stepper(method, &state, seconds / f64::from(steps));
    let acceleration = [0.0, -GRAVITY, 0.0].map(R::from_f64);
    for _ in 0..steps {
        stepper.step(&mut state, acceleration, R::from_f64(0.0));
    }
    state
}

/// All methods tend to one motion, to first order in their step h.
///
/// A first-order method is early or late by up to half a step, which displaces
/// a particle in free fall by h/2 g T. Backward Euler also damps: a mode ω that
/// the sudden load g excites has an amplitude up to g / ω² and loses the part
/// ω² h T / 2 of it, again h/2 g T; and modes are orthogonal. So the root mean
/// square error is below h g T, 3.0e-4 m for h = T/8192. A halving divides it by
/// 2 in the limit; by less while stiff modes are damped out within T, and by more
/// while a single iteration leaves an error of its own.
///
/// Measured, in 1e-5 m, at T/1024, T/2048, T/4096, T/8192:
/// - Hooke 35.8, 17.9, 8.9, 4.5
/// - position based, 10 sweeps: 61.0, 35.8, 19.6, 10.3
/// - small steps, 4 a step: 18.5, 10.0, 5.1, 2.5
/// - projective dynamics, 10 iterations: 61.0, 35.8, 19.6, 10.3
/// - projective dynamics, 1 iteration: 177.5, 62.0, 25.6, 11.6
#[test]
fn methods_converge_to_one_motion() {
    const SECONDS: f64 = 0.5;
    const BOUND: f64 = SECONDS / 8192.0 * GRAVITY * SECONDS;
    let reference = |substeps| after(hung::<f64>(), Method::SmallSteps { substeps }, SECONDS, 64);
    let mut substeps = 2048;
    let mut exact = reference(substeps);
    // To first order the change of a halving is the error that is left:
    // far below the 2.5e-5 m of the most accurate method.
    loop {
        substeps *= 2;
        let finer = reference(substeps);
        let change = finer.rms_distance(&exact);
        exact = finer;
        if change < 2e-6 {
            break;
        }
        assert!(
            substeps < 1 << 16,
            "the reference does not converge: {change}"
        );
    }
    let single = Method::ProjectiveDynamics { iterations: 1 };
    for method in EVERY_METHOD.into_iter().chain([single]) {
        let error = |steps| after(hung::<f64>(), method, SECONDS, steps).rms_distance(&exact);
        let errors = [1024, 2048, 4096, 8192].map(error);
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((1.6..3.0).contains(&ratio), "{method:?}: {errors:?}");
        }
        assert!(errors[3] < BOUND, "{method:?}: {errors:?}");
    }
}

/// The period of a pendulum is 2π √(L/g) times 1 + θ²/16 for the amplitude θ
/// and 1 + α m g / 2L for the stretched spring. Two errors are left to the step
/// h: 1 ± (ω h)²/3 (backward Euler; symplectic Euler has 1/24), and the amplitude
/// that backward Euler damps, θ² by the part ω² h T in a period T. Crossings of
/// the vertical are interpolated where the path has no curvature, which costs
/// less, and products of the corrections are below 1e-7.
///
/// Measured: at most 1.2e-6 of the period, with a tolerance of 6.4e-6.
#[test]
fn pendulum_has_its_period() {
    const ANGLE: f32 = 0.05;
    const MASS: f32 = 0.1;
    const COMPLIANCE: f32 = 1e-4;
    const STEP: f64 = 1e-3;
    let stretch = COMPLIANCE * MASS * 9.81;
    let bob = Vec3::new(ANGLE.sin(), -ANGLE.cos(), 0.0) * (1.0 + stretch);
    let spring = Spring {
        kind: SpringKind::Structural,
        ends: [0, 1],
        rest_length: 1.0,
        compliance: COMPLIANCE,
    };
    let start = MassSpring::<f64>::new(&[Vec3::ZERO, bob], &[0.0, 1.0 / MASS], &[spring])
        .expect("a valid pendulum");
    let frequency = GRAVITY.sqrt();
    let amplitude = f64::from(ANGLE).powi(2) / 16.0;
    let expected = (1.0 + amplitude + f64::from(stretch) / 2.0) * std::f64::consts::TAU / frequency;
    let tolerance =
        (frequency * STEP).powi(2) / 3.0 + amplitude * frequency * frequency * STEP * expected;
    for method in EVERY_METHOD {
        let mut state = start.clone();
        let mut stepper = stepper(method, &state, STEP);
        let (mut time, mut crossings) = (0.0, Vec::new());
        while crossings.len() < 3 && time < 10.0 {
            let before = state.positions[1][0];
            stepper.step(&mut state, [0.0, -GRAVITY, 0.0], 0.0);
            let now = state.positions[1][0];
            if before * now < 0.0 {
                crossings.push(time + STEP * before / (before - now));
            }
            time += STEP;
        }
        let period = crossings[2] - crossings[0];
        let error = period / expected - 1.0;
        assert!(
            error.abs() < tolerance,
            "{method:?}: {error}, not {tolerance}"
        );
    }
}

/// With steps h and no velocity at the start a mode moves as
/// cos((n + 1/2) φ) / cos(φ/2), where cos(φ/2) = √(1 - (ω h / 2)²): at 0.97 of
/// the limit no mode exceeds 1/√(1 - 0.97²) = 4.12 times its start (5 % are
/// left for what is not linear). At 1.03 the top mode grows by
/// (1.03 + √(1.03² - 1))² = 1.63 a step, by 3e8 in 40 steps, of which 1e3 is asked.
///
/// Measured: 1.5 below the limit, 5e9 above it, long past the linear regime.
#[test]
fn hooke_is_stable_up_to_its_limit() {
    let rest = free(9);
    let mut start = rest.clone();
    let mut seed = 1_u32;
    for position in &mut start.positions {
        for component in &mut position[..2] {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *component += 1e-5 * (f64::from(seed) / f64::from(u32::MAX) - 0.5);
        }
    }
    let limit = 2.0 / largest_frequency(&rest);
    // Masses are equal, so the plain root mean square is that of the modes.
    let growth = |part: f64, steps| {
        let mut state = start.clone();
        let mut stepper = stepper(Method::Hooke, &state, part * limit);
        let mut largest = 0.0_f64;
        for _ in 0..steps {
            stepper.step(&mut state, [0.0; 3], 0.0);
            largest = largest.max(state.rms_distance(&rest));
        }
        largest / start.rms_distance(&rest)
    };
    let (below, above) = (growth(0.97, 4000), growth(1.03, 40));
    assert!(below < 1.05 / (1.0_f64 - 0.97 * 0.97).sqrt(), "{below}");
    assert!(above > 1e3, "{above}");
}

/// The order of the springs decides what one sweep achieves on rigid springs.
/// No bound is derived for it: about half and double of what is measured at
/// n = 32 are asked.
///
/// Measured: largest structural stretch in the last of 3 s (1 is 100 %), rows
/// against colours, for n × n particles: n = 16: 0.030, 0.026; 24: 1.38, 0.065;
/// 32: 2.09, 0.14; 48: 3.20, 0.38; 64: 3e5 (it blows up), 0.72.
#[test]
fn sweeping_row_by_row_overstretches() {
    let last_second = |side: u16, order| {
        let corner = |row, column| row == 0 && (column == 0 || column == side - 1);
        let mut state = cloth::<f32>(side, 0.0, order, |z, x| Vec3::new(x, 0.0, z), corner);
        let mut stepper = stepper(Method::SmallSteps { substeps: 20 }, &state, 1.0 / 60.0);
        let damping = 1.0 - 0.99_f32.powf(1.0 / 60.0); // 1 % a second
        let mut worst = 0.0_f64;
        for frame in 0..180 {
            stepper.step(&mut state, [0.0, -9.81, 0.0], damping);
            if frame >= 120 {
                let stretch = state.largest_stretch();
                worst = if stretch.is_nan() {
                    f64::INFINITY
                } else {
                    worst.max(stretch)
                };
            }
        }
        worst
    };
    let (rows, colours) = (
        last_second(32, Order::Rows),
        last_second(32, Order::Colours),
    );
    assert!(rows > 1.0, "{rows}");
    assert!(colours < 0.3, "{colours}");
}

/// In `f32` a coordinate below 2 m rounds by at most 2^-24 × 2 m. A position
/// is written up to 1 + 8 × 10 times a step (8 springs a particle, 10 sweeps),
/// and where velocities are differences of positions each rounding stays as an
/// offset per step. With independent signs, N = 60 steps sum to
/// √(81 × N³ / 3) × 1.2e-7 m = 2.9e-4 m at most.
///
/// Measured: Hooke 2e-7, position based 2.7e-5, small steps 1.4e-6, projective
/// dynamics 2e-6 m; only position based takes the differences.
#[test]
fn precisions_agree() {
    let tolerance = f64::sqrt(81.0 * 60.0_f64.powi(3) / 3.0) * f64::from(f32::EPSILON);
    for method in EVERY_METHOD {
        let single = after(hung::<f32>(), method, 0.06, 60);
        let distance = single.rms_distance(&after(hung::<f64>(), method, 0.06, 60));
        assert!(
            distance > 0.0 && distance < tolerance,
            "{method:?}: {distance}"
        );
    }
}

/// Springs push both ends alike, so only rounding changes the momentum: by at
/// most half an ulp of 2 m, 2.2e-16 m, in each of 81 writes (see above) of 25
/// positions over 100 steps, times m / h; with independent signs the root of
/// their number counts, 3.7e-12 kg m/s. Twice that is allowed.
///
/// Measured: position based 6e-13, small steps 2e-15, the others 3e-16 kg m/s.
#[test]
fn free_network_keeps_its_momentum() {
    const STEP: f64 = 1e-3;
    let mut start = free(5);
    for (index, velocity) in (0_u16..).zip(&mut start.velocities) {
        let phase = f64::from(index);
        *velocity = [1.0 + phase.sin(), (2.0 * phase).cos(), (3.0 * phase).sin()];
    }
    let mass = 1.0 / start.inverse_mass[0];
    let momentum = |state: &MassSpring<f64>| {
        [0, 1, 2].map(|axis| state.velocities.iter().map(|v| mass * v[axis]).sum::<f64>())
    };
    let tolerance = 2.0 * f64::sqrt(100.0 * 25.0 * 81.0) * f64::EPSILON * mass / STEP;
    for method in EVERY_METHOD {
        let mut state = start.clone();
        let mut stepper = stepper(method, &state, STEP);
        for _ in 0..100 {
            stepper.step(&mut state, [0.0; 3], 0.0);
        }
        // The springs have worked: the velocities are others.
        assert!((state.velocities[0][0] - start.velocities[0][0]).abs() > 1e-3);
        for (now, before) in momentum(&state).into_iter().zip(momentum(&start)) {
            assert!(
                (now - before).abs() < tolerance,
                "{method:?}: {now} after {before}"
            );
        }
    }
}

/// 30 steps of 1/60 s keep (1 - D)^30, whatever the method cuts them into. The
/// powers and products round by a few ulp each.
#[test]
fn damping_is_per_sixtieth_of_a_second() {
    for method in EVERY_METHOD {
        let mut state = MassSpring::<f64>::new(&[Vec3::ZERO], &[1.0], &[]).expect("a particle");
        state.velocities[0] = [1.0, 0.0, 0.0];
        let mut stepper = stepper(method, &state, 1.0 / 60.0);
        for _ in 0..30 {
            stepper.step(&mut state, [0.0; 3], 0.02);
        }
        assert!(
            (state.velocities[0][0] - 0.98_f64.powi(30)).abs() < 1e-13,
            "{method:?}"
        );
    }
}

#[test]
fn what_cannot_be_stepped_is_refused() {
    let mut state = hung::<f32>();
    state.springs[7].compliance = 0.0;
    for method in [Method::Hooke, Method::ProjectiveDynamics { iterations: 1 }] {
        let error = Stepper::new(method, &state, 0.01).expect_err("a rigid spring");
        assert!(
            matches!(error, MethodError::RigidSpring { method: named, spring: 7, compliance: 0.0 } if named == method),
            "{error}"
        );
        assert!(
            error
                .to_string()
                .contains("spring 7 has the compliance 0 m/N"),
            "{error}"
        );
    }
    for (method, seconds) in [
        (Method::SmallSteps { substeps: 0 }, 0.01),
        (Method::Hooke, 0.0),
        (Method::Hooke, f64::NAN),
    ] {
        assert!(Stepper::new(method, &hung::<f32>(), seconds).is_err());
    }
    let looped = Spring {
        ends: [3, 3],
        ..state.springs[0]
    };
    assert!(matches!(
        MassSpring::<f32>::new(&[Vec3::ZERO; 4], &[1.0; 4], &[looped]),
        Err(MethodError::Ends { spring: 0, .. })
    ));
}
