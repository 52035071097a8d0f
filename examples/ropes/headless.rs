//! The same app without a window, where the swing is pushed: a report and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use examples_shared::{
    headless::Run,
    report::{Report, is_now},
};
use serde::Serialize;

use crate::scene::{self, Plank};

/// When the swing is pushed (s).
const PUSHED: f32 = 3.0;

/// The printed report.
#[derive(Serialize, Resource, Default, Clone)]
struct Own {
    plank_kg: f32,
    /// Height of the plank at rest, and how far it swings (m).
    rest_m: f32,
    swing_m: f32,
    /// Largest gap between a tie and its corner of the sail (mm), and the most that a rope was longer than it is (%).
    gap_mm: f32,
    stretch_percent: f32,
}

/// Simulates, prints the report, and saves `ropes.png`.
pub fn report(mut run: Run) -> ExitCode {
    let own = Own {
        plank_kg: scene::MASS,
        ..default()
    };
    run.app
        .insert_resource(own)
        .add_systems(
            FixedUpdate,
            scene::push
                .before(ClothSystems::Prepare)
                .run_if(|time: Res<Time>| is_now(&time, PUSHED)),
        )
        .add_systems(FixedLast, measure);
    let report = Report {
        title: "A swing and a sail",
        picture: Some(run.picture()),
        figures: run.finish(),
        own: run.app.world().resource::<Own>().clone(),
    };
    let code = report.print(&mut run, |Report { own, .. }| {
        println!(
            "  plank            {} kg, {:.3} m high at rest, swings by {:.2} m",
            own.plank_kg, own.rest_m, own.swing_m
        );
        println!("  knots            {:.2} mm apart at most", own.gap_mm);
        println!(
            "  ropes            {:.2} % longer than at rest, at most",
            own.stretch_percent
        );
    });
    let own = &report.own;
    let expected = [
        (own.rest_m > 0.4, "the ropes hold the plank"),
        (own.swing_m > 0.1, "it swings"),
        (own.gap_mm < 1.0, "the knots hold"),
        (
            own.stretch_percent < 2.0,
            "the ropes are as long as they were",
        ),
    ];
    report.check(code, 2.0 * PUSHED, &expected)
}

fn measure(
    time: Res<Time>,
    cloths: Query<(&Cloth, &ClothParticles, &ClothFrame)>,
    planks: Query<&Transform, With<Plank>>,
    mut own: ResMut<Own>,
) {
    // The first second is for the knots to close.
    if time.elapsed_secs() < 1.0 {
        return;
    }
    let places = |(_, all, frame): (&Cloth, &ClothParticles, &ClothFrame)| -> Vec<Vec3> {
        all.positions().map(|place| frame.to_world(place)).collect()
    };
    let length = |places: &[Vec3]| -> f32 {
        let parts = places.windows(2);
        parts.map(|ends| ends[0].distance(ends[1])).sum()
    };
    let is_sail = |cloth: &Cloth| matches!(cloth.shape, ClothShape::Grid(_));
    let sail = cloths.iter().find(|(cloth, ..)| is_sail(cloth));
    let sail = sail.map_or(Vec::new(), places);
    for (cloth, all, frame) in &cloths {
        let at_rest = match &cloth.shape {
            ClothShape::Rope(rope) => rope.spacing * (rope.particles - 1) as f32,
            ClothShape::RopePath(path) => length(&path.points),
            _ => continue,
        };
        let places = places((cloth, all, frame));
        let longer = length(&places) / at_rest - 1.0;
        own.stretch_percent = own.stretch_percent.max(100.0 * longer);
        // The slings' last particles are pinned.
        if let Some(end) = places.last()
            && all.inverse_mass(places.len() - 1) != Some(0.0)
        {
            let gaps = sail.iter().map(|corner| 1.0e3 * corner.distance(*end));
            own.gap_mm = own.gap_mm.max(gaps.fold(f32::MAX, f32::min));
        }
    }
    for plank in &planks {
        match time.elapsed_secs() < PUSHED {
            true => own.rest_m = plank.translation.y,
            false => own.swing_m = own.swing_m.max(plank.translation.z.abs()),
        }
    }
}
