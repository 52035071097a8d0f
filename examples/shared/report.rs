//! Reports: figures of all cloths, what an example adds to them, and its picture.

use std::process::ExitCode;

use bevy::time::Time;
use bevy_drape::prelude::*;
use serde::Serialize;

use crate::{
    headless::{Picture, Run},
    measured::Figures,
};

/// The printed report.
#[derive(Serialize)]
pub struct Report<Own> {
    #[serde(skip)]
    pub title: &'static str,
    #[serde(flatten)]
    pub figures: Figures,
    /// The example's own.
    #[serde(flatten)]
    pub own: Own,
    #[serde(flatten)]
    pub picture: Option<Picture>,
}

impl<Own: Serialize> Report<Own> {
    /// For a program to read or for a person. Fails if a cloth or collider is left out.
    pub fn print(&self, run: &mut Run, print_own: fn(&Self)) -> ExitCode {
        let mut code = print(self, run.options.json, |report| {
            report.figures.print(report.title);
            print_own(report);
            if let Some(picture) = &report.picture {
                println!("  picture          {picture}");
            }
        });
        let world = run.app.world_mut();
        let mut faults = world.query::<&ClothFault>();
        for fault in faults.iter(world) {
            eprintln!("Left out: {}", fault.error);
            code = ExitCode::FAILURE;
        }
        code
    }

    /// Fails if a run of at least so many seconds did not end as expected. Each expectation is a condition and its text.
    pub fn check(&self, printed: ExitCode, seconds: f32, expected: &[(bool, &str)]) -> ExitCode {
        if self.figures.simulated_seconds < f64::from(seconds) {
            return printed;
        }
        let missed = expected.iter().filter(|(is_met, _)| !is_met);
        missed.fold(printed, |_, (_, wanted)| {
            eprintln!("Not so: {wanted}");
            ExitCode::FAILURE
        })
    }
}

/// The same for a report without figures of all cloths.
pub fn print<R: Serialize>(report: &R, as_json: bool, as_text: impl Fn(&R)) -> ExitCode {
    if !as_json {
        as_text(report);
        return ExitCode::SUCCESS;
    }
    match serde_json::to_string(report) {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("The report could not be written as JSON: {error}");
            ExitCode::FAILURE
        }
    }
}

#[derive(Serialize)]
struct Contacts {
    contacts: usize,
}

/// The report of an example without figures of its own.
pub fn plain(mut run: Run) -> ExitCode {
    let picture = run.picture();
    let figures = run.finish();
    let report = Report {
        title: run.example.title,
        own: Contacts {
            contacts: figures.contacts,
        },
        figures,
        picture: Some(picture),
    };
    report.print(&mut run, |report| {
        println!(
            "  contacts         at most {} particles",
            report.own.contacts
        );
    })
}

/// Whether this time (s) is passed in this tick.
pub fn is_now(time: &Time, seconds: f32) -> bool {
    let now = time.elapsed_secs();
    now >= seconds && now - time.delta_secs() < seconds
}
