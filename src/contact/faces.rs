//! The narrow phase by triangles, for what is so small that it would slip between particles.

mod one;

use bevy::math::Vec3;

pub(super) use super::corners::SubstepMotion;
use super::{
    ColliderShape,
    candidates::{Candidate, ContactBlock, Fans},
    cells::{Place, Stop, push_cells, slots_of},
    eight::Cells,
    friction::{Axle, hold_all},
    held::Held,
    lanes::{LaneMotion, Sums},
    particle::Found,
};
use crate::cloth::{ClothParticles, Slot};

/// How often all triangles are gone through at most, while any is hit on a fast way: one that was passed by may have been
/// moved into the way by another's corners.
const MAX_PASSES: u32 = 4;

/// What to go on with.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct ResumePoint {
    pass: u32,
    /// A particle, and which of the triangles that it stands for.
    at: (u32, usize),
    /// In blocks of cells.
    place: Place,
    /// Whether one was hit on a fast way in this pass.
    is_swept: bool,
}

/// What a collider's triangles are pushed in.
pub(super) struct Pushed<'a> {
    pub candidates: &'a [Candidate],
    /// Those of the collider, of which the first is the `first` of all.
    pub contacts: &'a mut [ContactBlock],
    pub first: usize,
    pub helds: &'a mut [Held],
    pub fans: &'a Fans,
    /// Once particles may have been pushed farther than this, candidates may be missing (m).
    pub room: f32,
    /// How far anything has moved in the sub-step (m).
    pub moved: f32,
    /// What the sub-step comes to.
    pub found: Found,
    /// The farthest that one triangle has pushed in this pass (m).
    passed: f32,
}

impl<'a> Pushed<'a> {
    pub fn new(
        candidates: &'a [Candidate],
        (contacts, first): (&'a mut [ContactBlock], usize),
        helds: &'a mut [Held],
        fans: &'a Fans,
        [room, moved]: [f32; 2],
    ) -> Self {
        Self {
            candidates,
            contacts,
            first,
            helds,
            fans,
            room,
            moved,
            found: Found::default(),
            passed: 0.0,
        }
    }

    /// Pushes the triangles out of a collider that it touches or passed through in this sub-step, each by moving its
    /// corners as much as they have a part in the nearest point, and mass allows; then friction holds back their particles.
    ///
    /// Goes on `from` a triangle. Once a particle may have been pushed farther than there is room, candidates may be
    /// missing: it stops then, and says with which triangle to go on.
    pub fn push(
        &mut self,
        particles: &mut ClothParticles,
        (motion, lanes): (&SubstepMotion, &LaneMotion),
        from: ResumePoint,
    ) -> Option<ResumePoint> {
        let mut resume = from;
        let ball = match motion.collider.shape {
            ColliderShape::Ball { .. } if particles.layout().rows > 1 => Some(motion.at_end[0]),
            _ => None,
        };
        while resume.pass < MAX_PASSES {
            let stops = match ball {
                Some(centre) => self.push_cells(particles, (motion, lanes), centre, &mut resume),
                None => self.push_each(particles, (motion, lanes), &mut resume),
            };
            self.found.farthest_push += self.passed * self.fans.max_faces;
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
        self.hold(particles, (motion, lanes));
        None
    }

    /// One after the other. Returns whether it has to stop.
    fn push_each(
        &mut self,
        particles: &mut ClothParticles,
        (motion, lanes): (&SubstepMotion, &LaneMotion),
        resume: &mut ResumePoint,
    ) -> bool {
        let push_out = lanes.push_out;
        for contact in self.contacts.iter_mut() {
            // NaN is looked at.
            contact.is_left = !(lanes.odometer < contact.clear_until);
            if contact.is_left {
                contact.clear_until = f32::INFINITY;
            }
        }
        for candidate in self.candidates {
            let (contact, lane) = candidate.lane();
            let contact = contact - self.first;
            let faces = self.fans.faces(candidate.faces);
            if faces.is_empty() {
                continue;
            }
            let now = lanes.odometer + self.pushed();
            if !self.contacts[contact].is_left && now < self.contacts[contact].clear_until {
                continue;
            }
            let slot = Slot {
                block: self.contacts[contact].block as usize,
                lane,
            };
            let corners = self.fans.corners(candidate.corners);
            let [clear, speed] = motion.clearance(particles.blocks(), slot, corners);
            let until = if clear > 0.0 {
                lanes.odometer * (1.0 - 1.0e-5) + clear
            } else {
                f32::NEG_INFINITY
            };
            let contact_block = &mut self.contacts[contact];
            contact_block.clear_until = contact_block.clear_until.min(until);
            if clear > speed {
                continue;
            }
            for (which, &slots) in faces.iter().enumerate() {
                if (candidate.particle, which) < resume.at {
                    continue;
                }
                self.push_one(particles, motion, (contact, lane), slots, &push_out, resume);
                if self.is_full() {
                    resume.at = (candidate.particle, which + 1);
                    return true;
                }
            }
        }
        false
    }

    /// How far a particle may have been pushed so far (m).
    fn pushed(&self) -> f32 {
        self.found.farthest_push + self.passed * self.fans.max_faces
    }

    /// Whether that is farther than there is room.
    fn is_full(&self) -> bool {
        self.pushed() > self.room
    }

    /// Has all be looked at again.
    fn look_again(&mut self) {
        for contact in self.contacts.iter_mut() {
            contact.clear_until = f32::NEG_INFINITY;
        }
    }

    /// By blocks of cells, out of a ball. Returns whether it has to stop.
    fn push_cells(
        &mut self,
        particles: &mut ClothParticles,
        (motion, lanes): (&SubstepMotion, &LaneMotion),
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
                fastest: self.moved + motion.slide.length() + motion.swing,
                pushed: self.found.farthest_push,
                room: self.room,
                max_faces: self.fans.max_faces,
                is_measured: resume.pass == 0,
            };
            let blocks = particles.blocks_mut();
            let of = (lanes, &cells);
            let (stop, next) = push_cells(
                blocks,
                self.contacts,
                self.helds,
                of,
                resume.place,
                &mut sums,
            );
            resume.place = next;
            self.passed = self.passed.max(sums.passed);
            match stop {
                Stop::Left {
                    contact,
                    which,
                    lanes: left,
                } => {
                    for (lane, _) in left.iter().enumerate().filter(|(_, is_left)| **is_left) {
                        let slots = slots_of(layout, &self.contacts[contact], which, lane);
                        let at = (contact, lane);
                        self.push_one(particles, motion, at, slots, &lanes.push_out, resume);
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

    /// Has friction hold back what was pushed.
    fn hold(
        &mut self,
        particles: &mut ClothParticles,
        (motion, lanes): (&SubstepMotion, &LaneMotion),
    ) {
        let [start, end] = motion.at_end;
        let along = end - start;
        let axle = Axle {
            axis: along.normalize_or_zero().to_array(),
            half_length: along.length() / 2.0,
            radius: motion.reach - motion.settings.particle_radius,
        };
        let seconds = particles.substep();
        let mut sums = Sums::default();
        let blocks = particles.blocks_mut();
        hold_all(
            blocks,
            self.contacts,
            self.helds,
            &axle,
            lanes,
            seconds,
            &mut sums,
        );
        let farthest = self.found.farthest_push;
        self.found.add(&sums);
        // Friction comes after all pushes.
        let held = sums.farthest_push.iter().copied().fold(0.0, f32::max);
        self.found.farthest_push = farthest + held.sqrt();
    }
}
