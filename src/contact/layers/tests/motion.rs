//! Bounds of the motion of particles and patches.

use bevy::math::Vec3A;

use super::{Sheeted, participants, settings, thrown::Draw};
use crate::contact::layers::{
    motion::Motion,
    participant::Participant,
    patch_pair::{PatchPair, Place},
};

/// Particles move at random, and some are put elsewhere twice. Patches are measured now and then. No two points of two patches come nearer
/// than their bound says, whenever they were compared, nor than the odometer says.
#[test]
fn particles_come_no_nearer_than_their_bound() {
    let mut draw = Draw(5);
    let (mut measured, mut nearest) = (0, f32::INFINITY);
    for is_mesh in [false, true] {
        let mut cloths = vec![Sheeted::of_kind(7, 0.6, is_mesh, |at| at)];
        let count = cloths[0].particles.len();
        let mut motion = Motion::default();
        motion.reset(&participants(&mut cloths, settings(0.01)));
        let mut compared: Vec<Compared> = Vec::new();
        for step in 0..60 {
            let common = draw.vector();
            // Trembling alone, or more than that.
            let size = if step % 3 == 0 { 0.02 } else { 0.0002 };
            for index in 0..count {
                let at = cloths[0].particles.position(index).expect("it exists");
                let at = at + common + size * draw.vector();
                let set = cloths[0].particles.set_position(index, at);
                set.expect("finite");
            }
            let of = participants(&mut cloths, settings(0.01));
            if step % 7 == 6 {
                let odometer = motion.odometer();
                for compared in &mut compared {
                    for patch in compared.pair.of {
                        compared.pair.since -= motion.patches[patch as usize].earlier;
                    }
                    compared.odometer -= odometer;
                }
                motion.reset_odometer();
            }
            let before = motion.odometer();
            motion.read(&of);
            for _ in 0..2 {
                let mut farthest = 0.0_f32;
                for _ in 0..5 {
                    let particle = (24.5 * (draw.next() + 1.0)) as u32 % 49;
                    let place = motion.end[particle as usize];
                    let by = Vec3A::from(1.5 * size * draw.vector());
                    farthest = farthest.max(motion.put(&of, particle, place + by));
                }
                motion.note(farthest);
                for compared in compared.iter().filter(|_| draw.next() > 0.3) {
                    measured += 1;
                    compared.check(&of, &mut motion);
                }
            }
            let patches = motion.patches.len() as u32;
            compared.retain(|_| draw.next() > -0.5);
            for a in 0..patches {
                let b = (a + step) % patches;
                let of_pair = [a.min(b), a.max(b)];
                of_pair.iter().for_each(|patch| motion.measure(&of, *patch));
                let mut pair = PatchPair::new(of_pair, None, false);
                let used = Place::of(&mut pair, &of, &motion, 0.0).used;
                nearest = nearest.min(used);
                compared.push(Compared {
                    pair,
                    places: motion.start.clone(),
                    odometer: before,
                });
            }
            motion.pass();
            for (index, place) in motion.start.iter().enumerate() {
                let set = cloths[0].particles.set_position(index, (*place).into());
                set.expect("finite");
            }
        }
    }
    assert!(measured > 1000 && nearest < 0.005, "{measured}, {nearest}");
}

/// A pair of patches that was compared with its particles at these places.
struct Compared {
    pair: PatchPair,
    places: Vec<Vec3A>,
    odometer: f32,
}

impl Compared {
    fn check(&self, of: &[Participant], motion: &mut Motion) {
        (self.pair.of.iter()).for_each(|patch| motion.measure(of, *patch));
        let used = self.pair.used(motion);
        let by_odometer = motion.odometer() - self.odometer;
        let [first, second] = self.pair.of.map(|patch| of[0].sheet.particles_of(patch));
        for [i, j] in first
            .iter()
            .flat_map(|i| second.iter().map(move |j| [i, j]))
        {
            let [i, j] = [i, j].map(|of| *of as usize);
            let was = self.places[i].distance(self.places[j]);
            let nearer = was - motion.end[i].distance(motion.end[j]);
            // Positions up to 60 m from the origin, in up to 60 steps.
            let rounding = 60.0 * 8.0 * f32::EPSILON;
            assert!(nearer <= used + rounding, "{nearer} of {used}");
            assert!(
                nearer <= by_odometer + 10.0 * rounding,
                "{nearer} of {by_odometer}"
            );
        }
    }
}
