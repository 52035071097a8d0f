//! A strip hung by both ends: the catenary, rigid and elastic.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Solver, Tethers, TickStep},
};

const GRAVITY: f64 = 9.81;
/// Length of the strip at rest (m).
const LENGTH: f64 = 2.0;
/// Columns of particles along a strip, and the distance between what holds its ends (m).
type Strip = (u32, f64);
const USUAL: Strip = (41, 1.4);
/// Seconds of a sub-step.
const SUBSTEP: f64 = 1.0 / 1280.0;

/// The root of a growing function between `low` and `high`.
fn root(function: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        if function(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Over a span (m), where a strip that weighs `weight` N/m and needs `stiffness` N for a strain of 1 hangs: (x, y) of the point that
/// is `along` m from its middle at rest, from its lowest point (Irvine, Cable Structures, 1981).
pub fn catenary(span: f64, weight: f64, stiffness: f64) -> impl Fn(f64) -> (f64, f64) {
    let x = move |tension: f64, along: f64| {
        tension * along / stiffness + tension / weight * (weight * along / tension).asinh()
    };
    // The tighter, the wider.
    let tension = root(
        |tension| 2.0 * x(tension, LENGTH / 2.0) - span,
        1.0e-6,
        1.0e4,
    );
    move |along| {
        let slope = weight * along / tension;
        let stretched = weight * along * along / (2.0 * stiffness);
        let y = stretched + tension / weight * ((1.0 + slope * slope).sqrt() - 1.0);
        (x(tension, along), y)
    }
}

/// How far the strip hangs from the closed form at rest, at most (m), and how far that is from the rigid one.
fn hang((columns, span): Strip, compliance: f32, tethers: bool) -> (f64, f64) {
    let spacing = LENGTH as f32 / (columns - 1) as f32;
    let material = ClothMaterial {
        stretch_compliance: compliance,
        shear_compliance: f32::INFINITY,
        bend_rigidity: 0.0,
        damping: 0.05,
        ..ClothMaterial::COTTON
    };
    // Two rows, side by side: each hangs by itself.
    let grid = Cloth::new(columns, 2, spacing)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let surface = Surface::of_grid(&grid);
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
    for (row, column) in grid.cells() {
        // Up one flank of a V and down the other.
        let along = f64::from(column) / f64::from(columns - 1) - 0.5;
        let depth = (LENGTH * LENGTH - span * span).sqrt() * (0.5 - along.abs());
        let position = Vec3::new((along * span) as f32, -depth as f32, row as f32 * spacing);
        particles
            .set_position((row, column), position)
            .expect("it exists");
        if column == 0 || column == columns - 1 {
            particles
                .set_inverse_mass((row, column), 0.0)
                .expect("it exists");
        }
    }
    let springs = Springs::of_grid(&grid, &material);
    let mut solver = Solver::new(&springs, &particles);
    if tethers {
        solver.set_tethers(Tethers::new(
            &surface,
            &material,
            &particles,
            GRAVITY as f32,
        ));
    }
    let step = TickStep {
        seconds: 20.0 * SUBSTEP as f32,
        substeps: 20,
        acceleration: Vec3::new(0.0, -GRAVITY as f32, 0.0),
        damping: material.damping,
        ..TickStep::default()
    };
    for _ in 0..64 * 12 {
        solver.advance(&mut particles, step, &[], |_, _| false);
    }
    let width = f64::from(spacing);
    let weight = f64::from(material.areal_density) * width * GRAVITY;
    // A compliance is a square patch's: strain = compliance × newtons a metre of width.
    let elastic = catenary(span, weight, width / f64::from(compliance).max(1.0e-12));
    let rigid = catenary(span, weight, width / 1.0e-12);
    let (_, top) = elastic(LENGTH / 2.0);
    let (mut off, mut between) = (0.0_f64, 0.0_f64);
    for (row, column) in grid.cells() {
        let along = LENGTH * (f64::from(column) / f64::from(columns - 1) - 0.5);
        let (x, y) = elastic(along);
        let (rigid_x, rigid_y) = rigid(along);
        let found = particles.position((row, column)).expect("it exists");
        let apart = (f64::from(found.x) - x).hypot(f64::from(found.y) - (y - top));
        off = off.max(apart);
        between = between.max((rigid_x - x).hypot(rigid_y - rigid(1.0).1 - (y - top)));
    }
    (off, between)
}

/// Half a per cent of the strip's length: 10 mm. What is derived is less: chords in place of arcs shorten a curve
/// of radius R by spacing²/24 R² of itself, 40 of them at R > 0.25 m by 3 mm in all; a sweep leaves (n − 1)² g Δt² with
/// n = 21 particles from the middle to an end, 2.4 mm.
#[test]
fn a_strip_hangs_as_the_catenary() {
    for compliance in [0.0, 0.1] {
        for tethers in [false, true] {
            let (off, between) = hang(USUAL, compliance, tethers);
            println!(
                "catenary, {compliance} m/N, tethers {tethers}: {:.2} mm off, the rigid one {:.0} mm",
                1.0e3 * off,
                1.0e3 * between
            );
            assert!(off < 0.005 * LENGTH, "{compliance} {tethers}: {off} m");
            assert!(compliance == 0.0 || between > 10.0 * off, "{between}");
        }
    }
}

/// A flatter strip and a finer one are off by more, for a sweep leaves more in them: (n − 1)² g Δt² in each half with n
/// particles, 2.4 mm at 21 and 38 mm at 81, more where the pull is more than the half's weight. A flat arc of sag
/// f = √(3 s (L − s) ⁄ 8) is pulled by s² ⁄ 4 f L of that weight, 1.7 over s = 1.9 m, and sinks by 3 s ⁄ 16 f of what it is
/// lengthened by, 1.3.
#[test]
fn flatter_and_finer_strips_are_off_by_what_a_sweep_leaves() {
    for (columns, span) in [(41, 1.9), (161, 1.4)] {
        let (off, _) = hang((columns, span), 0.0, false);
        println!(
            "catenary, {columns} particles over {span} m: {:.1} mm off",
            1.0e3 * off
        );
        let left = (f64::from(columns - 1) / 2.0).powi(2) * GRAVITY * SUBSTEP * SUBSTEP;
        let sag = (3.0 * span * (LENGTH - span) / 8.0).sqrt();
        let pull = span * span / (4.0 * sag * LENGTH);
        let sinks = 3.0 * span / (16.0 * sag);
        // Both halves are lengthened, and the chords' 3 mm come on top.
        let bound = 2.0 * left * pull.max(1.0) * sinks.max(1.0) + 0.003;
        assert!(off < bound, "{columns} {span}: {off} m of {bound}");
    }
}
