//! A strip that is clamped level at one end, and droops.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{ClothMaterial, Spring, SpringKind, Springs},
    solver::{Solver, TickStep},
};
use examples_shared::sheet::{GRAVITY, Sheet, threads};

/// Free length (m), and mass per area (kg/m²).
const LENGTH: f32 = 0.3;
const DENSITY: f32 = 0.15;

/// Ticks of 1/60 s until it hangs still, losing 5 % of its velocity in each.
const TICKS: u32 = 480;

/// Rigidity (N·m) of a strip whose weight is Γ times what bends it: Γ = w L³ ⁄ D.
pub fn rigidity(gamma: f64) -> f64 {
    f64::from(DENSITY) * GRAVITY * f64::from(LENGTH).powi(3) / gamma
}

/// What a strip of this rigidity (N·m) is made of.
fn strip_material(rigidity: f32) -> ClothMaterial {
    ClothMaterial {
        areal_density: DENSITY,
        damping: 0.05,
        bend_rigidity: rigidity,
        ..threads(0.0, 1.0e-3)
    }
}

/// How far its free end is below its clamped one, as a part of its length, with `columns` particles along it and `rows` across.
pub fn drop_of(gamma: f64, [columns, rows]: [u32; 2], substeps: u32) -> f64 {
    let material = strip_material(rigidity(gamma) as f32);
    settle(strip([columns, rows], substeps, material))
}

/// The same with rigid springs between every second particle of a row in place of what the material says: they know of no Γ.
pub fn drop_of_chords([columns, rows]: [u32; 2], substeps: u32) -> f64 {
    let material = ClothMaterial {
        damping: 0.05,
        ..threads(0.0, 1.0e-3)
    };
    let mut sheet = strip([columns, rows], substeps, material);
    let spacing = sheet.grid().spacing().x;
    let mut springs = Vec::new();
    for (row, column) in sheet.grid().cells() {
        if column + 2 < columns {
            springs.push(Spring {
                kind: SpringKind::Bend,
                ends: [column, column + 2].map(|column| sheet.grid().index(row, column)),
                rest_length: 2.0 * spacing,
                compliance: 0.0,
            });
        }
    }
    // What is stiffer has the last word.
    springs.extend(sheet.springs.iter().copied());
    let springs = Springs::of_list(&springs, sheet.particles.len()).expect("valid springs");
    sheet.solver = Solver::new(&springs, &sheet.particles);
    settle(sheet)
}

/// The first two columns are clamped: the strip is level halfway between them, where its free length begins.
fn strip([columns, rows]: [u32; 2], substeps: u32, material: ClothMaterial) -> Sheet {
    let spacing = LENGTH / (columns as f32 - 1.5);
    let step = TickStep {
        seconds: 1.0 / 60.0,
        substeps,
        ..TickStep::default()
    };
    let place = |row: u32, column: u32| spacing * Vec3::new(column as f32, 0.0, row as f32);
    let clamped = |_, column| column < 2;
    Sheet::new((columns, rows), spacing, material, step, place, clamped)
}

fn settle(mut sheet: Sheet) -> f64 {
    for _ in 0..TICKS {
        sheet.tick(|_, _| {});
    }
    let (rows, end) = (sheet.grid().rows(), sheet.grid().columns() - 1);
    let heights = (0..rows).map(|row| sheet.particles.position((row, end)).expect("it exists").y);
    -f64::from(heights.sum::<f32>() / rows as f32 / LENGTH)
}
