//! How many sub-steps a cloth needs for how many particles, how long a tick may be, and how fast its pins may run.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{ClothMaterial, Springs},
    solver::PinMotion,
};

use super::{
    BY_STRETCH, HOLDS, Job, Map, Row, between, by,
    cloth::{Moving, Way},
    ensure, largest, methods, outcome_of, percent, values,
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    measure::line_through,
    methods::Scene,
};

pub const SUBSTEP_SIZE: Map = Map {
    name: "substep_size",
    columns: "x: length of a sub-step (ms), y: particles a side, measure: largest stretch of the last of 3 s, also: the same in very short sub-steps, the material's own, to which the outcome is held; 1/64 s a tick, cotton hung by two corners",
    jobs: size_jobs,
    check: size_check,
    findings: size_findings,
};

pub const FALL: Map = Map {
    name: "fall",
    columns: "x: length of a tick (s), y: sub-steps in it, measure: largest stretch of the last third, also: of all; 32 × 32 particles of cotton, 2 m wide, hung by two corners, 3 s or 30 ticks",
    jobs: fall_jobs,
    check: fall_check,
    findings: fall_findings,
};

pub const PULLED: Map = Map {
    name: "pulled",
    columns: "x: way of the pins in a sub-step in spacings, y: their speed (m/s), measure: largest stretch while they run for 1/4 s and stand for 2 s, also: at the end; 32 × 32 particles of cotton, 2 m wide, hung by the top row, 20 sub-steps in 1/64 s",
    jobs: pull_jobs,
    check: pull_check,
    findings: pull_findings,
};

/// Length of a tick (ms).
const TICK: f64 = 1.0e3 / 64.0;

/// What a stretch may be (m/m).
const ALLOWED: f64 = 0.05;

/// Of cotton, as the plugin has it by default.
fn scene(side: u32, width: f32) -> Scene {
    let mut scene = Scene::hung_by_corners(side, width).expect("a valid scene");
    scene.material = ClothMaterial::COTTON;
    scene.springs = Springs::of_grid(&scene.grid, &scene.material);
    scene.seconds = 1.0 / 64.0;
    scene
}

/// The largest stretch in ticks from one on, and in all.
fn stretches(scene: &Scene, substeps: u32, ticks: u32, from: u32) -> [f64; 2] {
    let mut moving = Moving::new(scene, Way::ours(substeps), scene.seconds.into());
    let (mut last, mut ever) = (0.0, 0.0);
    for tick in 0..ticks {
        moving.step();
        let stretch = moving.stretch();
        ever = largest([ever, stretch]);
        if tick >= from {
            last = largest([last, stretch]);
        }
    }
    [last, ever]
}

fn size_jobs(quick: bool) -> Vec<Job> {
    let (sides, substeps, widths): (&[u32], &[u32], &[f32]) = if quick {
        (&[16, 32], &[5, 10, 20, 40], &[2.0])
    } else {
        (
            &[8, 16, 32, 64, 128],
            &[5, 7, 10, 14, 20, 28, 40, 56, 80, 160],
            &[2.0, 8.0],
        )
    };
    let shortest = if quick { 80 } else { 320 };
    let mut jobs: Vec<Job> = Vec::new();
    for &side in sides {
        for &width in widths {
            jobs.push(Box::new(move || {
                let scene = scene(side, width);
                let [own, _] = stretches(&scene, shortest, 192, 128);
                let cell = |&substeps: &u32| {
                    let [last, _] = stretches(&scene, substeps, 192, 128);
                    let at = [TICK / f64::from(substeps), side.into()];
                    let row = Row::new(&SUBSTEP_SIZE, format!("{width} m wide"), at);
                    row.found(outcome_of(last - own), last, own)
                };
                substeps.iter().map(cell).collect()
            }));
        }
    }
    jobs
}

/// For each size the longest sub-step (ms) that stretches the cloth by 5 % more than the shortest, found between two
/// cells along a power law: (side, ms).
fn longest_steps(rows: &[Row], method: &str) -> Vec<[f64; 2]> {
    let cells = by(rows, method);
    let sides = values(rows, |row| row.y).into_iter();
    sides
        .filter_map(|side| {
            let mut cells: Vec<&&Row> = cells.iter().filter(|row| row.y == side).collect();
            cells.sort_by(|a, b| a.x.total_cmp(&b.x));
            let excess = |row: &Row| row.measure - row.also;
            let after = cells.iter().position(|row| excess(row) > ALLOWED)?;
            let (held, failed) = (cells.get(after.checked_sub(1)?)?, cells[after]);
            // What is no more at all is a little.
            let [low, high] = [excess(held).max(1.0e-3), excess(failed)].map(f64::ln);
            let part = (ALLOWED.ln() - low) / (high - low);
            Some([side, held.x * (failed.x / held.x).powf(part)])
        })
        .collect()
}

/// The power law nearest to them: ms = factor × sideᵉˣᵖᵒⁿᵉⁿᵗ.
fn law(steps: &[[f64; 2]]) -> Option<[f64; 2]> {
    let logs: Vec<[f64; 2]> = steps.iter().map(|step| step.map(f64::ln)).collect();
    let [slope, intercept] = (logs.len() > 1).then(|| line_through(&logs))?;
    Some([slope, intercept.exp()])
}

fn size_check(rows: &[Row]) -> Result<(), String> {
    for row in rows {
        ensure(row.measure.is_finite(), || {
            format!("{}² in sub-steps of {} ms", row.y, row.x)
        })?;
    }
    let cell = rows
        .iter()
        .find(|row| row.y == 32.0 && (row.x - TICK / 20.0).abs() < 1e-9);
    ensure(cell.is_some_and(|row| row.outcome == HOLDS), || {
        "the defaults do not hold 32²".into()
    })
}

fn size_findings(rows: &[Row]) -> Vec<String> {
    let each = methods(rows).into_iter().map(|method| {
        let steps = longest_steps(rows, method);
        let list: Vec<String> = steps
            .iter()
            .map(|[side, ms]| format!("{:.0} for {side}²", (TICK / ms).ceil()))
            .collect();
        let law = law(&steps).map_or(String::new(), |[exponent, factor]| {
            format!(": a sub-step of at most {factor:.3} ms × n^{exponent:.2}")
        });
        let own: Vec<String> = values(rows, |row| row.y)
            .into_iter()
            .filter_map(|side| by(rows, method).into_iter().find(|row| row.y == side))
            .map(|row| percent(row.also))
            .collect();
        format!(
            "{method} {}{law} (its own stretch is {} at {} particles a side)",
            list.join(", "),
            own.join(", "),
            values(rows, |row| row.y)
                .iter()
                .map(|side| format!("{side}"))
                .collect::<Vec<_>>()
                .join(", ")
        )
    });
    let each: Vec<String> = each.collect();
    vec![format!(
        "Sub-steps in 1/64 s that a cotton cloth hung by two corners takes to stretch by at most 5 % more than in very short ones: {}.",
        each.join("; ")
    )]
}

fn fall_jobs(quick: bool) -> Vec<Job> {
    let ticks: &[f32] = if quick {
        &[1.0 / 64.0, 0.1, 1.0]
    } else {
        &[1.0 / 64.0, 1.0 / 30.0, 0.05, 0.1, 0.2, 0.5, 1.0]
    };
    let mut jobs: Vec<Job> = Vec::new();
    for substeps in [1, 5, 20, 80] {
        for &seconds in ticks {
            jobs.push(Box::new(move || {
                let mut scene = scene(32, 2.0);
                scene.seconds = seconds;
                let ticks = ((3.0 / seconds).round() as u32).max(30);
                let [last, ever] = stretches(&scene, substeps, ticks, ticks * 2 / 3);
                let row = Row::new(
                    &FALL,
                    if substeps == 1 {
                        "1 sub-step".into()
                    } else {
                        format!("{substeps} sub-steps")
                    },
                    [seconds.into(), substeps.into()],
                );
                vec![row.found(outcome_of(last), last, ever)]
            }));
        }
    }
    jobs
}

fn fall_check(rows: &[Row]) -> Result<(), String> {
    for row in rows {
        ensure(row.also.is_finite(), || {
            format!("{} s in {}", row.x, row.method)
        })?;
    }
    Ok(())
}

fn fall_findings(rows: &[Row]) -> Vec<String> {
    let mut steps: Vec<(f64, bool)> = rows
        .iter()
        .map(|row| (1.0e3 * row.x / row.y, row.outcome == HOLDS))
        .collect();
    steps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let held = steps.iter().take_while(|(_, holds)| *holds).last();
    let held = held.map_or(0.0, |(step, _)| *step);
    let longest = rows
        .iter()
        .max_by(|a, b| (a.x / a.y).total_cmp(&(b.x / b.y)));
    vec![format!(
        "However long the tick, 32² keeps finite: {} in sub-steps of {:.0} ms; it holds 5 % in sub-steps of up to {:.2} ms.",
        longest.map_or(String::new(), |row| percent(row.measure)),
        longest.map_or(f64::NAN, |row| 1.0e3 * row.x / row.y),
        held
    )]
}

fn pull(tethers: bool, speed: f32) -> Row {
    let mut scene = scene(32, 2.0);
    for (row, column) in scene.grid.cells() {
        let rest = scene.grid.rest_position(row, column);
        scene
            .particles
            .set_position((row, column), rest)
            .expect("a place");
        if row == 0 {
            scene
                .particles
                .set_inverse_mass((row, column), 0.0)
                .expect("it exists");
        }
    }
    let mut solver = scene.solver(tethers);
    let mut particles = scene.particles.clone();
    let step = scene.step(20);
    let (mut ever, mut end) = (0.0, 0.0);
    for tick in 0..144 {
        let way = if tick < 16 {
            Vec3::Z * speed * scene.seconds
        } else {
            Vec3::ZERO
        };
        let pins: Vec<PinMotion> = (0..32)
            .map(|particle| {
                let from = particles.position(particle as usize).expect("it exists");
                PinMotion {
                    particle,
                    from,
                    to: from + way,
                }
            })
            .collect();
        let stretch = solver.advance(&mut particles, step, &pins, |_, _| false);
        let is_valid = particles.validate().is_ok();
        end = if is_valid {
            f64::from(stretch.structural)
        } else {
            f64::NAN
        };
        ever = largest([ever, end]);
    }
    let way = speed * scene.seconds / 20.0 / scene.grid.spacing().x;
    let name = if tethers {
        "with tethers"
    } else {
        "bevy_drape"
    };
    Row::new(&PULLED, name, [way.into(), speed.into()]).found(outcome_of(ever), ever, end)
}

fn pull_jobs(quick: bool) -> Vec<Job> {
    let speeds: &[f32] = if quick {
        &[2.0, 20.0, 200.0]
    } else {
        &[1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0]
    };
    let mut jobs: Vec<Job> = Vec::new();
    for tethers in [true, false] {
        for &speed in speeds {
            jobs.push(Box::new(move || vec![pull(tethers, speed)]));
        }
    }
    jobs
}

fn pull_check(rows: &[Row]) -> Result<(), String> {
    for row in rows {
        ensure(row.also.is_finite(), || {
            format!("{} at {} m/s", row.method, row.y)
        })?;
    }
    Ok(())
}

fn pull_findings(rows: &[Row]) -> Vec<String> {
    let held = |method| {
        let cells = by(rows, method);
        let held = cells.iter().take_while(|row| row.measure <= ALLOWED);
        held.last().map_or([0.0; 2], |row| [row.y, row.x])
    };
    let ([speed, way], [tethered, _]) = (held("bevy_drape"), held("with tethers"));
    let worst = by(rows, "bevy_drape")
        .into_iter()
        .max_by(|a, b| a.measure.total_cmp(&b.measure));
    vec![format!(
        "Pins that start at once hold 5 % up to {speed} m/s, {way:.3} spacings a sub-step, with tethers up to {tethered} m/s; at {} m/s the stretch is {}, and {} two seconds after they stand.",
        worst.map_or(0.0, |row| row.y),
        percent(worst.map_or(f64::NAN, |row| row.measure)),
        percent(worst.map_or(f64::NAN, |row| row.also)),
    )]
}

pub fn chart(rows: &[Row]) -> Chart {
    let methods = methods(rows);
    let steps = |method| longest_steps(rows, method);
    let needs = steps(methods[0])
        .last()
        .map_or(String::new(), |[side, ms]| {
            format!("{:.0} a tick for {side}²", (TICK / ms).ceil())
        });
    let mut chart = Chart::new(
        "stability-size",
        format!("Finer cloth needs more sub-steps: {needs}"),
        "Largest stretch in the third second of a cotton cloth hung by two corners, beyond what it gives in very short sub-steps: holds up to 5 %. The line is the power law nearest to where 5 % are crossed.",
    )
    .sized([960, 520])
    .columns(methods.len());
    for method in methods {
        let xs = values(rows, |row| row.x);
        let ys = values(rows, |row| row.y);
        let ticks = xs.iter().map(|ms| (TICK / ms).round());
        let named = ticks.map(|n| (TICK / n, format!("{n}")));
        let mut panel = Panel::new(
            method,
            Axis::log("sub-steps in 1/64 s")
                .named(named)
                .between(xs[xs.len() - 1] * 1.2, xs[0] / 1.2),
            Axis::log("particles a side")
                .named(ys.iter().map(|&side| (side, format!("{side}²"))))
                .between(ys[0] / 1.45, ys[ys.len() - 1] * 1.45),
        );
        for (outcome, look) in BY_STRETCH {
            let cells = by(rows, method)
                .into_iter()
                .filter(|row| row.outcome == outcome);
            let cells = cells.map(|row| [row.x, row.y]);
            panel = panel.with(Series::new(outcome, look, Kind::Cells, cells));
        }
        if let Some([exponent, factor]) = law(&steps(method)) {
            // No farther than where something was crossed.
            let line = steps(method).into_iter();
            let line = line.map(|[side, _]| [factor * side.powf(exponent), side]);
            panel = panel.with(Series::new("power law", Look::Ink, Kind::Line, line));
        }
        chart = chart.with(panel);
    }
    chart
}

pub fn chart_of_steps(falls: &[Row], pulls: &[Row]) -> Chart {
    /// The edges of the charts (%).
    const ENDS: [f64; 2] = [0.1, 1.0e4];
    let shown = |stretch: f64| between(100.0 * stretch, ENDS);
    let allowed = |ends: [f64; 2]| {
        let line = ends.map(|end| [end, 100.0 * ALLOWED]);
        Series::new("5 %", Look::Ink, Kind::Line, line)
    };
    let mut fall = Panel::new(
        "By the length of a tick",
        Axis::log("tick, s"),
        Axis::log("largest stretch, %").between(ENDS[0], ENDS[1]),
    );
    for (style, method) in methods(falls).into_iter().enumerate() {
        let points = by(falls, method).into_iter();
        let points = points.map(|row| [row.x, shown(row.measure)]);
        fall = fall.with(Series::new(
            method,
            Look::Style(style),
            Kind::Marked,
            points,
        ));
    }
    let mut pull = Panel::new(
        "By the speed of its pins",
        Axis::log("way of the pins in a sub-step, spacings"),
        Axis::log("largest stretch, %").between(ENDS[0], ENDS[1]),
    );
    for (style, method) in methods(pulls).into_iter().enumerate() {
        let points = by(pulls, method).into_iter();
        let points = points.map(|row| [row.x, shown(row.measure)]);
        pull = pull.with(Series::new(
            method,
            Look::Style(style + 4),
            Kind::Marked,
            points,
        ));
    }
    let longest = largest(falls.iter().map(|row| row.x));
    let ways = values(pulls, |row| row.x);
    Chart::new(
        "stability-steps",
        format!(
            "Whatever the tick and the pins, cloth stays finite: tethered it is stretched by at most {} in ticks of {longest} s and 20 sub-steps",
            percent(largest(
                falls
                    .iter()
                    .filter(|row| row.y == 20.0)
                    .map(|row| row.measure)
            ))
        ),
        "32 × 32 particles of cotton, 2 m wide. Left: hung by two corners, last third of 3 s or 30 ticks. Right: the pinned row starts at once and runs for 1/4 s, 20 sub-steps in 1/64 s.",
    )
    .sized([960, 520])
    .columns(2)
    .with(fall.with(allowed([1.0 / 64.0, longest])))
    .with(pull.with(allowed([ways[0], ways[ways.len() - 1]])))
}
