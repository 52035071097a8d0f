//! What single precision loses: by how Verlet's state is stored, and by how far the cloth is from its origin.

use bevy::math::{DVec3, Vec3};

use super::{Job, Map, Row, between, by, ensure, largest};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series, number},
    methods::{GRAVITY, MassSpring, Method, Scene, Stepper},
};

pub const VERLET_FORM: Map = Map {
    name: "verlet_form",
    columns: "x: sub-steps a tick, measure: RMS distance from a converged run in f64 after 0.5 s (m), also: largest stretch; 17 × 17 particles, 2 m wide, 10⁻³ m/N, hung by the top row, let go 0.5 rad aside, 60 ticks a second",
    jobs: form_jobs,
    check: form_check,
    findings: form_findings,
};

pub const ORIGIN: Map = Map {
    name: "origin",
    columns: "x: distance from the origin (m), y: sub-steps a tick, measure: RMS distance from a converged run in f64 after 0.5 s (m), also: largest stretch; the same cloth, of a spacing of 0.125 m",
    jobs: origin_jobs,
    check: origin_check,
    findings: origin_findings,
};

/// Ticks that the cloth swings.
const TICKS: u32 = 30;
const DOUBLE: &str = "f64";
const DISPLACEMENTS: &str = "f32, position and displacement";
const POSITIONS: &str = "f32, two positions";
const AT_ORIGIN: &str = "at the origin, as in its own frame";
const WORLD: &str = "in world coordinates";

/// What an error against the same sub-steps without rounding is called.
fn outcome(error: f64, without: f64) -> &'static str {
    if error <= 1.1 * without {
        "as in f64"
    } else if error <= 2.0 * without {
        "coarser"
    } else {
        "lost"
    }
}

fn scene() -> Scene {
    Scene::swinging(17, 2.0, 0.5, 1.0e-3).expect("a valid scene")
}

fn in_f64(scene: &Scene, substeps: u32) -> MassSpring<f64> {
    let mut network = MassSpring::of_scene(scene).expect("a valid network");
    let method = Method::SmallSteps { substeps };
    let mut stepper =
        Stepper::new(method, &network, scene.seconds.into()).expect("a method for it");
    for _ in 0..TICKS {
        stepper.step(&mut network, GRAVITY.as_dvec3().to_array(), 0.0);
    }
    network
}

fn rms(found: impl Iterator<Item = DVec3>, truth: &MassSpring<f64>) -> f64 {
    let squares = found.zip(&truth.positions);
    let squares = squares.map(|(found, truth)| found.distance_squared((*truth).into()));
    (squares.sum::<f64>() / truth.positions.len() as f64).sqrt()
}

/// The swing by the library's solver, the cloth lying elsewhere. Returns the error (m) and the largest stretch.
fn ours(scene: &Scene, substeps: u32, place: Vec3, truth: &MassSpring<f64>) -> [f64; 2] {
    let mut particles = scene.particles.clone();
    for index in 0..particles.len() {
        let at = particles.position(index).expect("it exists");
        particles.set_position(index, at + place).expect("a place");
    }
    let mut solver = scene.solver(false);
    let mut stretch = 0.0;
    for _ in 0..TICKS {
        let found = solver.advance(&mut particles, scene.step(substeps), &[], |_, _| false);
        stretch = largest([stretch, found.structural.into()]);
    }
    let found = particles
        .positions()
        .map(|p| p.as_dvec3() - place.as_dvec3());
    [rms(found, truth), stretch]
}

/// The swing with two positions a particle: x' = 2 x − x₋₁ + g Δt², then one sweep.
fn by_positions(scene: &Scene, substeps: u32, truth: &MassSpring<f64>) -> [f64; 2] {
    let mut now: Vec<Vec3> = scene.particles.positions().collect();
    let mut before = now.clone();
    let inverse_masses: Vec<f32> = scene.particles.inverse_masses().collect();
    let springs = scene.springs.to_vec();
    let dt = scene.seconds / substeps as f32;
    for _ in 0..TICKS * substeps {
        for ((now, before), w) in now.iter_mut().zip(&mut before).zip(&inverse_masses) {
            if *w > 0.0 {
                let next = *now + (*now - *before) + GRAVITY * dt * dt;
                *before = std::mem::replace(now, next);
            }
        }
        for spring in &springs {
            let [a, b] = spring.ends.map(|end| end as usize);
            let (span, [w_a, w_b]) = (now[b] - now[a], [a, b].map(|end| inverse_masses[end]));
            let softness = w_a + w_b + spring.compliance / (dt * dt);
            let share = (1.0 - spring.rest_length / span.length()) / softness;
            // Between two pins there is nothing to share.
            if w_a + w_b > 0.0 {
                now[a] += span * (share * w_a);
                now[b] -= span * (share * w_b);
            }
        }
    }
    let lengths = springs.iter().map(|spring| {
        let [a, b] = spring.ends.map(|end| now[end as usize]);
        f64::from(a.distance(b) / spring.rest_length) - 1.0
    });
    [
        rms(now.iter().map(|p| p.as_dvec3()), truth),
        largest(lengths),
    ]
}

fn converged(quick: bool, scene: &Scene) -> MassSpring<f64> {
    in_f64(scene, if quick { 1280 } else { 5120 })
}

fn form_jobs(quick: bool) -> Vec<Job> {
    vec![Box::new(move || {
        let scene = scene();
        let truth = converged(quick, &scene);
        let all = [5, 10, 20, 40, 80, 160, 320, 640];
        let few = [20, 80, 320];
        let mut rows = Vec::new();
        for &substeps in if quick { &few[..] } else { &all[..] } {
            let exact = in_f64(&scene, substeps);
            let without = exact.rms_distance(&truth);
            for (method, [error, stretch]) in [
                (DOUBLE, [without, exact.largest_stretch()]),
                (DISPLACEMENTS, ours(&scene, substeps, Vec3::ZERO, &truth)),
                (POSITIONS, by_positions(&scene, substeps, &truth)),
            ] {
                let row = Row::new(&VERLET_FORM, method, [substeps.into(), 0.0]);
                rows.push(row.found(outcome(error, without), error, stretch));
            }
        }
        rows
    })]
}

fn errors(rows: &[Row], method: &str) -> Vec<f64> {
    by(rows, method).iter().map(|row| row.measure).collect()
}

fn form_check(rows: &[Row]) -> Result<(), String> {
    let (displacements, positions) = (errors(rows, DISPLACEMENTS), errors(rows, POSITIONS));
    let fall = |errors: &[f64]| errors[errors.len() - 1] / errors[0];
    ensure(fall(&displacements) < 0.5, || {
        format!("displacements: {displacements:?}")
    })?;
    ensure(fall(&positions) > 2.0, || {
        format!("positions: {positions:?}")
    })
}

fn form_findings(rows: &[Row]) -> Vec<String> {
    let list = |method| {
        let errors = errors(rows, method).into_iter();
        let errors: Vec<String> = errors
            .map(|error| number((1.0e5 * error).round() / 100.0))
            .collect();
        errors.join(", ")
    };
    let substeps: Vec<String> = by(rows, DOUBLE).iter().map(|row| number(row.x)).collect();
    vec![format!(
        "RMS error at {} sub-steps, mm: f64 {}; f32 with displacements {}; f32 with two positions {}.",
        substeps.join(", "),
        list(DOUBLE),
        list(DISPLACEMENTS),
        list(POSITIONS)
    )]
}

fn origin_jobs(quick: bool) -> Vec<Job> {
    vec![Box::new(move || {
        let scene = scene();
        let truth = converged(quick, &scene);
        let all = [
            1.0, 10.0, 30.0, 100.0, 300.0, 1.0e3, 3.0e3, 1.0e4, 1.0e5, 1.0e6,
        ];
        let few = [1.0, 100.0, 1.0e4];
        let mut rows = Vec::new();
        for substeps in [5, 20, 80] {
            let [own, own_stretch] = ours(&scene, substeps, Vec3::ZERO, &truth);
            let row = Row::new(&ORIGIN, AT_ORIGIN, [0.0, substeps.into()]);
            rows.push(row.found(outcome(own, own), own, own_stretch));
            for &distance in if quick { &few[..] } else { &all[..] } {
                // Along no axis, and no power of two.
                let place = Vec3::new(0.6, 0.64, 0.48) * distance;
                let [error, stretch] = ours(&scene, substeps, place, &truth);
                let row = Row::new(&ORIGIN, WORLD, [distance.into(), substeps.into()]);
                rows.push(row.found(outcome(error, own), error, stretch));
            }
        }
        rows
    })]
}

fn origin_check(rows: &[Row]) -> Result<(), String> {
    for row in by(rows, AT_ORIGIN) {
        ensure(row.measure < 0.02, || {
            format!("{} m at the origin", row.measure)
        })?;
    }
    for row in by(rows, WORLD)
        .into_iter()
        .filter(|row| row.y == 20.0 && row.x >= 1.0e4)
    {
        ensure(row.outcome == "lost", || {
            format!("nothing is lost at {} m", row.x)
        })?;
    }
    Ok(())
}

/// The farthest from the origin that a cloth keeps within twice its error.
fn far(rows: &[Row], substeps: f64) -> f64 {
    let mut cells = by(rows, WORLD);
    cells.retain(|row| row.y == substeps);
    let kept = cells.iter().take_while(|row| row.outcome != "lost");
    kept.map(|row| row.x).fold(0.0, f64::max)
}

fn origin_findings(rows: &[Row]) -> Vec<String> {
    let off = |method, distance: f64| {
        let cells = by(rows, method);
        let cell = cells.iter().find(|row| row.x == distance && row.y == 20.0);
        cell.map_or(f64::NAN, |row| 1.0e3 * row.measure)
    };
    vec![format!(
        "At the origin, where a cloth is in its own frame wherever that is, it is {:.1} mm off; particles at a distance keep within twice of that up to {} m at 5 sub-steps, {} m at 20, {} m at 80, and at 20 is {:.1} mm off at 100 m, {:.0} mm at 10,000.",
        off(AT_ORIGIN, 0.0),
        far(rows, 5.0),
        far(rows, 20.0),
        far(rows, 80.0),
        off(WORLD, 100.0),
        off(WORLD, 1.0e4)
    )]
}

pub fn chart(forms: &[Row], origins: &[Row]) -> Chart {
    /// The edges of the chart by distance (mm).
    const ENDS: [f64; 2] = [0.1, 1.0e3];
    let last = |method| {
        errors(forms, method)
            .last()
            .map_or(f64::NAN, |error| 1.0e3 * error)
    };
    let most = largest(forms.iter().map(|row| row.x));
    let mut form = Panel::new(
        "By what is stored",
        Axis::log("sub-steps a tick"),
        Axis::log("RMS error after 0.5 s, mm"),
    );
    for (style, method) in [DISPLACEMENTS, POSITIONS, DOUBLE].into_iter().enumerate() {
        let points = by(forms, method).into_iter();
        let points = points.map(|row| [row.x, 1.0e3 * row.measure]);
        // As exact as can be: a line beneath the others' markers.
        let (look, kind) = if method == DOUBLE {
            (Look::Ink, Kind::Line)
        } else {
            (Look::Style(style), Kind::Marked)
        };
        form = form.with(Series::new(method, look, kind, points));
    }
    let mut origin = Panel::new(
        "By the distance from the origin",
        Axis::log("distance, m"),
        Axis::log("RMS error after 0.5 s, mm").between(ENDS[0], ENDS[1]),
    );
    for (style, substeps) in [20.0, 80.0].into_iter().enumerate() {
        let of = |method| {
            let mut cells = by(origins, method);
            cells.retain(|row| row.y == substeps);
            cells
        };
        let points = of(WORLD).into_iter();
        let points = points.map(|row| [row.x, between(1.0e3 * row.measure, ENDS)]);
        let look = Look::Style(style + 3);
        let name = format!("particles at that distance, {substeps} sub-steps");
        origin = origin.with(Series::new(name, look, Kind::Marked, points));
        let ends = [1.0, largest(origins.iter().map(|row| row.x))];
        for row in of(AT_ORIGIN) {
            let line = ends.map(|end| [end, 1.0e3 * row.measure]);
            origin = origin.with(Series::new(AT_ORIGIN, Look::Ink, Kind::Line, line));
        }
    }
    Chart::new(
        "stability-precision",
        format!(
            "Displacements keep f32 exact: {} mm off at {most} sub-steps where two positions are {:.0}",
            number((last(DISPLACEMENTS) * 100.0).round() / 100.0),
            last(POSITIONS)
        ),
        "A cloth of 17 × 17 particles, 2 m wide, swings for half a second: RMS distance of its particles from a converged run in f64.",
    )
    .sized([960, 500])
    .columns(2)
    .with(form)
    .with(origin)
}
