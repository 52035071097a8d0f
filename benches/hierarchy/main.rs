//! What the search is meant to reach, and what it reaches here: `cargo bench --profile dev --bench hierarchy`.
//!
//! A draped cloth, two waves across it and three spacings high, and a ball of four spacings that touches it. Whatever
//! is compared is timed in turns within one run; each figure is the median of its turns.

mod ecs;
mod parry;
mod rays;
mod scene;

use std::{hint::black_box, time::Instant};

use bevy::math::Vec3;
use bevy_drape::{
    hierarchy::{BoundRule, BoundingVolume, NodeBounds, Probe, TopDownQuery, brute_force},
    solver::{Solver, TickStep},
};
use parry::ParryTree;
use scene::Draped;

/// Turns that each candidate gets.
const TURNS: usize = 15;

/// Each volume by each rule.
const CHOICES: [(BoundingVolume, BoundRule); 10] = [
    (BoundingVolume::Sphere, BoundRule::RestShape),
    (BoundingVolume::Aabb, BoundRule::RestShape),
    (BoundingVolume::Sphere, BoundRule::Refit),
    (BoundingVolume::Aabb, BoundRule::Refit),
    (BoundingVolume::Obb, BoundRule::Refit),
    (BoundingVolume::KDop14, BoundRule::Refit),
    (BoundingVolume::KDop18, BoundRule::Refit),
    (BoundingVolume::KDop26, BoundRule::Refit),
    (BoundingVolume::Sphere, BoundRule::Paper),
    (BoundingVolume::Aabb, BoundRule::Paper),
];

fn main() {
    one_ball();
    what_the_stretch_costs();
    volumes(256);
    visits();
    many_balls(256);
    many_balls(64);
    nothing_near();
    rays::rays();
}

/// Rebuild and query for one ball, against parry's tree and a scan over the columns.
fn one_ball() {
    println!("one ball of 4 spacings, rebuild + query (µs)\n");
    println!(
        "{:>6} {:>11} {:>11} {:>11} {:>12} {:>9} {:>9} {:>9} {:>9}",
        "size",
        "rest shape",
        "scan",
        "parry",
        "parry, moved",
        "x scan",
        "x parry",
        "visited",
        "contacts"
    );
    for side in [16, 24, 32, 48, 64, 128, 256, 512, 1024] {
        let draped = Draped::new(side);
        let probe = draped.ball();
        let mut bounds = NodeBounds::default();
        let mut query = TopDownQuery::default();
        let mut parry = ParryTree::new(&draped.particles);
        let truth = brute_force(&draped.particles, &probe).len();
        let mut found = [const { Vec::new() }; 4];
        for turn in 0..TURNS {
            found[0].push(seconds(2.0e-4, || {
                query.clear();
                draped.rebuild(&mut bounds, CHOICES[0]);
                query
                    .search(&draped.tree, &bounds, &draped.particles, black_box(&probe))
                    .len()
            }));
            assert_eq!(query.candidates().len(), truth);
            found[1].push(seconds(2.0e-4, || {
                query.clear();
                query.scan(&draped.particles, black_box(&probe)).len()
            }));
            assert_eq!(query.candidates().len(), truth);
            // All leaves updated, as a cloth in motion needs it, and refitted; then every leaf out of its margin.
            if turn < 5 || side < 512 {
                found[2].push(seconds(0.0, || parry.tick(&draped.particles, &probe, 0.0)));
                found[3].push(seconds(0.0, || parry.tick(&draped.particles, &probe, 1.0)));
            }
        }
        query.clear();
        query.search(&draped.tree, &bounds, &draped.particles, &probe);
        let [rest, scan, still, moved] = found.map(|mut times| 1.0e6 * median(&mut times));
        println!(
            "{:>6} {rest:>11.3} {scan:>11.3} {still:>11.1} {moved:>12.1} {:>9.1} {:>9.0} {:>9} {truth:>9}",
            format!("{side}²"),
            scan / rest,
            still / rest,
            query.nodes_visited(),
        );
    }
}

/// Every volume and rule on one scene, against the scan.
fn volumes(side: u32) {
    let draped = Draped::new(side);
    let probe = draped.ball();
    let truth = brute_force(&draped.particles, &probe).len();
    println!("\nevery volume, one ball, {side}² (µs)\n");
    println!(
        "{:>10} {:>11} {:>10} {:>9} {:>10} {:>9} {:>9} {:>9}",
        "volume", "rule", "rebuild", "query", "scan", "x scan", "visited", "leaves"
    );
    let mut query = TopDownQuery::default();
    for choice in CHOICES {
        let mut bounds = NodeBounds::default();
        let mut found = [const { Vec::new() }; 3];
        for _ in 0..TURNS {
            found[0].push(seconds(2.0e-4, || {
                draped.rebuild(black_box(&mut bounds), choice);
            }));
            found[1].push(seconds(2.0e-4, || {
                query.clear();
                query
                    .search(&draped.tree, &bounds, &draped.particles, black_box(&probe))
                    .len()
            }));
            assert!(query.candidates().len() == truth || choice.1 == BoundRule::Paper);
            found[2].push(seconds(2.0e-4, || {
                query.clear();
                query.scan(&draped.particles, black_box(&probe)).len()
            }));
        }
        query.clear();
        query.search(&draped.tree, &bounds, &draped.particles, &probe);
        let [rebuild, search, scan] = found.map(|mut times| 1.0e6 * median(&mut times));
        println!(
            "{:>10} {:>11} {rebuild:>10.2} {search:>9.3} {scan:>10.2} {:>9.2} {:>9} {:>9}",
            choice.0.name(),
            choice.1.name(),
            (rebuild + search) / scan,
            query.nodes_visited(),
            query.leaf_tests()
        );
    }
}

/// The rest shape needs the largest stretch: what measuring it costs, by itself, beside a tick of 20 sub-steps whose
/// last one measures it on the way.
fn what_the_stretch_costs() {
    println!("\nthe stretch that the rest shape needs (µs)\n");
    println!(
        "{:>6} {:>12} {:>22} {:>9}",
        "size", "measured", "a tick, 20 sub-steps", "part"
    );
    for side in [64, 256, 1024] {
        let draped = Draped::new(side);
        let mut solver = Solver::new(&draped.springs, &draped.particles);
        let mut particles = draped.particles.clone();
        let mut found = [const { Vec::new() }; 2];
        for _ in 0..TURNS / 3 {
            found[0].push(seconds(2.0e-4, || solver.measure(black_box(&particles))));
            found[1].push(seconds(0.0, || {
                particles.clone_from(&draped.particles);
                solver.advance(&mut particles, TickStep::default(), &[], |_, _| false)
            }));
        }
        let [measured, tick] = found.map(|mut times| 1.0e6 * median(&mut times));
        println!(
            "{:>6} {measured:>12.1} {tick:>22.1} {:>8.1} %",
            format!("{side}²"),
            100.0 * measured / tick
        );
    }
}

/// Nodes looked at and leaves tested, volume by volume, on the same scenes.
fn visits() {
    println!("\nnodes visited / leaves tested, one ball of 4 spacings\n");
    let sides = [16, 64, 256, 1024];
    print!("{:>10} {:>11}", "volume", "rule");
    for side in sides {
        print!(" {:>12}", format!("{side}²"));
    }
    println!();
    let scenes = sides.map(Draped::new);
    let mut query = TopDownQuery::default();
    for choice in CHOICES {
        print!("{:>10} {:>11}", choice.0.name(), choice.1.name());
        for draped in &scenes {
            let mut bounds = NodeBounds::default();
            draped.rebuild(&mut bounds, choice);
            query.clear();
            query.search(&draped.tree, &bounds, &draped.particles, &draped.ball());
            print!(
                " {:>12}",
                format!("{} / {}", query.nodes_visited(), query.leaf_tests())
            );
        }
        println!();
    }
}

/// A thousand cloths, and a ball that is far away from all: what rebuild and query take a cloth.
fn nothing_near() {
    let draped = Draped::new(64);
    let far = Probe::ball(Vec3::splat(1.0e3), 1.0, 0.0);
    let mut times: Vec<f64> = (0..TURNS)
        .map(|_| {
            seconds(2.0e-4, || {
                let root = draped.tree.root_sphere(black_box(&draped.particles), 0.1);
                let reach = root.radius() + far.radius;
                far.core.middle().distance_squared(root.center.into()) <= reach * reach
            })
        })
        .collect();
    println!("\nno collider near\n");
    println!(
        "the root's test alone: {:.1} ns",
        1.0e9 * median(&mut times)
    );
    println!(
        "both systems, of 1000 cloths, a cloth: {:.1} ns",
        ecs::nanoseconds_a_cloth(1000)
    );
}

/// Balls all over the cloth: when does a refit pay?
fn many_balls(side: u32) {
    let draped = Draped::new(side);
    println!("\nmany balls, {side}², rebuild + queries (µs)\n");
    println!(
        "{:>6} {:>11} {:>15} {:>12} {:>11} {:>16}",
        "balls", "rest shape", "refitted spheres", "refit AABBs", "scans", "scan / rest shape"
    );
    let mut query = TopDownQuery::default();
    for count in [1, 10, 30, 100, 300, 1000, 3000] {
        let balls = draped.balls(count);
        let mut bounds = [const { None }; 3].map(|_: Option<()>| NodeBounds::default());
        let mut found = [const { Vec::new() }; 4];
        for _ in 0..if count < 1000 { TURNS } else { 3 } {
            for (at, choice) in [CHOICES[0], CHOICES[2], CHOICES[3]].into_iter().enumerate() {
                found[at].push(seconds(2.0e-4, || {
                    query.clear();
                    draped.rebuild(&mut bounds[at], choice);
                    balls
                        .iter()
                        .map(|ball| {
                            query
                                .search(&draped.tree, &bounds[at], &draped.particles, ball)
                                .len()
                        })
                        .sum::<usize>()
                }));
            }
            found[3].push(seconds(2.0e-4, || {
                query.clear();
                balls
                    .iter()
                    .map(|ball| query.scan(&draped.particles, ball).len())
                    .sum::<usize>()
            }));
        }
        let [rest, spheres, boxes, scans] = found.map(|mut times| 1.0e6 * median(&mut times));
        println!(
            "{count:>6} {rest:>11.1} {spheres:>15.1} {boxes:>12.1} {scans:>11.1} {:>16.1}",
            scans / rest
        );
    }
}

/// Time of one call (s), called again until so much time has passed.
fn seconds<R>(least: f64, mut work: impl FnMut() -> R) -> f64 {
    let start = Instant::now();
    let mut calls = 0;
    loop {
        black_box(work());
        calls += 1;
        let passed = start.elapsed().as_secs_f64();
        if passed >= least {
            return passed / f64::from(calls);
        }
        // Not a look at the clock for each.
        if passed < least / 4.0 {
            for _ in 0..calls {
                black_box(work());
            }
            calls *= 2;
        }
    }
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_unstable_by(f64::total_cmp);
    times[times.len() / 2]
}
