//! Pieces of a torn cloth, which fall asleep one by one.

use bevy::{
    ecs::entity::MapEntities,
    prelude::{Entity, Vec3},
};

use super::resting::RestsOn;
use crate::{
    cloth::{ClothParticles, Surface},
    contact::MovingCollider,
    solver::{PinMotion, RestLimits},
};

/// The colliders that a cloth rests on, and the rest of its pieces.
#[derive(MapEntities, Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Resting {
    /// The colliders that it touched as it fell asleep, each with its place then.
    #[entities]
    pub on: Vec<RestsOn>,
    #[entities]
    pub pieces: Pieces,
}

impl Resting {
    /// Copies `other` into its own memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.on.clone_from(&other.on);
        self.pieces.copy_from(&other.pieces);
    }

    /// The colliders that it or one of its pieces rests on.
    pub fn colliders_mut(&mut self) -> impl Iterator<Item = &mut RestsOn> {
        self.on.iter_mut().chain(self.pieces.colliders_mut())
    }
}

/// The pieces of a torn cloth. One that has come to rest sleeps while others move.
#[derive(MapEntities, Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Pieces {
    /// The piece of each particle. Empty while nothing is known of them, or there is only one.
    of_particle: Vec<u32>,
    #[entities]
    all: Vec<Piece>,
    /// Where each particle was in the tick after its piece was last seen to move (m).
    origin: Vec<Vec3>,
}

/// A connected piece of cloth.
#[derive(MapEntities, Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Piece {
    /// For how long its particles have been near their places (s); 0 if it moved in the last tick, or was woken.
    calm: f32,
    /// Whether it has left its place in this tick, or is moved by pins.
    #[cfg_attr(feature = "serialize", serde(skip))]
    moves: bool,
    /// The least and the greatest corner of its box (m): of an earlier tick, while no piece may sleep.
    #[cfg_attr(feature = "serialize", serde(skip))]
    corners: [Vec3; 2],
    is_asleep: bool,
    /// The colliders near it as it fell asleep.
    #[entities]
    rests_on: Vec<RestsOn>,
}

impl Pieces {
    /// Wakes all.
    pub fn wake(&mut self) {
        self.all.iter_mut().for_each(Piece::wake);
    }

    /// Forgets which there are: the surface is torn in another way.
    pub fn forget(&mut self) {
        self.of_particle.clear();
        self.all.clear();
    }

    /// Copies `other` into its own memory, but for the colliders that pieces rest on.
    pub fn copy_from(&mut self, other: &Self) {
        self.of_particle.clone_from(&other.of_particle);
        self.all.clone_from(&other.all);
        self.origin.clone_from(&other.origin);
    }

    /// Whether this state, read from a file, matches that number of particles.
    pub fn is_valid_for(&self, particles: usize) -> bool {
        let is_known = |piece: &u32| (*piece as usize) < self.all.len();
        self.of_particle.is_empty()
            || self.of_particle.len() == particles
                && self.origin.len() == particles
                && self.of_particle.iter().all(is_known)
    }

    /// The colliders that its pieces sleep on.
    pub fn colliders_mut(&mut self) -> impl Iterator<Item = &mut RestsOn> {
        self.all.iter_mut().flat_map(|piece| &mut piece.rests_on)
    }

    /// Whether a particle's piece sleeps.
    pub fn sleeps(&self, particle: u32) -> bool {
        let piece = self.of_particle.get(particle as usize);
        piece.is_some_and(|piece| self.all[*piece as usize].is_asleep)
    }

    /// The particles whose piece sleeps.
    pub fn asleep(&self) -> impl Iterator<Item = u32> {
        let any = self.all.iter().any(|piece| piece.is_asleep);
        let count = if any { self.of_particle.len() } else { 0 };
        (0..count as u32).filter(|particle| self.sleeps(*particle))
    }

    /// Takes the particles as a tick of this many seconds begins, and the pins that move in it. Pieces that leave their places wake.
    pub fn observe(
        &mut self,
        surface: &Surface,
        particles: &ClothParticles,
        pins: &[PinMotion],
        limits: RestLimits,
        seconds: f32,
    ) {
        if self.of_particle.len() != particles.len() {
            self.of_particle.clear();
            self.of_particle.extend(surface.pieces_of());
            let last = self.of_particle.iter().max();
            self.all.clear();
            (self.all).resize(last.map_or(0, |last| *last as usize + 1), Piece::default());
            self.origin.clear();
            self.origin.extend(particles.positions());
        }
        self.all.iter_mut().for_each(|piece| piece.moves = false);
        for pin in pins {
            if let Some(piece) = self.of_particle.get(pin.particle as usize) {
                self.all[*piece as usize].moves = true;
            }
        }
        let places = self.of_particle.iter().zip(particles.positions());
        for ((piece, place), origin) in places.zip(&mut self.origin) {
            let piece = &mut self.all[*piece as usize];
            // One that sleeps is held, however near it has to be from now on.
            if piece.is_asleep {
                continue;
            }
            let is_near = place.distance_squared(*origin) <= limits.reach.powi(2);
            // NaN is not near.
            piece.moves |= !is_near;
            if piece.calm == 0.0 {
                *origin = place;
            }
        }
        for piece in &mut self.all {
            piece.calm += seconds;
            if piece.moves {
                piece.wake();
            }
        }
        let may_sleep = |piece: &Piece| piece.may_sleep(limits.patience);
        if self.all.iter().any(may_sleep) {
            self.measure(particles);
        }
    }

    /// Measures the box of each.
    fn measure(&mut self, particles: &ClothParticles) {
        for piece in &mut self.all {
            piece.corners = [Vec3::MAX, Vec3::MIN];
        }
        for (piece, place) in self.of_particle.iter().zip(particles.positions()) {
            let corners = &mut self.all[*piece as usize].corners;
            *corners = [corners[0].min(place), corners[1].max(place)];
        }
    }

    /// Lets those sleep that have been calm for so long (s) and [settle](Piece::settle). If pieces touch each other, `touching` is the
    /// distance at which they may do so in this tick (m): none sleeps beside one that moves.
    pub fn fall_asleep(
        &mut self,
        patience: f32,
        touching: Option<f32>,
        mut settles: impl FnMut(&mut Piece) -> bool,
    ) {
        for at in 0..self.all.len() {
            if !self.all[at].may_sleep(patience) {
                continue;
            }
            let corners = self.all[at].corners;
            let is_disturbed = touching.is_some_and(|distance| {
                let meets = |[low, high]: [Vec3; 2]| {
                    let gap = (low - corners[1]).max(corners[0] - high);
                    gap.max_element() <= distance
                };
                let mut others = self.all.iter();
                others.any(|other| !other.may_sleep(patience) && meets(other.corners))
            });
            let piece = &mut self.all[at];
            if is_disturbed {
                // One that was awake still waits for the others.
                if piece.is_asleep {
                    piece.wake();
                }
            } else if settles(piece) {
                piece.is_asleep = true;
            } else {
                piece.wake();
            }
        }
    }
}

impl Piece {
    fn wake(&mut self) {
        (self.calm, self.is_asleep) = (0.0, false);
        self.rests_on.clear();
    }

    /// Whether it sleeps, or was calm for so long (s) that it may.
    fn may_sleep(&self, patience: f32) -> bool {
        self.is_asleep || self.calm >= patience
    }

    /// A ball around it: middle and radius (m).
    fn ball(&self) -> (Vec3, f32) {
        let [low, high] = self.corners;
        ((low + high) / 2.0, low.distance(high) / 2.0)
    }

    /// Returns whether nothing within `reach` of its ball (m) moves, and if it sleeps, whether the same colliders are there as when it fell
    /// asleep. If it is awake, these are remembered.
    pub fn settle(&mut self, near: &[(Entity, MovingCollider)], reach: f32) -> bool {
        let (middle, radius) = self.ball();
        let mut count = 0;
        for (entity, collider) in near {
            let travel = collider.max_surface_travel(f32::INFINITY);
            let distance = collider.nearest(0.0, middle).distance;
            if distance > radius + reach + travel {
                continue;
            }
            if travel > 0.0 || collider.body.is_some() {
                return false;
            }
            count += 1;
            if !self.is_asleep {
                self.rests_on.push(RestsOn::new(*entity, collider));
                continue;
            }
            let mut known = self.rests_on.iter_mut();
            let known = known.find(|known| known.entity == *entity);
            if !known.is_some_and(|known| known.still_rests(collider, 0.0)) {
                return false;
            }
        }
        count == self.rests_on.len()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::cloth::{Cloth, ClothMaterial};

    const LIMITS: RestLimits = RestLimits {
        reach: 1.0e-3,
        patience: 0.5,
    };
    const TICK: f32 = 0.1;

    /// Three columns and rows, cut along the row in the middle.
    fn cut() -> (Arc<Surface>, ClothParticles) {
        let whole = Arc::new(Cloth::new(3, 3, 0.1).surface(Vec3::ONE).expect("a grid"));
        let torn = whole.torn(&[[3, 4], [4, 5]]).expect("edges of the grid");
        assert_eq!(torn.pieces(), 2);
        let particles = ClothParticles::at_rest(&torn, &ClothMaterial::COTTON);
        (Arc::new(torn), particles.expect("a material"))
    }

    /// Which pieces sleep after that many ticks, whose particles `moves` moves in each.
    fn asleep_after(
        ticks: u32,
        pins: &[PinMotion],
        touching: Option<f32>,
        moves: impl Fn(&mut ClothParticles, u32),
    ) -> [bool; 2] {
        let (surface, mut particles) = cut();
        let mut pieces = Pieces::default();
        for tick in 0..ticks {
            moves(&mut particles, tick);
            pieces.observe(&surface, &particles, pins, LIMITS, TICK);
            pieces.fall_asleep(LIMITS.patience, touching, |_| true);
        }
        let of = surface.pieces_of();
        let last = (of.len() - 1) as u32;
        assert_ne!(of[0], of[last as usize]);
        [0, last].map(|particle| pieces.sleeps(particle))
    }

    fn shift(particles: &mut ClothParticles, index: usize, by: Vec3) {
        let place = particles.position_at(index) + by;
        particles.set_position(index, place).expect("it exists");
    }

    #[test]
    fn a_piece_sleeps_once_it_was_calm_for_long_enough() {
        let still = |_: &mut ClothParticles, _| {};
        assert_eq!(asleep_after(4, &[], None, still), [false; 2]);
        assert_eq!(asleep_after(7, &[], None, still), [true; 2]);
        let creeps = |particles: &mut ClothParticles, _| shift(particles, 0, 3.0e-4 * Vec3::X);
        assert_eq!(asleep_after(50, &[], None, creeps), [false, true]);
        let trembles = |particles: &mut ClothParticles, tick: u32| {
            let sign = if tick.is_multiple_of(2) { 1.0 } else { -1.0 };
            shift(particles, 0, sign * 9.0e-4 * Vec3::X);
        };
        assert_eq!(asleep_after(50, &[], None, trembles), [true; 2]);
        let is_lost = |particles: &mut ClothParticles, _| shift(particles, 0, Vec3::NAN);
        assert_eq!(asleep_after(50, &[], None, is_lost), [false, true]);
    }

    /// Layers that settle rest sooner, and farther from where they were, than cloth that hangs. Once they sleep they touch nothing, so other
    /// limits hold.
    #[test]
    fn other_limits_wake_nothing() {
        let (surface, mut particles) = cut();
        let mut pieces = Pieces::default();
        for tick in 0..30 {
            if tick < 6 {
                shift(&mut particles, 0, 1.5e-4 * Vec3::X);
            }
            let limits = match tick < 8 {
                true => LIMITS,
                false => RestLimits {
                    reach: 1.0e-4,
                    patience: 2.0,
                },
            };
            pieces.observe(&surface, &particles, &[], limits, TICK);
            pieces.fall_asleep(limits.patience, Some(1.0), |_| true);
            let is_asleep = pieces.sleeps(0);
            assert!(is_asleep == (tick >= 6) || (4..6).contains(&tick), "{tick}");
        }
        pieces.fall_asleep(2.0, Some(1.0), |_| false);
        assert!(!pieces.sleeps(0));
    }

    /// A piece that was calm and jumps begins anew: it sleeps half a second after the tick after its jump.
    #[test]
    fn a_jump_begins_anew() {
        let jumps = |particles: &mut ClothParticles, tick: u32| {
            if tick == 3 {
                shift(particles, 0, 0.1 * Vec3::X);
            }
        };
        // It moves in ticks 0, as it is seen for the first time, and 3 and 4.
        assert_eq!(asleep_after(5 + 4, &[], None, jumps), [false, true]);
        assert_eq!(asleep_after(5 + 5, &[], None, jumps), [true; 2]);
    }

    /// A pin that moves keeps its piece awake, and with layers each piece beside one that moves.
    #[test]
    fn pins_and_pieces_beside_it_keep_a_piece_awake() {
        let pin = PinMotion {
            particle: 1,
            from: Vec3::ZERO,
            to: Vec3::ZERO,
        };
        let still = |_: &mut ClothParticles, _| {};
        assert_eq!(asleep_after(50, &[pin], None, still), [false, true]);
        // They are less than a tenth of a metre apart.
        assert_eq!(asleep_after(50, &[pin], Some(0.1), still), [false; 2]);
        let fallen = |particles: &mut ClothParticles, tick| {
            let low = (0..particles.len()).filter(|index| *index > 5);
            if tick == 0 {
                low.for_each(|index| shift(particles, index, -Vec3::Y));
            }
        };
        assert_eq!(asleep_after(50, &[], Some(0.1), still), [true; 2]);
        assert_eq!(asleep_after(50, &[pin], Some(0.1), fallen), [false, true]);
    }
}
