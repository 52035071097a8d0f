//! The narrow phase by triangles, for colliders so small that they would slip between particles.

mod push_triangle;

use bevy::math::Vec3;

use super::{
    corners::CoreMotion,
    friction::{CapsuleCore, hold_all},
    grid::{Place, Stop, push_cells, slots_of},
    lanes::Cells,
};
use crate::{
    cloth::{ClothParticles, Fans, LANES, Slot},
    contact::{
        candidates::{Candidate, ContactBlock},
        colliders::ColliderShape,
        friction::FrictionBudget,
        particles::{ContactResult, Sums},
    },
};

/// Largest number of passes over all triangles while fast ones are hit: a corner's push may move a passed triangle into
/// the way.
const MAX_PASSES: u32 = 4;

/// Where to continue.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct ResumePoint {
    pass: u32,
    /// A particle, and the index among its triangles.
    at: (u32, usize),
    /// Position in blocks of cells.
    place: Place,
    /// Whether a fast triangle was hit in this pass.
    is_swept: bool,
}

/// Context for pushing a collider's triangles.
pub(crate) struct TrianglePush<'a> {
    pub candidates: &'a [Candidate],
    /// Blocks of the collider; `first` is the index of the first among all.
    pub contacts: &'a mut [ContactBlock],
    pub first: usize,
    pub budgets: &'a mut [FrictionBudget],
    pub fans: &'a Fans,
    /// Number of triangles that may push each particle.
    pub max_faces: f32,
    /// Largest push before candidates may be missing (m).
    pub clearance: f32,
    /// Largest displacement in the sub-step (m).
    pub moved: f32,
    /// Whether areas are wanted.
    pub is_measured: bool,
    /// Result of the sub-step so far.
    pub found: ContactResult,
    /// Largest push by one triangle in this pass so far (m).
    pub passed: f32,
}

impl TrianglePush<'_> {
    /// Pushes triangles out of a collider that they touch or passed through in this sub-step. Each push moves the
    /// corners by their weights in the nearest point and their inverse masses. Friction then acts on their particles.
    ///
    /// Continues `from` a triangle. Once the pushes exceed the clearance, candidates may be missing: it stops, and returns
    /// the triangle to continue with.
    pub fn push(
        &mut self,
        particles: &mut ClothParticles,
        motion: &CoreMotion,
        from: ResumePoint,
    ) -> Option<ResumePoint> {
        let mut resume = from;
        let ball = match motion.of.collider.shape {
            ColliderShape::Ball { .. } if particles.layout().has_cells => Some(motion.at_end[0]),
            _ => None,
        };
        while resume.pass < MAX_PASSES {
            let stops = match ball {
                Some(centre) => self.push_cells(particles, motion, centre, &mut resume),
                None => self.push_each(particles, motion, &mut resume),
            };
            self.found.farthest_push += self.passed * self.max_faces;
            self.passed = 0.0;
            if stops {
                self.look_again();
                return Some(resume);
            }
            if !resume.is_swept {
                break;
            }
            self.look_again();
            resume = ResumePoint {
                pass: resume.pass + 1,
                ..ResumePoint::default()
            };
        }
        self.hold(particles, motion);
        None
    }

    /// Pushes one by one. Returns whether it has to stop.
    fn push_each(
        &mut self,
        particles: &mut ClothParticles,
        motion: &CoreMotion,
        resume: &mut ResumePoint,
    ) -> bool {
        let odometer = motion.lanes.odometer;
        for contact in self.contacts.iter_mut() {
            // False for NaN.
            let is_clear = odometer < contact.faces_clear_until;
            contact.are_faces_due = !is_clear;
            if !is_clear {
                contact.faces_clear_until = f32::INFINITY;
            }
        }
        for candidate in self.candidates {
            let (contact, lane) = candidate.lane();
            let contact = contact - self.first;
            let fan = candidate.fan(self.fans);
            if fan.faces.is_empty() {
                continue;
            }
            let now = odometer + self.pushed();
            let of = &mut self.contacts[contact];
            if !of.are_faces_due && now < of.faces_clear_until {
                continue;
            }
            let slot = Slot {
                block: of.block as usize,
                lane,
            };
            let [clear, speed] = motion.clearance(particles.blocks(), slot, fan.corners);
            let until = odometer * (1.0 - 1.0e-5) + clear;
            let until = if clear > 0.0 {
                until
            } else {
                f32::NEG_INFINITY
            };
            of.faces_clear_until = of.faces_clear_until.min(until);
            if clear > speed {
                continue;
            }
            for (which, &face) in fan.faces.iter().enumerate() {
                if (candidate.particle, which) < resume.at {
                    continue;
                }
                let slots = fan.slots(face);
                self.push_one(particles, motion, (contact, lane), slots, resume);
                if self.is_full() {
                    resume.at = (candidate.particle, which + 1);
                    return true;
                }
            }
        }
        false
    }

    /// Largest push of a particle so far (m).
    fn pushed(&self) -> f32 {
        self.found.farthest_push + self.passed * self.max_faces
    }

    /// Whether that exceeds the clearance.
    fn is_full(&self) -> bool {
        self.pushed() > self.clearance
    }

    /// Marks everything for another test.
    fn look_again(&mut self) {
        for contact in self.contacts.iter_mut() {
            contact.faces_clear_until = f32::NEG_INFINITY;
        }
    }

    /// Pushes by blocks of cells, out of a ball. Returns whether it has to stop.
    fn push_cells(
        &mut self,
        particles: &mut ClothParticles,
        motion: &CoreMotion,
        centre: Vec3,
        resume: &mut ResumePoint,
    ) -> bool {
        let layout = particles.layout();
        let mut sums = Sums::default();
        loop {
            sums.passed = self.passed;
            let cells = Cells {
                layout,
                centre: centre.to_array(),
                reach: motion.reach,
                fastest: self.moved + motion.of.slide.length() + motion.of.swing,
                pushed: self.found.farthest_push,
                clearance: self.clearance,
                max_faces: self.max_faces,
                is_measured: self.is_measured && resume.pass == 0,
            };
            let (blocks, from) = (particles.blocks_mut(), resume.place);
            let (contacts, budgets) = (&mut *self.contacts, &mut *self.budgets);
            let of = (&motion.lanes, &cells);
            let (stop, next) = push_cells(blocks, contacts, budgets, of, from, &mut sums);
            resume.place = next;
            self.passed = self.passed.max(sums.passed);
            match stop {
                Stop::Left {
                    contact,
                    which,
                    lanes,
                } => {
                    for lane in (0..LANES).filter(|&lane| lanes[lane]) {
                        let slots = slots_of(layout, &self.contacts[contact], which, lane);
                        self.push_one(particles, motion, (contact, lane), slots, resume);
                    }
                }
                Stop::Room => {}
                Stop::Done => break,
            }
            if self.is_full() {
                break;
            }
        }
        let stops = self.is_full() && resume.place != Place::END;
        self.found.add(&sums);
        stops
    }

    /// Applies friction to the pushed particles.
    fn hold(&mut self, particles: &mut ClothParticles, motion: &CoreMotion) {
        let [start, end] = motion.at_end;
        let along = end - start;
        let core = CapsuleCore {
            axis: along.normalize_or_zero().to_array(),
            half_length: along.length() / 2.0,
            radius: motion.reach - motion.lanes.particle_radius,
        };
        let seconds = particles.substep();
        let mut sums = Sums::default();
        let blocks = particles.blocks_mut();
        let (contacts, budgets, lanes) = (&*self.contacts, &mut *self.budgets, &motion.lanes);
        hold_all(blocks, contacts, budgets, &core, lanes, seconds, &mut sums);
        let farthest = self.found.farthest_push;
        self.found.add(&sums);
        // Friction comes after all pushes.
        let held = sums.farthest_push.iter().copied().fold(0.0, f32::max);
        self.found.farthest_push = farthest + held.sqrt();
    }
}
