//! The same app without a window: a report on the dishes, and two pictures.

use std::process::ExitCode;

use bevy::{platform::collections::HashMap, prelude::*};
use bevy_drape::prelude::*;
use examples_shared::headless::{Picture, Run};
use examples_shared::{depth::Placed, report::Report};
use serde::Serialize;

use crate::scene::{self, Pull, Shown};
use crate::things::Thing;

/// After which part of the time the cloth is pulled, and how long after that it is drawn again (s).
const PULLED_AFTER: f64 = 0.6;
const DRAWN_AFTER: f64 = 0.5;

/// The printed report.
#[derive(Serialize)]
struct Own {
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

/// Simulates, prints the report, and saves `table.png` and `table_pulled.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Depths>()
        .add_systems(FixedLast, measure);
    run.example.drawn_at = PULLED_AFTER * run.options.seconds;
    let laid = run.picture();
    let edges_through_at_rest = run.app.world().resource::<Shown>().most;
    run.app.world_mut().resource_mut::<Pull>().begin();
    run.example.name = "table_pulled";
    run.example.drawn_at += DRAWN_AFTER;
    let pulled = run.picture();
    let figures = run.finish();

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
    let own = Own {
        edges_through_at_rest,
        edges_through: world.resource::<Shown>().most,
        deepest_left,
        things,
        left_on_table,
        laid,
        pulled,
    };
    let report = Report {
        title: "A tablecloth, pulled off",
        figures,
        own,
        picture: None,
    };
    report.print(&mut run, |report| print_own(&report.own))
}

fn print_own(own: &Own) {
    println!(
        "  poke-through     at most {} triangles that a table edge crosses before the pull, {} overall",
        own.edges_through_at_rest, own.edges_through
    );
    println!("  penetration      the most after any tick, by brute force:");
    for (name, depth) in &own.deepest_left {
        println!("    {name:<14} {depth:.3} mm");
    }
    println!("  dishes           at the end:");
    for row in &own.things {
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
        own.left_on_table
    );
    println!("  pictures         {}", own.laid);
    println!("                   {}", own.pulled);
}

fn measure(
    cloths: Query<Placed>,
    colliders: Query<(Entity, &Name, &Transform, &ClothCollider)>,
    mut depths: ResMut<Depths>,
) {
    for cloth in &cloths {
        for (entity, name, transform, collider) in &colliders {
            let known = depths
                .0
                .entry(entity)
                .or_insert_with(|| (name.to_string(), 0.0));
            known.1 = known.1.max(cloth.depth_in(collider, transform));
        }
    }
}
