//! The headless run of an example without figures of its own: a report and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use serde::Serialize;

use crate::{
    measured::{Figures, MeasuringPlugin},
    shared::{
        headless::{Picture, Run, print, ticks_in},
        stage::{Grid, Shot},
        start::Options,
        view::View,
    },
};

/// When the picture is drawn (s), from where, and its file.
pub struct Moment {
    pub at: f64,
    pub shot: Shot,
    pub file: &'static str,
}

#[derive(Serialize)]
struct Report {
    #[serde(skip)]
    title: String,
    #[serde(flatten)]
    figures: Figures,
    /// Largest number of particles that touched.
    contacts: usize,
    #[serde(flatten)]
    picture: Picture,
}

#[derive(Resource, Default)]
struct Touching(usize);

/// Simulates, prints the report, and saves a picture if `view` can draw. Fails if a cloth or collider is left out.
pub fn run(
    (title, scene): (&str, impl Plugin),
    moment: &Moment,
    view: View,
    grid: Grid,
    options: &Options,
) -> ExitCode {
    let mut run = Run::new((title, scene), view, grid, options, |app| {
        app.insert_resource(moment.shot)
            .add_plugins(MeasuringPlugin)
            .init_resource::<Touching>()
            .add_systems(FixedLast, count_contacts);
    });
    run.until(ticks_in(&run.app, moment.at).min(run.ticks));
    let picture = run.take_picture(moment.shot, &options.out, moment.file);
    run.finish();
    let report = Report {
        title: title.into(),
        figures: Figures::of(&mut run),
        contacts: run.app.world().resource::<Touching>().0,
        picture,
    };
    let printed = print(&report, options.json, |report| {
        report.figures.print(&report.title);
        println!("  contacts         at most {} particles", report.contacts);
        println!("  picture          {}", report.picture);
    });
    let world = run.app.world_mut();
    let mut faults = world.query::<&ClothFault>();
    let mut code = printed;
    for fault in faults.iter(world) {
        eprintln!("Left out: {}", fault.error);
        code = ExitCode::FAILURE;
    }
    code
}

fn count_contacts(cloths: Query<&ClothStats>, mut touching: ResMut<Touching>) {
    let now = cloths.iter().map(|stats| stats.contacts).sum();
    touching.0 = touching.0.max(now);
}
