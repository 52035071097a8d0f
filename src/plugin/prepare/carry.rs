//! Moves the particles when their frame moves, and sees whether their pins jump.

use bevy::prelude::{Isometry3d, Vec3};

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

/// A pin that goes farther than this in a tick (m) may have jumped: the default of
/// [`ClothInertia::teleport_distance`](crate::plugin::ClothInertia). At 64 Hz a runner at 10 m/s goes 0.16 m, a car at 60 m/s 0.94 m; 2 m is
/// 128 m/s. A length and no part of the cloth's size: honest motion is no slower for small cloth, and what a jump does to the chains
/// next to the pins is no less for large cloth.
pub(crate) const FAR: f32 = 2.0;

/// It has jumped if it is also this many times as fast as any particle: cloth that flies with a jet goes 5 m in a tick, and all of
/// it does.
const FASTER: f32 = 2.0;

/// How far the pins jump in a tick (m), 0 if they do not. The fastest particle has so much speed as the tick begins (m/s), and the
/// tick takes `seconds` and stands for so many `ticks`.
pub(crate) fn jump(pins: &[PinMotion], fastest: f32, (seconds, ticks): (f32, u32)) -> f32 {
    let squares = pins.iter().map(|pin| pin.from.distance_squared(pin.to));
    let displacement = squares.fold(0.0, f32::max).sqrt();
    let is_jump = displacement > FAR * ticks as f32 && displacement > FASTER * fastest * seconds;
    if is_jump { displacement } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;

    use super::*;

    const TICK: f32 = 1.0 / 64.0;

    fn pins(displacement: f32) -> [PinMotion; 2] {
        [0.5, 1.0].map(|part| PinMotion {
            particle: 0,
            from: Vec3::X,
            to: Vec3::X + Vec3::new(0.6, 0.0, 0.8) * part * displacement,
        })
    }

    #[test]
    fn what_is_far_and_faster_than_the_cloth_is_a_jump() {
        assert_eq!(jump(&[], 0.0, (TICK, 1)), 0.0);
        let found = jump(&pins(5.0), 1.0, (TICK, 1));
        assert!((found - 5.0).abs() < 1.0e-5, "{found}");
        for speed in [10.0, 60.0, 120.0] {
            assert_eq!(jump(&pins(speed * TICK), 0.0, (TICK, 1)), 0.0, "{speed}");
        }
        assert_eq!(jump(&pins(5.0), 320.0, (TICK, 1)), 0.0, "it goes along");
        // A runner who starts at once, of a cloth that is moved in each sixteenth tick.
        assert_eq!(jump(&pins(2.5), 0.0, (16.0 * TICK, 16)), 0.0);
    }
}
