//! Moves the particles when their frame moves.

use bevy::math::{Isometry3d, Vec3};

use crate::{
    cloth::ClothParticles,
    plugin::{authoring::Carried, frame::ClothFrame},
    solver::{DampingFrame, PinMotion},
};

/// The transform from the cloth's old frame to its new one, carried along or not; `None` if it does not move.
pub(crate) fn new_from_old(
    [old, new]: [&ClothFrame; 2],
    carried: Option<&Carried>,
) -> Option<Isometry3d> {
    match carried {
        Some(carried) => Some(carried.seen_from(new, old.isometry())),
        None => (old != new).then(|| new.isometry().inverse() * old.isometry()),
    }
}

/// Sets the motion of a pin in the tick. It replaces the pin's motion among the first `carried` ones, which are in the
/// order of the particles.
pub(crate) fn set_motion(motions: &mut Vec<PinMotion>, carried: usize, motion: PinMotion) {
    let known = motions[..carried].binary_search_by_key(&motion.particle, |known| known.particle);
    match known {
        Ok(at) => motions[at] = motion,
        Err(_) if motion.from != motion.to => motions.push(motion),
        Err(_) => {}
    }
}

/// The frame in which damping acts: the mean motion of the pins of a cloth with that many pins; the cloth's own motion
/// if it has none.
pub(crate) fn carrier(pins: &[PinMotion], pinned: usize, seconds: f32) -> DampingFrame {
    if pinned == 0 {
        return DampingFrame::CentreOfMass;
    }
    let moved: Vec3 = pins.iter().map(|pin| pin.to - pin.from).sum();
    if moved == Vec3::ZERO || seconds == 0.0 {
        return DampingFrame::Still;
    }
    DampingFrame::Moving(moved / (pinned as f32 * seconds))
}

/// Follows a move of the frame. Particles stay where they are in the world, unless a root carries them along, and pins
/// move with the frame in the course of the tick.
pub(crate) fn carry(
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
