//! Every way to search, and the paper's Figure 7.

use bevy_drape::hierarchy::BoundRule;

use super::{IN_PRINT, Row, kinds, of, spread};
use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Point, Series},
    measure::Spread,
};

/// Every way to search, from the fastest to the slowest.
pub fn medians(rows: &[Row]) -> Chart {
    let mut kinds: Vec<([&str; 2], Spread)> = kinds(rows)
        .into_iter()
        .filter(|[_, rule]| *rule != IN_PRINT)
        .map(|kind| (kind, spread(rows, kind[0], kind[1])))
        .collect();
    kinds.sort_by(|a, b| b.1.median.total_cmp(&a.1.median));
    let names = kinds
        .iter()
        .map(|([volume, rule], _)| format!("{volume}, {rule}"));
    let mut panel = Panel::new(
        "",
        Axis::log("ms for all ticks of the scene, log"),
        Axis::of_names("", names),
    );
    let [paper, rest, refit] =
        [BoundRule::Paper, BoundRule::RestShape, BoundRule::Refit].map(BoundRule::name);
    let groups: [(&str, usize, &[&str]); 4] = [
        ("the paper's rule", 1, &[paper]),
        ("rest shape", 0, &[rest]),
        ("refit", 2, &[refit]),
        (
            "no tree of ours",
            3,
            &["scan", "brute force, f64", "parry3d"],
        ),
    ];
    for (name, style, rules) in groups {
        let points = kinds
            .iter()
            .enumerate()
            .filter(|(_, ([_, rule], _))| rules.contains(rule));
        let points = points.map(|(at, (_, times))| Point {
            at: [times.median, at as f64],
            across: Some([times.low, times.high]),
            up: None,
        });
        panel = panel.with(Series::new(name, Look::Style(style), Kind::Points, points));
    }
    let rest = spread(rows, "spheres", BoundRule::RestShape.name()).median;
    let slowest = kinds.iter().find(|([volume, _], _)| *volume != "particles");
    let (name, slowest) = slowest.map_or((String::new(), f64::NAN), |([volume, rule], times)| {
        (format!("{volume}, {rule}"), times.median)
    });
    let missed = |volume| {
        of(rows, volume, paper)
            .next()
            .map_or((0, 0), |row| (row.missed, row.contacts))
    };
    let ((spheres, contacts), (boxes, _)) = (missed("spheres"), missed("AABBs"));
    let others = kinds.iter().filter(|([_, rule], _)| *rule != paper);
    let others: usize = others
        .filter_map(|([volume, rule], _)| Some(of(rows, volume, rule).next()?.missed))
        .sum();
    Chart::new(
        "table1",
        format!("The rest shape searches the paper's scene {:.0} × as fast as the slowest tree ({name})", slowest / rest),
        format!("16 × 16 particles, a ball goes through and back; every volume brought up to date in every tick. Median of 20 runs, quartiles. Of {contacts} contacts the paper's spheres miss {spheres}, its AABBs {boxes}, all others together {others}."),
    )
    .with(panel)
}

/// The paper's Figure 7, and the same by our measurement.
pub fn figure_7(rows: &[Row]) -> Chart {
    let panel = |title: &str, rule: &str| {
        // As far up from the spheres in each, so that ratios can be seen.
        let spheres = spread(rows, "spheres", rule).median;
        let mut panel = Panel::new(
            title,
            Axis::linear("run").between(0.0, 21.0),
            Axis::log("ms, log").between(0.6 * spheres, 8.0 * spheres),
        );
        for (style, volume) in ["spheres", "AABBs"].into_iter().enumerate() {
            let runs = of(rows, volume, rule).map(|row| [f64::from(row.run), row.ms]);
            panel = panel.with(Series::new(volume, Look::Style(style), Kind::Marked, runs));
        }
        panel
    };
    let paper = BoundRule::Paper.name();
    let ratio = |rule| spread(rows, "AABBs", rule).median / spread(rows, "spheres", rule).median;
    Chart::new(
        "figure7",
        format!(
            "Spheres: {:.1} × as fast as AABBs in the paper, {:.2} × on one tree",
            ratio(IN_PRINT),
            ratio(paper)
        ),
        "Figure 7 of the paper, drawn from its Table 1, and the same test here: both volumes in one tree, by the paper's rule and by the rest shape. The machines differ, the axes reach equally far.",
    )
    .columns(3)
    .with(panel("The paper", IN_PRINT))
    .with(panel("Here, its rule", paper))
    .with(panel("Here, rest shape", BoundRule::RestShape.name()))
}
