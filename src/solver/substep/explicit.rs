//! Ticks in which soft springs act by explicit forces: their conditions, and their sub-steps.

use super::Solver;
use crate::{
    cloth::ClothParticles,
    solver::{
        step::{TickStep, TimeOrder},
        substepping::{MAX_SUBSTEPS, Substepping},
    },
};

/// Number of sub-steps of forces that cost as much as one in which chains are solved.
const CHEAPER: u32 = 2;

/// Possible rounding of a quotient.
const ROUNDING: f32 = 1.0 + 1.0e-6;

/// With more damping, particles hardly keep any displacement to which bending could add.
const MAX_DAMPING: f32 = 0.5;

impl Solver {
    /// The longest sub-step (s) in which the springs act by explicit forces, in a motion of second order. 0 if they
    /// never do: on a mesh that was no grid, with tethers, with damping along springs, or if a spring is rigid.
    pub fn longest_explicit_substep(&self, particles: &ClothParticles) -> f32 {
        let blocks = particles.blocks();
        match &self.soft_springs {
            Some(soft_springs) if self.tethers.is_empty() && self.retardation == 0.0 => {
                let bent = self.bending.as_ref();
                let bent = bent.map_or(f32::INFINITY, |bending| bending.longest_push(blocks));
                soft_springs.longest_substep(blocks).min(bent)
            }
            _ => 0.0,
        }
    }

    /// Whether a sub-step of `dt` (s) may be short enough for forces; for most cloths the first rows show that it is
    /// not.
    fn may_be_explicit(&self, particles: &ClothParticles, dt: f32) -> bool {
        let soft_springs = self.soft_springs.as_ref();
        soft_springs.is_some_and(|springs| springs.is_short(particles.blocks(), dt))
    }

    /// Whether the springs of the coming tick act by explicit forces.
    pub(crate) fn is_explicit(&self, particles: &ClothParticles, step: &TickStep) -> bool {
        let dt = step.seconds / step.substeps.max(1) as f32;
        step.order == TimeOrder::Second
            // Forces do not include the bodies that particles carry.
            && !particles.has_loads()
            && step.damping <= MAX_DAMPING
            && self.may_be_explicit(particles, dt)
            && dt <= self.longest_explicit_substep(particles)
    }

    /// Number of sub-steps in a tick of `seconds` that holds a cloth with `along` particles on its longer side, in a
    /// motion of this order. It is [`Substepping::needed`], or the number from which its springs act by explicit
    /// forces, if that costs no more.
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
            // Contact needs as many as before.
            from.max(needed)
        } else {
            needed
        }
    }

    /// Turns explicit forces off: chains are solved, however soft they are.
    #[doc(hidden)]
    pub fn forget_soft_springs(&mut self) {
        self.soft_springs = None;
    }
}
