//! The same app without a window: a report and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use examples_shared::{headless::Run, report::Report};
use serde::Serialize;

/// The printed report.
#[derive(Serialize, Resource, Default, Clone)]
struct Own {
    /// Largest gap of the side seams at last (m).
    gap_m: f32,
    /// The most that a panel was stretched once it was dressed (%).
    stretch_percent: f32,
    /// Height of the shoulder seams at last (m).
    shoulders_m: f32,
}

/// When the tunic has settled on the figure (s).
const SETTLED: f32 = 3.0;

/// Simulates, prints the report, and saves `sewing.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Own>()
        .add_systems(FixedLast, measure);
    let report = Report {
        title: "A tunic, sewn around a figure",
        picture: Some(run.picture()),
        figures: run.finish(),
        own: run.app.world().resource::<Own>().clone(),
    };
    report.print(&mut run, |Report { own, .. }| {
        println!("  side seams       {:.1e} m apart at most", own.gap_m);
        println!("  shoulders        at {:.2} m", own.shoulders_m);
        println!(
            "  stretch          {:.1} % at most once it is dressed",
            own.stretch_percent
        );
    })
}

fn measure(
    time: Res<Time>,
    panels: Query<(&Name, &ClothParticles, &ClothFrame, &ClothStats)>,
    mut own: ResMut<Own>,
) {
    let named = |wanted: &str| panels.iter().find(|(name, ..)| name.as_str() == wanted);
    let (Some(front), Some(back)) = (named("front"), named("back")) else {
        return;
    };
    let place = |(_, all, frame, _): (&Name, &ClothParticles, &ClothFrame, &ClothStats), cell| {
        all.position(cell).map(|place| frame.to_world(place))
    };
    let [columns, rows] = [front.1.columns(), front.1.rows()];
    if rows == 0 {
        return;
    }
    own.gap_m = 0.0;
    for row in rows / 2..rows {
        for column in [0, columns - 1] {
            let ends = [front, back].map(|of| place(of, (row, column)));
            if let [Some(a), Some(b)] = ends {
                own.gap_m = own.gap_m.max(a.distance(b));
            }
        }
    }
    own.shoulders_m = place(front, (0, 0)).map_or(0.0, |place| place.y);
    if time.elapsed_secs() > SETTLED {
        for (.., stats) in [front, back] {
            let stretch = 100.0 * stats.stretch.structural;
            own.stretch_percent = own.stretch_percent.max(stretch);
        }
    }
}
