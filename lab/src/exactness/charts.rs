//! What the paper's rule misses, and how tight the others are.

use super::{RADII, Row, STRETCHES, of, share};
use crate::chart::{Axis, Chart, Kind, Look, Panel, Series};

/// How much the paper's rule misses.
pub fn misses(rows: &[Row]) -> Chart {
    let names = STRETCHES.map(|stretch| format!("{:.0} %", 100.0 * stretch));
    let most = |volume| {
        of(rows, volume, "paper")
            .map(|row| share([row].into_iter()))
            .fold(0.0, f64::max)
    };
    let top = most("spheres").max(most("AABBs")).max(1.0);
    let mut chart = Chart::new(
        "exactness",
        format!(
            "The paper's spheres miss up to {:.0} % of the contacts, its AABBs up to {:.0} %; every other rule misses none",
            most("spheres"),
            most("AABBs"),
        ),
        format!(
            "Contacts missed against brute force in f64, by the cloth's largest stretch and the ball's radius in spacings; {} random states a point, cloths of 4 to 33 particles a side, bent and folded.",
            rows.first().map_or(0, |row| row.states)
        ),
    )
    .columns(2);
    for volume in ["spheres", "AABBs"] {
        let mut panel = Panel::new(
            format!("Rule Paper, {volume}"),
            Axis::of_names("largest stretch", names.iter().cloned()),
            Axis::linear("contacts missed (%)").between(-0.03 * top, 1.08 * top),
        );
        for (style, radius) in RADII.into_iter().enumerate() {
            let points = STRETCHES.into_iter().enumerate().map(|(at, stretch)| {
                let rows = of(rows, volume, "paper")
                    .filter(|row| row.radius_over_spacing == radius && row.stretch == stretch);
                [at as f64, share(rows)]
            });
            panel = panel.with(Series::new(
                format!("ball of {radius}"),
                Look::Style(style),
                Kind::Marked,
                points,
            ));
        }
        let others = (0..STRETCHES.len()).map(|at| {
            let stretch = STRETCHES[at];
            let rows = rows
                .iter()
                .filter(|row| !row.is_paper() && row.stretch == stretch);
            [at as f64, share(rows)]
        });
        chart = chart.with(panel.with(Series::new(
            "rest shape, refit, scan: all volumes",
            Look::Ink,
            Kind::Line,
            others,
        )));
    }
    chart
}

/// How many nodes each volume looks at: how closely it holds its patch.
pub fn tightness(rows: &[Row]) -> Chart {
    let shown = [
        ("spheres", "rest shape"),
        ("AABBs", "rest shape"),
        ("spheres", "refit"),
        ("AABBs", "refit"),
        ("OBBs", "refit"),
        ("26-DOPs", "refit"),
    ];
    let visited = |volume, rule, radius: f32, stretch: f32| {
        of(rows, volume, rule)
            .find(|row| row.radius_over_spacing == radius && row.stretch == stretch)
            .map_or(f64::NAN, |row| row.visited)
    };
    let (radius, stretch) = (1.0, 0.01);
    let radii: Vec<(f64, String)> = RADII.map(|r| (f64::from(r), format!("{r}"))).to_vec();
    let mut by_radius = Panel::new(
        format!("Stretched by {:.0} %", 100.0 * stretch),
        Axis::log("ball's radius in spacings, log").named(radii),
        Axis::log("nodes visited, log"),
    );
    let names = STRETCHES.map(|stretch| format!("{:.0} %", 100.0 * stretch));
    let mut by_stretch = Panel::new(
        format!("Ball of {radius} spacing"),
        Axis::of_names("largest stretch", names),
        Axis::log("nodes visited, log"),
    );
    for (style, (volume, rule)) in shown.into_iter().enumerate() {
        let name = format!("{volume}, {rule}");
        let look = Look::Style(style);
        let points = RADII.map(|r| [f64::from(r), visited(volume, rule, r, stretch)]);
        by_radius = by_radius.with(Series::new(name.clone(), look, Kind::Marked, points));
        let points = STRETCHES.into_iter().enumerate();
        let points = points.map(|(at, s)| [at as f64, visited(volume, rule, radius, s)]);
        by_stretch = by_stretch.with(Series::new(name, look, Kind::Marked, points));
    }
    let rest = |stretch| visited("spheres", "rest shape", radius, stretch);
    let refit = |stretch| visited("AABBs", "refit", radius, stretch);
    Chart::new(
        "exactness-visited",
        format!(
            "Exact, but not equally tight: rest-shape spheres look at {:.1} × as many nodes as refitted AABBs, at 200 % stretch {:.1} ×",
            rest(0.01) / refit(0.01),
            rest(2.0) / refit(2.0)
        ),
        "Nodes looked at in a search, on average over random cloths of 4 to 33 particles a side. None of these misses a contact.",
    )
    .columns(2)
    .with(by_radius)
    .with(by_stretch)
}
