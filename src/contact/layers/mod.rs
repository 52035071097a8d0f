//! Contact of cloth with cloth: with itself, and with others.
//!
//! Pairs of features, vertex with face and edge with edge, are kept a thickness apart: the mean of both. Boxes and slack take the
//! largest of a cloth.
//!
//! ```text
//!   cloth → patches of a few faces (sheet)
//!   neighbouring patches in sharp folds (windows, flattened, folds)                 → near pairs of patches
//!   boxes with clearance around other patches, searched from the top down (near_patches)   → near pairs of patches
//!   features of near pairs, culled by boxes, compared eight at a time (compare, lanes) → slack, listed features
//!   the pair's own motion since then (motion): used > until?                        → look again (near_features)
//!   listed pairs that may touch in this sub-step                                    → contacts: push, certify
//! ```
//!
//! # The guarantee
//! At the end of a sub-step no two triangles intersect, if they did not at its beginning:
//!
//! 1. Two patches whose boxes do not overlap are a thickness apart.
//! 2. Of two patches whose boxes overlap, features that are not listed were farther apart than a thickness by at least
//!    the pair's slack. No two points of them have come nearer by more than the pair has [used](motion). While that is
//!    less, they are a thickness apart.
//! 3. Neighbouring patches are apart, whatever their motion was, while a [projection](flattened) onto a plane keeps all points apart
//!    there ([folds]): in bends of nearly a right angle to either side, less what the thickness takes.
//! 4. A listed pair that has used up its distance is a contact, or is kept apart by others that are. A contact is
//!    [pushed](response) apart in proportion to its inverse masses, with friction. Then [a plane](certificate) between
//!    its nearest points at the beginning proves that it has not passed, or it is stopped.
//! 5. A push moves particles: 1 to 4 are done again, until nothing new is near.
//!
//! Patches that begin intersected are left alone until they are apart. With more work than the [limit](work) all cloths that
//! may touch stop for the rest of the tick, where they were last apart, and it is reported. Nothing is kept apart for some
//! ticks after too many of these in a row, if any pin moves meanwhile, or if any patches began intersected. Resting layers
//! are [held](mean_pushes) for a few sub-steps, while none can have come near enough to pass.
//! No step assumes springs, so all of this holds for [torn cloth and ropes](sheet), too.

mod bounds;
mod certificate;
mod circumstances;
mod compare;
mod contacts;
mod flattened;
mod flattening;
mod folds;
mod inside;
mod intersections;
mod joined;
mod lanes;
mod last_test;
mod mean_pushes;
mod members;
mod motion;
mod near_features;
mod near_patches;
mod origin;
mod pair;
mod participant;
mod patch_pair;
mod response;
mod settings;
mod sheet;
#[cfg(test)]
mod tests;
mod windows;
mod work;

use certificate::Zones;
use circumstances::Circumstances;
use contacts::Contacts;
use last_test::LastTest;
use mean_pushes::MeanPushes;
use members::Members;
use motion::Motion;
use near_features::NearFeatures;
use near_patches::{Meets, PatchBoxes};
use origin::Origin;
use participant::thinnest;
use response::push;
use work::{Counts, WORK_OF_CONTACT};

pub(crate) use inside::Inside;
pub use intersections::intersections;
pub(crate) use participant::Participant;
pub use settings::ClothSelfCollision;
pub(crate) use sheet::Sheet;

/// Largest number of times that features are looked for in a sub-step near those that were pushed.
const ROUNDS: u32 = 4;

/// Largest number of sub-steps that layers want.
const MOST_SUBSTEPS: f32 = 16.0;

/// Number of ticks in a row that too much work may stop cloths, and of those without contact after one more.
const MOST_STOPPED: u32 = 8;
const TICKS_OFF: u32 = 8;

/// Deviation of a patch from its reference, as a fraction of the smallest thickness, from which on it gets a new one.
const REFERENCE: f32 = 0.05;

/// Contact of cloths with themselves and with each other, from tick to tick. Can be dropped at any time.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MutualContact {
    circumstances: Circumstances,
    motion: Motion,
    boxes: PatchBoxes,
    near: NearFeatures,
    contacts: Contacts,
    members: Members,
    zones: Zones,
    /// The pushes that hold particles between tests.
    mean_pushes: MeanPushes,
    last: LastTest,
    /// Positions before colliders push particles in the sub-step, if noted.
    before_colliders: Origin,
    is_known: bool,
    /// Number of ticks in a row in which too much work stopped the cloths, and of those left without contact.
    stopped: u32,
    ticks_off: u32,
    counts: Counts,
}

impl MutualContact {
    /// Forgets all pairs: the particles are others, or have jumped.
    pub fn forget(&mut self) {
        (self.is_known, self.stopped, self.ticks_off) = (false, 0, 0);
    }

    /// Sets the pairs of particles that are sewn together, by their places among the particles of all cloths.
    pub fn set_joined(&mut self, pairs: impl Iterator<Item = [u32; 2]>) {
        if self.near.joined.set(pairs) {
            self.forget();
        }
    }

    /// Begins a tick of these cloths. `meets` returns whether two of them may touch.
    pub fn begin(&mut self, cloths: &[Participant], meets: impl Fn(usize, usize) -> bool) {
        let was_lost = self.counts.is_lost;
        if !was_lost {
            self.stopped = 0;
        }
        self.counts = Counts::new(cloths.iter().map(|cloth| cloth.particles.len()).sum());
        let is_same = self.circumstances.renew(cloths, &meets);
        if is_same && self.ticks_off > 0 {
            self.ticks_off -= 1;
            self.counts.is_lost = true;
            return;
        }
        let is_new = !(self.is_known && self.motion.is_of(cloths));
        if is_same && !is_new && !was_lost {
            self.near.begin_tick(cloths, &mut self.motion);
            self.tighten();
            let approach = self.last.begin_tick(cloths);
            if approach == 0.0 || approach <= self.last.free {
                return;
            }
            // Something else has moved them.
            self.motion.read(cloths);
            self.motion.measure_all();
            self.motion.measure(cloths);
            self.motion.pass(cloths, REFERENCE * thinnest(cloths));
            // Both ends of the sub-step are here.
            self.motion.end.clone_from(&self.motion.start);
        } else {
            let has_stayed = self.stopped > 0 && self.last.passed.are_pins_still(cloths);
            let begins = is_new || (was_lost && !has_stayed);
            if !begins {
                self.tighten();
            }
            self.motion.reset(cloths);
            let among = Meets {
                cloths,
                meets: &meets,
            };
            self.near.restart(begins, &among);
            self.boxes.reset(cloths, self.motion.patches.len());
            self.mean_pushes.clear(cloths);
            self.contacts.pairs.clear();
            (self.is_known, self.ticks_off) = (true, 0);
        }
        (self.last.wait, self.last.waited) = (0, 0);
        self.last.pass(cloths);
        match self.look(cloths, &meets) {
            Some(free) => self.last.free = free,
            None => self.lose(),
        }
        self.near.pass(cloths, &self.motion);
        self.tighten();
    }

    /// Lowers the limit of work by what began inside each other.
    fn tighten(&mut self) {
        let tangled = self.near.tangled_share(self.motion.patches.len());
        self.counts.tighten(self.motion.end.len(), tangled);
    }

    /// Number of times that the features of two patches were compared in the tick.
    pub fn searches(&self) -> u32 {
        self.counts.compared
    }

    /// Number of sub-steps that these layers want in the next tick, 0 if none touched. In a pile they carry its weight. In
    /// each, fast layers move by a thickness.
    pub fn wanted_substeps(&self) -> u32 {
        if self.counts.touched == 0.0 {
            return 0;
        }
        let pile = MOST_SUBSTEPS * self.counts.touched;
        let fast = self.counts.motion * self.counts.substeps as f32;
        pile.max(fast).clamp(1.0, MOST_SUBSTEPS) as u32
    }

    /// Number of sub-steps of the tick in which layers were stopped or may have passed through each other: there was too much
    /// work, or pairs could not be parted, as when pins force them together.
    pub fn lost(&self) -> u32 {
        self.counts.lost
    }

    /// Number of pairs of features that may come near each other.
    pub fn pairs(&self) -> usize {
        self.near.len()
    }

    /// Notes the particles' positions in a sub-step before colliders push them. Particles cannot move against these
    /// pushes.
    pub fn note_before_colliders(&mut self, cloths: &[Participant]) {
        if self.near.len() > 0 {
            self.before_colliders.set(cloths);
        } else {
            self.before_colliders.clear();
        }
    }

    /// Keeps the layers of cloths apart at the end of a sub-step of `dt` (s). Marks the cloths that were pushed.
    /// Returns the largest push (m).
    pub fn respond(
        &mut self,
        cloths: &mut [Participant],
        meets: impl Fn(usize, usize) -> bool,
        dt: f32,
        is_pushed: &mut [bool],
    ) -> f32 {
        if self.counts.is_lost {
            self.counts.lost += 1;
            return self.stay(cloths, is_pushed);
        }
        self.counts.substeps += 1;
        self.last.waited += 1;
        let is_waiting = self.last.wait > 0;
        self.last.wait = self.last.wait.saturating_sub(1);
        let (held, approach) = if is_waiting {
            self.mean_pushes.apply(cloths, &self.last.passed, is_pushed)
        } else {
            (0.0, self.last.passed.approach(cloths))
        };
        let has_none = self.contacts.pairs.is_empty() && !self.near.has_changed;
        if (is_waiting || has_none) && approach <= self.last.free {
            return held;
        }
        self.last.wait = 0;
        self.motion.read(cloths);
        self.motion.measure_all();
        self.motion.measure(cloths);
        let is_done = self.keep_apart(cloths, &meets, dt);
        let pushed = self.members.farthest_push();
        self.mean_pushes.pass();
        self.members
            .scatter(cloths, is_pushed, &mut self.mean_pushes);
        if !is_done {
            self.counts.lost += 1;
            self.stop();
            return pushed + held + self.stay(cloths, is_pushed);
        }
        self.counts.lost += u32::from(!self.counts.is_certain);
        let thinnest = thinnest(cloths);
        let pace = self.last.passed.approach(cloths) / self.last.waited as f32;
        self.counts.motion = self.counts.motion.max(0.5 * pace / thinnest);
        self.motion.pass(cloths, REFERENCE * thinnest);
        self.near.pass(cloths, &self.motion);
        self.last.reserve = 0.0;
        if !self.contacts.pairs.is_empty() {
            let are_resting = self.members.are_resting(dt);
            self.last.hold(thinnest, pace, are_resting);
        }
        self.last.pass(cloths);
        self.last.waited = 0;
        pushed + held
    }

    /// Pushes apart what touches, and looks for what the pushed particles may touch. Returns whether all pairs are certain
    /// or work is left.
    fn keep_apart(
        &mut self,
        cloths: &[Participant],
        meets: impl Fn(usize, usize) -> bool,
        dt: f32,
    ) -> bool {
        self.counts.is_certain = true;
        for round in 0..ROUNDS {
            let Some(free) = self.look(cloths, &meets) else {
                return false;
            };
            self.last.free = free;
            if round == 0 && !self.near.has_changed {
                self.members
                    .gather(cloths, &self.motion, &self.before_colliders);
            } else if self.near.has_changed {
                if round == 0 {
                    self.members.clear(self.motion.end.len());
                }
                self.contacts.list(
                    &mut self.near,
                    cloths,
                    &self.motion,
                    &mut self.members,
                    &self.before_colliders,
                    &mut self.counts,
                );
            } else {
                break;
            }
            let (contacts, members) = (&mut self.contacts, &mut self.members);
            self.counts.take(WORK_OF_CONTACT * contacts.pairs.len());
            let mut has_moved = false;
            if round == 0 {
                let touched = push(contacts, members, dt);
                let each = touched as f32 / members.len().max(1) as f32;
                self.counts.touched = self.counts.touched.max(each);
                has_moved = touched > 0;
            }
            let (zones, counts) = (&mut self.zones, &mut self.counts);
            has_moved |= zones.certify(&contacts.pairs, members, counts);
            if !has_moved {
                break;
            }
            self.members.put(cloths, &mut self.motion);
            self.motion.measure_changed(cloths);
            self.last.free = f32::NEG_INFINITY;
        }
        self.counts.is_certain || self.counts.work > 0
    }

    /// Looks at the patches that have used up what they may. Returns the approach of any two particles before others
    /// have (m); `None` if there was too much work.
    fn look(
        &mut self,
        cloths: &[Participant],
        meets: impl Fn(usize, usize) -> bool,
    ) -> Option<f32> {
        let Self {
            motion,
            boxes,
            near,
            last,
            counts,
            ..
        } = self;
        let (has_left, clearance) = boxes.renew(cloths, motion, last.reserve);
        let among = Meets { cloths, meets };
        let unfolded = near.renew(
            boxes,
            has_left,
            &among,
            motion,
            last.reserve,
            &mut counts.work,
        );
        let slack = near.look(cloths, motion, last.reserve, counts)?;
        Some(slack.min(unfolded).min(2.0 * clearance))
    }

    /// Stops the cloths for the rest of the tick, where they were last apart. Keeps nothing apart after many such ticks, so
    /// that they go on, if some began inside each other, or if they have not been tested in this tick.
    fn stop(&mut self) {
        let stopped = self.stopped + 1;
        let has_tangled = self.near.tangled_share(self.motion.patches.len()) > 0.0;
        let may_stop = stopped <= MOST_STOPPED && self.last.is_of_tick && !has_tangled;
        self.lose();
        if may_stop {
            (self.stopped, self.ticks_off) = (stopped, 0);
        }
    }

    /// Keeps stopped cloths where they are, until a pin moves. Returns how far they had moved, at most (m).
    fn stay(&mut self, cloths: &mut [Participant], is_pushed: &mut [bool]) -> f32 {
        if self.stopped == 0 {
            return 0.0;
        }
        if !self.last.passed.are_pins_still(cloths) {
            self.lose();
            return 0.0;
        }
        self.last.passed.put_back(cloths, is_pushed)
    }

    /// Keeps nothing apart for the rest of the tick and some more.
    fn lose(&mut self) {
        (self.counts.is_lost, self.stopped, self.ticks_off) = (true, 0, TICKS_OFF);
        self.near.clear();
        self.contacts.pairs.clear();
    }
}
