//! What is so deep inside that the nearest way out may lead to the other side.

use bevy::math::Vec3;

use super::{ONLY, all_of, build, deepest_at, random::Random};
use crate::{
    contact::{ContactSettings, MovingCollider, NarrowPhase},
    solver::SubStep,
};

/// A ball appears with its centre just beyond a sheet whose noise is larger than that distance: some particles are on
/// the centre's other side, and the nearest way out leads them there. All leave on the sheet's side: those nearer to
/// the centre than half of the radius by force, but for what is beside it by the mean normal, which is up to 15° off
/// the sheet's: as far down as 0.3 m × sin 15° = 0.08 m; those farther out along their own normal, which takes what is
/// up to the noise below the centre to twice that at most, 0.04 m.
#[test]
fn a_sheet_is_not_split_by_a_ball_that_appears_in_it() {
    for seed in 0..50 {
        let mut random = Random(seed);
        let (surface, mut particles) = build(21, 21, 0.05);
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
        let mut detection = all_of(std::slice::from_ref(&ball), &settings, &surface, &particles);
        for index in 0..3 {
            let substep = SubStep {
                index,
                count: 3,
                ..ONLY
            };
            detection.respond(&mut particles, &settings, substep, |_| {});
        }
        let mut beyond = 0;
        for (index, before) in before.into_iter().enumerate() {
            let offset = before - centre;
            let after = particles.position(index).expect("it exists") - centre;
            if offset.length() < 0.3 {
                assert!(after.z > -0.08, "{seed}: {offset} {after}");
                beyond += usize::from(offset.length() < 0.15 && offset.z < 0.0);
            }
        }
        assert!(beyond > 0, "some are on the other side");
        assert!(deepest_at(&particles, &ball, 1.0, 0.0) < 1e-6);
    }
}
