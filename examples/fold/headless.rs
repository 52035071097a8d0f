//! The same app without a window: a report of the folds, and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use examples_shared::{headless::Run, report::Report};
use serde::Serialize;

use crate::scene::Crossings;

/// The printed report.
#[derive(Serialize)]
struct Own {
    /// The most triangles that passed through each other after any tick: pairs.
    crossings: usize,
    counts: u32,
    /// The most pairs of features near each other, and how often they were searched for, in all.
    pairs: usize,
    searches: u64,
    /// Height of the pile (mm).
    height_mm: f32,
}

#[derive(Resource, Default)]
struct Contact {
    pairs: usize,
    searches: u64,
}

/// Simulates, prints the report, and saves `fold.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Contact>()
        .add_systems(FixedLast, measure);
    run.app.world_mut().resource_mut::<Crossings>().is_thorough = true;
    let picture = run.picture();
    let figures = run.finish();
    let world = run.app.world_mut();
    let mut cloths = world.query::<(&ClothParticles, &ClothFrame)>();
    let heights = cloths.iter(world).flat_map(|(cloth, frame)| {
        let places = cloth.positions();
        places.map(|place| frame.to_world(place).y)
    });
    let height = heights.fold(0.0, f32::max);
    let crossings = world.resource::<Crossings>();
    let contact = world.resource::<Contact>();
    let own = Own {
        crossings: crossings.most,
        counts: crossings.counts,
        pairs: contact.pairs,
        searches: contact.searches,
        height_mm: 1.0e3 * height,
    };
    let report = Report {
        title: "A cloth lowered into folds",
        figures,
        own,
        picture: Some(picture),
    };
    let printed = report.print(&mut run, |report| print_own(&report.own));
    if report.own.crossings == 0 {
        printed
    } else {
        eprintln!("The cloth passed through itself.");
        ExitCode::FAILURE
    }
}

fn print_own(own: &Own) {
    println!(
        "  intersections    at most {} pairs of triangles, in {} counts by brute force",
        own.crossings, own.counts
    );
    println!(
        "  contact          at most {} pairs of close features, in {} searches",
        own.pairs, own.searches
    );
    println!("  pile             {:.0} mm high", own.height_mm);
}

fn measure(cloths: Query<&ClothStats>, mut contact: ResMut<Contact>) {
    for stats in &cloths {
        contact.pairs = contact.pairs.max(stats.layer_pairs);
        contact.searches += u64::from(stats.layer_searches);
    }
}
