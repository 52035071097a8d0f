//! Scenes of games: meshes with a material, on bodies and with gas in them.

mod meshes;
mod players;
mod scenes;

use bevy::math::Vec3;

use self::scenes::{FRAMES, Game, LAST, SETTINGS};
use crate::{
    collider::depths,
    game_row::GameRow,
    outcome::{Milliseconds, Play, larger, median, stretch},
    player::{Player, play},
    record,
    told::{FRAME, Told},
    turns,
};

/// The result of a scene.
struct Outcome {
    ms: Milliseconds,
    stretch: [f64; 2],
    /// Of vertices and of triangles (m).
    depths: [f64; 2],
    /// m³
    volume: f64,
    /// In the mean over all vertices (m).
    height: f64,
}

impl Outcome {
    fn of(play: &Play, told: &Told) -> Self {
        let place = |vertex: u32| Vec3::from_array(told.positions[vertex as usize]).as_dvec3();
        let springs: Vec<([u32; 2], f64)> = told
            .springs
            .iter()
            .map(|&[a, b]| ([a, b], place(a).distance(place(b))))
            .collect();
        let mut deepest = [0.0; 2];
        let (mut volume, mut height) = (0.0, 0.0);
        for (frame, places) in (FRAMES - LAST + 1..).zip(&play.last) {
            let seconds = frame as f32 * FRAME;
            let found = depths(places, &told.triangles, &told.colliders, seconds);
            deepest = [0, 1].map(|which| larger(deepest[which], found[which]));
            volume += meshes::volume(places, &told.triangles);
            height += places.iter().map(|place| f64::from(place[1])).sum::<f64>();
        }
        let count = play.last.len() as f64;
        Self {
            ms: play.ms,
            stretch: stretch(&play.last, &springs),
            depths: deepest,
            volume: volume / count,
            height: height / count / told.positions.len() as f64,
        }
    }
}

/// Plays all scenes from so many starts by all solvers whose names contain `only`, and returns rows, and what else the header says.
///
/// # Errors
/// If the plugin itself can't play a scene.
pub fn run(
    is_quick: bool,
    starts: u32,
    only: &str,
) -> Result<(Vec<GameRow>, record::Header), String> {
    let (mut rows, mut left_out, mut checks) = (Vec::new(), Vec::new(), Vec::new());
    for game in Game::all() {
        println!("{}", game.name);
        let truth = truth(&game, &mut checks)?;
        let mut all = players::all(&game, is_quick);
        all.retain(|player| player.solver.contains(only));
        let outcomes = turns(game.name, &all, starts, &mut left_out, |player, start| {
            outcome(&game, player, start)
        });
        for (player, outcomes) in all.iter().zip(&outcomes) {
            if !outcomes.is_empty() {
                let row = row(&game, player, outcomes, truth.as_ref());
                print(&row);
                rows.push(row);
            }
        }
    }
    let mut header: record::Header = SETTINGS.map(|(name, value)| (name, value.into())).into();
    header.push((
        "100 sub-steps in place of 200",
        format!("differ by {}", checks.join(", ")),
    ));
    header.push(("starts", format!("{starts}, solvers in turns")));
    record::push_left_out(&mut header, left_out);
    Ok((rows, header))
}

/// The result of many sub-steps in a scene that is compared, and how much that of half as many differs.
fn truth(game: &Game, checks: &mut Vec<String>) -> Result<Option<Outcome>, String> {
    if !game.is_compared() {
        return Ok(None);
    }
    let [truth, coarser] = players::references().map(|player| outcome(game, &player, 0));
    let (truth, coarser) = (truth?, coarser?);
    checks.push(if game.is_balloon() {
        let off = (coarser.volume - truth.volume).abs() / volume_at_rest(game);
        format!("{off:.5} of the balloon's volume")
    } else {
        let off = 1.0e3 * (coarser.height - truth.height).abs();
        format!("{off:.2} mm of the hung mesh's height")
    });
    Ok(Some(truth))
}

fn outcome(game: &Game, player: &Player, start: u32) -> Result<Outcome, String> {
    let told = game.told(start);
    let mut frames = player.way.begin(&game.garment, &told)?;
    Ok(Outcome::of(&play(&mut *frames, FRAMES, LAST)?, &told))
}

/// 0 of what is not closed.
fn volume_at_rest(game: &Game) -> f64 {
    let told = game.told(0);
    if game.is_balloon() {
        meshes::volume(&told.positions, &told.triangles)
    } else {
        0.0
    }
}

/// The smallest times of all starts, and of all else the medians.
fn row(game: &Game, player: &Player, outcomes: &[Outcome], truth: Option<&Outcome>) -> GameRow {
    let smallest = |ms: fn(&Milliseconds) -> f64| {
        let each = outcomes.iter().map(|outcome| ms(&outcome.ms));
        each.fold(f64::INFINITY, f64::min)
    };
    let middle = |value: &dyn Fn(&Outcome) -> f64| median(outcomes.iter().map(value));
    let some = |is_there: bool, value: &dyn Fn(&Outcome) -> f64| is_there.then(|| middle(value));
    let off = |is_there: bool, value: fn(&Outcome) -> f64| {
        let truth = value(truth?);
        some(is_there, &|outcome| (value(outcome) - truth).abs())
    };
    let (rest, has_bodies) = (volume_at_rest(game), game.has_colliders());
    GameRow {
        scene: game.name.into(),
        solver: player.solver.into(),
        setting: player.setting.clone(),
        ms_per_frame: smallest(|ms| ms.mean),
        ms_p99: smallest(|ms| ms.p99),
        ms_max: smallest(|ms| ms.max),
        max_stretch: middle(&|outcome| outcome.stretch[0]),
        rms_stretch: middle(&|outcome| outcome.stretch[1]),
        depth_m: some(has_bodies, &|outcome| outcome.depths[0]),
        triangles_depth_m: some(has_bodies, &|outcome| outcome.depths[1]),
        volume: some(game.is_balloon(), &|outcome| outcome.volume / rest),
        height_error_m: off(!game.is_balloon(), |outcome| outcome.height),
        volume_error: off(game.is_balloon(), |outcome| outcome.volume).map(|off| off / rest),
    }
}

fn print(row: &GameRow) {
    let said = |value: Option<f64>, unit: f64| {
        value.map_or("-".into(), |value| format!("{:.4}", unit * value))
    };
    println!(
        "  {:12} {:32} {:8.3} ms (p99 {:8.3}, max {:8.3})  stretch {:8.3} % (RMS {:7.4})  deep {:>8}, {:>8} mm  volume {:>7}  off {:>8} mm, {:>7}",
        row.solver,
        row.setting,
        row.ms_per_frame,
        row.ms_p99,
        row.ms_max,
        100.0 * row.max_stretch,
        100.0 * row.rms_stretch,
        said(row.depth_m, 1.0e3),
        said(row.triangles_depth_m, 1.0e3),
        said(row.volume, 1.0),
        said(row.height_error_m, 1.0e3),
        said(row.volume_error, 1.0),
    );
}
