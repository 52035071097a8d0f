//! Friction budgets of particles.
//!
//! A push on one triangle may lift its neighbours, so that not all triangles on a collider are pushed in each sub-step.
//! If friction acted on each triangle alone, it would slip a little in the sub-steps without a push. So each particle
//! has a budget: its triangles' pushes along their normals, times μ. Slipping spends it, and the rest decays slowly:
//! Coulomb's law holds for each particle on average over some milliseconds.

use crate::cloth::{LANES, Lanes};

/// The friction budgets of eight particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FrictionBudget {
    /// Pushes of contacts in this sub-step, along their normals (m).
    pub push: [Lanes; 3],
    /// Normal of the last contact.
    pub normal: [Lanes; 3],
    /// Largest displacement by friction (m).
    pub budget: Lanes,
    /// Whether any of them has a push or a budget.
    pub is_active: bool,
}

impl FrictionBudget {
    pub const NONE: Self = Self {
        push: [[0.0; LANES]; 3],
        normal: [[0.0; LANES]; 3],
        budget: [0.0; LANES],
        is_active: false,
    };

    /// Adds the pushes of contacts.
    #[inline(always)]
    pub fn add(&mut self, push: &[Lanes; 3]) {
        for (to, push) in self.push.iter_mut().zip(push) {
            for l in 0..LANES {
                to[l] += push[l];
            }
        }
        self.is_active = true;
    }

    /// Adds the pushes of contacts to the particles a lane to the right.
    #[inline(always)]
    pub fn add_shifted(&mut self, push: &[Lanes; 3]) {
        for (to, [a, b, c, d, e, f, g, _]) in self.push.iter_mut().zip(push) {
            let moved = [0.0, *a, *b, *c, *d, *e, *f, *g];
            for l in 0..LANES {
                to[l] += moved[l];
            }
        }
        self.is_active = true;
    }

    /// Adds the push of a contact to one particle.
    pub fn add_one(&mut self, lane: usize, push: [f32; 3]) {
        for (to, push) in self.push.iter_mut().zip(push) {
            to[lane] += push;
        }
        self.is_active = true;
    }
}
