//! Bounds of the motion of particles and patches.

use bevy::math::{Vec3, Vec3A};

use super::{Sheeted, participants, settings, thrown::Draw};
use crate::contact::layers::{
    motion::Motion,
    patch_pair::{PatchPair, Place},
};

/// Particles move at random, and some are put elsewhere twice. No two of two patches come nearer than the bound says, and each patch is
/// as if all had been measured.
#[test]
fn particles_come_no_nearer_than_their_bound() {
    let mut draw = Draw(5);
    for is_mesh in [false, true] {
        let mut cloths = vec![Sheeted::of_kind(7, 0.6, is_mesh, |at| at)];
        let mut motion = Motion::default();
        motion.reset(&participants(&mut cloths, settings(0.01)));
        for _ in 0..30 {
            let common = draw.vector();
            for index in 0..cloths[0].particles.len() {
                let at = cloths[0].particles.position(index).expect("it exists");
                let at = at + common + 0.02 * draw.vector();
                let set = cloths[0].particles.set_position(index, at);
                set.expect("finite");
            }
            let of = participants(&mut cloths, settings(0.01));
            motion.read(&of);
            motion.measure_all();
            motion.measure(&of);
            for _ in 0..2 {
                for _ in 0..5 {
                    let particle = (24.5 * (draw.next() + 1.0)) as u32 % 49;
                    let place = motion.end[particle as usize];
                    let by = Vec3A::from(Vec3::splat(0.03) * draw.vector());
                    motion.put(&of, particle, place + by);
                }
                motion.measure_changed(&of);
            }
            let ends = motion.ends.clone();
            motion.measure(&of);
            assert_eq!(ends, motion.ends);
            let patches = 0..motion.patches.len() as u32;
            let pairs = patches
                .clone()
                .flat_map(|a| (a..patches.end).map(move |b| [a, b]));
            for of_pair in pairs {
                let mut pair = PatchPair::new(of_pair, None, false);
                let used = Place::of(&mut pair, &of, &motion, 0.0).used;
                let [first, second] = of_pair.map(|patch| of[0].sheet.particles_of(patch));
                for [i, j] in first
                    .iter()
                    .flat_map(|i| second.iter().map(move |j| [i, j]))
                {
                    let [i, j] = [i, j].map(|of| *of as usize);
                    let nearer = motion.start[i].distance(motion.start[j])
                        - motion.end[i].distance(motion.end[j]);
                    // Positions up to 30 m from the origin.
                    assert!(nearer <= used + 30.0 * 8.0 * f32::EPSILON);
                }
            }
            motion.pass(&of, 0.0005);
            for (index, place) in motion.start.iter().enumerate() {
                let set = cloths[0].particles.set_position(index, (*place).into());
                set.expect("finite");
            }
        }
    }
}
