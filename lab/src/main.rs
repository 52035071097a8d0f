//! The lab measures, charts and checks every claim about the plugin.
//!
//! ```sh
//! cargo run --release -p lab -- all                       # all experiments, to out/lab
//! cargo run --release -p lab -- pareto --quick            # a short run of one experiment
//! cargo run --release -p lab -- all --redraw --out DIR    # draws the charts again from the CSV files in DIR
//! ```
//!
//! Each experiment writes `NAME.csv`, with the machine and the settings in its header, and its charts as SVG and PNG for light and
//! dark pages. It prints a table and its findings, and fails if a required property does not hold.

mod bending;
mod calls;
mod chart;
mod cloths;
mod colliders;
mod convergence;
mod cpu;
#[path = "../../benches/hierarchy/scene.rs"]
mod draped;
mod drawn;
mod exactness;
mod experiment;
mod fabrics;
mod frames;
mod games;
mod hung;
mod layers;
mod lod;
mod measure;
#[path = "../../tests/shared/meshes.rs"]
mod meshes;
mod methods;
mod needs;
mod pareto;
#[path = "../../benches/hierarchy/parry.rs"]
mod parry;
mod peers;
mod record;
mod scaling;
#[path = "../../examples/ball/scene.rs"]
mod scene;
mod stability;
mod surfaces;
mod table1;
mod timed;
mod waves;

use std::{path::PathBuf, process::ExitCode};

/// `meshes` calls the crate by this name: the crate's own tests include that file, too.
use bevy_drape as library;
use clap::{Parser, ValueEnum};
use examples_shared::view::View;

use crate::experiment::{Output, Run, conduct};

/// Measures speed and accuracy, and finds where methods fail
#[derive(Parser)]
#[command(name = "lab")]
struct Options {
    /// Which experiment
    #[arg(value_enum)]
    name: Name,
    /// Short run: fewer settings and repetitions
    #[arg(long)]
    quick: bool,
    /// Folder of the CSV files and charts, created if missing
    #[arg(long, value_name = "DIR", default_value = "out/lab")]
    out: PathBuf,
    /// Measure nothing: draw the charts from existing CSV files
    #[arg(long)]
    redraw: bool,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Name {
    /// The paper's time execution test
    Table1,
    /// The paper's frame test
    Frames,
    /// The paper's test of OpenGL calls, with today's renderer
    Calls,
    /// The paper's test of CPU utilisation
    Cpu,
    /// Rebuild, query and whole tick from 64 particles to a million
    Scaling,
    /// Contacts missed and imagined, against brute force in f64
    Exactness,
    /// Features that a scene does not use: what each saves
    Needs,
    /// Cost of colliders, by number and shape
    Colliders,
    /// Cost of distant cloths, with and without level of detail
    Lod,
    /// Cloth on cloth: its cost, and how much passes through
    #[value(name = "self")]
    Layers,
    /// Cloth on cloth in scenes of games: mean and longest tick
    Games,
    /// Speed against accuracy
    Pareto,
    /// Stretch against time for six ways of pinning
    Hung,
    /// Other solvers in the same scenes, measured by the package `peers`
    Peers,
    /// Other solvers in scenes of games, measured by the package `peers`
    #[value(name = "peers_games")]
    PeersGames,
    /// Order of accuracy: error against sub-step
    Convergence,
    /// Periods of sheets and membranes, and the sag of a strip, against closed forms
    Waves,
    /// A clamped strip against the heavy elastica
    Bending,
    /// Closed forms of sheets, strips and membranes, for grids and meshes
    Fabrics,
    /// Maps of where methods fail
    Stability,
    /// All experiments, one after the other
    All,
}

type Conduct = fn(&mut Run, &Output) -> Result<(), String>;

const EXPERIMENTS: [(Name, Conduct); 20] = [
    (Name::Table1, conduct::<table1::Table1>),
    (Name::Frames, conduct::<frames::Frames>),
    (Name::Calls, conduct::<calls::Calls>),
    (Name::Cpu, conduct::<cpu::Cpu>),
    (Name::Scaling, conduct::<scaling::Scaling>),
    (Name::Exactness, conduct::<exactness::Exactness>),
    (Name::Needs, conduct::<needs::Needs>),
    (Name::Colliders, conduct::<colliders::Colliders>),
    (Name::Lod, conduct::<lod::Lod>),
    (Name::Layers, conduct::<layers::Layers>),
    (Name::Games, conduct::<games::Games>),
    (Name::Pareto, conduct::<pareto::Pareto>),
    (Name::Hung, conduct::<hung::Hung>),
    (Name::Peers, conduct::<peers::Peers>),
    (Name::PeersGames, conduct::<peers::PeersGames>),
    (Name::Convergence, conduct::<convergence::Convergence>),
    (Name::Waves, conduct::<waves::Waves>),
    (Name::Bending, conduct::<bending::Bending>),
    (Name::Fabrics, conduct::<fabrics::Fabrics>),
    (Name::Stability, conduct::<stability::Stability>),
];

fn main() -> ExitCode {
    View::try_out_if_asked();
    let options = Options::parse();
    let view = if options.redraw {
        View::Nothing
    } else {
        View::without_window()
    };
    let mut run = Run::new(options.quick, view);
    let output = Output {
        folder: options.out,
        redraw: options.redraw,
    };
    let mut outcome = ExitCode::SUCCESS;
    for (name, conduct) in EXPERIMENTS {
        if (options.name == Name::All || options.name == name)
            && let Err(error) = conduct(&mut run, &output)
        {
            eprintln!("{error}");
            outcome = ExitCode::FAILURE;
        }
    }
    outcome
}

#[cfg(test)]
mod tests {
    use examples_shared::view::View;

    /// As a program does at its start: tests have none of their own.
    #[test]
    fn a_view_is_tried_out_if_asked() {
        View::try_out_if_asked();
    }
}
