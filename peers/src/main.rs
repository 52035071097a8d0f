//! The lab's scenes, run by `bevy_drape` and by other solvers, on one thread each, in turns.
//!
//! ```sh
//! peers/run            # everything: packages, solvers, chart; to assets/lab
//! peers/run --quick    # one start, few settings; to target/peers
//! ```
//!
//! Writes `peers.csv`, which the lab draws (`-- peers --redraw`).

mod explicit;
mod jolt;
mod ours;
mod outcome;
mod player;
mod python;
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

use std::{fs, path::PathBuf, process::ExitCode};

use clap::Parser;

use crate::{
    outcome::Outcome, player::Player, python::Python, row::Row, scene::Scene, shared::exact::Exact,
};

/// Runs the same scenes by several solvers
#[derive(Parser)]
#[command(name = "peers")]
struct Options {
    /// A short run: one start, few settings
    #[arg(long)]
    quick: bool,
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
    let folder = std::env::temp_dir().join(format!("bevy_drape_peers_{}", std::process::id()));
    let python = match &options.python {
        Some(interpreter) => Some(Python::new(interpreter, folder.clone())?),
        None => None,
    };
    let packages = python.as_ref().map(Python::versions).transpose()?;
    let starts = if options.quick { 1 } else { 5 };
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
        let mut outcomes: Vec<Vec<Outcome>> = players.iter().map(|_| Vec::new()).collect();
        for start in 0..starts {
            for (player, outcomes) in players.iter().zip(&mut outcomes) {
                match player.play(&scene, python.as_ref(), start) {
                    Ok(play) => {
                        outcomes.push(play.outcome(&scene, reference.as_ref().map(|of| &of.0)))
                    }
                    Err(error) => {
                        let line = format!(
                            "{}, {}, {}: {error}",
                            scene.name, player.solver, player.setting
                        );
                        eprintln!("  left out: {line}");
                        left_out.push(line);
                    }
                }
            }
        }
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
    left_out.dedup();
    let mut header = vec![
        ("machine", record::machine()),
        ("versions", record::versions()),
        (
            "packages",
            packages.unwrap_or_else(|| "none, no --python".into()),
        ),
    ];
    header.extend(scene::SETTINGS.map(|(name, value)| (name, value.to_owned())));
    header.push(("starts", format!("{starts}, solvers in turns")));
    if !left_out.is_empty() {
        header.push(("left out", left_out.join("; ")));
    }
    let path = options.out.join("peers.csv");
    record::write(&path, &header, &rows)?;
    println!("{}", path.display());
    Ok(())
}

/// The smallest time of all starts, and of all else the medians.
fn row(
    scene: &Scene,
    player: &Player,
    outcomes: &[Outcome],
    reference: Option<&(Exact, f64)>,
) -> Row {
    let median = |value: &dyn Fn(&Outcome) -> f64| {
        let mut values: Vec<f64> = outcomes.iter().map(value).collect();
        // NaN is the largest, whatever its sign.
        values.sort_by(|a, b| a.is_nan().cmp(&b.is_nan()).then(a.total_cmp(b)));
        values[values.len() / 2]
    };
    let some = |value: fn(&Outcome) -> Option<f64>| {
        let all = outcomes.iter().all(|outcome| value(outcome).is_some());
        all.then(|| median(&|outcome| value(outcome).unwrap_or(f64::NAN)))
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
        max_stretch: median(&|outcome| outcome.max_stretch),
        rms_stretch: median(&|outcome| outcome.rms_stretch),
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
