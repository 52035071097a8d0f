//! What a tick and a sub-step are.

use bevy::{
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::ClothParticles;

/// The time step for which the paper's damping D is given (s).
pub(super) const DAMPING_REFERENCE: f32 = 1.0 / 60.0;

/// What moves a cloth in a tick, besides its springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TickStep {
    /// Length of the tick (s).
    pub seconds: f32,
    /// Sub-steps in it, at least 1.
    pub substeps: u32,
    /// Acceleration in the cloth's frame (m/s²).
    pub acceleration: Vec3,
    /// The paper's D: the part of its velocity that the cloth loses in 1/60 s.
    pub damping: f32,
    /// Which velocity that is.
    pub damped_against: DampingFrame,
    /// Of which order in time.
    pub order: TimeOrder,
    /// The stretch that the material itself gives: what is far beyond it has not been solved, and is no motion to go on from.
    pub material_stretch: f32,
}

/// What the velocity that damping takes from is relative to.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub enum DampingFrame {
    /// To what stands still: the paper's equation (2). What falls freely is slowed down as well.
    #[default]
    Still,
    /// To something that moves evenly, such as what a cloth is pinned to: its velocity in the cloth's frame (m/s).
    Moving(Vec3),
    /// To the centre of mass of all particles that are free: damping takes no momentum.
    CentreOfMass,
}

/// How the error of a motion falls with the length of a sub-step Δt.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum TimeOrder {
    /// In proportion to Δt: the paper's Verlet, equation (2), which with constraints is implicit Euler. Takes energy out of a
    /// motion of frequency ω, by the part ω² Δt in a second.
    First,
    /// In proportion to Δt²: backward differences over three displacements (BDF2), or velocity Verlet where soft springs push by
    /// their forces. After what no past can foretell it falls
    /// back to the first order for a while: contact, springs that were not solved, a write by the game.
    #[default]
    Second,
}

impl Default for TickStep {
    /// 20 sub-steps of Bevy's 64 Hz, no acceleration, no damping.
    fn default() -> Self {
        Self {
            seconds: 1.0 / 64.0,
            substeps: 20,
            acceleration: Vec3::ZERO,
            damping: 0.0,
            damped_against: DampingFrame::default(),
            order: TimeOrder::default(),
            material_stretch: 0.0,
        }
    }
}

/// One sub-step of a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubStep {
    /// Which one, from 0.
    pub index: u32,
    /// How many there are.
    pub count: u32,
    /// How far the particle that moved farthest in it has moved (m).
    pub farthest_move: f32,
}

impl SubStep {
    /// The first of so many, in which nothing has moved yet.
    pub(crate) fn first_of(count: u32) -> Self {
        Self {
            index: 0,
            count,
            farthest_move: 0.0,
        }
    }

    /// The one that follows, in which nothing has moved yet, if there is one.
    pub(crate) fn next(&self) -> Option<Self> {
        let index = self.index + 1;
        (index < self.count).then_some(Self {
            index,
            ..Self::first_of(self.count)
        })
    }

    /// The part of the tick that has passed when this sub-step begins, less than 1.
    pub(crate) fn start(&self) -> f32 {
        self.index as f32 / self.count as f32
    }

    /// The part of the tick that has passed when this sub-step ends, up to 1.
    pub fn end(&self) -> f32 {
        (self.index + 1) as f32 / self.count as f32
    }
}

/// A pinned particle that its cloth's frame, or whatever it is pinned to, carries along in a tick. One of a particle that
/// does not exist moves nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinMotion {
    /// Index of the particle.
    pub particle: u32,
    /// Where it is as the tick begins (m).
    pub from: Vec3,
    /// Where it is as the tick ends (m).
    pub to: Vec3,
}

/// Those of particles that exist.
pub(super) fn existing(pins: &[PinMotion], particles: usize) -> impl Iterator<Item = &PinMotion> {
    pins.iter()
        .filter(move |pin| (pin.particle as usize) < particles)
}

/// Puts pinned particles where they are at the end of a tick: not a rounding beside it.
pub(super) fn put_pins(particles: &mut ClothParticles, pins: &[PinMotion]) {
    for pin in existing(pins, particles.len()) {
        particles.put(pin.particle as usize, pin.to);
    }
}
