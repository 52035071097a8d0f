//! A strip hung by both ends: the catenary, rigid and elastic.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs},
    solver::{Solver, Tethers, TickStep},
};

const GRAVITY: f64 = 9.81;
/// Length of the strip at rest (m).
const LENGTH: f64 = 2.0;
/// Distance between what holds its ends (m).
const SPAN: f64 = 1.4;
const COLUMNS: u32 = 41;
const SPACING: f32 = 0.05;

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

/// Where a strip that weighs `weight` N/m and needs `stiffness` N for a strain of 1 hangs: (x, y) of the point that
/// is `along` m from its middle at rest, from its lowest point (Irvine, Cable Structures, 1981).
fn catenary(weight: f64, stiffness: f64) -> impl Fn(f64) -> (f64, f64) {
    let x = move |tension: f64, along: f64| {
        tension * along / stiffness + tension / weight * (weight * along / tension).asinh()
    };
    // The tighter, the wider.
    let tension = root(
        |tension| 2.0 * x(tension, LENGTH / 2.0) - SPAN,
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
fn hang(compliance: f32, tethers: bool) -> (f64, f64) {
    let material = ClothMaterial {
        stretch_compliance: compliance,
        shear_compliance: f32::INFINITY,
        bend_compliance: f32::INFINITY,
        damping: 0.05,
        ..ClothMaterial::COTTON
    };
    // Two rows, side by side: each hangs by itself.
    let grid = Cloth::new(COLUMNS, 2, SPACING)
        .grid(Vec3::ONE)
        .expect("a sound grid");
    let mut particles = ClothParticles::at_rest(&grid, &material).expect("a sound material");
    for (row, column) in grid.cells() {
        // Up one flank of a V and down the other.
        let along = f64::from(column) / f64::from(COLUMNS - 1) - 0.5;
        let depth = (LENGTH * LENGTH - SPAN * SPAN).sqrt() * (0.5 - along.abs());
        let position = Vec3::new((along * SPAN) as f32, -depth as f32, row as f32 * SPACING);
        particles
            .set_position((row, column), position)
            .expect("it exists");
        if column == 0 || column == COLUMNS - 1 {
            particles
                .set_inverse_mass((row, column), 0.0)
                .expect("it exists");
        }
    }
    let springs = Springs::of_grid(&grid, &material);
    let mut solver = Solver::new(&springs, &particles);
    if tethers {
        solver.set_tethers(Tethers::new(&grid, &material, &particles, GRAVITY as f32));
    }
    let step = TickStep {
        seconds: 1.0 / 64.0,
        substeps: 20,
        acceleration: Vec3::new(0.0, -GRAVITY as f32, 0.0),
        damping: material.damping,
    };
    for _ in 0..64 * 12 {
        solver.advance(&mut particles, step, &[], |_, _| false);
    }
    let width = f64::from(SPACING);
    let weight = f64::from(material.areal_density) * width * GRAVITY;
    // A compliance is a square patch's: strain = compliance × newtons a metre of width.
    let elastic = catenary(weight, width / f64::from(compliance).max(1.0e-12));
    let rigid = catenary(weight, width / 1.0e-12);
    let (_, top) = elastic(LENGTH / 2.0);
    let (mut off, mut between) = (0.0_f64, 0.0_f64);
    for (row, column) in grid.cells() {
        let along = LENGTH * (f64::from(column) / f64::from(COLUMNS - 1) - 0.5);
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
            let (off, between) = hang(compliance, tethers);
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
