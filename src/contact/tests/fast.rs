//! Fast balls against a free cloth: how many get through.

use bevy::math::{DVec3, Vec3};

use super::{all_of, random::Random, weave};
use crate::{
    cloth::{ClothGrid, ClothMaterial, ClothParticles, Springs},
    contact::{MovingCollider, Terms},
    solver::{Solver, TickStep},
};

const SIDE: u32 = 16;
const SPACING: f32 = 0.1;
const TRIALS: u64 = 9;

/// Corners of all triangles, seen from a ball's centre (m).
fn seen(particles: &ClothParticles, grid: &ClothGrid, centre: Vec3) -> Vec<[DVec3; 3]> {
    let place = |index: u32| particles.position(index as usize).expect("it exists");
    let offset = |index: u32| place(index).as_dvec3() - centre.as_dvec3();
    grid.triangles()
        .map(|corners| corners.map(offset))
        .collect()
}

/// Whether a triangle passes over the origin between two states, along straight lines: where its plane does, the
/// origin is in it. The plane's passing is looked for in 16 parts.
fn crosses(before: [DVec3; 3], after: [DVec3; 3]) -> bool {
    // Most are all on one side.
    let (low, high) = before
        .into_iter()
        .chain(after)
        .fold((DVec3::MAX, DVec3::MIN), |(low, high), p| {
            (low.min(p), high.max(p))
        });
    if low.max_element() > 0.0 || high.min_element() < 0.0 {
        return false;
    }
    let when = |part: f64| [0, 1, 2].map(|corner| before[corner].lerp(after[corner], part));
    let height = |part: f64| {
        let [a, b, c] = when(part);
        a.dot(b.cross(c))
    };
    (0..16).any(|index| {
        let [mut from, mut to] = [index, index + 1].map(|index| f64::from(index) / 16.0);
        if height(from) * height(to) > 0.0 {
            return false;
        }
        for _ in 0..40 {
            let middle = f64::midpoint(from, to);
            if height(from) * height(middle) > 0.0 {
                from = middle;
            } else {
                to = middle;
            }
        }
        let [a, b, c] = when(to);
        let normal = (b - a).cross(c - a);
        [(a, b), (b, c), (c, a)]
            .into_iter()
            .all(|(p, q)| p.cross(q).dot(normal) >= 0.0)
    })
}

/// After how many ticks a ball of a radius (m) at a speed (m/s), spinning, is through a free cloth that it meets in
/// its middle third: its centre has passed a triangle. `None` if it is not 12 ticks after it has hit it.
///
/// That the cloth is still before it would say less: it may be thrown ahead, or slip off sideways.
fn through(speed: f32, radius: f32, is_swept: bool, seed: u64) -> Option<u32> {
    let mut random = Random(seed);
    let (grid, mut particles) = weave(SIDE, SIDE, SPACING);
    let springs = Springs::of_grid(&grid, &ClothMaterial::COTTON);
    let mut solver = Solver::new(&springs, &particles);
    let step = TickStep {
        seconds: 1.0 / 60.0,
        substeps: 20,
        acceleration: Vec3::NEG_Y * 9.81,
        damping: 0.01,
    };
    let terms = Terms {
        particle_radius: 0.01,
        friction: 0.3,
        is_swept,
        ..Terms::default()
    };
    let width = (SIDE - 1) as f32 * SPACING;
    let beside = random.within(width / 6.0).with_z(0.0);
    // It meets the cloth anywhere in the first tick.
    let behind = radius + 0.01 + random.part() * speed * step.seconds;
    let mut centre = Vec3::new(width / 2.0, -width / 2.0, -behind) + beside;
    let turn = random.direction() * 50.0 * random.part() * step.seconds;
    for tick in 0..13 {
        let to = centre + Vec3::Z * speed * step.seconds;
        let ball = MovingCollider {
            turn,
            ..MovingCollider::ball(radius, centre, to)
        };
        let mut detection = all_of(&[ball], &terms, &grid, &particles);
        let mut before = seen(&particles, &grid, centre);
        let mut is_through = false;
        solver.advance(&mut particles, step, &[], |particles, substep| {
            let is_pushed = detection.respond(particles, &terms, substep, |_| {});
            let at = Vec3::from(ball.pose(substep.end()).translation);
            let after = seen(particles, &grid, at);
            is_through |= before.iter().zip(&after).any(|(a, b)| crosses(*a, *b));
            before = after;
            is_pushed
        });
        assert_eq!(particles.validate(), Ok(()));
        centre = to;
        // Until it is through, it has the cloth in front of it, or beside it, where that has slipped off.
        if is_through {
            return Some(tick);
        }
    }
    None
}

/// How many balls get through, by speed and radius, with the test all along the way and with that at the end of each
/// sub-step alone: counted, and printed as CSV by `cargo test --lib tunnelling -- --nocapture`.
#[test]
fn tunnelling_is_of_the_discrete_test_alone() {
    let mut discrete = 0;
    let mut swept = 0;
    println!("speed_m_s,spacing_m,radius_over_spacing,test,trials,tunnelled");
    for speed in [10.0, 50.0, 100.0, 200.0, 400.0] {
        for ratio in [0.5, 1.0, 2.0, 4.0] {
            for (is_swept, name, sum) in [
                (false, "discrete", &mut discrete),
                (true, "swept", &mut swept),
            ] {
                let tunnelled: Vec<_> = (0..TRIALS)
                    .filter_map(|seed| through(speed, ratio * SPACING, is_swept, seed))
                    .collect();
                let count = tunnelled.len();
                println!("{speed},{SPACING},{ratio},{name},{TRIALS},{count}");
                *sum += count;
            }
        }
    }
    assert!(discrete > 0, "there is something to be swept for");
    assert_eq!(swept, 0);
}
