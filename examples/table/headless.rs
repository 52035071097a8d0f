//! The same app without a window: a report on the dishes, and two pictures.

use std::process::ExitCode;

use bevy::{platform::collections::HashMap, prelude::*};
use bevy_drape::{contact::deepest_penetration, prelude::*};
use serde::Serialize;

use crate::{
    measured::{Figures, MeasuringPlugin},
    scene::{self, Pull, ScenePlugin, Shown},
    shared::{
        headless::{Picture, Run, print, ticks_in},
        stage::Grid,
        start::Options,
        view::View,
    },
    things::Thing,
};

/// After which part of the time the cloth is pulled, and how long after that it is drawn again (s).
const PULLED_AFTER: f64 = 0.6;
const DRAWN_AFTER: f64 = 0.5;

/// What is printed.
#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    figures: Figures,
    /// The most triangles that an edge of the table passed through after any tick: until it was pulled, and in all.
    edges_through_at_rest: usize,
    edges_through: usize,
    /// The deepest that any particle was in the table or the floor as a tick ended, by brute force in f64 (mm).
    deepest_left: Vec<(String, f64)>,
    things: Vec<Row>,
    /// How many of the cloth's particles are still above the table at last.
    left_on_table: usize,
    laid: Picture,
    pulled: Picture,
}

/// What became of a thing.
#[derive(Serialize)]
struct Row {
    name: String,
    /// How far it is from where it stood (mm), and how much it leans (degrees).
    moved_mm: f32,
    leans_degrees: f32,
    stands: bool,
}

#[derive(Resource, Default)]
struct Depths(HashMap<Entity, (String, f64)>);

/// Simulates, prints the report, and saves `table.png` and `table_pulled.png` if `view` can draw.
pub fn run(view: View, grid: Grid, options: &Options) -> ExitCode {
    let mut run = Run::new(("a tablecloth", ScenePlugin), view, grid, options, |app| {
        app.add_plugins(MeasuringPlugin)
            .init_resource::<Depths>()
            .add_systems(FixedLast, measure);
    });
    let pulled = ticks_in(&run.app, PULLED_AFTER * options.seconds);
    run.until(pulled);
    let laid = run.take_picture(scene::SHOT, &options.out, "table.png");
    let edges_through_at_rest = run.app.world().resource::<Shown>().most;
    run.app.world_mut().resource_mut::<Pull>().begin();
    let drawn = pulled + ticks_in(&run.app, DRAWN_AFTER);
    run.until(drawn.min(run.ticks));
    let pulled = run.take_picture(scene::SHOT, &options.out, "table_pulled.png");
    run.finish();

    let figures = Figures::of(&mut run);
    let world = run.app.world_mut();
    let mut things = world.query::<(&Name, &Thing, &Transform)>();
    let row = |(name, thing, now): (&Name, &Thing, &Transform)| {
        let moved = now.translation - thing.0.translation;
        let leans = now.up().angle_between(Vec3::Y).to_degrees();
        Row {
            name: name.to_string(),
            moved_mm: 1.0e3 * moved.with_y(0.0).length(),
            leans_degrees: leans,
            stands: leans < 10.0 && moved.y.abs() < 0.02,
        }
    };
    let things = things.iter(world).map(row).collect();
    let mut cloths = world.query::<(&ClothParticles, &ClothFrame)>();
    let places = cloths.iter(world).flat_map(|(particles, frame)| {
        let places = particles.positions();
        places.map(|place| frame.to_world(place))
    });
    let left_on_table = places.filter(|place| scene::is_on_table(*place)).count();
    let mut deepest_left: Vec<_> = world.resource::<Depths>().0.values().cloned().collect();
    deepest_left.sort_by(|a, b| a.0.cmp(&b.0));
    let report = Report {
        figures,
        edges_through_at_rest,
        edges_through: world.resource::<Shown>().most,
        deepest_left,
        things,
        left_on_table,
        laid,
        pulled,
    };
    print(&report, options.json, print_report)
}

fn print_report(report: &Report) {
    report.figures.print("A tablecloth, pulled off");
    println!(
        "  poke-through     at most {} triangles that a table edge crosses before the pull, {} overall",
        report.edges_through_at_rest, report.edges_through
    );
    println!("  penetration      the most after any tick, by brute force:");
    for (name, depth) in &report.deepest_left {
        println!("    {name:<14} {depth:.3} mm");
    }
    println!("  dishes           at the end:");
    for row in &report.things {
        println!(
            "    {:<14} moved by {:.1} mm, leans by {:.1}°, {}",
            row.name,
            row.moved_mm,
            row.leans_degrees,
            if row.stands { "stands" } else { "has fallen" }
        );
    }
    println!(
        "  cloth            {} particles still on the table",
        report.left_on_table
    );
    println!("  pictures         {}", report.laid);
    println!("                   {}", report.pulled);
}

fn measure(
    cloths: Query<(&ClothParticles, &ClothFrame, &ClothSettings)>,
    colliders: Query<(Entity, &Name, &Transform, &ClothCollider)>,
    mut depths: ResMut<Depths>,
) {
    for (particles, frame, settings) in &cloths {
        for (entity, name, transform, collider) in &colliders {
            let pose = frame.isometry().inverse() * transform.to_isometry();
            if let Ok(shape) = collider.scaled(transform.scale) {
                let depth = deepest_penetration(particles, &shape, pose, settings.particle_radius);
                let known = depths
                    .0
                    .entry(entity)
                    .or_insert_with(|| (name.to_string(), 0.0));
                known.1 = known.1.max(1.0e3 * depth);
            }
        }
    }
}
