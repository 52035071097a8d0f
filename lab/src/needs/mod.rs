//! No more than a scene needs: what each saving brings, and what it costs.
//!
//! Five questions, each with its own scenes: what happens near a cloth, how exactly it is simulated, how it is searched,
//! what colliders are tested against, and how its particles are kept. What is compared takes its turns within one run.

mod apps;
mod charts;
mod entities;
#[path = "../../../benches/contact/press.rs"]
mod press;
mod search;
mod substepping;

use serde::{Deserialize, Serialize};

use crate::{
    chart::{Chart, number},
    experiment::{Experiment, Run, Table},
    measure::Spread,
};

pub struct Needs;

/// One choice in one scene.
#[derive(Serialize, Deserialize)]
pub struct Row {
    scene: String,
    choice: String,
    ms_per_tick: f64,
    error: f64,
    /// What the error is, and in which unit.
    error_of: String,
    ms_low: f64,
    ms_high: f64,
    /// Whether Bevy itself was compiled with all optimisations and without assertions.
    build: String,
}

impl Row {
    fn new(scene: &str, choice: &str, ms: &[f64], (error, error_of): (f64, &str)) -> Self {
        let Spread { low, median, high } = Spread::of(ms);
        Self {
            scene: scene.into(),
            choice: choice.into(),
            ms_per_tick: median,
            error,
            error_of: error_of.into(),
            ms_low: low,
            ms_high: high,
            build: if cfg!(debug_assertions) {
                DEV
            } else {
                "release"
            }
            .into(),
        }
    }
}

const DEV: &str = "dev";

/// What errors are.
const INSIDE: &str = "particles left inside of the ball in any tick";
const STRETCH: &str = "largest stretch in any tick";
const WRONG: &str = "contacts missed or imagined, against brute force";
const DEPTH: &str = "depth of triangles inside of the ball, in radii";
const DISTANCE: &str = "RMS distance to the vectorised columns after 1 s (m)";

impl Experiment for Needs {
    type Row = Row;

    const NAME: &'static str = "needs";

    fn run(run: &mut Run) -> Vec<Row> {
        run.begin(Self::NAME, 6);
        let parts = [
            apps::one_cloth,
            apps::many_cloths,
            substepping::measure,
            search::trees,
            search::narrow_phases,
            entities::measure,
        ];
        let mut rows = Vec::new();
        for part in parts {
            rows.extend(part(run));
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for row in rows {
            let is_valid = row.ms_per_tick > 0.0 && row.error >= 0.0;
            let is_exact = ![INSIDE, WRONG].contains(&row.error_of.as_str()) || row.error == 0.0;
            if !is_valid || !is_exact {
                return Err(format!(
                    "{}, {}: {} {}",
                    row.scene, row.choice, row.error, row.error_of
                ));
            }
        }
        let error =
            |scene: &str, choice: &str| get(rows, scene, choice).map_or(f64::NAN, |row| row.error);
        for (name, stretch) in substepping::TOLERANCES {
            let found = error(substepping::SCENE, name);
            if !is_within(found, f64::from(stretch)) {
                return Err(format!("{name}: stretched by {found}"));
            }
        }
        for (scene, _) in search::BALLS {
            let [particles, triangles] =
                [search::PARTICLES, search::TRIANGLES].map(|choice| error(scene, choice));
            if !is_within(triangles, particles + 1.0e-3) {
                return Err(format!(
                    "{scene}: {triangles} deep against triangles, {particles} against particles"
                ));
            }
        }
        for choice in [entities::SCALAR, entities::ENTITIES] {
            let distance = error(entities::SCENE, choice);
            if !is_within(distance, 2.0e-3) {
                return Err(format!("{choice} end {distance} m beside the columns"));
            }
        }
        let whole = 4 + 3 + 7 + 18 + 6 + 3;
        if rows.len() == whole {
            Ok(())
        } else {
            Err(format!("{} rows in place of {whole}", rows.len()))
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let ms = |scene: &str, choice: &str| {
            get(rows, scene, choice).map_or(f64::NAN, |row| row.ms_per_tick)
        };
        let error =
            |scene: &str, choice: &str| get(rows, scene, choice).map_or(f64::NAN, |row| row.error);
        let times =
            |scene: &str, dear: &str, cheap: &str| number_of(ms(scene, dear) / ms(scene, cheap));
        let percent = |scene: &str, choice: &str| 100.0 * error(scene, choice);
        use apps::{ALL_ASLEEP, ALL_AWAKE, ASLEEP, FAR, HUNDRED, NEAR, ONE, ONE_TOUCHED, TOUCHING};
        use entities::{COLUMNS, ENTITIES, SCALAR, SCENE as HUNG};
        use search::{PARTICLES, REFIT, REST_SHAPE, SCAN, TRIANGLES};
        use substepping::SCENE as SWING;
        let held = |name: &str, fixed: &str| {
            format!(
                "{name} takes {:.3} ms for {:.1} % at most, {fixed} {:.3} ms for {:.1} %",
                ms(SWING, name),
                percent(SWING, name),
                ms(SWING, fixed),
                percent(SWING, fixed)
            )
        };
        vec![
            format!(
                "A cloth of 64² that sleeps on a ball costs {:.4} ms a tick, 1/{} of one that a ball drags about ({:.3} ms); awake, a ball far away costs {:.3} ms, one near {:.3} ms. Nothing was left inside of the ball in any.",
                ms(ONE, ASLEEP),
                times(ONE, TOUCHING, ASLEEP),
                ms(ONE, TOUCHING),
                ms(ONE, FAR),
                ms(ONE, NEAR),
            ),
            format!(
                "Of 100 cloths of 16² with one touched, the others asleep, a tick takes {:.3} ms: {} × as fast as with all awake ({:.2} ms), and {:.3} ms more than with all asleep.",
                ms(HUNDRED, ONE_TOUCHED),
                times(HUNDRED, ALL_AWAKE, ONE_TOUCHED),
                ms(HUNDRED, ALL_AWAKE),
                ms(HUNDRED, ONE_TOUCHED) - ms(HUNDRED, ALL_ASLEEP),
            ),
            format!(
                "Precision over a fall, a calm and a gust: {}; {}.",
                held("tolerance 5 %", "10 sub-steps"),
                held("tolerance 2 %", "20 sub-steps"),
            ),
            format!(
                "For the finest, {}. {}",
                held("tolerance 1 %", "40 sub-steps"),
                substepping_verdict(rows)
            ),
            format!(
                "Tree against scan, one ball: the rest shape is {} × as fast as a scan at 16², {} × at 64², {} × at 256²; with 100 balls {}, {} and {} ×, refitted AABBs {}, {} and {} ×. {}",
                times("16², 1 ball", SCAN, REST_SHAPE),
                times("64², 1 ball", SCAN, REST_SHAPE),
                times("256², 1 ball", SCAN, REST_SHAPE),
                times("16², 100 balls", SCAN, REST_SHAPE),
                times("64², 100 balls", SCAN, REST_SHAPE),
                times("256², 100 balls", SCAN, REST_SHAPE),
                times("16², 100 balls", SCAN, REFIT),
                times("64², 100 balls", SCAN, REFIT),
                times("256², 100 balls", SCAN, REFIT),
                same_found(rows),
            ),
            format!(
                "{}; how deep the ball is in flat triangles, of its radius: {}.",
                narrow_factors(rows).map_or(
                    "No ball was held by both particles and triangles, so that their times can't be compared".into(),
                    |[low, high]| format!(
                        "Where both hold the ball, the response against particles is {} to {} × as fast as against triangles",
                        number_of(low),
                        number_of(high)
                    )
                ),
                search::BALLS
                    .map(|(scene, _)| format!(
                        "{scene} {} against particles, {} against triangles",
                        depth(error(scene, PARTICLES)),
                        depth(error(scene, TRIANGLES))
                    ))
                    .join("; "),
            ),
            format!(
                "A cloth of 32² with an entity for each particle takes {:.2} ms a tick, {} × as long as the same method over columns, in the same order, one spring after the other ({:.3} ms): that is what storage does. Vectorising, which columns allow, is the rest: the solver's {:.3} ms, {} × as fast as that loop. After a second the loops are {:.3} and {:.3} mm RMS from the solver.{}",
                ms(HUNG, ENTITIES),
                times(HUNG, ENTITIES, SCALAR),
                ms(HUNG, SCALAR),
                ms(HUNG, COLUMNS),
                times(HUNG, SCALAR, COLUMNS),
                1.0e3 * error(HUNG, ENTITIES),
                1.0e3 * error(HUNG, SCALAR),
                if rows.iter().any(|row| row.build == DEV) {
                    " In this dev build Bevy's own queries are hardly optimised and full of assertions: in a release build they are several times as fast."
                } else {
                    ""
                },
            ),
        ]
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new(["scene", "choice", "ms a tick", "quartiles", "error", "of"]);
        for row in rows {
            table.row([
                row.scene.clone(),
                row.choice.clone(),
                format!("{:.4}", row.ms_per_tick),
                format!("{:.4} to {:.4}", row.ms_low, row.ms_high),
                number(row.error),
                row.error_of.clone(),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![charts::all(rows)]
    }
}

/// NaN is not.
fn is_within(value: f64, limit: f64) -> bool {
    value <= limit
}

/// Whether a tolerance is the cheaper way to its own stretch.
fn substepping_verdict(rows: &[Row]) -> String {
    let scene = || rows.iter().filter(|row| row.scene == substepping::SCENE);
    let mut losers = Vec::new();
    for (name, _) in substepping::TOLERANCES {
        let Some(tolerance) = get(rows, substepping::SCENE, name) else {
            continue;
        };
        let is_tolerance = |row: &&Row| {
            substepping::TOLERANCES
                .iter()
                .any(|(t, _)| *t == row.choice)
        };
        let beats =
            |row: &&Row| row.ms_per_tick <= tolerance.ms_per_tick && row.error <= tolerance.error;
        losers.extend(
            scene()
                .filter(|row| !is_tolerance(row))
                .filter(beats)
                .map(|row| format!("{} beat {name}", row.choice)),
        );
    }
    if losers.is_empty() {
        "No fixed number measured is both faster and less stretched than a tolerance.".into()
    } else {
        format!(
            "Of fixed numbers, both faster and less stretched: {}; but who would know which?",
            losers.join(", ")
        )
    }
}

/// Whether the searches found the very contacts of brute force.
fn same_found(rows: &[Row]) -> String {
    let searches = rows.iter().filter(|row| row.error_of == WRONG);
    let wrong: f64 = searches.map(|row| row.error).sum();
    if wrong == 0.0 {
        "All find the contacts of brute force and no others.".into()
    } else {
        format!("{wrong:.0} contacts are missed or imagined.")
    }
}

/// A ball this many radii deep has left the cloth behind.
fn fell_through(depth: f64) -> bool {
    depth >= 1.0
}

/// How deep a ball is, in words.
fn depth(radii: f64) -> String {
    if fell_through(radii) {
        "falls through".into()
    } else {
        format!("{:.1} %", 100.0 * radii)
    }
}

/// How many times faster particles are than triangles, at least and at most: where the ball is held by both, since what
/// it fell through has nothing to respond to.
fn narrow_factors(rows: &[Row]) -> Option<[f64; 2]> {
    let factors = search::BALLS.iter().filter_map(|(scene, _)| {
        let [particles, triangles] =
            [search::PARTICLES, search::TRIANGLES].map(|choice| get(rows, scene, choice));
        let (particles, triangles) = particles.zip(triangles)?;
        let is_held = ![particles, triangles]
            .iter()
            .any(|row| fell_through(row.error));
        is_held.then(|| triangles.ms_per_tick / particles.ms_per_tick)
    });
    factors.fold(None, |range, factor| {
        let [low, high] = range.unwrap_or([factor; 2]);
        Some([factor.min(low), factor.max(high)])
    })
}

/// With as many digits as say something.
fn number_of(value: f64) -> String {
    let digits = if value < 0.1 {
        3
    } else if value < 10.0 {
        1
    } else {
        0
    };
    format!("{value:.digits$}")
}

fn get<'a>(rows: &'a [Row], scene: &str, choice: &str) -> Option<&'a Row> {
    rows.iter()
        .find(|row| row.scene == scene && row.choice == choice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    #[test]
    fn needs_are_complete_and_savings_are_exact() {
        let rows = quick::<Needs>(
            View::Nothing,
            "scene,choice,ms_per_tick,error,error_of,ms_low,ms_high",
        );
        assert!(rows.iter().all(|row| row.ms_low <= row.ms_high));
        let stretch = |choice| get(&rows, substepping::SCENE, choice).map_or(0.0, |row| row.error);
        assert!(stretch("5 sub-steps") > stretch("40 sub-steps"));
    }
}
