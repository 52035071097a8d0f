//! How the picture passes from one level of detail to another.
//!
//! A picture would jump as a cloth freezes, thaws, or is moved before it has been drawn where the last move left it.
//! Then the difference between the old picture and the new one is kept, and fades out ("inertialization").

use bevy::math::Vec3;

use crate::cloth::ClothParticles;

/// How long it takes (s).
const SECONDS: f64 = 0.125;

/// A difference that fades out.
#[derive(Debug, Default)]
pub(super) struct Blend {
    /// The jump that it belongs to.
    cuts: u32,
    /// When it began (s).
    start: f64,
    /// Offset of each particle from where it would be drawn, in the entity's frame.
    offsets: Vec<Vec3>,
}

impl Blend {
    /// Whether it has nothing more to add; `cuts` is the number of jumps so far.
    pub fn is_over(&self, cuts: u32) -> bool {
        self.offsets.is_empty() && self.cuts == cuts
    }

    /// Adds the rest of the difference to the positions drawn `before` to those `drawn` at a time (s). Pins are drawn
    /// where they are.
    pub fn add(
        &mut self,
        cuts: u32,
        seconds: f64,
        particles: &ClothParticles,
        before: &[Vec3],
        drawn: &mut [Vec3],
    ) {
        if self.cuts != cuts {
            self.cuts = cuts;
            self.start = seconds;
            self.offsets.clear();
            if before.len() == drawn.len() {
                let pairs = before.iter().zip(&*drawn).zip(particles.inverse_masses());
                let offsets = pairs.map(|((before, drawn), inverse_mass)| {
                    let offset = *before - *drawn;
                    if inverse_mass > 0.0 {
                        offset
                    } else {
                        Vec3::ZERO
                    }
                });
                self.offsets.extend(offsets);
            }
        }
        let part = 1.0 - (seconds - self.start) / SECONDS;
        if part <= 0.0 || self.offsets.len() != drawn.len() {
            self.offsets.clear();
            return;
        }
        // It begins and ends without a speed of its own.
        let part = part.min(1.0) as f32;
        let weight = part * part * (3.0 - 2.0 * part);
        for (drawn, offset) in drawn.iter_mut().zip(&self.offsets) {
            *drawn += *offset * weight;
        }
    }
}
