//! How sheets swing, ring and sag, against closed forms: what falsifies the motion is seen here, whatever the stretch.
//!
//! Sheets hang by their top row and are let go in the shape of one of their first three modes; a membrane of cotton is stretched
//! by 1 % on a frame and let go in its first; a strip of cotton is held at the ends of a span as long as itself. Undamped, but for
//! the strip, and with the settings by default but for the sub-steps.

mod charts;

use bevy_drape::{
    cloth::ClothMaterial,
    solver::{ClothSettings, TickStep},
};
use examples_shared::{
    modes::{
        ROOTS, hanging_found, hanging_period, membrane_found, membrane_period, taut_found, taut_sag,
    },
    sheet::threads,
};
use serde::{Deserialize, Serialize};

use crate::{
    experiment::{Experiment, Run, Table},
    measure::distinct,
};

const HANGING: [(&str, Material, f64); 4] = [
    ("hanging 1 m, rigid", Material::Rigid, 1.0),
    ("hanging 1 m, cotton", Material::Cotton, 1.0),
    ("hanging 2 m, rigid", Material::Rigid, 2.0),
    ("hanging 2 m, cotton", Material::Cotton, 2.0),
];
const MEMBRANE: &str = "membrane, 1 %";
const STRIP: &str = "taut strip, 2 m";

/// Columns of a hanging sheet and rows of a strip, both of which count for nothing.
const COLUMNS: u32 = 8;
const STRIP_ROWS: u32 = 2;
const STRIP_LENGTH: f64 = 2.0;

/// From this many sub-steps on periods and sags have to be true, by parts: with the default, that is.
const ENOUGH: u32 = 20;
const HANGING_WITHIN: f64 = 0.02;
const MEMBRANE_WITHIN: f64 = 0.05;
const STRIP_WITHIN: f64 = 0.03;

/// The third mode of 16 rows is not a continuum's any more: of those with fewer rows than this only the first is held to it.
const FINE: usize = 64 * COLUMNS as usize;

#[derive(Clone, Copy)]
enum Material {
    Rigid,
    Cotton,
}

impl Material {
    /// Without bending and damping.
    fn threads(self) -> ClothMaterial {
        let cotton = ClothMaterial::COTTON;
        match self {
            Self::Rigid => threads(0.0, 0.0),
            Self::Cotton => threads(cotton.stretch_compliance, cotton.shear_compliance),
        }
    }
}

pub struct Waves;

/// One mode of one sheet.
#[derive(Serialize, Deserialize)]
pub struct Row {
    scene: String,
    particles: usize,
    /// From 1.
    mode: usize,
    substeps: u32,
    /// Found (s), and infinite where nothing swings; of the strip, its sag (m).
    period: f64,
    /// In closed form, the same.
    truth: f64,
}

impl Row {
    fn ratio(&self) -> f64 {
        self.period / self.truth
    }

    fn is_true(&self) -> bool {
        let within = match self.scene.as_str() {
            MEMBRANE => MEMBRANE_WITHIN,
            STRIP => STRIP_WITHIN,
            // What cotton gives rings along its threads, and is seen in its shorter waves.
            _ if self.mode == 3 => 2.5 * HANGING_WITHIN,
            _ => HANGING_WITHIN,
        };
        (self.ratio() - 1.0).abs() <= within
    }

    /// Whether it has to be true: where the ripples that its tension makes are resolved, which of a membrane of 65² takes 40
    /// sub-steps.
    fn counts(&self) -> bool {
        let is_fine_membrane = self.scene.starts_with("membrane") && self.particles > 33 * 33;
        let is_resolved =
            !self.scene.starts_with("hanging") || self.mode == 1 || self.particles >= FINE;
        let enough = if is_fine_membrane { 2 * ENOUGH } else { ENOUGH };
        self.substeps >= enough && is_resolved
    }
}

impl Experiment for Waves {
    type Row = Row;

    const NAME: &'static str = "waves";

    fn run(run: &mut Run) -> Vec<Row> {
        run.set("hanging", "a sheet of 8 columns, hung by its top row and let go in the shape J0(j sqrt(s / L)) of a mode, sloped by 1.5 % at most; truth: 2 pi / (j / 2 sqrt(g / L))");
        run.set("membrane", "cotton, 1 m x 1 m at rest, stretched by 1 % on its frame and let go in its first mode, 1 mm high; truth: sqrt(2 rho / N)");
        run.set(
            "taut strip",
            "cotton without diagonals, its ends held 2 m apart, as long as it is: period and truth are its sag (m) after 12 s, damped",
        );
        run.set(
            "period",
            "mean of 5, zero crossings interpolated between sub-steps; inf: none within 20 true periods; 60 ticks a second",
        );
        let substeps = run.either(vec![20], vec![10, 20, 40, 80]);
        let rows_of = run.either(vec![16, 64], vec![16, 32, 64, 128]);
        let sides = run.either(vec![17, 33], vec![17, 33, 65]);
        let tethers = ClothSettings::default().tethers;
        let per_substeps = HANGING.len() * rows_of.len() + 2 * sides.len();
        run.begin(Self::NAME, substeps.len() * per_substeps);
        let mut rows = Vec::new();
        for substeps in substeps {
            let step = TickStep {
                seconds: 1.0 / 60.0,
                substeps,
                ..TickStep::default()
            };
            for (scene, material, length) in HANGING {
                let material = material.threads();
                for &count in &rows_of {
                    for mode in 0..ROOTS.len() {
                        rows.push(Row {
                            scene: scene.into(),
                            particles: (count * COLUMNS) as usize,
                            mode: mode + 1,
                            substeps,
                            period: hanging_found(count, length, mode, &material, step, tethers),
                            truth: hanging_period(length, mode),
                        });
                    }
                    run.step();
                }
            }
            let material = Material::Cotton.threads();
            for &side in &sides {
                let first = |scene: &str, particles: u32, period, truth| Row {
                    scene: scene.into(),
                    particles: particles as usize,
                    mode: 1,
                    substeps,
                    period,
                    truth,
                };
                let found = membrane_found(side, &material, step, tethers, None);
                rows.push(first(
                    MEMBRANE,
                    side * side,
                    found,
                    membrane_period(&material),
                ));
                run.step();
                let found = taut_found(side, STRIP_LENGTH, &material, step, tethers);
                let truth = taut_sag(STRIP_LENGTH, &material);
                rows.push(first(STRIP, side * STRIP_ROWS, found, truth));
                run.step();
            }
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        let scenes = distinct(rows.iter().map(|row| row.scene.as_str()));
        if scenes.len() != HANGING.len() + 2 {
            return Err(format!("{} scenes", scenes.len()));
        }
        let wrong: Vec<String> = rows
            .iter()
            .filter(|row| row.counts() && !row.is_true())
            .map(|row| {
                format!(
                    "{}, {} particles, mode {}, {} sub-steps: {:.3} of the closed form",
                    row.scene,
                    row.particles,
                    row.mode,
                    row.substeps,
                    row.ratio()
                )
            })
            .collect();
        if wrong.is_empty() {
            Ok(())
        } else {
            Err(wrong.join("\n"))
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let mut findings = Vec::new();
        for (name, is_of) in charts::GROUPS {
            let of: Vec<&Row> = rows
                .iter()
                .filter(|row| is_of(row) && row.counts())
                .collect();
            let ratios = || of.iter().map(|row| row.ratio());
            let [low, high] = [
                ratios().fold(f64::INFINITY, f64::min),
                ratios().fold(0.0, f64::max),
            ];
            findings.push(format!(
                "{name}: {low:.3} to {high:.3} of the closed form, from {ENOUGH} sub-steps on."
            ));
        }
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "scene",
            "particles",
            "mode",
            "sub-steps",
            "period, s, or sag, m",
            "closed form",
            "ratio",
        ]);
        for row in rows {
            table.row([
                row.scene.clone(),
                row.particles.to_string(),
                row.mode.to_string(),
                row.substeps.to_string(),
                format!("{:.4}", row.period),
                format!("{:.4}", row.truth),
                format!("{:.3}", row.ratio()),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<crate::chart::Chart> {
        vec![charts::all(rows)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn modes_are_measured_against_closed_forms() {
        let rows = quick::<Waves>(View::Nothing, "scene,particles,mode,substeps,period,truth");
        assert_eq!(rows.len(), HANGING.len() * 2 * 3 + 2 * 2);
    }

    /// 2 m of anything: 2.359 s. 1 % of cotton on a frame: 20 Hz. Cotton over 2 m: 48 mm.
    #[test]
    fn closed_forms_are_known() {
        let cotton = Material::Cotton.threads();
        assert!((hanging_period(2.0, 0) - 2.359).abs() < 1e-3);
        assert!((membrane_period(&cotton) - 0.0502).abs() < 1e-4);
        assert!((taut_sag(2.0, &cotton) - 0.048).abs() < 1e-4);
    }
}
