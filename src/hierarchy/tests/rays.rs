//! Rays against brute force in f64, by another test of triangles.

use bevy::math::{Dir3, Ray3d, Vec3};
use proptest::{
    arbitrary::any,
    sample::Index,
    strategy::{Strategy, ValueTree},
    test_runner::TestRunner,
};

use super::{
    states::{Scene, State, runner, states},
    surfaces::{all, scene},
};
use crate::{
    cloth::{ClothParticles, Surface},
    hierarchy::ray::RayQuery,
};

/// Distance of the first face that a ray hits, each of which is larger by a margin on all sides (Möller and Trumbore 1997).
fn first_hit(surface: &Surface, scene: &Scene, ray: Ray3d, margin: f64) -> Option<f64> {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let at = |corner: u32| scene.particles.position_at(corner as usize).as_dvec3();
    let hit = |face: &[u32; 3]| {
        let [a, b, c] = face.map(at);
        let (ab, ac) = (b - a, c - a);
        let across = direction.cross(ac);
        let determinant = ab.dot(across);
        let offset = origin - a;
        let u = offset.dot(across) / determinant;
        let v = direction.dot(offset.cross(ab)) / determinant;
        let distance = ac.dot(offset.cross(ab)) / determinant;
        let is_in = [u, v, 1.0 - u - v].iter().all(|weight| *weight >= -margin);
        (is_in && distance >= -margin && determinant != 0.0).then_some(distance)
    };
    let hits = surface.triangles().iter().filter_map(hit);
    hits.min_by(f64::total_cmp)
}

/// Where a ray comes from and goes: towards one of a surface's particles, the middle of two, or past it.
#[derive(Debug)]
struct Aim {
    particles: [Index; 2],
    kind: u32,
    past: Vec3,
    from: Vec3,
}

fn aims() -> impl Strategy<Value = Aim> {
    let direction = || {
        let within = (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0);
        within.prop_map(|place| Vec3::from(place).normalize_or(Vec3::Z))
    };
    let particles = (any::<Index>(), any::<Index>());
    (particles, 0u32..3, direction(), direction()).prop_map(|((a, b), kind, past, from)| Aim {
        particles: [a, b],
        kind,
        past,
        from,
    })
}

impl Aim {
    fn at(&self, particles: &ClothParticles) -> Vec3 {
        let [a, b] = self
            .particles
            .map(|index| particles.position_at(index.index(particles.len())));
        match self.kind {
            0 => a,
            1 => a.midpoint(b),
            _ => a + 0.3 * self.past,
        }
    }
}

fn some<T>(strategy: &impl Strategy<Value = T>, runner: &mut TestRunner) -> T {
    strategy.new_tree(runner).expect("one").current()
}

fn towards(origin: Vec3, aim: Vec3) -> Ray3d {
    Ray3d::new(origin, Dir3::new(aim - origin).expect("they differ"))
}

/// A hit is found if there is one by more than rounding, and only then.
#[test]
fn rays_hit_as_by_brute_force() {
    // Both work in f64 on the same numbers: only the distance is rounded to f32. Weights near 0 differ by less than this.
    let margin = 1.0e-6;
    let (mut rays, mut hits) = (0, 0);
    for (name, surface, _) in all() {
        let mut runner = runner(5);
        let mut query = RayQuery::default();
        for number in 0..60 {
            let state = State {
                origin: Vec3::splat(number as f32),
                ..some(&states(), &mut runner)
            };
            let scene = scene(&surface, &state);
            let (tree, particles) = (&scene.tree, &scene.particles);
            let stretch = scene.stretch.bound;
            for _ in 0..30 {
                let aim = some(&aims(), &mut runner);
                let at = aim.at(particles);
                let ray = towards(at + 1.5 * aim.from, at);
                let found = query.cast(&surface, tree, particles, stretch, ray, f32::INFINITY);
                let small = first_hit(&surface, &scene, ray, -margin);
                let large = first_hit(&surface, &scene, ray, margin);
                let rounding = 1.0e-6 * (1.0 + large.unwrap_or(0.0));
                rays += 1;
                if let Some(hit) = found {
                    hits += 1;
                    let distance = f64::from(hit.distance);
                    let large = large.expect("a larger face is hit, too");
                    assert!(distance >= large - rounding, "{name}: {distance} {large}");
                    let corners = surface.triangles()[hit.face];
                    let each = corners.iter().zip(hit.weights);
                    let each =
                        each.map(|(&corner, part)| part * particles.position_at(corner as usize));
                    let place = each.sum::<Vec3>();
                    let off = place.distance(ray.get_point(hit.distance));
                    // Some ten roundings of up to ten metres.
                    assert!(off < 1.0e-5, "{name}: {off}");
                    let shorter = 0.999 * hit.distance;
                    let before = query.cast(&surface, tree, particles, stretch, ray, shorter);
                    assert_eq!(before, None, "{name}: nothing is nearer");
                }
                if let Some(small) = small {
                    let distance = found.map(|hit| f64::from(hit.distance));
                    let is_found = distance.is_some_and(|found| found <= small + rounding);
                    assert!(is_found, "{name}: {distance:?} {small}");
                }
            }
        }
    }
    println!("{hits} of {rays} rays hit");
    assert!(hits > rays / 4 && hits < rays);
}

/// No ray from inside passes between the faces of a closed surface, nor through a particle.
#[test]
fn no_ray_leaves_a_cube() {
    let (_, surface, _) = all().swap_remove(3);
    assert!(surface.is_closed());
    let scene = scene(&surface, &State::flat(2, 2));
    let (tree, particles) = (&scene.tree, &scene.particles);
    let middle = particles.positions().sum::<Vec3>() / particles.len() as f32;
    let mut query = RayQuery::default();
    let mut runner = runner(3);
    for _ in 0..20_000 {
        let aim = some(&aims(), &mut runner);
        let face = surface.triangles()[aim.particles[0].index(surface.triangles().len())];
        let [a, b, _] = face.map(|corner| particles.position_at(corner as usize));
        let at = a.lerp(b, 0.5 * aim.kind as f32);
        let ray = towards(middle + 0.1 * aim.from, at);
        let hit = query.cast(&surface, tree, particles, scene.stretch.bound, ray, 10.0);
        let hit = hit.unwrap_or_else(|| panic!("{ray:?}"));
        // The direction is rounded, which moves a hit by its length over the sine of 20° or more.
        let off = (hit.distance - at.distance(ray.origin)).abs();
        assert!(off < 2.0e-6, "{off}");
    }
}

/// Nothing is hit by a ray that is no number, that points away, or that ends before.
#[test]
fn rays_that_hit_nothing() {
    let (_, surface, _) = all().swap_remove(0);
    let scene = scene(&surface, &State::flat(2, 2));
    let (tree, particles) = (&scene.tree, &scene.particles);
    let middle = particles.positions().sum::<Vec3>() / particles.len() as f32;
    let mut query = RayQuery::default();
    let mut cast = |origin: Vec3, direction: Dir3, farthest: f32| {
        let (stretch, ray) = (scene.stretch.bound, Ray3d::new(origin, direction));
        let hit = query.cast(&surface, tree, particles, stretch, ray, farthest);
        hit.map(|hit| hit.distance)
    };
    let (before, endless) = (middle + Vec3::Z, f32::INFINITY);
    let hit = cast(before, Dir3::NEG_Z, endless).expect("it is in front of it");
    assert!((hit - 1.0).abs() < 1.0e-6, "{hit}");
    assert!(cast(before, Dir3::NEG_Z, 1.001).is_some());
    assert_eq!(cast(before, Dir3::NEG_Z, 0.999), None);
    assert_eq!(cast(before, Dir3::Z, endless), None);
    assert_eq!(cast(before, Dir3::NEG_Z, f32::NAN), None);
    assert_eq!(cast(before, Dir3::NEG_Z, -1.0), None);
    assert_eq!(cast(before + 9.0 * Vec3::X, Dir3::NEG_Z, endless), None);
    assert_eq!(cast(Vec3::NAN, Dir3::NEG_Z, endless), None);
    assert_eq!(cast(Vec3::INFINITY, Dir3::NEG_Z, endless), None);
}
