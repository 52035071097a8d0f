//! Meshes that deform: against brute force in f64, and against those that move as a whole.

use std::{f32::consts::PI, sync::Arc};

use bevy::math::{DVec3, Quat, Vec3};

use super::{all_of, build, random::Random};
use crate::contact::{
    candidates::{ContactSettings, NarrowPhase},
    colliders::{ColliderShape, DeformingMesh, MovingCollider, Topology},
};
use crate::solver::SubStep;

const RINGS: u32 = 9;
const AROUND: u32 = 14;

/// Radius of a particle (m).
const RADIUS: f32 = 0.05;

/// A ball with bumps, closed at its poles, and its triangles.
fn bumpy(random: &mut Random) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut places = vec![Vec3::Y * random.between(0.8, 1.2)];
    for ring in 1..RINGS {
        for step in 0..AROUND {
            let turn = Quat::from_rotation_y(2.0 * PI * step as f32 / AROUND as f32);
            let tilt = Quat::from_rotation_z(PI * ring as f32 / RINGS as f32);
            places.push(turn * tilt * Vec3::Y * random.between(0.8, 1.2));
        }
    }
    places.push(Vec3::NEG_Y * random.between(0.8, 1.2));
    let last = places.len() as u32 - 1;
    let at = |ring: u32, step: u32| match ring {
        0 => 0,
        RINGS => last,
        _ => 1 + (ring - 1) * AROUND + step % AROUND,
    };
    let mut triangles = Vec::new();
    for ring in 0..RINGS {
        for step in 0..AROUND {
            let [a, b] = [at(ring, step), at(ring, step + 1)];
            let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    (places, triangles)
}

/// Such a ball that turns and swells in a tick, with the places of its vertices at both ends.
fn deforming(random: &mut Random) -> (DeformingMesh, [Vec<Vec3>; 2], Vec<[u32; 3]>) {
    let (from, triangles) = bumpy(random);
    let turn = Quat::from_scaled_axis(random.direction() * 0.3);
    let moved = random.within(0.3);
    let swell = |at: &Vec3| turn * (*at * random.between(0.95, 1.05)) + moved;
    let to: Vec<Vec3> = from.iter().map(swell).collect();
    let ends = [from, to];
    (mesh(&ends, triangles.clone()), ends, triangles)
}

fn mesh(ends: &[Vec<Vec3>; 2], triangles: Vec<[u32; 3]>) -> DeformingMesh {
    let topology = Arc::new(Topology::new(&ends[0], triangles));
    DeformingMesh::new(&topology, |own| {
        own.clone_from(ends);
        false
    })
}

/// The corners of all triangles at a fraction of the tick.
fn faces(ends: &[Vec<Vec3>; 2], triangles: &[[u32; 3]], part: f64) -> Vec<[DVec3; 3]> {
    let at = |corner: u32| {
        let [from, to] = [0, 1].map(|end: usize| ends[end][corner as usize].as_dvec3());
        from.lerp(to, part)
    };
    triangles.iter().map(|triangle| triangle.map(at)).collect()
}

/// Distance of a point from triangles (m).
fn distance(faces: &[[DVec3; 3]], point: DVec3) -> f64 {
    let of_side = |a: DVec3, b: DVec3| {
        let part = (point - a).dot(b - a) / (b - a).length_squared();
        point.distance(a.lerp(b, part.clamp(0.0, 1.0)))
    };
    let each = faces.iter().map(|&[a, b, c]| {
        let normal = (b - a).cross(c - a).normalize();
        let off = normal.dot(point - a);
        let foot = point - normal * off;
        let is_left = |a: DVec3, b: DVec3| (b - a).cross(foot - a).dot(normal) >= 0.0;
        if is_left(a, b) && is_left(b, c) && is_left(c, a) {
            off.abs()
        } else {
            of_side(a, b).min(of_side(b, c)).min(of_side(c, a))
        }
    });
    each.fold(f64::INFINITY, f64::min)
}

/// How often closed triangles wind around a point (van Oosterom and Strackee 1983).
fn winding(faces: &[[DVec3; 3]], point: DVec3) -> f64 {
    let each = faces.iter().map(|face| {
        let [a, b, c] = face.map(|corner| corner - point);
        let [x, y, z] = [a, b, c].map(DVec3::length);
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).atan2(below)
    });
    each.sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// Errors of distances of up to 3 m, in f32: a dozen roundings.
const ROUNDING: f64 = 12.0 * 3.0 * f32::EPSILON as f64;

/// Near and far, inside and out, at any time; wound either way round, and mirrored as well.
#[test]
fn the_nearest_surface_is_that_of_brute_force() {
    let (mut inside, mut outside) = (0, 0);
    for seed in 0..60 {
        let mut random = Random(seed);
        let (whole, ends, triangles) = deforming(&mut random);
        let turned: Vec<_> = triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
        let turned = mesh(&ends, turned);
        for _ in 0..40 {
            let (part, point) = (random.part(), random.within(1.1));
            let faces = faces(&ends, &triangles, part.into());
            let truth = distance(&faces, point.as_dvec3());
            let is_inside = winding(&faces, point.as_dvec3()).abs() > 0.5;
            for mesh in [&whole, &turned] {
                let found = mesh.nearest(part, point);
                let signed = if is_inside { -truth } else { truth };
                let error = (f64::from(found.distance) - signed).abs();
                assert!(error < ROUNDING, "{seed}: {found:?}, {signed} at {point}");
                let surface = point - found.normal * found.distance;
                let off = distance(&faces, surface.as_dvec3());
                assert!(off < ROUNDING, "{seed}: {found:?} leads {off} m beside it");
            }
            (inside, outside) = match is_inside {
                true => (inside + 1, outside),
                false => (inside, outside + 1),
            };
        }
    }
    assert!(inside > 400 && outside > 400, "{inside} {outside}");
}

/// No time of the tick brings the surface nearer to a moving point than its clearance. That is the distance itself where the
/// point moves as all of the surface does.
#[test]
fn nothing_comes_nearer_than_the_clearance() {
    for seed in 0..60 {
        let mut random = Random(seed);
        let (mesh, ends, triangles) = deforming(&mut random);
        let moved = random.within(0.2);
        let to = ends[0].iter().map(|at| *at + moved).collect();
        let alike = self::mesh(&[ends[0].clone(), to], triangles.clone());
        for _ in 0..20 {
            let (part, point, displacement) =
                (random.part(), random.within(2.0), random.within(0.3));
            let at = |time: f32| {
                let there = point + displacement * (time - part);
                distance(&faces(&ends, &triangles, time.into()), there.as_dvec3())
            };
            let least = (0..=16).map(|time| at(time as f32 / 16.0));
            let least = least.fold(f64::INFINITY, f64::min);
            let clearance = f64::from(mesh.clearance(part, point, displacement));
            assert!(
                clearance <= least + ROUNDING,
                "{seed}: {clearance} > {least}"
            );
            let found = alike.clearance(part, point, moved);
            let truth = alike.nearest(part, point).distance.abs();
            assert!(
                f64::from((found - truth).abs()) < ROUNDING,
                "{seed}: {found}"
            );
        }
    }
}

/// At the border of an open mesh nothing is inside, and elsewhere whatever is behind it.
#[test]
fn an_open_mesh_has_an_outer_side() {
    let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let places: Vec<Vec3> = places.map(|(x, z)| Vec3::new(x, 0.0, z)).into();
    // A roof, which is open below.
    let places = [places, vec![Vec3::new(0.5, 0.4, 0.5)]].concat();
    let triangles = vec![[0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]];
    let roof = mesh(&[places.clone(), places], triangles);
    let distance = |x, y, z| roof.nearest(0.5, Vec3::new(x, y, z)).distance;
    assert!(distance(0.5, 0.5, 0.5) > 0.09, "above its tip");
    assert!(distance(0.5, 0.35, 0.5) < -0.03, "below its tip");
    assert!(distance(0.5, 0.2, 0.45) < -0.1, "under it");
    assert!(distance(1.2, -0.1, 0.5) > 0.2, "beside it");
    assert!(distance(0.95, -0.3, 0.5) > 0.2, "nearest to its border");
}

/// A point that is no number has no distance.
#[test]
fn no_number_is_near() {
    let (mesh, ..) = deforming(&mut Random(1));
    for point in [Vec3::NAN, Vec3::INFINITY] {
        assert!(mesh.nearest(0.5, point).distance.is_nan(), "{point}");
    }
}

/// A mesh whose vertices move as those of a mesh that moves and turns as a whole pushes and drags particles alike.
#[test]
fn a_deformation_pushes_as_a_motion_does() {
    for seed in 0..40 {
        let mut random = Random(seed);
        let (from, triangles) = bumpy(&mut random);
        // By so little that no plane is too old.
        let (travel, pose) = (random.within(0.2 * RADIUS), random.pose(0.2));
        // Every second one turns.
        let turn = random.within(0.004) * (seed % 2) as f32;
        let still = [from.clone(), from.clone()];
        let whole = ColliderShape::Deforming(mesh(&still, triangles.clone()));
        let whole = MovingCollider {
            to: Vec3::from(pose.translation) + travel,
            turn,
            ..MovingCollider::still(whole, pose)
        };
        let end = pose.inverse() * whole.pose_at(1.0);
        let to = from.iter().map(|at| end * *at).collect();
        let ends = [from, to];
        let parts = ColliderShape::Deforming(mesh(&ends, triangles));
        let parts = MovingCollider::still(parts, pose);
        let friction = random.part();
        let top = ends[0]
            .iter()
            .map(|at| (pose * *at).y)
            .fold(f32::MIN, f32::max);
        let offset = random.within(0.3).with_y(top + 1.1 * RADIUS);
        let both = [whole, parts].map(|collider| pushed(&collider, friction, offset));
        let [(whole, depth), (parts, other_depth)] = both;
        assert!(depth > 0.001, "{seed}: it touches, {depth} m");
        // Straight paths are off the arcs of a radius r by r θ²/8 at most: the particles are no farther than 2 m from the middle. Three
        // times that, as a push goes along a normal, which turns as well. And a dozen roundings of 3 m in each of ten sub-steps.
        let bow = 3.0 * 2.0 * turn.length_squared() / 8.0 + 10.0 * ROUNDING as f32;
        // A particle that has moved by less than a tenth of its radius is tested against the plane before. One of both may just have
        // moved farther, and then another face is nearer by up to twice that.
        let most = if turn == Vec3::ZERO {
            bow
        } else {
            bow + 0.2 * RADIUS
        };
        let apart = whole.iter().zip(&parts).map(|(a, b)| a.distance(*b));
        let apart: Vec<f32> = apart.collect();
        let farthest = apart.iter().copied().fold(0.0, f32::max);
        let mean = apart.iter().sum::<f32>() / apart.len() as f32;
        assert!(farthest < most, "{seed}: {farthest} of {most}");
        assert!(mean < bow, "{seed}: {mean} of {bow}");
        assert!(
            (depth - other_depth).abs() < most,
            "{seed}: {depth} {other_depth}"
        );
    }
}

/// Where the particles of a lying sheet are after ten sub-steps in which they fall on a collider, and how deep the deepest was
/// (m).
fn pushed(collider: &MovingCollider, friction: f32, offset: Vec3) -> (Vec<Vec3>, f32) {
    let settings = ContactSettings {
        particle_radius: RADIUS,
        friction,
        narrow_phase: NarrowPhase::Particles,
        ..ContactSettings::default()
    };
    let (surface, mut particles) = build(16, 16, 0.1);
    for index in 0..particles.len() {
        let place = particles.position_at(index) + Vec3::new(-0.75, 0.75, 0.0);
        particles.put(index, Vec3::new(place.x, 0.0, place.y) + offset);
    }
    particles.set_substep(1.0 / 640.0);
    let colliders = std::slice::from_ref(collider);
    let mut detection = all_of(colliders, &settings, &surface, &particles);
    for index in 0..10 {
        for particle in 0..particles.len() {
            let fall = Vec3::Y * -0.006;
            let place = particles.position_at(particle);
            particles.put(particle, place + fall);
            (particles.set_displacement(particle, fall)).expect("it exists");
        }
        let substep = SubStep {
            index,
            count: 10,
            farthest_move: 0.01,
        };
        detection.respond(&mut particles, &settings, substep, |_| {});
    }
    let deepest = detection.touches()[0].deepest;
    (particles.positions().collect(), deepest)
}
