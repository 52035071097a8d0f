//! Stretched, crumpled, coincident and inverted starts: which methods find back to a cloth.

use bevy::math::Vec3;
use bevy_drape::cloth::{ClothMaterial, Springs};

use super::{
    Job, Map, Row, SHREDDED, by,
    cloth::{Moving, Way},
    ensure, methods, percent,
};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    measure::Random,
    methods::{MassSpring, Scene, largest_frequency},
};

pub const STARTS: Map = Map {
    name: "starts",
    columns: "x: 0 at rest, 1 to 3 stretched × 1.5, 3, 10, 4 crumpled, 5 half of it in one point, 6 all of it, 7 all of it within 1 mm, 8 rows inverted, y: mean length over rest length of structural springs at the end, measure: largest stretch after 3 s, also: largest speed then (m/s); 17 × 17 particles, 1.6 m wide, ± 1 mm out of their plane but for 5 and 6, cotton, hung by the top row, 60 ticks a second",
    jobs,
    check,
    findings,
};

const SIDE: u32 = 17;
const SPACING: f32 = 0.1;

const KINDS: [&str; 9] = [
    "at rest",
    "× 1.5",
    "× 3",
    "× 10",
    "crumpled",
    "half in a point",
    "all in a point",
    "within 1 mm",
    "inverted",
];

const TETHERED: &str = "with tethers";
const WITHOUT: &str = "bevy_drape";
const EXPLICIT: &str = "explicit forces";

const WAYS: [(&str, fn(&Scene) -> Way); 6] = [
    (TETHERED, |_| Way::tethered(20)),
    (WITHOUT, |_| Way::ours(20)),
    ("small steps, 20", |_| Way::small_steps(20)),
    ("position-based, 20", |_| Way::position_based(20)),
    ("projective dynamics, 10", |_| Way::projective(10)),
    // Twice as many as the limit asks for.
    (EXPLICIT, |scene| {
        let frequency = largest_frequency(&MassSpring::of_scene(scene).expect("a valid network"));
        Way::explicit((f64::from(scene.seconds) * frequency).ceil() as u32)
    }),
];

const RECOVERS: &str = "recovers";
const SHORT: &str = "stays collapsed";
const TANGLED: &str = "stays stretched";

/// At the end of three seconds a cloth hangs: 5 % is what an eye notices, and cloth that lies in folds is shorter than
/// at rest in a few springs, but not by a tenth on average.
fn outcome(stretch: f64, mean_length: f64) -> &'static str {
    match stretch {
        ..=0.05 if mean_length > 0.9 => RECOVERS,
        ..=0.05 => SHORT,
        ..=10.0 => TANGLED,
        _ => SHREDDED,
    }
}

fn at_rest() -> Scene {
    let mut scene =
        Scene::swinging(SIDE, SPACING * (SIDE - 1) as f32, 0.0, 1.0e-3).expect("a valid scene");
    scene.material = ClothMaterial::COTTON;
    scene.springs = Springs::of_grid(&scene.grid, &scene.material);
    scene
}

fn scene(kind: usize) -> Scene {
    let mut scene = at_rest();
    let mut random = Random(3);
    let width = SPACING * (SIDE - 1) as f32;
    let middle = Vec3::new(width, -width, 0.0) / 2.0;
    for (row, column) in scene.grid.cells() {
        let rest = scene.grid.rest_position(row, column);
        let mut within = || random.between(-0.5, 0.5) * width;
        let crumpled = middle + Vec3::new(within(), within(), within());
        let place = match kind {
            1 => rest * Vec3::new(1.0, 1.5, 1.0),
            2 => rest * Vec3::new(1.0, 3.0, 1.0),
            3 => rest * Vec3::new(1.0, 10.0, 1.0),
            4 => crumpled,
            5 if row > SIDE / 2 => middle,
            6 | 7 => middle,
            8 => scene.grid.rest_position(SIDE - row, column),
            _ => rest,
        };
        if row > 0 {
            // Not quite flat: nothing would ever push a cloth in a plane out of it.
            let out = match kind {
                5 | 6 => 0.0,
                _ => random.between(-0.01, 0.01) * SPACING,
            };
            let mut place = place + Vec3::Z * out;
            if kind == 7 {
                place.x += random.between(-0.01, 0.01) * SPACING;
                place.y += random.between(-0.01, 0.01) * SPACING;
            }
            scene
                .particles
                .set_position((row, column), place)
                .expect("a place");
        }
    }
    scene
}

fn cell(name: &str, way: fn(&Scene) -> Way, kind: usize) -> Row {
    let scene = scene(kind);
    let mut moving = Moving::new(&scene, way(&at_rest()), scene.seconds.into());
    for _ in 0..180 {
        moving.step();
    }
    let (stretch, mean_length) = (moving.stretch(), moving.mean_length());
    Row::new(&STARTS, name, [kind as f64, mean_length]).found(
        outcome(stretch, mean_length),
        stretch,
        moving.largest_speed(),
    )
}

fn jobs(quick: bool) -> Vec<Job> {
    let mut jobs: Vec<Job> = Vec::new();
    for (name, way) in WAYS {
        for kind in 0..KINDS.len() {
            if !quick || [1, 4, 7].contains(&kind) {
                jobs.push(Box::new(move || vec![cell(name, way, kind)]));
            }
        }
    }
    jobs
}

fn check(rows: &[Row]) -> Result<(), String> {
    for row in rows
        .iter()
        .filter(|row| [TETHERED, WITHOUT].contains(&row.method.as_str()))
    {
        ensure(row.outcome != SHREDDED, || {
            format!(
                "{} from {}: {}",
                row.method, KINDS[row.x as usize], row.measure
            )
        })?;
        let is_stretched = row.x <= 3.0;
        ensure(!is_stretched || row.outcome == RECOVERS, || {
            format!(
                "{} from {}: {}",
                row.method, KINDS[row.x as usize], row.outcome
            )
        })?;
    }
    Ok(())
}

fn findings(rows: &[Row]) -> Vec<String> {
    let each = methods(rows).into_iter().map(|method| {
        let cells = by(rows, method);
        let failed = cells.iter().filter(|row| row.outcome != RECOVERS);
        let failed: Vec<String> = failed
            .map(|row| {
                format!(
                    "{} {} ({})",
                    KINDS[row.x as usize],
                    row.outcome,
                    percent(row.measure)
                )
            })
            .collect();
        let recovered = cells.len() - failed.len();
        if failed.is_empty() {
            format!("{method} from all {recovered}")
        } else {
            format!(
                "{method} from {recovered} of {}, not {}",
                cells.len(),
                failed.join(", ")
            )
        }
    });
    let each: Vec<String> = each.collect();
    vec![format!(
        "From all starts, rest included, these hang in 3 s: {}.",
        each.join("; ")
    )]
}

pub fn chart(rows: &[Row]) -> Chart {
    let names = methods(rows);
    let mut panel = Panel::new(
        "",
        Axis::of_names("", KINDS),
        // The first one on top.
        Axis::of_names("", names.iter().rev().copied()),
    );
    let looks = [
        (RECOVERS, Look::Style(2)),
        (SHORT, Look::Style(5)),
        (TANGLED, Look::Style(4)),
        (SHREDDED, Look::Style(1)),
    ];
    for (outcome, look) in looks {
        let cells = rows.iter().filter(|row| row.outcome == outcome);
        let points = cells.map(|row| {
            let from_top = names
                .iter()
                .position(|name| *name == row.method)
                .unwrap_or(0);
            [row.x, (names.len() - 1 - from_top) as f64]
        });
        panel = panel.with(Series::new(outcome, look, Kind::Cells, points));
    }
    let of_bad = |method| {
        let cells = by(rows, method).into_iter().filter(|row| row.x > 0.0);
        let outcomes = cells.map(|row| row.outcome == RECOVERS);
        outcomes.fold((0, 0), |(found, all), is_found| {
            (found + usize::from(is_found), all + 1)
        })
    };
    let ((ours, all), (explicit, _)) = (of_bad(WITHOUT), of_bad(EXPLICIT));
    Chart::new(
        "stability-starts",
        format!(
            "From {ours} of {all} bad starts the cloth finds back by itself, with explicit forces from {explicit}"
        ),
        "A cotton cloth of 17 × 17 particles, hung by the top row, 3 s after it began like this. Recovers: no spring stretched by more than 5 %, and none of it still in a heap. Explicit forces take steps half as long as their limit.",
    )
    .sized([960, 440])
    .with(panel)
}
