//! The same app without a window, where a script slashes the banner: a report and a picture.

use std::{process::ExitCode, time::Instant};

use bevy::prelude::*;
use bevy_drape::{contact::intersections, prelude::*};
use examples_shared::{
    headless::Run,
    report::{Report, is_now},
};
use serde::Serialize;

use crate::scene::Sword;

/// When the sword slashes (s).
const SLASHED: f32 = 2.5;

/// The printed report.
#[derive(Serialize, Resource, Default, Clone)]
struct Own {
    /// Edges torn by the sword, and by load.
    cut: usize,
    torn: usize,
    pieces: usize,
    /// Mass of all parts now over that of the whole banner.
    mass: f32,
    /// The longest tick in which something tore, and the longest of the others (ms).
    tearing_ms: f64,
    whole_ms: f64,
    /// The most triangle pairs that intersected in any tick, by brute force.
    intersections: usize,
}

/// Simulates, prints the report, and saves `tear.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Own>()
        .add_systems(FixedUpdate, slash.before(ClothSystems::Prepare))
        .add_systems(FixedFirst, begin_tick)
        .add_systems(FixedLast, measure);
    let report = Report {
        title: "A banner and a sword",
        picture: Some(run.picture()),
        figures: run.finish(),
        own: run.app.world().resource::<Own>().clone(),
    };
    report.print(&mut run, |Report { own, .. }| {
        println!("  cut              {} edges by the sword", own.cut);
        println!("  torn             {} edges by its load", own.torn);
        println!(
            "  ticks            {:.1} ms at most; {:.1} ms where it tears",
            own.whole_ms, own.tearing_ms
        );
        println!(
            "  pieces           {}, which together have {:.4} of the mass",
            own.pieces, own.mass
        );
        println!(
            "  intersections    {} triangle pairs at most",
            own.intersections
        );
    })
}

fn slash(time: Res<Time>, mut swords: Query<&mut Sword>) {
    if is_now(&time, SLASHED) {
        swords
            .iter_mut()
            .for_each(|mut sword| sword.slashing = Some(0.0));
    }
}

/// When the tick began.
#[derive(Resource)]
struct Began(Instant);

fn begin_tick(mut commands: Commands) {
    commands.insert_resource(Began(Instant::now()));
}

fn measure(
    began: Res<Began>,
    mut torn: MessageReader<ClothTorn>,
    time: Res<Time>,
    cloths: Query<(&ClothBuilt, &ClothParticles)>,
    mut whole: Local<Option<f32>>,
    mut own: ResMut<Own>,
) {
    let milliseconds = 1000.0 * began.0.elapsed().as_secs_f64();
    // The first ones build the cloth.
    let is_later = whole.is_some();
    match torn.is_empty() {
        true if is_later => own.whole_ms = own.whole_ms.max(milliseconds),
        true => {}
        false => own.tearing_ms = own.tearing_ms.max(milliseconds),
    }
    for torn in torn.read() {
        match time.elapsed_secs() < SLASHED + 0.5 {
            true => own.cut += torn.edges,
            false => own.torn += torn.edges,
        }
        own.pieces = torn.pieces;
    }
    for (built, particles) in &cloths {
        let masses = particles.inverse_masses().filter(|w| *w > 0.0);
        let mass: f32 = masses.map(|w| 1.0 / w).sum();
        own.mass = mass / *whole.get_or_insert(mass);
        let found = intersections(&[(built.surface(), particles.positions().collect())]);
        own.intersections = own.intersections.max(found);
    }
}
