//! One cloth, hung in one way and simulated for three seconds.

use std::time::Instant;

use bevy::math::Vec3;
use bevy_drape::{
    cloth::SpringKind,
    solver::{ClothSettings, Control, Substepping, TickStep},
};
use examples_shared::sheet::{Sheet, threads};

use crate::surfaces::Made;

/// Particles along a side, and its length (m).
pub const SIDE: u32 = 64;
pub const WIDTH: f32 = 2.0;

/// Ticks of 1/60 s, and how many of them, the last, the stretch is taken from.
pub const TICKS: u32 = 180;
const LAST: u32 = 60;

/// How far one particle is moved in each start (m): what is a draw has to differ.
const NUDGE: f32 = 1.0e-6;

type Pinned = fn(row: u32, column: u32) -> bool;

/// Names of all ways, and which particles are pinned.
pub const PINS: [(&str, Pinned); 6] = [
    ("two corners", |row, column| {
        row == 0 && (column == 0 || column == SIDE - 1)
    }),
    ("one corner", |row, column| row == 0 && column == 0),
    ("centre", |row, column| {
        row == SIDE / 2 && column == SIDE / 2
    }),
    ("five points", |row, column| {
        [(3, 9), (50, 60), (31, 7), (10, 44), (63, 0)].contains(&(row, column))
    }),
    ("diagonal", |row, column| row == column),
    ("top row", |row, _| row == 0),
];

/// What came of it.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    pub particles: usize,
    pub ms_per_tick: f64,
    /// Over structural springs in the last second, as parts of their length.
    pub max_stretch: f64,
    pub rms_stretch: f64,
    pub energy_gain: f64,
}

/// Plays a scene, with one particle a µm aside in each `start`.
pub fn play(made: Made, pinned: Pinned, substepping: Substepping, start: u32) -> Outcome {
    let spacing = WIDTH / (SIDE - 1) as f32;
    let step = TickStep {
        seconds: 1.0 / 60.0,
        ..TickStep::default()
    };
    let (surface, _) = made.surface([SIDE; 2], spacing);
    // A mesh's particles are in another order.
    let mut cells = vec![(0, 0); surface.len()];
    for vertex in 0..SIDE * SIDE {
        let particle = surface.particle_of_vertex(vertex as usize);
        cells[particle.expect("a particle for each vertex")] = (vertex / SIDE, vertex % SIDE);
    }
    let rest = surface.rest_positions().to_vec();
    let place = |particle: usize| {
        let is_nudged = cells[particle] == (7 * start % SIDE, (11 * start + 5) % SIDE);
        let height = if is_nudged { NUDGE } else { 0.0 };
        Vec3::new(rest[particle].x, height, -rest[particle].y)
    };
    let is_pinned = |particle: usize| {
        let (row, column) = cells[particle];
        pinned(row, column)
    };
    let mut sheet = Sheet::of_surface(surface, threads(0.0, 0.0), step, place, is_pinned)
        .tethered(ClothSettings::default().tethers);
    let scale = sheet.fall();
    let [_, begins] = sheet.energy();
    let mut control = Control::default();
    let mut backup = sheet.particles.clone();
    let (mut seconds, mut highest) = (0.0, begins);
    let (mut largest, mut squares, mut count) = (0.0, 0.0, 0.0);
    for tick in 0..TICKS {
        let clock = Instant::now();
        sheet.step.substeps = control.substeps(
            substepping,
            Substepping::needed(SIDE as usize, sheet.step.seconds),
        );
        if matches!(substepping, Substepping::Adaptive { .. }) {
            backup.clone_from(&sheet.particles);
        }
        loop {
            let stretch = sheet.tick(|_, _| {});
            let Some(more) = control.observe(substepping, stretch) else {
                break;
            };
            sheet.particles.clone_from(&backup);
            sheet.step.substeps = more;
        }
        seconds += clock.elapsed().as_secs_f64();
        highest = larger(highest, sheet.energy()[1]);
        if tick + LAST >= TICKS {
            for stretch in stretches(&sheet) {
                largest = larger(largest, stretch);
                squares += stretch * stretch;
                count += 1.0;
            }
        }
    }
    Outcome {
        particles: sheet.particles.len(),
        ms_per_tick: 1.0e3 * seconds / f64::from(TICKS),
        max_stretch: largest,
        rms_stretch: f64::sqrt(squares / count),
        energy_gain: (highest - begins) / scale,
    }
}

/// The larger of two; NaN if one of them is.
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// Length over rest length, − 1, of each structural spring.
fn stretches(sheet: &Sheet) -> impl Iterator<Item = f64> {
    let places: Vec<Vec3> = sheet.particles.positions().collect();
    let structural = sheet.springs.iter();
    let structural = structural.filter(|spring| spring.kind == SpringKind::Structural);
    structural.map(move |spring| {
        let [a, b] = spring.ends.map(|end| places[end as usize].as_dvec3());
        a.distance(b) / f64::from(spring.rest_length) - 1.0
    })
}
