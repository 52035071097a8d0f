//! What begins a tick deep inside a collider, where the nearest ways out lead apart.

use bevy::math::Vec3;

use super::{ONLY, build, deepest_at, random::Random};
use crate::{
    cloth::ClothParticles,
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::MovingCollider,
        detection::Detection,
    },
};

/// A ball appears with its centre just beyond a sheet whose noise is larger than that distance: the nearest ways out of a
/// particle and of its neighbours lead to opposite sides. They all leave on one side instead, the one or the other.
#[test]
fn a_sheet_is_not_split_by_a_ball_that_appears_in_it() {
    for seed in 0..50 {
        let mut random = Random(seed);
        let (surface, mut particles) = build(21, 21, 0.05);
        particles.set_substep(1.0 / 64.0);
        let noise = 0.02;
        for index in 0..particles.len() {
            let place = particles.position(index).expect("it exists");
            let place = place + Vec3::Z * random.between(-noise, noise);
            particles.set_position(index, place).expect("it exists");
        }
        let before: Vec<Vec3> = particles.positions().collect();
        let centre = Vec3::new(0.5, -0.5, -0.01) + random.within(0.005);
        let ball = MovingCollider::ball(0.3, centre, centre);
        let settings = ContactSettings {
            narrow_phase: NarrowPhase::Particles,
            ..ContactSettings::default()
        };
        let all: Vec<u32> = (0..particles.len() as u32).collect();
        let mut detection = Detection::default();
        let mut was_embedded = false;
        let stop = |particles: &mut ClothParticles| {
            for index in 0..particles.len() {
                (particles.set_velocity(index, Vec3::ZERO)).expect("it exists");
            }
        };
        for _ in 0..400 {
            stop(&mut particles);
            detection.begin(&surface, f32::INFINITY);
            detection.embed(
                0,
                &ball,
                was_embedded,
                &all,
                &particles,
                [&ball].into_iter(),
            );
            detection.add(0, &ball, settings.narrow_phase, &all, &particles);
            detection.respond(&mut particles, &settings, ONLY, |_| {});
            if !detection.is_embedded(0) {
                break;
            }
            was_embedded = true;
        }
        for _ in 0..20 {
            stop(&mut particles);
            detection.respond(&mut particles, &settings, ONLY, |_| {});
        }
        // What was shallow left the nearest way, beside the ball.
        let deep = before
            .into_iter()
            .enumerate()
            .filter_map(|(index, before)| {
                let after = particles.position(index).expect("it exists");
                (before.distance(centre) < 0.25)
                    .then_some([before.z - centre.z, after.z - centre.z])
            });
        let deep: Vec<[f32; 2]> = deep.collect();
        let fronts = [0, 1].map(|when| deep.iter().filter(|z| z[when] > 0.0).count());
        assert!(
            0 < fronts[0] && fronts[0] < deep.len(),
            "{seed}: it is split at first"
        );
        let is_one = fronts[1] == 0 || fronts[1] == deep.len();
        assert!(
            is_one,
            "{seed}: {} of {} are in front",
            fronts[1],
            deep.len()
        );
        assert!(deepest_at(&particles, &ball, 1.0, 0.0) < 0.0025);
    }
}
