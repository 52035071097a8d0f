//! The lab: everything that is claimed of the plugin, measured, charted, and checked.
//!
//! ```sh
//! cargo run --release --example lab -- all                       # everything, to out/lab
//! cargo run --release --example lab -- pareto --quick            # one experiment, short
//! cargo run --release --example lab -- all --redraw --out DIR    # charts again from the CSV files in DIR
//! ```
//!
//! Each experiment writes `NAME.csv` with the machine and the settings in its header, and its charts as SVG and PNG for
//! light and dark pages; it prints a table and what it found, and fails where something does not hold that must.

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
mod frames;
mod hung;
mod layers;
mod lod;
mod measure;
mod needs;
mod pareto;
#[path = "../../benches/hierarchy/parry.rs"]
mod parry;
mod peers;
#[path = "../shared/physics.rs"]
mod physics;
mod record;
#[path = "../ball/scene.rs"]
mod scene;
#[path = "../shared"]
mod shared {
    pub mod exact;
    pub mod modes;
    pub mod sheet;
    pub mod smooth;
    pub mod stage;
    pub mod woven;
}
mod scaling;
mod stability;
mod table1;
#[path = "../shared/view.rs"]
mod view;
mod waves;

use std::{path::PathBuf, process::ExitCode};

use clap::{Parser, ValueEnum};

use crate::{
    experiment::{Output, Run, conduct},
    view::View,
};

/// Measures speed against accuracy, and where methods fail
#[derive(Parser)]
#[command(name = "lab")]
struct Options {
    /// Which experiment
    #[arg(value_enum)]
    name: Name,
    /// A short run: fewer settings and turns
    #[arg(long)]
    quick: bool,
    /// Folder of the CSV files and charts, made if it is not there
    #[arg(long, value_name = "DIR", default_value = "out/lab")]
    out: PathBuf,
    /// Measure nothing: draw the charts from the CSV files that are there
    #[arg(long)]
    redraw: bool,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Name {
    /// The paper's time execution test
    Table1,
    /// The paper's frame test
    Frames,
    /// The paper's test of OpenGL calls, as it is today
    Calls,
    /// The paper's test of CPU utilisation
    Cpu,
    /// Rebuild, query and whole tick from 64 particles to a million
    Scaling,
    /// Contacts missed and imagined, against brute force in f64
    Exactness,
    /// What a scene needs, and what it does not
    Needs,
    /// What colliders cost, by number and shape
    Colliders,
    /// What cloths cost that are far from the camera, with and without level of detail
    Lod,
    /// Cloth on cloth: what it costs, and what passes through
    #[value(name = "self")]
    Layers,
    /// Speed against accuracy
    Pareto,
    /// How it is hung: stretch against time for six ways of pinning
    Hung,
    /// Real solvers, same scenes, as the package `peers` has measured them
    Peers,
    /// With which power of the sub-step errors fall
    Convergence,
    /// Periods of sheets and membranes, and a strip's sag, against closed forms
    Waves,
    /// A clamped strip against the heavy elastica
    Bending,
    /// Maps of where methods fail
    Stability,
    /// All of them, one after the other
    All,
}

type Conduct = fn(&mut Run, &Output) -> Result<(), String>;

const EXPERIMENTS: [(Name, Conduct); 17] = [
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
    (Name::Pareto, conduct::<pareto::Pareto>),
    (Name::Hung, conduct::<hung::Hung>),
    (Name::Peers, conduct::<peers::Peers>),
    (Name::Convergence, conduct::<convergence::Convergence>),
    (Name::Waves, conduct::<waves::Waves>),
    (Name::Bending, conduct::<bending::Bending>),
    (Name::Stability, conduct::<stability::Stability>),
];

fn main() -> ExitCode {
    if View::was_tried_out() {
        return ExitCode::SUCCESS;
    }
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
