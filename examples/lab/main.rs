//! The lab: everything that is claimed of the plugin, measured, charted, and checked.
//!
//! ```sh
//! cargo run --release --example lab -- all                       # everything, to out/lab
//! cargo run --release --example lab -- pareto --quick            # one experiment, short
//! cargo run --release --example lab -- all --redraw --out DIR    # charts anew from the CSV files in DIR
//! ```
//!
//! Each experiment writes `NAME.csv` with the machine and the settings in its header, and its charts as SVG and PNG for
//! light and dark pages; it prints a table and what it found, and fails where something does not hold that must.

mod chart;
mod cloths;
mod experiment;
mod measure;
#[path = "../../benches/hierarchy/parry.rs"]
mod parry;
mod record;
mod table1;
#[path = "../shared/view.rs"]
mod view;

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
    #[arg(value_enum, required_unless_present = "probe")]
    name: Option<Name>,
    /// A short run: fewer settings and turns
    #[arg(long)]
    quick: bool,
    /// Folder of the CSV files and charts, made if it is not there
    #[arg(long, value_name = "DIR", default_value = "out/lab")]
    out: PathBuf,
    /// Measure nothing: draw the charts from the CSV files that are there
    #[arg(long)]
    redraw: bool,
    /// Only try whether this view can be had; what the program asks of itself
    #[arg(long, hide = true)]
    probe: Option<View>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Name {
    /// The paper's time execution test
    Table1,
    /// All of them, one after the other
    All,
}

type Conduct = fn(&mut Run, &Output) -> Result<(), String>;

const EXPERIMENTS: [(Name, Conduct); 1] = [(Name::Table1, conduct::<table1::Table1>)];

fn main() -> ExitCode {
    let options = Options::parse();
    if let Some(view) = options.probe {
        view.try_out();
        return ExitCode::SUCCESS;
    }
    let view = if !options.redraw && View::Offscreen.can_be_had() {
        View::Offscreen
    } else {
        View::Nothing
    };
    let mut run = Run::new(options.quick, view);
    let output = Output {
        folder: options.out,
        redraw: options.redraw,
    };
    let mut outcome = ExitCode::SUCCESS;
    for (name, conduct) in EXPERIMENTS {
        if options.name == Some(Name::All) || options.name == Some(name) {
            if let Err(error) = conduct(&mut run, &output) {
                eprintln!("{error}");
                outcome = ExitCode::FAILURE;
            }
        }
    }
    outcome
}
