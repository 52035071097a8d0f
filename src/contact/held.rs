//! What friction may still hold back, particle by particle.
//!
//! What pushes one triangle out may lift its neighbours as well, so that in one sub-step not all that lie on a collider are
//! pushed; and one whose friction acts at the triangle alone slips a little in each sub-step in which it is not. So each particle
//! has a budget: what its triangles' contacts pushed it by along their normals, times μ, which slipping spends. What is not
//! spent is kept for a while: Coulomb's law holds in the mean over some milliseconds, for each particle.

use crate::cloth::{LANES, Lanes};

/// What eight particles may spend on slipping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Held {
    /// What contacts have pushed them by in this sub-step, along their normals (m).
    pub push: [Lanes; 3],
    /// Of the last contact.
    pub normal: [Lanes; 3],
    /// How far they may be held back (m).
    pub budget: Lanes,
    /// Whether any of them has a push or a budget.
    pub is_active: bool,
}

impl Held {
    pub const NONE: Self = Self {
        push: [[0.0; LANES]; 3],
        normal: [[0.0; LANES]; 3],
        budget: [0.0; LANES],
        is_active: false,
    };

    /// Adds what contacts push by.
    #[inline(always)]
    pub fn add(&mut self, push: &[Lanes; 3]) {
        for (to, push) in self.push.iter_mut().zip(push) {
            for l in 0..LANES {
                to[l] += push[l];
            }
        }
        self.is_active = true;
    }

    /// Adds what contacts push those by that are a lane to the right.
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

    /// Adds what a contact pushes one by.
    pub fn add_one(&mut self, lane: usize, push: [f32; 3]) {
        for (to, push) in self.push.iter_mut().zip(push) {
            to[lane] += push;
        }
        self.is_active = true;
    }
}
