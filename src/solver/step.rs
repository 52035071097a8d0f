//! Parameters of a tick and of a sub-step.

use bevy::{
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::ClothParticles;

/// The time step for which the paper's damping D is given (s).
pub(super) const DAMPING_REFERENCE: f32 = 1.0 / 60.0;

/// Parameters of a tick: its length, its sub-steps, and the forces besides springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TickStep {
    /// Length of the tick (s).
    pub seconds: f32,
    /// Sub-steps in it, at least 1.
    pub substeps: u32,
    /// Acceleration in the cloth's frame (m/s²).
    pub acceleration: Vec3,
    /// The paper's D: the fraction of its velocity that the cloth loses in 1/60 s.
    pub damping: f32,
    /// The frame of that velocity.
    pub damped_against: DampingFrame,
    /// The order in time.
    pub order: TimeOrder,
    /// The stretch of the material itself. A stretch far beyond it is unsolved, and the motion does not continue from
    /// it.
    pub material_stretch: f32,
    /// Whether it may touch cloth, itself or another.
    pub has_layers: bool,
}

/// The frame in which damping acts. The plugin damps a piece that no pin holds relative to its own centre of mass.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub enum DampingFrame {
    /// At rest: the paper's equation (2). It slows down free fall as well.
    #[default]
    Still,
    /// In uniform motion, such as that of a body to which the cloth is pinned: its velocity in the cloth's frame (m/s).
    Moving(Vec3),
    /// With the centre of mass of all free particles: damping takes no momentum.
    CentreOfMass,
}

/// Order in time: how the error of a motion falls with the length Δt of a sub-step.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum TimeOrder {
    /// In proportion to Δt: the paper's Verlet, equation (2), which with constraints is implicit Euler. It takes energy
    /// from a motion of frequency ω: the fraction ω² Δt in a second.
    First,
    /// In proportion to Δt²: backward differences over three displacements (BDF2), or velocity Verlet where soft
    /// springs act by explicit forces. It falls back to first order for a while after sudden changes: contact, unsolved
    /// springs, or a write by the game.
    #[default]
    Second,
}

impl Default for TickStep {
    /// A tick of Bevy's 64 Hz in 20 sub-steps, without acceleration or damping.
    fn default() -> Self {
        Self {
            seconds: 1.0 / 64.0,
            substeps: 20,
            acceleration: Vec3::ZERO,
            damping: 0.0,
            damped_against: DampingFrame::default(),
            order: TimeOrder::default(),
            material_stretch: 0.0,
            has_layers: false,
        }
    }
}

/// One sub-step of a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubStep {
    /// Its index, from 0.
    pub index: u32,
    /// Number of sub-steps in the tick.
    pub count: u32,
    /// Largest displacement of a particle in it (m).
    pub farthest_move: f32,
}

impl SubStep {
    /// The first of `count` sub-steps, in which nothing has moved yet.
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

/// The motion of a pinned particle in a tick, with its cloth's frame or the entity that it is pinned to. It is ignored
/// if the particle does not exist.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinMotion {
    /// Index of the particle.
    pub particle: u32,
    /// Its position as the tick begins (m).
    pub from: Vec3,
    /// Its position as the tick ends (m).
    pub to: Vec3,
}

/// Those of particles that exist.
pub(super) fn existing(pins: &[PinMotion], particles: usize) -> impl Iterator<Item = &PinMotion> {
    pins.iter()
        .filter(move |pin| (pin.particle as usize) < particles)
}

/// Puts pinned particles exactly where they are at the end of a tick.
pub(super) fn put_pins(particles: &mut ClothParticles, pins: &[PinMotion]) {
    for pin in existing(pins, particles.len()) {
        particles.put(pin.particle as usize, pin.to);
    }
}
