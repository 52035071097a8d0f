//! The paper's test of OpenGL calls, as it is today: what drawing the hierarchy hands to the renderer in a frame, by every
//! volume and level, and how many calls would have said the same vertex by vertex.

use bevy_drape::hierarchy::BoundingVolume;
use serde::{Deserialize, Serialize};

use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Series},
    drawn::{Drawn, NODES, SMALL, WHOLE},
    experiment::{Experiment, Run, Table},
};

/// The most calls a frame that the paper had, with spheres.
const PUBLISHED: usize = 27_000;

/// All levels at once.
const ALL: &str = "all";

pub struct Calls;

/// One frame.
#[derive(Serialize, Deserialize)]
pub struct Row {
    volume: String,
    /// Of the tree, 0 for the root, or all.
    level: String,
    /// Of the gizmos alone; not known without a renderer.
    draw_calls: Option<usize>,
    /// Ends and corners of lines.
    vertices: usize,
    /// What is uploaded in each frame.
    bytes: usize,
    /// How many volumes are drawn.
    nodes: usize,
    /// Calls of `glColor`, `glBegin`, `glVertex` and `glEnd` that draw the same lines.
    immediate_calls: usize,
}

impl Experiment for Calls {
    type Row = Row;

    const NAME: &'static str = "calls";

    fn run(run: &mut Run) -> Vec<Row> {
        let mut scene = Drawn::new(run.view, SMALL);
        match scene.adapter() {
            Some(adapter) => run.set("adapter", adapter),
            None => run.say(
                "  no graphics adapter found: vertices and bytes are counted, draw calls are not",
            ),
        }
        run.set(
            "scene",
            "the example ball's when the ball is farthest in; volumes are refitted",
        );
        run.set(
            "immediate_calls",
            "one a vertex, three a strip of lines, two for a box's other lines",
        );
        scene.go_to_best_moment();
        let mut rows = Vec::new();
        run.begin(Self::NAME, BoundingVolume::ALL.len());
        for (name, volume) in BoundingVolume::ALL {
            scene.show(volume, None);
            scene.tick();
            let without = scene.draw_calls();
            let each = NODES.iter().enumerate();
            let levels = each.map(|(level, &nodes)| (level.to_string(), level..=level, nodes));
            let all = (ALL.to_owned(), WHOLE, NODES.iter().sum());
            for (level, range, nodes) in levels.chain([all]) {
                scene.show(volume, Some(range));
                // New lines are drawn a frame late.
                (0..2).for_each(|_| scene.tick());
                let lines = scene.lines();
                let with = scene.draw_calls();
                let pairs = if lines.has_pairs { 2 * nodes } else { 0 };
                rows.push(Row {
                    volume: name.into(),
                    level,
                    draw_calls: with
                        .zip(without)
                        .and_then(|(with, without)| with.checked_sub(without)),
                    vertices: lines.vertices,
                    bytes: lines.bytes,
                    nodes,
                    immediate_calls: lines.vertices + 3 * lines.strips + pairs,
                });
            }
            run.step();
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        let levels = NODES.len() + 1;
        if rows.len() != BoundingVolume::ALL.len() * levels {
            return Err("each level of each volume, and all levels".into());
        }
        for row in rows {
            let Row { volume, level, .. } = row;
            if row.vertices < 8 * row.nodes {
                return Err(format!(
                    "{volume}, level {level}: {} vertices are not those of {} volumes",
                    row.vertices, row.nodes
                ));
            }
            // One for strips and one for single lines, however many volumes.
            if row
                .draw_calls
                .is_some_and(|calls| !(1..=2).contains(&calls))
            {
                return Err(format!(
                    "{volume}, level {level}: {:?} draw calls",
                    row.draw_calls
                ));
            }
        }
        if vertices(rows, "spheres") <= vertices(rows, "AABBs") {
            return Err("a sphere has more vertices than a box".into());
        }
        Ok(())
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let immediate = |volume| whole(rows, volume).map_or(0, |row| row.immediate_calls);
        let (spheres, boxes) = (immediate("spheres"), immediate("AABBs"));
        let nodes: usize = NODES.iter().sum();
        let mut findings = vec![format!(
            "The paper's 27,000 calls a frame are {:.0} for each of the tree's {nodes} spheres. Drawn vertex by vertex, our lines would take {} calls with spheres and {} with AABBs, a ratio of {:.1}: that spheres need more calls is true of such drawing.",
            PUBLISHED as f64 / nodes as f64,
            thousands(spheres),
            thousands(boxes),
            spheres as f64 / boxes as f64,
        )];
        let most = rows.iter().filter_map(|row| row.draw_calls).max();
        let calls = whole(rows, "spheres").and_then(|row| row.draw_calls);
        if let (Some(most), Some(calls)) = (most, calls) {
            findings.push(format!(
                "Here the whole hierarchy is {calls} draw with spheres and {} with AABBs, and never more than {most} whatever the level: the paper's reason is gone, what is left are {:.0} and {:.0} KB of vertices a frame.",
                whole(rows, "AABBs").and_then(|row| row.draw_calls).unwrap_or(0),
                kilobytes(rows, "spheres"),
                kilobytes(rows, "AABBs"),
            ));
        }
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "volume",
            "level",
            "volumes",
            "draw calls",
            "vertices",
            "KB",
            "calls one by one",
        ]);
        for row in rows {
            table.row([
                row.volume.clone(),
                row.level.clone(),
                row.nodes.to_string(),
                row.draw_calls
                    .map_or_else(|| "?".into(), |calls| calls.to_string()),
                row.vertices.to_string(),
                format!("{:.1}", row.bytes as f64 / 1.0e3),
                row.immediate_calls.to_string(),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![figure_9(rows)]
    }
}

/// The paper's Figure 9, of which only the largest number was published, and the same here.
fn figure_9(rows: &[Row]) -> Chart {
    let levels = (0..NODES.len()).map(|level| (level as f64, level.to_string()));
    let levels: Vec<_> = levels
        .chain([(NODES.len() as f64, ALL.to_owned())])
        .collect();
    let mut panel = Panel::new(
        "",
        Axis::linear("level of the tree that is drawn")
            .between(-0.3, 6.3)
            .named(levels),
        Axis::log("calls a frame, log").between(0.7, 1.5e5),
    );
    // Boxes are boxes, however they lie.
    let shown = [
        ("spheres", "spheres"),
        ("AABBs", "AABBs and OBBs"),
        ("14-DOPs", "14-DOPs"),
        ("18-DOPs", "18-DOPs"),
        ("26-DOPs", "26-DOPs"),
    ];
    for (style, (volume, name)) in shown.into_iter().enumerate() {
        let points = rows.iter().filter(|row| row.volume == volume).enumerate();
        let points = points.map(|(place, row)| [place as f64, row.immediate_calls as f64]);
        panel = panel.with(Series::new(name, Look::Style(style), Kind::Marked, points));
    }
    let limit = |calls: usize| {
        let line = [-0.3, 5.2].map(|x| [x, calls as f64]);
        Series::new("", Look::Ink, Kind::Line, line)
    };
    panel = panel
        .with(limit(PUBLISHED))
        .note([5.2, PUBLISHED as f64], "the paper's most");
    let most = rows.iter().filter_map(|row| row.draw_calls).max();
    let title = if let Some(most) = most {
        panel = panel
            .with(limit(most))
            .note([5.2, most as f64], "draw calls, here");
        format!("Up to 27,000 OpenGL calls a frame in the paper, {most} draw calls here")
    } else {
        "Spheres take more calls than boxes where each vertex is one".into()
    };
    Chart::new(
        "calls",
        title,
        "A cloth of 16 × 16 and a ball. Points: the calls of glColor, glBegin, glVertex and glEnd that would draw the same lines one by one.",
    )
    .with(panel)
}

/// The frame with all levels.
fn whole<'a>(rows: &'a [Row], volume: &str) -> Option<&'a Row> {
    rows.iter()
        .find(|row| row.volume == volume && row.level == ALL)
}

fn vertices(rows: &[Row], volume: &str) -> usize {
    whole(rows, volume).map_or(0, |row| row.vertices)
}

fn kilobytes(rows: &[Row], volume: &str) -> f64 {
    whole(rows, volume).map_or(0.0, |row| row.bytes as f64 / 1.0e3)
}

/// With a comma.
fn thousands(number: usize) -> String {
    if number < 1000 {
        number.to_string()
    } else {
        format!("{},{:03}", number / 1000, number % 1000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::quick;
    use examples_shared::view::View;

    const COLUMNS: &str = "volume,level,draw_calls,vertices";

    #[test]
    fn calls_are_few_and_vertices_add_up() {
        let view = View::without_window();
        let rows = quick::<Calls>(view, COLUMNS);
        let is_drawn = view == View::Offscreen;
        assert!(rows.iter().all(|row| row.draw_calls.is_some() == is_drawn));
        // Spheres and boxes look the same at any moment.
        for volume in ["spheres", "AABBs", "OBBs"] {
            let levels = rows
                .iter()
                .filter(|row| row.volume == volume && row.level != ALL);
            let sum: usize = levels.map(|row| row.vertices).sum();
            assert_eq!(sum, vertices(&rows, volume), "{volume}");
        }
    }

    #[test]
    fn vertices_are_counted_without_a_renderer() {
        let mut run = Run::new(true, View::Nothing);
        let rows = Calls::run(&mut run);
        assert_eq!(Calls::check(&rows), Ok(()));
        assert!(rows.iter().all(|row| row.draw_calls.is_none()));
        assert_eq!(Calls::findings(&rows).len(), 1);
    }
}
