//! Detects that a cloth has come to rest.

use crate::cloth::ClothParticles;

/// Largest displacement of a particle at rest, in diagonals of the cloth: a pixel if the cloth fills the screen.
const REACH: f32 = 1.0e-3;

/// And in metres: a person stands nearer to a large cloth than its size.
const LARGEST_REACH: f32 = 5.0e-3;

/// How long it has to stay so near (s): half a swing, √(g/L) × 2.405/2 being the angular frequency of a sheet of length
/// L that hangs by its upper edge. A cloth that swings by more than one and a half times as far to either side leaves
/// its place in that time, from any phase: in half a swing it moves by at least two thirds of its amplitude.
const HALF_SWING: f32 = 2.61;
const PATIENCE: [f32; 2] = [0.5, 20.0];

/// Pause between comparisons of a cloth that moves (s).
const PAUSE: f32 = 0.125;

/// Layers of cloth that lie on each other settle for minutes, by less than a person sees. They rest when they have
/// moved by less than this distance (m) in this time (s): a third of the speed at which Jolt lets bodies sleep.
const REACH_OF_LAYERS: f32 = 5.0e-3;
const PATIENCE_OF_LAYERS: f32 = 0.5;

/// The same for cloth that trembles under a body, in diagonals of the cloth.
const REACH_OF_CARRIERS: f32 = 1.0e-2;

/// Where nothing swings, as there is no gravity (s).
const WITHOUT_GRAVITY: f32 = 2.5;

/// How a cloth at rest is expected to move.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub enum RestRule {
    /// Not at all.
    #[default]
    Free,
    /// Its layers settle.
    Layers,
    /// It trembles under a body.
    Carries,
}

/// The limits of a motion that counts as rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestLimits {
    /// Largest displacement of a particle (m).
    pub reach: f32,
    /// For how long it has to stay so near (s).
    pub patience: f32,
}

impl RestRule {
    /// The limits for cloth that measures `diagonal` (m) at rest, under an `acceleration` (m/s²).
    pub fn limits(self, diagonal: f32, acceleration: f32) -> RestLimits {
        let patience = match self {
            Self::Layers => PATIENCE_OF_LAYERS,
            _ if acceleration > 0.0 => HALF_SWING * (diagonal / acceleration).sqrt(),
            _ => WITHOUT_GRAVITY,
        };
        let reach = match self {
            Self::Layers => REACH_OF_LAYERS,
            Self::Carries => (REACH_OF_CARRIERS * diagonal).min(LARGEST_REACH),
            Self::Free => (REACH * diagonal).min(LARGEST_REACH),
        };
        RestLimits {
            reach,
            patience: patience.clamp(PATIENCE[0], PATIENCE[1]),
        }
    }
}

/// Detects rest as an observer would see it. A cloth is at rest once no particle has moved by more than a thousandth of
/// the cloth's diagonal, capped at 5 mm, for half a swing. That is the half period of a hanging sheet as long as the
/// diagonal (1.3 s for 2.3 m on Earth), from 0.5 to 20 s. Speeds do not count: a cloth that trembles in place is at
/// rest. Cloth that lies on cloth, or carries a body, follows another [`RestRule`].
#[derive(Debug, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct Rest {
    /// Positions of the particles when they were last seen to move; the sleeping particles, if they sleep.
    origin: ClothParticles,
    /// Time until the next comparison after a motion (s): the particles of a moving cloth are not copied in each tick.
    wait: f32,
    /// For how long they have been near it (s).
    calm: f32,
    is_asleep: bool,
}

impl Rest {
    /// Whether this state, read from a file, is valid.
    pub(crate) fn is_valid(&self) -> bool {
        self.origin.is_valid()
    }

    /// Takes the particles at the end of a tick of this many seconds. The cloth measures `diagonal` (m) at rest, and
    /// is under an `acceleration` (m/s²).
    pub fn observe(
        &mut self,
        seconds: f32,
        particles: &ClothParticles,
        (diagonal, acceleration): (f32, f32),
        rule: RestRule,
    ) {
        let RestLimits { reach, patience } = rule.limits(diagonal, acceleration);
        if self.wait > 0.0 {
            self.wait -= seconds;
            if self.wait <= 0.0 {
                self.origin.copy_from(particles);
                self.calm = 0.0;
            }
            return;
        }
        let is_near = particles.stays_within(reach, &self.origin);
        if !is_near {
            self.wait = PAUSE;
            return;
        }
        self.calm += seconds;
        if self.calm >= patience {
            self.is_asleep = true;
            self.origin.copy_from(particles);
        }
    }

    /// Copies `other` into its own memory. Positions of particles that move are not needed until they are compared
    /// again.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        (self.wait, self.calm) = (other.wait, other.calm);
        self.is_asleep = other.is_asleep;
        if other.is_asleep || other.wait <= 0.0 {
            self.origin.copy_from(&other.origin);
        }
    }

    /// Whether the cloth has been at rest for long enough to sleep.
    pub fn is_asleep(&self) -> bool {
        self.is_asleep
    }

    /// For how long they have been near their places (s); endless if they sleep.
    pub(crate) fn calm(&self) -> f32 {
        if self.is_asleep {
            f32::INFINITY
        } else {
            self.calm
        }
    }

    /// Whether all particles were near their places when they were last compared.
    pub fn is_calm(&self) -> bool {
        self.is_asleep || self.calm > 0.0
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

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec3;

    const TICK: f32 = 1.0 / 64.0;
    const GRAVITY: f32 = 9.81;

    /// Two metres, the least that half a swing takes being 1.2 s: 75.5 ticks after the one that is compared with, which is the
    /// ninth.
    fn asleep_after(ticks: u32, at: impl Fn(u32) -> f32) -> bool {
        asleep_under(GRAVITY, ticks, at)
    }

    fn asleep_under(gravity: f32, ticks: u32, at: impl Fn(u32) -> f32) -> bool {
        let mut rest = Rest::default();
        for tick in 0..ticks {
            let place = [Vec3::ZERO, Vec3::new(1.0, at(tick), 0.0)];
            let particles = ClothParticles::new(&place, &[1.0; 2]).expect("two particles");
            rest.observe(TICK, &particles, (2.0, gravity), RestRule::Free);
        }
        rest.is_asleep()
    }

    #[test]
    fn sleeps_when_nothing_has_left_its_place_for_half_a_swing() {
        assert!(!asleep_after(83, |_| 0.0));
        assert!(asleep_after(85, |_| 0.0));
        let trembling = |tick: u32| {
            if tick.is_multiple_of(2) {
                0.0009
            } else {
                -0.0009
            }
        };
        assert!(asleep_after(85, trembling), "in its place, however fast");
        let creeping = |tick: u32| 0.002 * tick as f32 * TICK;
        assert!(!asleep_after(640, creeping), "a pixel in a second");
        let creeping = |tick: u32| 0.0015 * tick as f32 * TICK;
        assert!(asleep_after(640, creeping));
    }

    /// A swing that an eye sees, seen first at its turning point, of the period that is the longest for its size.
    #[test]
    fn does_not_sleep_at_a_turning_point() {
        for gravity in [GRAVITY, 1.62, 0.3] {
            let swing = |amplitude: f32| {
                let omega = 2.405 / 2.0 * (gravity / 2.0_f32).sqrt();
                move |tick: u32| amplitude * (omega * tick as f32 * TICK).cos()
            };
            let asleep_after = |at: &dyn Fn(u32) -> f32| asleep_under(gravity, 6400, at);
            assert!(!asleep_after(&swing(0.0031)), "{gravity} m/s²");
            assert!(asleep_after(&swing(0.0009)), "{gravity} m/s²");
        }
    }

    #[test]
    fn wakes_when_it_is_disturbed_and_knows_what_it_slept_as() {
        let mut rest = Rest::default();
        let particles = ClothParticles::new(&[Vec3::ZERO], &[1.0]).expect("a particle");
        for _ in 0..64 {
            rest.observe(TICK, &particles, (0.1, GRAVITY), RestRule::Free);
        }
        assert!(rest.is_asleep() && rest.sleeps_as(&particles.clone()));
        let mut moved = particles.clone();
        moved.set_velocity(0, Vec3::X).expect("it exists");
        assert!(!rest.sleeps_as(&moved));
        rest.disturb();
        assert!(!rest.is_asleep() && !rest.sleeps_as(&particles));
        let nan = ClothParticles::default();
        rest.observe(TICK, &nan, (0.1, GRAVITY), RestRule::Free);
        assert!(!rest.is_asleep());
    }
}
