//! The same app without a window: a report of who touched what, and a picture.

use std::process::ExitCode;

use bevy::{platform::collections::HashMap, prelude::*};
use bevy_drape::{plugin::ClothContact, prelude::*};
use examples_shared::{depth::Placed, report::Report};
use examples_shared::{headless::Run, measured::median};
use serde::Serialize;

/// The printed report.
#[derive(Serialize)]
struct Own {
    /// Each way that the cloth was searched, with the reason and the number of ticks.
    searches: Vec<(String, u64)>,
    /// Medians over the ticks that had something near, and were not asleep.
    colliders_near: f64,
    nodes_visited: f64,
    particles_tested: f64,
    rebuild_ms: f64,
    query_ms: f64,
    /// Searches that were done again within a tick, in all.
    requeries: u64,
    shapes: Vec<Shape>,
}

/// One collider's contact.
#[derive(Serialize, Default, Clone)]
struct Shape {
    name: String,
    /// The narrow phase that tested it.
    narrow_phase: &'static str,
    /// Particles, or cells of two triangles: the most of any tick, and those of the last.
    most: usize,
    last: usize,
    /// The deepest found in a sub-step, before it was pushed out (mm).
    deepest_found_mm: f32,
    /// The deepest that any particle was as a tick ended, by brute force in f64 (mm).
    deepest_left_mm: f64,
    /// The part of it that the cloth covers: the largest area inside at the end of a sub-step (cm²), and ∫ depth dA (cm³).
    area_cm2: f32,
    volume_cm3: f32,
}

/// Measurements of each tick.
#[derive(Resource, Default)]
struct Measured {
    searches: Vec<(String, u64)>,
    shapes: HashMap<Entity, Shape>,
    near: Vec<f64>,
    visited: Vec<f64>,
    tested: Vec<f64>,
    rebuild_ms: Vec<f64>,
    query_ms: Vec<f64>,
    requeries: u64,
}

/// Simulates, prints the report, and saves `shapes.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Measured>()
        .add_systems(FixedLast, measure);
    let picture = run.picture();
    let mut measured = run.app.world_mut().resource_mut::<Measured>();
    let mut shapes: Vec<Shape> = measured.shapes.values().cloned().collect();
    shapes.sort_by(|a, b| a.name.cmp(&b.name));
    let own = Own {
        searches: measured.searches.clone(),
        colliders_near: median(&mut measured.near),
        nodes_visited: median(&mut measured.visited),
        particles_tested: median(&mut measured.tested),
        rebuild_ms: median(&mut measured.rebuild_ms),
        query_ms: median(&mut measured.query_ms),
        requeries: measured.requeries,
        shapes,
    };
    let report = Report {
        title: "Cloth over every shape",
        figures: run.finish(),
        own,
        picture: Some(picture),
    };
    report.print(&mut run, |report| print_own(&report.own))
}

fn print_own(own: &Own) {
    for (how, ticks) in &own.searches {
        println!("  search           {how}: {ticks} ticks");
    }
    println!(
        "  each search      {} colliders near, {} nodes visited, {} particles tested (medians)",
        own.colliders_near, own.nodes_visited, own.particles_tested
    );
    println!(
        "  extra searches   {} within a tick, after particles outran the first",
        own.requeries
    );
    println!(
        "  search time      {:.4} ms to refit, {:.4} ms to search (medians)",
        own.rebuild_ms, own.query_ms
    );
    println!(
        "  {:<14} {:>10} {:>6} {:>6} {:>10} {:>10} {:>10} {:>10}",
        "collider", "tested by", "most", "last", "found, mm", "left, mm", "area, cm²", "cut, cm³"
    );
    for shape in &own.shapes {
        println!(
            "  {:<14} {:>10} {:>6} {:>6} {:>10.2} {:>10.5} {:>10.1} {:>10.3}",
            shape.name,
            shape.narrow_phase,
            shape.most,
            shape.last,
            shape.deepest_found_mm,
            shape.deepest_left_mm,
            shape.area_cm2,
            shape.volume_cm3
        );
    }
}

fn measure(
    cloths: Query<(&ClothStats, &ClothContacts, Placed)>,
    colliders: Query<(Entity, &Name, &Transform, &ClothCollider)>,
    mut measured: ResMut<Measured>,
) {
    let measured = &mut *measured;
    for (stats, contacts, cloth) in &cloths {
        measured.count_search(stats);
        if stats.colliders_near > 0 && !stats.is_asleep {
            measured.add(stats);
        }
        for (entity, name, transform, collider) in &colliders {
            let shape = measured.shapes.entry(entity).or_insert_with(|| Shape {
                name: name.to_string(),
                narrow_phase: "-",
                ..default()
            });
            shape.last = 0;
            if let Some(contact) = contacts.with(entity) {
                shape.see(contact);
            }
            let left = cloth.depth_in(collider, transform);
            shape.deepest_left_mm = shape.deepest_left_mm.max(left);
        }
    }
}

impl Measured {
    fn count_search(&mut self, stats: &ClothStats) {
        let how = if stats.search == SearchMethod::Auto {
            format!("none, {}", stats.reason)
        } else {
            format!("{} ({})", stats.search, stats.reason)
        };
        match self.searches.iter_mut().find(|(known, _)| *known == how) {
            Some((_, ticks)) => *ticks += 1,
            None => self.searches.push((how, 1)),
        }
    }

    fn add(&mut self, stats: &ClothStats) {
        self.near.push(stats.colliders_near as f64);
        self.visited.push(stats.nodes_visited as f64);
        self.tested.push(stats.leaf_tests as f64);
        self.rebuild_ms.push(stats.rebuild_ms);
        self.query_ms.push(stats.query_ms);
        self.requeries += u64::from(stats.requeries);
    }
}

impl Shape {
    fn see(&mut self, contact: &ClothContact) {
        let is_it = |(_, each): &&(&'static str, NarrowPhase)| *each == contact.narrow_phase;
        let by = NarrowPhase::ALL.iter().find(is_it);
        self.narrow_phase = by.map_or("-", |(name, _)| name);
        self.last = contact.particles;
        self.most = self.most.max(contact.particles);
        let found = 1.0e3 * contact.deepest_penetration;
        self.deepest_found_mm = self.deepest_found_mm.max(found);
        self.area_cm2 = self.area_cm2.max(1.0e4 * contact.area);
        self.volume_cm3 = self.volume_cm3.max(1.0e6 * contact.volume);
    }
}
