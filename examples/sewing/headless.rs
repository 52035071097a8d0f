//! The same app without a window: a report and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use examples_shared::{headless::Run, report::Report};
use serde::Serialize;

/// The printed report.
#[derive(Serialize, Resource, Default, Clone)]
struct Own {
    /// Largest gap of the side seams, and of the seams between front and sleeves, at last (m).
    sides_gap_m: f32,
    sleeves_gap_m: f32,
    /// The most that the front or the back was stretched once it was dressed (%).
    stretch_percent: f32,
    /// Height of the shoulder seams at last (m).
    shoulders_m: f32,
}

/// When the shirt has settled on the figure (s).
const SETTLED: f32 = 3.0;

/// Simulates, prints the report, and saves `sewing.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Own>()
        .add_systems(FixedLast, measure);
    let report = Report {
        title: "A shirt, sewn around a figure",
        picture: Some(run.picture()),
        figures: run.finish(),
        own: run.app.world().resource::<Own>().clone(),
    };
    let code = report.print(&mut run, |Report { own, .. }| {
        println!("  side seams       {:.1e} m apart at most", own.sides_gap_m);
        println!(
            "  sleeves          {:.1e} m apart at most",
            own.sleeves_gap_m
        );
        println!("  shoulders        at {:.2} m", own.shoulders_m);
        println!(
            "  stretch          {:.1} % at most once it is dressed",
            own.stretch_percent
        );
    });
    let own = &report.own;
    let expected = [
        (own.sides_gap_m < 1.0e-3, "the side seams are closed"),
        (own.sleeves_gap_m < 0.01, "the sleeves are sewn on"),
        (own.shoulders_m > 1.4, "the figure wears the shirt"),
        (
            own.stretch_percent < 15.0,
            "the shirt stays within the limit of stretch",
        ),
    ];
    report.check(code, 2.0 * SETTLED, &expected)
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
    let sleeves = ["right sleeve, front", "left sleeve, front"].map(named);
    let [Some(right), Some(left)] = sleeves else {
        return;
    };
    let place = |(_, all, frame, _): (&Name, &ClothParticles, &ClothFrame, &ClothStats), cell| {
        all.position(cell).map(|place| frame.to_world(place))
    };
    let gap = |ends: [_; 2]| match ends {
        [Some(a), Some(b)] => Vec3::distance(a, b),
        _ => 0.0,
    };
    let [columns, rows] = [front.1.columns(), front.1.rows()];
    let [along, across] = [left.1.columns(), left.1.rows()];
    if rows == 0 || across == 0 {
        return;
    }
    let below_arms = (across..rows).flat_map(|row| [(row, 0), (row, columns - 1)]);
    let sides = below_arms.map(|cell| gap([place(front, cell), place(back, cell)]));
    own.sides_gap_m = sides.fold(0.0, f32::max);
    let armholes = (0..across).flat_map(|row| {
        let on_left = [place(front, (row, columns - 1)), place(left, (row, 0))];
        let on_right = [place(front, (row, 0)), place(right, (row, along - 1))];
        [on_left, on_right]
    });
    own.sleeves_gap_m = armholes.map(gap).fold(0.0, f32::max);
    own.shoulders_m = place(front, (0, 0)).map_or(0.0, |place| place.y);
    if time.elapsed_secs() > SETTLED {
        for (.., stats) in [front, back] {
            let stretch = 100.0 * stats.stretch.structural;
            own.stretch_percent = own.stretch_percent.max(stretch);
        }
    }
}
