//! That no edge of a shape comes through a triangle.

use bevy::math::{DVec3, Isometry3d, Vec3};
use proptest::prelude::*;

use super::{Random, all_of, build, random::cases};
use crate::{
    cloth::{ClothParticles, Surface},
    contact::{ClothCollider, ColliderShape, ContactSettings, MovingCollider, NarrowPhase},
    solver::SubStep,
};

/// The corners of the triangle of two rows of two particles.
fn triangles(particles: &ClothParticles, surface: &Surface) -> Vec<[DVec3; 3]> {
    let place = |index: u32| {
        particles
            .position(index as usize)
            .expect("it exists")
            .as_dvec3()
    };
    surface
        .triangles()
        .iter()
        .map(|corners| corners.map(place))
        .collect()
}

/// How far the nearer end of an edge is through a triangle (m), 0 if it does not go through.
fn through([a, b, c]: [DVec3; 3], [from, to]: [DVec3; 2]) -> f64 {
    let normal = (b - a).cross(c - a).normalize();
    let (before, after) = (normal.dot(from - a), normal.dot(to - a));
    if before * after >= 0.0 {
        return 0.0;
    }
    let point = from.lerp(to, before / (before - after));
    let is_within = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(first, second)| (second - first).cross(point - first).dot(normal) > 0.0);
    if is_within {
        before.abs().min(after.abs())
    } else {
        0.0
    }
}

/// A box, or a four-sided pyramid, with its edges.
fn solid(random: &mut Random) -> (ColliderShape, Vec<[Vec3; 2]>) {
    let half = random.within(0.4).abs() + 0.1;
    let corner = |index: usize| {
        let sign = |bit: usize| if index & bit == 0 { -1.0 } else { 1.0 };
        Vec3::new(sign(1), sign(2), sign(4)) * half
    };
    if random.part() < 0.5 {
        let pairs = (0..8).flat_map(|from| [1, 2, 4].map(|bit| (from, from | bit)));
        let edges = pairs.filter(|(from, to)| from != to);
        let edges = edges.map(|(from, to)| [corner(from), corner(to)]).collect();
        (ColliderShape::Cuboid { half_size: half }, edges)
    } else {
        let tip = Vec3::Y * half.y;
        let base = [0, 1, 5, 4].map(corner);
        let sides =
            (0..4).flat_map(|index| [[base[index], base[(index + 1) % 4]], [base[index], tip]]);
        let edges = sides.collect();
        let points = [base.as_slice(), &[tip]].concat();
        let hull = ClothCollider::convex_hull(points).scaled(Vec3::ONE);
        (hull.expect("a valid hull"), edges)
    }
}

proptest! {
    #![proptest_config(cases(1_500))]

    /// Two triangles between four free particles come at a solid at up to three times their radius a sub-step, from a random
    /// side. Whatever of it they meet first, a face, an edge or a corner, no edge is through either by more than rounding at the
    /// end of any sub-step.
    #[test]
    fn no_edge_comes_through(seed in any::<u64>()) {
        let mut random = Random(seed);
        let (shape, edges) = solid(&mut random);
        let pose = random.pose(1.0);
        let collider = MovingCollider::still(shape, pose);
        let spacing = random.between(0.05, 0.4);
        let (surface, mut particles) = build(2, 2, spacing);
        let (turn, way) = (random.rotation(), random.direction());
        let radius = random.between(0.005, 0.02);
        let aim = Vec3::from(pose.translation) + random.within(0.3);
        let start = aim - way * 1.5;
        let step = way * radius * random.between(0.2, 3.0);
        for index in 0..4 {
            let offset = particles.position(index).expect("it exists") - Vec3::new(0.5, -0.5, 0.0) * spacing;
            particles.set_position(index, start + turn * offset).expect("it exists");
            particles.set_displacement(index, step).expect("it exists");
        }
        let settings = ContactSettings {
            particle_radius: radius,
            friction: random.between(0.0, 0.5),
            narrow_phase: NarrowPhase::Triangles,
            ..ContactSettings::default()
        };
        let count = 200;
        let mut detection = all_of(std::slice::from_ref(&collider), &settings, &surface, &particles);
        for index in 0..count {
            let starts: Vec<Vec3> = particles.positions().collect();
            for (particle, &start) in starts.iter().enumerate() {
                // What was stopped is pulled on.
                let displacement = particles.displacement(particle).expect("it exists") * 0.9 + step * 0.1;
                particles.set_position(particle, start + displacement).expect("it exists");
            }
            hold_together(&mut particles, spacing);
            for (particle, &start) in starts.iter().enumerate() {
                let place = particles.position(particle).expect("it exists");
                particles.set_displacement(particle, place - start).expect("it exists");
            }
            let farthest = particles.displacements().map(Vec3::length).fold(0.0, f32::max);
            let substep = SubStep { index, count, farthest_move: farthest };
            detection.respond(&mut particles, &settings, substep, |_| {});
            let world = |end: Vec3| (pose * end).as_dvec3();
            for triangle in triangles(&particles, &surface) {
                for &[from, to] in &edges {
                    let deep = through(triangle, [world(from), world(to)]);
                    prop_assert!(deep < 1.0e-4, "{collider:?} {index} {deep}");
                }
            }
        }
    }
}

/// Keeps four particles about as far apart as they were, by one sweep over their six distances.
fn hold_together(particles: &mut ClothParticles, spacing: f32) {
    let diagonal = spacing * 2.0_f32.sqrt();
    let pairs = [
        (0, 1, spacing),
        (2, 3, spacing),
        (0, 2, spacing),
        (1, 3, spacing),
        (0, 3, diagonal),
        (1, 2, diagonal),
    ];
    for (a, b, rest) in pairs {
        let place = |particle: usize| particles.position(particle).expect("it exists");
        let (from, to) = (place(a), place(b));
        let apart = to - from;
        let excess = apart * (0.5 * (1.0 - rest / apart.length().max(1.0e-6)));
        particles.set_position(a, from + excess).expect("it exists");
        particles.set_position(b, to - excess).expect("it exists");
    }
}

/// Triangles that lie flat on a face, over its edges too, are not moved.
#[test]
fn what_lies_flat_is_left_alone() {
    let half_size = Vec3::new(0.3, 0.2, 0.3);
    let (surface, mut particles) = build(21, 21, 0.05);
    for index in 0..particles.len() {
        let place = particles.position(index).expect("it exists");
        let lying = Vec3::new(place.x - 0.5, 0.2101, place.y + 0.5);
        particles.set_position(index, lying).expect("it exists");
    }
    let before: Vec<Vec3> = particles.positions().collect();
    let shape = ColliderShape::Cuboid { half_size };
    let collider = MovingCollider::still(shape, Isometry3d::IDENTITY);
    let settings = ContactSettings {
        particle_radius: 0.01,
        narrow_phase: NarrowPhase::Triangles,
        ..ContactSettings::default()
    };
    let mut detection = all_of(std::slice::from_ref(&collider), &settings, &surface, &particles);
    for index in 0..4 {
        let substep = SubStep {
            index,
            count: 4,
            farthest_move: 0.0,
        };
        assert!(!detection.respond(&mut particles, &settings, substep, |_| {}));
    }
    assert!(particles.positions().eq(before));
}
