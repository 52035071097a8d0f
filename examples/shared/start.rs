//! The options of every example, and the choice between a window and none.

use std::{path::PathBuf, process::ExitCode};

use bevy::app::App;
use clap::{CommandFactory, FromArgMatches, Parser, parser::ValueSource};

use super::{
    headless::Run,
    stage::{Grid, Shot},
    view::View,
    window,
};

/// The text of `--help` in every example.
const OPENS: &str = "Opens a window if possible, otherwise runs headless.";

/// Opens a window if possible, otherwise runs headless.
#[derive(Parser)]
pub struct Options {
    /// Run without a window, as fast as possible, and print a report
    #[arg(long)]
    headless: bool,
    /// Particles along either side of a cloth
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=512))]
    particles: Option<u32>,
    /// Headless: how long to simulate (s)
    #[arg(long, value_name = "S", default_value_t = 12.0, value_parser = seconds)]
    pub seconds: f64,
    /// Headless: folder for the pictures, created if missing
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Headless: save N frames of a film, frame-000.png and on, beside the picture
    #[arg(long, value_name = "N", default_value_t = 0, requires_all = ["from", "to"])]
    pub frames: u32,
    /// Headless: when the film begins (s)
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    pub from: f64,
    /// Headless: when the film ends (s)
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    pub to: f64,
    /// Headless: print the report as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// The options of headless runs.
const HEADLESS: [&str; 6] = ["seconds", "out", "frames", "from", "to", "json"];

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.1..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("expected a number of seconds from 0.1 to 3600".into()),
    }
}

/// An example.
#[derive(Clone, Copy)]
pub struct Example {
    pub name: &'static str,
    /// A sentence for `--help`.
    pub about: &'static str,
    /// Of its window, and of its report if that is the plain one.
    pub title: &'static str,
    /// How long it simulates without a window, unless asked (s).
    pub seconds: &'static str,
    /// Particles along either side of a cloth, unless asked.
    pub particles: u32,
    /// From where it is seen.
    pub shot: Shot,
    /// When its picture is drawn without a window (s). A shorter run draws it at its end.
    pub drawn_at: f64,
    /// Adds all but the camera.
    pub scene: fn(&mut App),
    /// Simulates without a window, and prints the report.
    pub report: fn(Run) -> ExitCode,
}

impl Example {
    /// Does as the command line says.
    pub fn run(self) -> ExitCode {
        View::try_out_if_asked();
        let command = Options::command()
            .name(self.name)
            .about(format!("{} {OPENS}", self.about))
            .mut_arg("seconds", |seconds| seconds.default_value(self.seconds));
        let matches = command.get_matches();
        let options = match Options::from_arg_matches(&matches) {
            Ok(options) => options,
            Err(error) => error.exit(),
        };
        let grid = Grid(options.particles.unwrap_or(self.particles));
        if !options.headless {
            if View::Window.can_be_had() {
                for option in HEADLESS {
                    if matches.value_source(option) == Some(ValueSource::CommandLine) {
                        eprintln!("--{option} counts only with --headless.");
                    }
                }
                return window::run(self, grid);
            }
            eprintln!("No window opens here: running headless.");
        }
        (self.report)(Run::new(self, View::without_window(), grid, options))
    }
}
