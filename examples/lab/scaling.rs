//! How the search and the whole tick grow with the cloth: from 8 × 8 to 1024 × 1024 particles.
//!
//! A draped cloth, two waves across it, and a ball of 4 spacings that touches it. All volumes and rules, the scan, brute
//! force and parry's tree take their turns, and in each turn the solver does a tick: 20 sub-steps with the response to
//! the ball. A search's whole tick is that and its own rebuild and query.

use bevy::math::{Vec3, bounding::BoundingSphere};
use bevy_drape::{
    cloth::{Cloth, ClothGrid, ClothMaterial},
    contact::{Detection, MovingCollider, NarrowPhase, Terms},
    hierarchy::{BoundRule, Core, NodeBounds, Probe, TopDownQuery, brute_force},
    solver::{Solver, TickStep},
};
use serde::{Deserialize, Serialize};

use crate::{
    chart::{Axis, Chart, Kind, Look, Panel, Point, Series, number},
    cloths::{CHOICES, Choice},
    experiment::{Experiment, Run, Table},
    measure::{Spread, exponent, seconds, seconds_each},
    parry::ParryTree,
    scene::{Draped, SPACING},
};

/// Exponents are of cloths from this side on: smaller ones are all waves, and fit into a cache.
const FITTED_FROM: u32 = 32;

/// How long something short is done again and again (s).
const LEAST: f64 = 2.0e-4;

pub struct Scaling;

/// One way to search a cloth of one size.
#[derive(Serialize, Deserialize)]
pub struct Row {
    particles: u32,
    volume: String,
    rule: String,
    rebuild_us: f64,
    query_us: f64,
    /// The solver's 20 sub-steps with response, and both of the above.
    tick_us: f64,
    rebuild_low: f64,
    rebuild_high: f64,
    query_low: f64,
    query_high: f64,
    tick_low: f64,
    tick_high: f64,
    /// Nodes, or particles where there is no tree; 0 where that is not known.
    visited: usize,
    contacts: usize,
    missed: usize,
    /// Largest stretch of the cloth.
    stretch: f32,
}

impl Row {
    fn side(&self) -> u32 {
        self.particles.isqrt()
    }

    fn search_us(&self) -> f64 {
        self.rebuild_us + self.query_us
    }
}

enum Searcher {
    Tree(Box<NodeBounds>, Choice),
    Scan,
    /// In f64, one by one.
    Brute,
    Parry(Box<ParryTree>),
}

impl Searcher {
    fn all(draped: &Draped) -> Vec<Self> {
        let trees = CHOICES.map(|choice| Self::Tree(Box::default(), choice));
        let others = [
            Self::Scan,
            Self::Brute,
            Self::Parry(Box::new(ParryTree::new(&draped.particles))),
        ];
        trees.into_iter().chain(others).collect()
    }

    fn names(&self) -> [&'static str; 2] {
        match self {
            Self::Tree(_, (volume, rule)) => [volume.name(), rule.name()],
            Self::Scan => ["particles", SCAN],
            Self::Brute => ["particles", BRUTE],
            Self::Parry(_) => ["AABBs", PARRY],
        }
    }

    fn rebuild(&mut self, draped: &Draped) {
        match self {
            Self::Tree(bounds, choice) => draped.rebuild(bounds, *choice),
            Self::Parry(tree) => tree.update(&draped.particles, 0.0),
            Self::Scan | Self::Brute => {}
        }
    }

    /// Says how many contacts it found.
    fn search(&self, query: &mut TopDownQuery, draped: &Draped, ball: &Probe) -> usize {
        query.clear();
        match self {
            Self::Tree(bounds, _) => query
                .search(&draped.tree, bounds, &draped.particles, ball)
                .len(),
            Self::Scan => query.scan(&draped.particles, ball).len(),
            Self::Brute => brute_force(&draped.particles, ball).len(),
            Self::Parry(tree) => tree.count(&draped.particles, ball),
        }
    }

    fn has_rebuild(&self) -> bool {
        !matches!(self, Self::Scan | Self::Brute)
    }
}

const SCAN: &str = "scan";
const BRUTE: &str = "brute force, f64";
const PARRY: &str = "parry3d";

/// A tick of a solver on one thread, with the response to the ball.
struct Ticking {
    solver: Solver,
    grid: ClothGrid,
    detection: Detection,
    query: TopDownQuery,
}

impl Ticking {
    fn new(draped: &Draped, side: u32) -> Self {
        Self {
            solver: Solver::new(&draped.springs, &draped.particles),
            grid: Cloth::new(side, side, SPACING)
                .grid(Vec3::ONE)
                .expect("a sound grid"),
            detection: Detection::default(),
            query: TopDownQuery::default(),
        }
    }

    /// What the solver takes (s): the search for candidates is not in it.
    fn seconds(&mut self, draped: &Draped, ball: &Probe) -> f64 {
        let mut particles = draped.particles.clone();
        let Core::Point(centre) = ball.core else {
            return f64::NAN;
        };
        let collider = MovingCollider::ball(ball.radius, centre, centre);
        let terms = Terms {
            particle_radius: ball.particle_radius,
            friction: ClothMaterial::COTTON.friction,
            narrow_phase: NarrowPhase::Particles,
            ..Default::default()
        };
        // A ball around all of the cloth, and more than a particle moves in the tick.
        let cloth = BoundingSphere::new(Vec3::ZERO, 200.0);
        self.detection.begin(4.0 * SPACING);
        let (probe, against) = self
            .detection
            .probe(&collider, &terms, &self.grid, SPACING, &cloth);
        self.query.clear();
        self.query.scan(&particles, &probe);
        let found = self.query.candidates();
        self.detection
            .add(0, &collider, against, found, &particles, &self.grid);
        let step = TickStep {
            acceleration: Vec3::NEG_Y * 9.81,
            damping: ClothMaterial::COTTON.damping,
            ..Default::default()
        };
        let Self {
            solver, detection, ..
        } = self;
        seconds(|| {
            solver.advance(&mut particles, step, &[], |particles, substep| {
                detection.respond(particles, &terms, substep, |_| {})
            });
        })
    }
}

impl Experiment for Scaling {
    type Row = Row;

    const NAME: &'static str = "scaling";

    fn run(run: &mut Run) -> Vec<Row> {
        let sides = run.either(
            &[8, 16, 32, 64, 128, 256][..],
            &[8, 16, 32, 64, 128, 256, 512, 1024],
        );
        let turns = run.either(3, 11);
        run.set("scene", "a draped cloth, two waves across it and three spacings high, spacing 0.05 m, and a ball of 4 spacings that touches it");
        run.set("turns", turns);
        run.set("tick", "20 sub-steps of 1/64 s on one thread, with response: measured once a turn, and each search's rebuild and query added to it");
        let mut rows = Vec::new();
        run.begin(Self::NAME, sides.len() * turns);
        for &side in sides {
            let draped = Draped::new(side);
            let ball = draped.ball();
            let contacts = brute_force(&draped.particles, &ball).len();
            let mut query = TopDownQuery::default();
            let mut ticking = Ticking::new(&draped, side);
            let mut searchers = Searcher::all(&draped);
            let mut times = vec![[const { Vec::new() }; 3]; searchers.len()];
            for _ in 0..turns {
                let solver = ticking.seconds(&draped, &ball);
                for (searcher, times) in searchers.iter_mut().zip(&mut times) {
                    let rebuild = if searcher.has_rebuild() {
                        seconds_each(LEAST, || searcher.rebuild(&draped))
                    } else {
                        0.0
                    };
                    let search =
                        seconds_each(LEAST, || searcher.search(&mut query, &draped, &ball));
                    let all = [rebuild, search, solver + rebuild + search];
                    for (times, seconds) in times.iter_mut().zip(all) {
                        times.push(1.0e6 * seconds);
                    }
                }
                run.step();
            }
            for (searcher, times) in searchers.iter().zip(&times) {
                let found = searcher.search(&mut query, &draped, &ball);
                let visited = match searcher {
                    Searcher::Parry(_) => 0,
                    Searcher::Brute => draped.particles.len(),
                    _ => query.nodes_visited().max(query.leaf_tests()),
                };
                let [rebuild, search, tick] = times.each_ref().map(|times| Spread::of(times));
                let [volume, rule] = searcher.names().map(String::from);
                rows.push(Row {
                    particles: side * side,
                    volume,
                    rule,
                    rebuild_us: rebuild.median,
                    query_us: search.median,
                    tick_us: tick.median,
                    rebuild_low: rebuild.low,
                    rebuild_high: rebuild.high,
                    query_low: search.low,
                    query_high: search.high,
                    tick_low: tick.low,
                    tick_high: tick.high,
                    visited,
                    contacts,
                    missed: contacts - found,
                    stretch: draped.stretch,
                });
            }
        }
        rows
    }

    fn check(rows: &[Row]) -> Result<(), String> {
        for row in rows {
            if row.missed > 0 && row.rule != BoundRule::Paper.name() {
                return Err(format!(
                    "{} by {} missed {} of {} contacts at {}²",
                    row.volume,
                    row.rule,
                    row.missed,
                    row.contacts,
                    row.side()
                ));
            }
            if row.contacts == 0 {
                return Err(format!("the ball does not touch at {}²", row.side()));
            }
        }
        let sides = sides(rows);
        let is_whole = sides.len() >= 6 && rows.len() == sides.len() * (CHOICES.len() + 3);
        if !is_whole {
            return Err("13 searches of each of at least 6 sizes".into());
        }
        // What a search looks at, not how long it takes: that is the machine's.
        let grows = |kind| fitted(rows, kind, |row| row.visited as f64);
        let (rest, scan) = (grows(REST), grows(["particles", SCAN]));
        if rest < 0.3 && scan > 0.99 {
            Ok(())
        } else {
            Err(format!(
                "nodes visited grow as n^{rest:.2} by the rest shape, as n^{scan:.2} by a scan"
            ))
        }
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let search = |kind| fitted(rows, kind, Row::search_us);
        let sides = sides(rows);
        let [smallest, largest] = [sides.first(), sides.last()].map(|side| *side.unwrap_or(&0));
        let us = |kind, side| at(rows, kind, side).map_or(f64::NAN, Row::search_us);
        let [scan, parry, brute] = [["particles", SCAN], ["AABBs", PARRY], ["particles", BRUTE]];
        let share = |kind| {
            at(rows, kind, largest).map_or(f64::NAN, |row| 100.0 * row.search_us() / row.tick_us)
        };
        let mut findings = vec![
            format!(
                "By the rest shape, spheres are searched in {:.1} µs at {smallest}² and in {:.1} µs at {largest}²: as n^{:.2} from {FITTED_FROM}² on, where refitted spheres and AABBs take n^{:.2} and n^{:.2}, a scan n^{:.2}, parry3d n^{:.2} and the solver's tick n^{:.2}.",
                us(REST, smallest),
                us(REST, largest),
                search(REST),
                search(REFIT_SPHERES),
                search(REFIT),
                search(scan),
                search(parry),
                fitted(rows, REST, |row| row.tick_us),
            ),
            beats_scan(rows),
            format!(
                "At {largest}² the rest shape is {} × as fast as a scan, {} × as brute force in f64, {} × as a refit of AABBs and {} × as parry3d; of a tick of 20 sub-steps it is {:.4} %, a scan {:.1} %, parry3d {:.0} %.",
                times(us(scan, largest) / us(REST, largest)),
                times(us(brute, largest) / us(REST, largest)),
                times(us(REFIT, largest) / us(REST, largest)),
                times(us(parry, largest) / us(REST, largest)),
                share(REST),
                share(scan),
                share(parry),
            ),
        ];
        if let [Some(rest), Some(refit)] = [REST, REFIT].map(|kind| at(rows, kind, largest)) {
            let saved = rest.query_us - refit.query_us;
            findings.push(format!(
                "Its price is looser volumes: {} nodes visited where refitted AABBs visit {}, and a query of {:.1} µs for {:.1}; the refit of {:.0} µs {}.",
                rest.visited,
                refit.visited,
                rest.query_us,
                refit.query_us,
                refit.rebuild_us,
                if saved > 0.0 {
                    format!("would pay from some {:.0} balls a tick on", refit.rebuild_us / saved)
                } else {
                    "never pays".into()
                }
            ));
        }
        let lost = |row: &&Row| row.missed > 0 && row.volume == "spheres";
        if let Some(row) = rows.iter().find(lost) {
            let worst = of(rows, ["spheres", "paper"])
                .filter(|row| row.missed > 0)
                .count();
            findings.push(format!(
                "The paper's spheres are not drawn: from {}² on they prune what the ball touches, {} of {} contacts there, and lose some at {worst} of {} sizes.",
                row.side(),
                row.missed,
                row.contacts,
                sides.len()
            ));
        }
        findings
    }

    fn table(rows: &[Row]) -> Table {
        let mut table = Table::new([
            "volume",
            "rule",
            "n",
            "rebuild µs",
            "query µs",
            "tick µs",
            "visited",
            "missed",
        ]);
        for row in rows {
            table.row([
                row.volume.clone(),
                row.rule.clone(),
                format!("{}²", row.side()),
                format!("{:.2}", row.rebuild_us),
                format!("{:.2}", row.query_us),
                format!("{:.1}", row.tick_us),
                row.visited.to_string(),
                row.missed.to_string(),
            ]);
        }
        table
    }

    fn charts(rows: &[Row]) -> Vec<Chart> {
        vec![growth(rows), parts(rows)]
    }
}

/// From which size on the rest shape is searched faster than all particles are scanned.
fn beats_scan(rows: &[Row]) -> String {
    let sides = sides(rows);
    let faster = |side: u32| {
        let rest = at(rows, REST, side)?.search_us();
        Some(at(rows, ["particles", SCAN], side)?.search_us() / rest)
    };
    let first = sides
        .iter()
        .find(|&&side| faster(side).is_some_and(|ratio| ratio > 1.0));
    let Some(&first) = first else {
        return "At every size measured a scan of all particles is faster than the tree.".into();
    };
    let below = sides.iter().rfind(|&&side| side < first);
    match below.and_then(|&side| Some((side, faster(side)?))) {
        Some((side, ratio)) => format!(
            "Below {first}² the scan wins, at {side}² by {:.1} ×; from {first}² on, where it takes {:.1} × as long, the tree does.",
            1.0 / ratio,
            faster(first).unwrap_or(f64::NAN)
        ),
        None => "The tree is faster than a scan at every size measured.".into(),
    }
}

type Names = [&'static str; 2];

const REST: Names = ["spheres", "rest shape"];
const REFIT_SPHERES: Names = ["spheres", "refit"];
const REFIT: Names = ["AABBs", "refit"];

/// What is drawn: the others lie between these.
const SHOWN: [(Names, usize); 6] = [
    (REST, 0),
    (["particles", SCAN], 1),
    (REFIT, 2),
    (["26-DOPs", "refit"], 3),
    (["OBBs", "refit"], 4),
    (["AABBs", PARRY], 5),
];

fn growth(rows: &[Row]) -> Chart {
    let called = |kind: Names| {
        let grows = fitted(rows, kind, Row::search_us);
        let name = match kind {
            ["particles", rule] => rule.into(),
            [_, PARRY] => PARRY.into(),
            [volume, rule] => format!("{volume}, {rule}"),
        };
        format!("{name}: n^{grows:.2}")
    };
    let mut search = Panel::new(
        "Rebuild and query",
        particles_axis(rows),
        Axis::log("µs a tick, log"),
    );
    let mut part = Panel::new(
        "Their part of the whole tick",
        particles_axis(rows),
        Axis::log("% of the tick, log"),
    );
    for (kind, style) in SHOWN {
        let at = |row: &Row, median: f64| [f64::from(row.particles), median];
        let points = of(rows, kind).map(|row| Point {
            at: at(row, row.search_us()),
            across: None,
            up: Some([
                row.rebuild_low + row.query_low,
                row.rebuild_high + row.query_high,
            ]),
        });
        let look = Look::Style(style);
        search = search.with(Series::new(called(kind), look, Kind::Marked, points));
        let parts = of(rows, kind).map(|row| at(row, 100.0 * row.search_us() / row.tick_us));
        part = part.with(Series::new(called(kind), look, Kind::Marked, parts));
    }
    let solver =
        || of(rows, REST).map(|row| [f64::from(row.particles), row.tick_us - row.search_us()]);
    let name = format!("20 sub-steps: n^{:.2}", exponent_from(solver()));
    search = search.with(Series::new(name, Look::Ink, Kind::Line, solver()));
    let sides = sides(rows);
    let [smallest, largest] = [sides.first(), sides.last()].map(|side| *side.unwrap_or(&0));
    let us = |kind| at(rows, kind, largest).map_or(f64::NAN, Row::search_us);
    let all = || of(rows, REST).map(Row::search_us);
    Chart::new(
        "scaling",
        format!(
            "From {smallest}² to {largest}² the rest shape takes {:.1} to {:.1} µs; at {largest}² a scan takes {} × as long, parry3d {} ×",
            all().fold(f64::INFINITY, f64::min),
            all().fold(0.0, f64::max),
            times(us(["particles", SCAN]) / us(REST)),
            times(us(["AABBs", PARRY]) / us(REST))
        ),
        format!("A draped cloth and one ball of 4 spacings, one thread; medians, quartiles. In the legend, how the time grows with n particles, from {FITTED_FROM}² on."),
    )
    .sized([960, 600])
    .columns(2)
    .with(search)
    .with(part)
}

/// Rebuild, query and nodes apart.
fn parts(rows: &[Row]) -> Chart {
    let panel = |title: &str, label: &str, value: fn(&Row) -> f64| {
        let mut panel = Panel::new(title, particles_axis(rows), Axis::log(label));
        for (kind, style) in SHOWN {
            let [volume, rule] = kind;
            let points = of(rows, kind).map(|row| [f64::from(row.particles), value(row)]);
            panel = panel.with(Series::new(
                format!("{volume}, {rule}"),
                Look::Style(style),
                Kind::Marked,
                points,
            ));
        }
        panel
    };
    let largest = sides(rows).last().copied().unwrap_or(0);
    let visited = |kind| at(rows, kind, largest).map_or(0, |row| row.visited);
    Chart::new(
        "scaling_parts",
        format!(
            "A refit pays for tight volumes: {} nodes visited in place of {}, and all of them brought up to date",
            visited(REFIT),
            visited(REST)
        ),
        "The same scene: what it takes to bring the volumes up to date, what one query takes, and how many nodes (or particles) it looks at. A scan has nothing to rebuild; what parry3d looks at is not known.",
    )
    .sized([960, 480])
    .columns(3)
    .with(panel("Rebuild", "µs, log", |row| row.rebuild_us))
    .with(panel("One query", "µs, log", |row| row.query_us))
    .with(panel("Nodes visited", "nodes, log", |row| {
        row.visited as f64
    }))
}

/// Every second size is named.
fn particles_axis(rows: &[Row]) -> Axis {
    let names = sides(rows)
        .into_iter()
        .step_by(2)
        .map(|side| (f64::from(side * side), format!("{side}²")));
    Axis::log("particles, log").named(names)
}

/// Exponent of the particles in a figure, from [`FITTED_FROM`] on.
fn fitted(rows: &[Row], kind: Names, value: impl Fn(&Row) -> f64) -> f64 {
    exponent_from(of(rows, kind).map(|row| [f64::from(row.particles), value(row)]))
}

/// With two digits that say something.
fn times(ratio: f64) -> String {
    let unit = 10f64.powf(ratio.log10().floor() - 1.0).max(0.1);
    number((ratio / unit).round() * unit)
}

fn exponent_from(points: impl Iterator<Item = [f64; 2]>) -> f64 {
    let least = f64::from(FITTED_FROM * FITTED_FROM);
    let points: Vec<[f64; 2]> = points
        .filter(|[particles, _]| *particles >= least)
        .collect();
    // Rounded as it is said: no minus before nothing.
    (100.0 * exponent(&points)).round() / 100.0 + 0.0
}

fn sides(rows: &[Row]) -> Vec<u32> {
    let mut sides: Vec<u32> = rows.iter().map(Row::side).collect();
    sides.dedup();
    sides
}

fn of(rows: &[Row], [volume, rule]: Names) -> impl Iterator<Item = &Row> {
    rows.iter()
        .filter(move |row| row.volume == volume && row.rule == rule)
}

fn at(rows: &[Row], kind: Names, side: u32) -> Option<&Row> {
    of(rows, kind).find(|row| row.side() == side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{experiment::quick, view::View};

    #[test]
    fn scaling_is_complete_and_the_rest_shape_hardly_grows() {
        let rows = quick::<Scaling>(
            View::Nothing,
            "particles,volume,rule,rebuild_us,query_us,tick_us,",
        );
        assert!(
            rows.iter()
                .all(|row| row.query_us > 0.0 && row.tick_us >= row.query_us)
        );
        assert!(rows.iter().all(|row| row.query_low <= row.query_high));
    }
}
