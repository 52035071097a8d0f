//! What becomes of the particles when their frame moves.

use bevy::math::Isometry3d;

use super::{ClothFrame, inertia::Carried};
use crate::{cloth::ClothParticles, solver::PinMotion};

/// What takes a cloth from the frame that it was in to the one that it is in now, carried along or not; `None` if neither moves it.
pub(super) fn new_from_old(
    [old, new]: [&ClothFrame; 2],
    carried: Option<&Carried>,
) -> Option<Isometry3d> {
    match carried {
        Some(carried) => Some(carried.seen_from(new, old.isometry())),
        None => (old != new).then(|| new.isometry().inverse() * old.isometry()),
    }
}

/// The frame has moved: the particles stay where they are in the world, but for what carries them along, and their pins go along
/// in the course of the tick.
pub(super) fn carry(
    particles: &mut ClothParticles,
    new_from_old: Isometry3d,
    motions: &mut Vec<PinMotion>,
) {
    for (index, inverse_mass) in particles.inverse_masses().enumerate() {
        if inverse_mass == 0.0 {
            let pinned_to = particles.position_at(index);
            motions.push(PinMotion {
                particle: index as u32,
                from: new_from_old * pinned_to,
                to: pinned_to,
            });
        }
    }
    particles.transform(new_from_old);
}
