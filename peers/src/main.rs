//! The lab's scenes, run by `bevy_drape` and by other solvers, on one thread each, in turns.
//!
//! ```sh
//! peers/run            # everything: packages, solvers, chart; to assets/lab
//! peers/run --games    # the scenes of games, without Python
//! peers/run --quick    # one start, few settings; to target/peers
//! ```
//!
//! Writes `peers.csv` or `peers_games.csv`, which the lab draws (`-- peers --redraw`).

mod collider;
mod explicit;
#[path = "../../lab/src/peers/game_row.rs"]
mod game_row;
mod games;
mod jolt;
mod ours;
mod outcome;
mod player;
mod python;
mod rapier;
mod record;
#[path = "../../lab/src/peers/row.rs"]
mod row;
mod scene;
#[path = "../../examples/shared"]
mod shared {
    pub mod exact;
    #[expect(
        dead_code,
        reason = "the lab moves its sheets, here only their springs are asked for"
    )]
    pub mod sheet;
}
mod told;

use std::{fs, path::PathBuf, process::ExitCode};

use clap::Parser;
use serde::Serialize;

use crate::{
    outcome::{Outcome, median},
    player::Player,
    python::Python,
    row::Row,
    scene::Scene,
    shared::exact::Exact,
};

/// Runs the same scenes by several solvers
#[derive(Parser)]
#[command(name = "peers")]
struct Options {
    /// The scenes of games in place of the sheets
    #[arg(long)]
    games: bool,
    /// A short run: one start, few settings
    #[arg(long)]
    quick: bool,
    /// Starts of each solver, in place of five for sheets, three for games, and one in a short run
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    starts: Option<u32>,
    /// Folder of the CSV file, made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// A Python with the packages of `python/requirements.txt`; without it theirs are left out
    #[arg(long, value_name = "FILE")]
    python: Option<PathBuf>,
    /// Only solvers whose name contains this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
}

impl Options {
    /// How often each solver starts, if that was not asked for and the run is not short.
    fn starts(&self, whole: u32) -> u32 {
        let usual = if self.quick { 1 } else { whole };
        self.starts.unwrap_or(usual)
    }
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    fs::create_dir_all(&options.out)
        .map_err(|error| format!("{}: {error}", options.out.display()))?;
    if options.games {
        let (rows, settings) = games::run(options.quick, options.starts(3), &options.only)?;
        return write(options, "peers_games.csv", settings, &rows);
    }
    let folder = std::env::temp_dir().join(format!("bevy_drape_peers_{}", std::process::id()));
    let python = match &options.python {
        Some(interpreter) => Some(Python::new(interpreter, folder.clone())?),
        None => None,
    };
    let packages = python.as_ref().map(Python::versions).transpose()?;
    let starts = options.starts(5);
    let (mut rows, mut left_out) = (Vec::new(), Vec::new());
    for scene in Scene::ALL {
        println!("{}", scene.name);
        let reference = scene
            .ball
            .is_none()
            .then(|| explicit::reference(&scene, options.quick));
        let players: Vec<Player> = Player::all(&scene, options.quick)
            .into_iter()
            .filter(|player| player.solver.contains(&options.only))
            .filter(|player| !player.is_python() || python.is_some())
            .collect();
        let outcomes = turns(
            scene.name,
            &players,
            starts,
            &mut left_out,
            |player, start| {
                let play = player.play(&scene, python.as_ref(), start)?;
                Ok(play.outcome(&scene, reference.as_ref().map(|of| &of.0)))
            },
        );
        for (player, outcomes) in players.iter().zip(&outcomes) {
            if !outcomes.is_empty() {
                let row = row(&scene, player, outcomes, reference.as_ref());
                print(&row);
                rows.push(row);
            }
        }
    }
    if python.is_some() {
        fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let mut header: record::Header = vec![(
        "packages",
        packages.unwrap_or_else(|| "none, no --python".into()),
    )];
    header.extend(scene::SETTINGS.map(|(name, value)| (name, value.to_owned())));
    header.push(("starts", format!("{starts}, solvers in turns")));
    record::push_left_out(&mut header, left_out);
    write(options, "peers.csv", header, &rows)
}

/// Writes rows, with the machine and the versions in the header.
fn write<R: Serialize>(
    options: &Options,
    name: &str,
    settings: record::Header,
    rows: &[R],
) -> Result<(), String> {
    let mut header = vec![
        ("machine", record::machine()),
        ("versions", record::versions()),
    ];
    header.extend(settings);
    let path = options.out.join(name);
    record::write(&path, &header, rows)?;
    println!("{}", path.display());
    Ok(())
}

/// The results of all players in a scene, from each start, in turns. A failure is printed, and kept in `left_out`.
fn turns<O>(
    scene: &str,
    players: &[Player],
    starts: u32,
    left_out: &mut Vec<String>,
    play: impl Fn(&Player, u32) -> Result<O, String>,
) -> Vec<Vec<O>> {
    let mut outcomes: Vec<Vec<O>> = players.iter().map(|_| Vec::new()).collect();
    for start in 0..starts {
        for (player, outcomes) in players.iter().zip(&mut outcomes) {
            match play(player, start) {
                Ok(outcome) => outcomes.push(outcome),
                Err(error) => {
                    let line = format!("{scene}, {}, {}: {error}", player.solver, player.setting);
                    eprintln!("  left out: {line}");
                    left_out.push(line);
                }
            }
        }
    }
    outcomes
}

/// The smallest time of all starts, and of all else the medians.
fn row(
    scene: &Scene,
    player: &Player,
    outcomes: &[Outcome],
    reference: Option<&(Exact, f64)>,
) -> Row {
    let middle = |value: &dyn Fn(&Outcome) -> f64| median(outcomes.iter().map(value));
    let some = |value: fn(&Outcome) -> Option<f64>| {
        let all = outcomes.iter().all(|outcome| value(outcome).is_some());
        all.then(|| middle(&|outcome| value(outcome).unwrap_or(f64::NAN)))
    };
    let is_comparable = player.has_same_springs(scene);
    Row {
        scene: scene.name.into(),
        solver: player.solver.into(),
        setting: player.setting.clone(),
        ms_per_frame: outcomes
            .iter()
            .map(|outcome| outcome.ms)
            .fold(f64::INFINITY, f64::min),
        max_stretch: middle(&|outcome| outcome.max_stretch),
        rms_stretch: middle(&|outcome| outcome.rms_stretch),
        position_error_m: some(|outcome| outcome.off).filter(|_| is_comparable),
        reference_error_m: reference.map(|(_, error)| *error),
        depth_m: some(|outcome| outcome.depth),
    }
}

fn print(row: &Row) {
    let mm = |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.4}", 1.0e3 * value));
    println!(
        "  {:22} {:32} {:9.3} ms  stretch {:9.3} % (RMS {:8.4})  off {:>9} mm  deep {:>8} mm",
        row.solver,
        row.setting,
        row.ms_per_frame,
        100.0 * row.max_stretch,
        100.0 * row.rms_stretch,
        mm(row.position_error_m),
        mm(row.depth_m),
    );
}
