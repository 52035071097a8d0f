//! Threads whose equations have no single solution: nothing becomes NaN, and nothing is thrown away.

use bevy::math::Vec3;
use bevy_drape::{cloth::ClothMaterial, solver::TickStep};
use examples_shared::sheet::{Sheet, threads};

/// Seconds of each run, and how far a particle may be from the origin after it (m).
const SECONDS: u32 = 1;
const FAR: f32 = 50.0;

/// Rigid, nearly so, soft, and without diagonals.
const COMPLIANCES: [[f32; 2]; 5] = [
    [0.0, 0.0],
    [1.0e-7, 0.0],
    [1.0e-4, 1.0e-3],
    [0.0, f32::INFINITY],
    [1.0e-2, f32::INFINITY],
];

/// Runs one with every material, few and many sub-steps, and gravity along each axis.
fn survives(
    name: &str,
    size: (u32, u32),
    placed: impl Fn(u32, u32) -> Vec3 + Copy,
    pinned: impl Fn(u32, u32) -> bool + Copy,
) {
    for compliances in COMPLIANCES {
        for substeps in [1, 5, 20] {
            for direction in [Vec3::ZERO, Vec3::X, Vec3::NEG_Y, Vec3::Z] {
                let step = TickStep {
                    substeps,
                    ..TickStep::default()
                };
                let material: ClothMaterial = threads(compliances[0], compliances[1]);
                let mut sheet = Sheet::new(size, 0.1, material, step, placed, pinned);
                sheet.step.acceleration = 9.81 * direction;
                for tick in 0..64 * SECONDS {
                    sheet.tick(|_, _| {});
                    let is_valid = sheet.particles.validate();
                    let farthest = sheet.particles.positions().map(Vec3::length);
                    let farthest = farthest.fold(0.0, f32::max);
                    assert!(
                        is_valid == Ok(()) && farthest < FAR,
                        "{name}, {size:?}, {compliances:?}, {substeps} sub-steps, gravity {direction}, tick {tick}: {is_valid:?}, {farthest} m"
                    );
                }
            }
        }
    }
}

/// Laid out flat, as it was made.
fn flat(row: u32, column: u32) -> Vec3 {
    0.1 * Vec3::new(column as f32, -(row as f32), 0.0)
}

const SIZES: [(u32, u32); 6] = [(2, 2), (2, 9), (9, 2), (3, 3), (12, 12), (33, 17)];

/// A straight chain whose ends don't give has one equation too many.
#[test]
fn straight_chains_between_pins_stay() {
    for size @ (columns, rows) in SIZES {
        let on_side = |column| column == 0 || column == columns - 1;
        survives("both sides", size, flat, |_, column| on_side(column));
        let on_end = |row| row == 0 || row == rows - 1;
        survives("top and bottom", size, flat, |row, _| on_end(row));
        survives("all around", size, flat, |row, column| {
            on_side(column) || on_end(row)
        });
        // Shorter and longer than what holds them allows.
        for factor in [0.5, 1.5] {
            survives(
                "both sides, elsewhere",
                size,
                |row, column| factor * flat(row, column),
                |_, column| on_side(column),
            );
        }
    }
}

#[test]
fn pins_alone_stay() {
    for size in SIZES {
        survives("all pinned", size, flat, |_, _| true);
    }
}

/// Every other one: each chain is one particle long.
#[test]
fn single_particles_between_pins_stay() {
    for size in SIZES {
        let is_even = |row: u32, column: u32| (row + column).is_multiple_of(2);
        survives("a chessboard of pins", size, flat, is_even);
        survives("one free", size, flat, |row, column| {
            (row, column) != (1, 1)
        });
        survives("none pinned", size, flat, |_, _| false);
    }
}

/// Springs of no length have no direction.
#[test]
fn coincident_particles_stay() {
    for size @ (_, rows) in SIZES {
        let top = |row: u32, _| row == 0;
        survives("all in one place", size, |_, _| Vec3::ZERO, top);
        survives(
            "all in one place, free",
            size,
            |_, _| Vec3::ZERO,
            |_, _| false,
        );
        survives(
            "rows of no length",
            size,
            |row, _| flat(row, 0),
            |row, column| row == 0 && column == 0,
        );
        survives(
            "columns of no length",
            size,
            |_, column| flat(0, column),
            top,
        );
        survives(
            "folded onto itself",
            size,
            |row, column| flat(row.min(rows - 1 - row), column),
            top,
        );
        // Two neighbours in one place in the middle of all others.
        survives(
            "a pair in one place",
            size,
            |row, column| flat(row, if column == 1 { 0 } else { column }),
            top,
        );
    }
}
