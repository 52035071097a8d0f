//! When a cloth has come to rest.

use crate::cloth::ClothParticles;

/// How far a particle of a cloth at rest is from where it was at most, in diagonals of the cloth: a pixel, where the
/// cloth fills the screen.
const REACH: f32 = 1.0e-3;

/// And in metres: a person stands nearer to a large cloth than its size.
const LARGEST_REACH: f32 = 5.0e-3;

/// How long it has to stay so near (s): half a swing, √(g/L) × 2.405/2 being the angular frequency of a sheet of length
/// L that hangs by its upper edge. What swings farther leaves its place in that time, also from a turning point.
const HALF_SWING: f32 = 2.61;
const GRAVITY: f32 = 9.81;
const PATIENCE: [f32; 2] = [0.5, 2.5];

/// Whether a cloth is at rest, told by what an eye sees: no particle has moved by more than a thousandth of the cloth's
/// diagonal, at most 5 mm, for as long as half a swing of a sheet as long as that takes (1.3 s for 2.3 m), from 0.5 to
/// 2.5 s. Speeds do not count: what trembles in its place is at rest.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Rest {
    /// Where the particles were when they were last seen to move; as they sleep, if they do.
    origin: ClothParticles,
    /// For how long they have been near it (s).
    calm: f32,
    is_asleep: bool,
}

impl Rest {
    /// Takes what a tick of so many seconds ended with, of a cloth that measures `diagonal` (m) at rest.
    pub fn observe(&mut self, seconds: f32, particles: &ClothParticles, diagonal: f32) {
        let reach = (REACH * diagonal).min(LARGEST_REACH);
        let patience = HALF_SWING * (diagonal / GRAVITY).sqrt();
        let is_near = particles.stays_within(reach, &self.origin);
        if !is_near {
            self.origin.copy_from(particles);
            self.calm = 0.0;
            return;
        }
        self.calm += seconds;
        if self.calm >= patience.clamp(PATIENCE[0], PATIENCE[1]) {
            self.is_asleep = true;
            self.origin.copy_from(particles);
        }
    }

    /// Whether it has been long enough.
    pub fn is_asleep(&self) -> bool {
        self.is_asleep
    }

    /// Whether it sleeps, with its particles as they are here to the last bit.
    pub fn sleeps_as(&self, particles: &ClothParticles) -> bool {
        self.is_asleep && self.origin == *particles
    }

    /// Wakes the cloth.
    pub fn disturb(&mut self) {
        self.calm = 0.0;
        self.is_asleep = false;
    }
}
