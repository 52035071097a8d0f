//! Speed against accuracy: every solver over its settings, on cloths that hang, swing and are pushed by a ball.
//!
//! Error is the RMS distance from a converged motion, over all particles and ticks; time is the solver's alone.

mod charts;
mod frontier;
mod methods;
mod reference;
mod scenes;

use std::collections::HashMap;

use bevy::math::DVec3;
use bevy_drape::cloth::SpringKind;
use serde::{Deserialize, Serialize};

use crate::{
    chart::Chart,
    experiment::{Experiment, Run, Table},
    measure::Spread,
    methods::{MassSpring, largest_frequency},
};
use frontier::Group;
use methods::{METHODS, ONE_SWEEP, OURS, Player, SMALL_STEPS, Way};
use reference::Reference;
use scenes::{Ball, Case, STIFF_SWINGING, TICKS};

/// What takes longer in its first turn (s) is timed in that alone.
const LONG: f64 = 0.5;

/// Smaller errors (m) may be the rounding of single precision, which more sub-steps do not make less.
const MIN_KNOWN: f64 = 2.0e-3;

/// In short runs and in whole ones.
const TURNS: [usize; 2] = [3, 5];

pub struct Pareto;

/// One method with one setting, in one scene.
#[derive(Serialize, Deserialize)]
pub struct Row {
    scene: String,
    method: String,
    setting: String,
    particles: usize,
    ms_per_second: f64,
    rms_error_m: f64,
    /// The largest of a structural spring at the end of any tick.
    max_stretch: f64,
    /// The deepest that any particle was found inside of the ball at the end of any step or sub-step, before it was
    /// pushed out; 0 without a ball.
    max_penetration_m: f64,
    ms_low: f64,
    ms_high: f64,
    /// Steps or sub-steps a tick, those in vain included.
    substeps: f64,
    compliance: f32,
    /// How far the reference moved when its sub-steps were doubled for the last time: smaller errors are not told
    /// apart.
    reference_error_m: f64,
    reference_stretch: f64,
    reference_substeps: u32,
}

impl Row {
    /// Its error, as far as it is known.
    fn error(&self) -> f64 {
        self.rms_error_m.max(self.reference_error_m)
    }

    /// Whether it takes no longer than another and is no farther off.
    fn is_as_good_as(&self, other: &Self) -> bool {
        self.ms_per_second <= other.ms_per_second && self.error() <= other.error()
    }

    /// The same, and is better in one.
    fn beats(&self, other: &Self) -> bool {
        self.is_as_good_as(other) && !other.is_as_good_as(self)
    }
}

impl Experiment for Pareto {
    type Row = Row;

    const NAME: &'static str = "pareto";

    fn run(run: &mut Run) -> Vec<Row> {
        let (sides, doubled, enough) = run.either(
            (&[16][..], [160, 320], 1.0e-4),
            (&[64, 32][..], [640, 1280], 1.0e-5),
        );
        let turns = run.either(TURNS[0], TURNS[1]);
        run.set("scenes", format!("cloths 2 m wide, 0.15 kg/m², grids and a Delaunay mesh of vertices moved by 0.3 spacings, hung by the top row, 60 ticks a second, 1 s; the ball of radius {} m moves {} m into the cloth, without friction", Ball::RADIUS, Ball::WAY));
        run.set("time", format!("the solver's alone, with its contacts, on one thread, made ready before; median of {turns} turns, in which all take part, or the one turn of what takes more than {LONG} s"));
        run.set("reference", format!("small steps in f64, sub-steps a tick doubled from {} until that moves particles by {enough} m or there are {}", doubled[0], doubled[1]));
        run.set("peers", "plain scalar code of the same crate, f32; they push particles out of the ball at the end of each step or sub-step, by the same law as the plugin");
        let cases: Vec<Case> = sides
            .iter()
            .flat_map(|&side| Case::all(side))
            // So much is seen in the smaller ones.
            .filter(|case| case.name != STIFF_SWINGING || case.particles() < 64 * 64)
            .collect();
        run.begin(Self::NAME, (1 + turns) * cases.len());
        let references = Reference::all(&cases, doubled, enough, || run.step());
        let mut frequencies: HashMap<(usize, bool), f64> = HashMap::new();
        let mut rows = Vec::new();
        for (case, reference) in cases.iter().zip(&references) {
            // Neither turning a cloth nor a ball changes it.
            let frequency = frequencies
                .entry((case.particles(), case.is_mesh()))
                .or_insert_with(|| {
                    let network: MassSpring<f64> =
                        MassSpring::of_scene(&case.scene).expect("a valid network");
                    largest_frequency(&network) / case.stiffness()
                });
            let ways = Way::all(
                case.explicit_limit(*frequency * case.stiffness()),
                run.quick,
            );
            rows.extend(measure(run, case, reference, &ways, turns));
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for row in rows {
            let is_valid = row.ms_per_second > 0.0
                && row.rms_error_m.is_finite()
                && row.max_stretch.is_finite()
                && row.max_penetration_m >= 0.0;
            if !is_valid {
                return Err(format!(
                    "{}: {} by {} is no result",
                    row.scene, row.method, row.setting
                ));
            }
        }
        for group in Group::all(rows) {
            let name = group.name();
            if let Some(missing) = METHODS
                .iter()
                .find(|method| group.of(method).next().is_none())
            {
                return Err(format!("{name}: {missing} is missing"));
            }
            let frontier = group.frontier();
            for row in group.rows() {
                let is_best = frontier.iter().any(|best| std::ptr::eq(*best, *row));
                let better = group.rows().iter().find(|other| other.beats(row));
                if let (true, Some(other)) = (is_best, better) {
                    return Err(format!(
                        "{name}: {} by {} beats {} by {}, which the frontier has",
                        other.method, other.setting, row.method, row.setting
                    ));
                }
                if !is_best && !frontier.iter().any(|best| best.is_as_good_as(row)) {
                    return Err(format!(
                        "{name}: nothing on the frontier is as good as {} by {}",
                        row.method, row.setting
                    ));
                }
            }
            let own: Vec<f64> = group.of(OURS).map(Row::error).collect();
            if let [first, .., last] = own[..]
                && first > (4.0 * group.first().reference_error_m).max(MIN_KNOWN)
                && last > first / 2.0
            {
                return Err(format!(
                    "{name}: ours is off by {first} m with the fewest sub-steps and by {last} m with the most"
                ));
            }
            for method in [OURS, ONE_SWEEP, SMALL_STEPS] {
                let known: Vec<&Row> = group.of(method).collect();
                let rises = |pair: &&[&Row]| {
                    pair[1].rms_error_m > 1.1 * pair[0].rms_error_m
                        && pair[1].rms_error_m > (3.0 * pair[1].reference_error_m).max(MIN_KNOWN)
                };
                if let Some(pair) = known.windows(2).find(rises) {
                    return Err(format!(
                        "{name}: {method} is off by {} m at {} and by {} m at {}",
                        pair[0].rms_error_m, pair[0].setting, pair[1].rms_error_m, pair[1].setting
                    ));
                }
            }
        }
        Ok(())
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        frontier::findings(rows)
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "scene, what nothing beats",
            "particles",
            "method",
            "setting",
            "ms a second",
            "quartiles",
            "error, mm",
            "stretch, %",
            "deepest, mm",
        ]);
        for group in Group::all(rows) {
            for row in group.frontier() {
                table.row([
                    row.scene.clone(),
                    row.particles.to_string(),
                    row.method.clone(),
                    row.setting.clone(),
                    format!("{:.1}", row.ms_per_second),
                    format!("{:.1} to {:.1}", row.ms_low, row.ms_high),
                    format!("{:.3}", 1.0e3 * row.rms_error_m),
                    format!("{:.2}", 100.0 * row.max_stretch),
                    format!("{:.4}", 1.0e3 * row.max_penetration_m),
                ]);
            }
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        charts::all(rows)
    }
}

/// What comes of a motion.
#[derive(Default, Clone, Copy)]
struct Outcome {
    squares: f64,
    stretch: f64,
    penetration: f64,
}

impl Outcome {
    /// Takes a tick's end into account.
    fn see(&mut self, threads: &[([usize; 2], f64)], positions: &[DVec3]) {
        for &([a, b], rest_length) in threads {
            let stretch = positions[a].distance(positions[b]) / rest_length - 1.0;
            // NaN has to be seen.
            if stretch > self.stretch || stretch.is_nan() {
                self.stretch = stretch;
            }
        }
    }
}

/// Ends and rest lengths (m) of structural springs.
fn threads(case: &Case) -> Vec<([usize; 2], f64)> {
    let springs = case.scene.springs.to_vec().into_iter();
    springs
        .filter(|spring| spring.kind == SpringKind::Structural)
        .map(|spring| {
            let ends = spring.ends.map(|end| end as usize);
            (ends, f64::from(spring.rest_length))
        })
        .collect()
}

/// All ways through a case, turn by turn.
fn measure(run: &Run, case: &Case, reference: &Reference, ways: &[Way], turns: usize) -> Vec<Row> {
    let threads = threads(case);
    let mut truth = Outcome::default();
    for positions in &reference.film {
        truth.see(&threads, positions);
    }
    let mut trials: Vec<(Vec<f64>, Outcome, u32)> = vec![Default::default(); ways.len()];
    let mut positions = Vec::new();
    for _ in 0..turns {
        for (way, (times, outcome, substeps)) in ways.iter().zip(&mut trials) {
            if times.first().is_some_and(|&first| first > LONG) {
                continue;
            }
            *outcome = Outcome::default();
            let mut player: Player<f32> = Player::new(case, *way);
            let mut seconds = 0.0;
            for (tick, truth) in reference.film.iter().enumerate() {
                seconds += player.tick(tick as u32).as_secs_f64();
                player.positions(&mut positions);
                outcome.see(&threads, &positions);
                let pairs = positions.iter().zip(truth);
                outcome.squares += pairs.map(|(a, b)| a.distance_squared(*b)).sum::<f64>();
            }
            times.push(seconds);
            outcome.penetration = player.deepest();
            *substeps = player.substeps();
        }
        run.step();
    }
    let places = f64::from(TICKS) * case.particles() as f64;
    ways.iter()
        .zip(trials)
        .map(|(way, (times, outcome, substeps))| {
            let ms = Spread::of(&times.iter().map(|time| 1.0e3 * time).collect::<Vec<_>>());
            Row {
                scene: case.name.into(),
                method: way.method().into(),
                setting: way.setting(),
                particles: case.particles(),
                ms_per_second: ms.median,
                rms_error_m: (outcome.squares / places).sqrt(),
                max_stretch: outcome.stretch,
                max_penetration_m: outcome.penetration,
                ms_low: ms.low,
                ms_high: ms.high,
                substeps: f64::from(substeps) / f64::from(TICKS),
                compliance: case.scene.material.stretch_compliance,
                reference_error_m: reference.error,
                reference_stretch: truth.stretch,
                reference_substeps: reference.substeps,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn pareto_is_complete_and_its_frontier_is_one() {
        let rows = quick::<Pareto>(
            View::Nothing,
            "scene,method,setting,particles,ms_per_second,rms_error_m,max_stretch,max_penetration_m",
        );
        assert_eq!(Group::all(&rows).len(), 6);
        // All are found inside of the ball where there is one, by no more than a few of its ways in a step.
        for row in &rows {
            let is_within = if row.scene == scenes::BALL {
                row.max_penetration_m > 1.0e-6 && row.max_penetration_m < 0.2 * f64::from(Ball::WAY)
            } else {
                row.max_penetration_m == 0.0
            };
            assert!(
                is_within,
                "{}, {}: {}",
                row.method, row.setting, row.max_penetration_m
            );
        }
        // The plain small steps are the same method as ours.
        for group in Group::all(&rows) {
            for (ours, plain) in group.of(ONE_SWEEP).zip(group.of(SMALL_STEPS)) {
                let apart = (ours.rms_error_m - plain.rms_error_m).abs();
                assert!(
                    apart < 0.05 * plain.rms_error_m + plain.reference_error_m,
                    "{}: {} {}",
                    group.name(),
                    ours.rms_error_m,
                    plain.rms_error_m
                );
            }
        }
    }
}
