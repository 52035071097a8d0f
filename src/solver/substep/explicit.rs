//! Ticks in which soft springs push by their forces: when, and how many sub-steps they take.

use super::Solver;
use crate::{
    cloth::ClothParticles,
    solver::{Substepping, TickStep, TimeOrder, substepping::MAX_SUBSTEPS},
};

/// So many sub-steps of forces take no longer than one in which threads are solved.
const CHEAPER: u32 = 2;

/// What a quotient may be off by.
const ROUNDING: f32 = 1.0 + 1.0e-6;

/// Damped more than that, particles hardly keep any displacement for what bends to be added to.
const MAX_DAMPING: f32 = 0.5;

impl Solver {
    /// The longest sub-step (s) in which the springs push by their forces, in a motion of second order; 0 where they never do: on a
    /// mesh, with tethers, with damping along springs, and where one of them is rigid.
    pub fn longest_explicit_substep(&self, particles: &ClothParticles) -> f32 {
        let blocks = particles.blocks();
        match &self.forces {
            Some(forces) if self.tethers.is_empty() && self.retardation == 0.0 => {
                let bent = self.bending.as_ref();
                let bent = bent.map_or(f32::INFINITY, |bending| bending.longest_push(blocks));
                forces.longest_substep(blocks).min(bent)
            }
            _ => 0.0,
        }
    }

    /// Whether a sub-step of `dt` (s) may be short enough for forces, which most cloths deny with their first rows.
    fn may_be_explicit(&self, particles: &ClothParticles, dt: f32) -> bool {
        let forces = self.forces.as_ref();
        forces.is_some_and(|forces| forces.is_short(particles.blocks(), dt))
    }

    /// Whether the springs of the coming tick push by their forces.
    pub(in crate::solver) fn is_explicit(
        &self,
        particles: &ClothParticles,
        step: &TickStep,
    ) -> bool {
        let dt = step.seconds / step.substeps.max(1) as f32;
        step.order == TimeOrder::Second
            // Forces know nothing of what particles carry.
            && !particles.has_loads()
            && step.damping <= MAX_DAMPING
            && self.may_be_explicit(particles, dt)
            && dt <= self.longest_explicit_substep(particles)
    }

    /// Sub-steps in a tick of `seconds` that hold the cloth, whose longer side has `along` particles, in a motion of this order:
    /// [`Substepping::needed`], or those from which its springs push by their forces, where these cost no more.
    pub fn needed(
        &self,
        particles: &ClothParticles,
        along: usize,
        seconds: f32,
        order: TimeOrder,
    ) -> u32 {
        let needed = Substepping::needed(along, seconds);
        let most = CHEAPER * needed;
        if order == TimeOrder::First || !self.may_be_explicit(particles, seconds / most as f32) {
            return needed;
        }
        let longest = self.longest_explicit_substep(particles);
        // Division may round to a step that is too long.
        let from = (seconds / longest * ROUNDING).ceil() as u32;
        if from <= most.min(MAX_SUBSTEPS) {
            // What touches it asks for as many as before.
            from.max(needed)
        } else {
            needed
        }
    }

    /// Without forces from now on: threads are solved, however soft they are.
    #[doc(hidden)]
    pub fn forget_forces(&mut self) {
        self.forces = None;
    }
}
