//! Motions that are smooth in time, to see with which power of the sub-step an error falls.

use bevy::math::Vec3;
use bevy_drape::solver::TickStep;

use super::{
    exact::Exact,
    modes::{hanging_places, hanging_shape},
    sheet::{GRAVITY, Sheet, threads},
};

/// Of threads and diagonals (m/N).
const COMPLIANCE: f32 = 1.0e-3;

/// Ticks of 1/60 s after which an error is taken: half a second.
const TICKS: u32 = 30;

/// Explicit steps of the reference in each tick: with ω up to 10⁴/s at 64² the stiffest wave is cut into 19 of them.
const EXACT_STEPS: u32 = 512;

/// A motion's name, and how it begins.
pub struct Smooth {
    pub name: &'static str,
    /// Sub-steps a tick to compare: what moves slowly is soon exact to rounding.
    pub substeps: [u32; 6],
    sheet: fn(TickStep) -> Sheet,
}

impl Smooth {
    pub const ALL: [Self; 4] = [
        Self {
            name: "pendulum, 2²",
            substeps: [1, 2, 4, 8, 16, 32],
            sheet: pendulum,
        },
        Self {
            name: "swing, 32²",
            substeps: [1, 2, 4, 8, 16, 32],
            sheet: swing,
        },
        Self {
            name: "fall, 32²",
            substeps: [5, 10, 20, 40, 80, 160],
            sheet: |step| fall(32, step),
        },
        Self {
            name: "fall, 64²",
            substeps: [5, 10, 20, 40, 80, 160],
            sheet: |step| fall(64, step),
        },
    ];

    /// Where it is after half a second, and how far that is from the same by half as many steps (m, RMS).
    pub fn reference(&self) -> (Exact, f64) {
        let by = |steps: u32| {
            let mut exact = Exact::of(&(self.sheet)(TickStep::default()));
            exact.advance(f64::from(TICKS) / 60.0, TICKS * steps);
            exact
        };
        let exact = by(EXACT_STEPS);
        let apart = exact.distance(by(EXACT_STEPS / 2).places());
        (exact, apart)
    }

    /// How far the solver is from there (m, RMS), by `step` with 1/60 s a tick: by solving threads alone, or by forces alone. Those
    /// are for short sub-steps: `None` for others.
    pub fn error(&self, step: TickStep, by_forces: bool, reference: &Exact) -> Option<f64> {
        let mut sheet = (self.sheet)(TickStep {
            seconds: 1.0 / 60.0,
            ..step
        });
        let longest = sheet.solver.longest_explicit_substep(&sheet.particles);
        if !by_forces {
            sheet.solver.forget_soft_springs();
        } else if sheet.step.seconds / step.substeps as f32 > longest {
            return None;
        }
        for _ in 0..TICKS {
            sheet.tick(|_, _| {});
        }
        let places = sheet.particles.positions();
        Some(reference.distance(places.map(Vec3::as_dvec3)))
    }
}

/// 2 m × 2 m, hung by the top row, falls from the horizontal. A bend runs down from that row.
fn fall(side: u32, step: TickStep) -> Sheet {
    let spacing = 2.0 / (side - 1) as f32;
    let place = |row: u32, column: u32| spacing * Vec3::new(column as f32, 0.0, row as f32);
    let material = threads(COMPLIANCE, COMPLIANCE);
    Sheet::new((side, side), spacing, material, step, place, |row, _| {
        row == 0
    })
}

/// 2 m × 2 m, hung by the top row, let go in the shape of its first mode, 0.4 m aside at the free end, and as long as its weight
/// makes it. It has no diagonals, which would be stretched by that.
fn swing(step: TickStep) -> Sheet {
    let side = 32_u32;
    let spacing = 2.0 / f64::from(side - 1);
    let material = threads(COMPLIANCE, f32::INFINITY);
    // What hangs below the middle of a spring is that spring's load, and half a spacing less: the last row is half a row.
    let load = f64::from(material.areal_density) * GRAVITY * spacing * spacing;
    let given = f64::from(COMPLIANCE) * load;
    let below = |row: u32| f64::from(side - 1 - row) - 0.5;
    let lengths: Vec<f64> = (0..side - 1)
        .map(|row| spacing + given * below(row))
        .collect();
    let places = hanging_places(&lengths, &hanging_shape(side, 0), 0.4);
    let place = |row: u32, column: u32| {
        let [y, z] = places[row as usize];
        Vec3::new((spacing * f64::from(column)) as f32, y as f32, z as f32)
    };
    let size = (side, side);
    Sheet::new(size, spacing as f32, material, step, place, |row, _| {
        row == 0
    })
}

/// One cell of 1 m × 1 m, hung by its upper side and let go 0.5 rad aside, as long as its weight makes it there.
fn pendulum(step: TickStep) -> Sheet {
    let material = threads(COMPLIANCE, f32::INFINITY);
    let angle = 0.5_f32;
    // Half of the cell's mass is in its lower row.
    let pull = 0.5 * material.areal_density * GRAVITY as f32 * angle.cos();
    let length = 1.0 + COMPLIANCE * pull;
    let place = |row: u32, column: u32| {
        let down = Vec3::new(0.0, -angle.cos(), angle.sin());
        Vec3::X * column as f32 + down * (row as f32 * length)
    };
    Sheet::new((2, 2), 1.0, material, step, place, |row, _| row == 0)
}
