//! How far particles have moved since the candidates were searched for, and how far they may.

use crate::cloth::ClothParticles;

/// Number of measurements of the particles' displacements in a sub-step, before a new search.
const MAX_MEASURED: u32 = 2;

/// The margin of a search, and how much of it is used. Whatever moves particles reports it here: else contacts are missed.
/// Others only read its fields.
#[derive(Debug, Default, Clone)]
pub(super) struct Margin {
    /// Displacement of a particle after which the candidates are searched for again (m).
    pub size: f32,
    /// Largest displacement of a particle since the search (m): the sum of the largest moves and pushes, or measured.
    moved: f32,
    /// The part of that in this sub-step: a sweep reaches this far back (m).
    pub moved_now: f32,
    /// Sum of all displacements in the tick so far (m): nothing farther away can have arrived.
    pub odometer: f32,
    /// Largest deviation of a body from the motion that was searched for (m).
    deviation: f32,
    /// The particles at the time of the search, if there was one.
    pub origin: ClothParticles,
    pub has_origin: bool,
    /// Number of measurements in this sub-step.
    measured: u32,
}

impl Margin {
    /// Begins a tick with a margin of this `size` (m).
    pub fn begin(&mut self, size: f32) {
        self.size = size;
        self.deviation = 0.0;
        (self.moved, self.moved_now, self.odometer) = (0.0, 0.0, 0.0);
        self.has_origin = false;
    }

    /// Begins the same tick again. Where it was `searched` again, the candidates are those of later positions.
    pub fn restart(&mut self, searched: bool) {
        self.odometer = 0.0;
        self.moved = if searched { f32::INFINITY } else { 0.0 };
    }

    /// Begins the response to a sub-step in which no particle moved farther than this (m).
    pub fn begin_substep(&mut self, farthest_move: f32) {
        self.note(farthest_move);
        self.moved_now = farthest_move;
        self.measured = 0;
    }

    /// Takes a push of at most this distance (m) into account.
    pub fn note(&mut self, farthest: f32) {
        self.moved += farthest;
        self.moved_now += farthest;
        self.odometer += farthest;
    }

    /// Takes into account that a body is this far from where it was expected (m).
    pub fn deviate(&mut self, by: f32) {
        self.deviation = self.deviation.max(by);
    }

    /// The part of the margin that is not used (m).
    pub fn left(&self) -> f32 {
        self.size - self.moved - self.deviation
    }

    /// From here on displacements are measured.
    pub fn remember(&mut self, particles: &ClothParticles) {
        self.origin.copy_places_from(particles);
        self.has_origin = true;
    }

    /// Whether particles have moved so far that candidates may be missing. The sum of all moves is checked first; it
    /// includes all jitter, so the displacement is then measured.
    pub fn is_outrun(&mut self, particles: &ClothParticles) -> bool {
        if !self.is_beyond() {
            return false;
        }
        // A new search widens the margin: that is cheaper than a measurement for every push.
        if self.has_origin && self.measured < MAX_MEASURED {
            self.measured += 1;
            self.moved = particles.farthest_from(&self.origin);
        }
        self.is_beyond()
    }

    /// Also true for NaN.
    fn is_beyond(&self) -> bool {
        let moved = self.moved + self.deviation;
        moved > self.size || moved.is_nan()
    }

    /// Nothing can be missed in the rest of the tick.
    pub fn open(&mut self) {
        self.size = f32::INFINITY;
    }

    /// Begins a new search with twice the margin that was too small: so a tick has few searches, however violent it is.
    pub fn widen(&mut self, particles: &ClothParticles) {
        let finite = |length: f32| if length.is_finite() { length } else { 0.0 };
        let moved_now = finite(self.moved_now);
        self.size = 2.0 * finite(self.moved).max(moved_now).max(self.size);
        // The motion of this sub-step has already happened.
        self.moved = moved_now;
        self.remember(particles);
        self.deviation = 0.0;
    }
}
