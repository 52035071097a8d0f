//! The same app without a window: a report of the folds, and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use serde::Serialize;

use crate::{
    measured::{Figures, MeasuringPlugin},
    scene::{self, Crossings, ScenePlugin},
    shared::{
        headless::{Picture, Run, print, ticks_in},
        stage::Grid,
        start::Options,
        view::View,
    },
};

/// When the picture is drawn (s): some of the cloth lies in folds, the rest hangs.
const DRAWN_AT: f64 = 1.65;

/// What is printed.
#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    figures: Figures,
    /// The most triangles that passed through each other after any tick: pairs.
    crossings: usize,
    counts: u32,
    /// The most pairs of features near each other, and how often they were searched for, in all.
    pairs: usize,
    searches: u64,
    /// Height of the pile (mm).
    height_mm: f32,
    #[serde(flatten)]
    picture: Picture,
}

#[derive(Resource, Default)]
struct Contact {
    pairs: usize,
    searches: u64,
}

/// Simulates, prints the report, and saves `fold.png` if `view` can draw.
pub fn run(view: View, grid: Grid, options: &Options) -> ExitCode {
    let mut run = Run::new(("folds", ScenePlugin), view, grid, options, |app| {
        app.insert_resource(scene::SHOT)
            .add_plugins(MeasuringPlugin)
            .init_resource::<Contact>()
            .add_systems(FixedLast, measure);
        app.world_mut().resource_mut::<Crossings>().is_thorough = true;
    });
    let moment = ticks_in(&run.app, DRAWN_AT);
    run.until(moment.min(run.ticks));
    let picture = run.take_picture(scene::SHOT, &options.out, "fold.png");
    run.finish();
    let figures = Figures::of(&mut run);
    let world = run.app.world_mut();
    let mut cloths = world.query::<(&ClothParticles, &ClothFrame)>();
    let heights = cloths.iter(world).flat_map(|(cloth, frame)| {
        let places = cloth.positions();
        places.map(|place| frame.to_world(place).y)
    });
    let height = heights.fold(0.0, f32::max);
    let crossings = world.resource::<Crossings>();
    let contact = world.resource::<Contact>();
    let report = Report {
        figures,
        crossings: crossings.most,
        counts: crossings.counts,
        pairs: contact.pairs,
        searches: contact.searches,
        height_mm: 1.0e3 * height,
        picture,
    };
    let printed = print(&report, options.json, print_report);
    if report.crossings == 0 {
        printed
    } else {
        eprintln!("The cloth passed through itself.");
        ExitCode::FAILURE
    }
}

fn print_report(report: &Report) {
    report.figures.print("A cloth lowered into folds");
    println!(
        "  intersections    at most {} pairs of triangles, in {} counts by brute force",
        report.crossings, report.counts
    );
    println!(
        "  contact          at most {} pairs of close features, in {} searches",
        report.pairs, report.searches
    );
    println!("  pile             {:.0} mm high", report.height_mm);
    println!("  picture          {}", report.picture);
}

fn measure(cloths: Query<&ClothStats>, mut contact: ResMut<Contact>) {
    for stats in &cloths {
        contact.pairs = contact.pairs.max(stats.layer_pairs);
        contact.searches += u64::from(stats.layer_searches);
    }
}
