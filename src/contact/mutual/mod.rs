//! Contact of cloth with cloth: with itself, and with others.
//!
//! Layers are kept a thickness apart by pairs of features, vertex with face and edge with edge. A search through the trees finds
//! those that may come near each other, with a margin; until particles have moved as far as that, each sub-step looks at these
//! alone. A patch that is not bent far is passed over whole, by [a bound that is proved](bounds::Tangents). At the end of each
//! sub-step pairs are pushed apart, in proportion to inverse masses and with friction, and then [a plane](certificate) between
//! each two proves that nothing has passed through. Where all is slow this is done in some sub-steps only, and particles are
//! [held](hold) in between, while none can have come near enough to pass.

mod bounds;
mod certificate;
mod circumstances;
mod flat;
mod hold;
mod inside;
mod intersections;
mod members;
mod motion;
mod near;
mod origin;
mod pair;
mod participant;
mod renewal;
mod response;
mod search;
mod settings;
mod sheet;
#[cfg(test)]
mod tests;

use self::{
    certificate::Zones, circumstances::Circumstances, hold::Hold, members::Members,
    motion::thinnest, near::NearPairs, origin::Origin, pair::Pair, response::push, search::Search,
};

pub(crate) use inside::Inside;
pub use intersections::intersections;
pub(crate) use participant::Participant;
pub use settings::ClothSelfCollision;
pub(crate) use sheet::Sheet;

/// How often in a sub-step what has been pushed is compared with what was too far away before.
const ROUNDS: u32 = 4;

/// As long as no two features are near each other, particles are looked at again in this many sub-steps at most, and before they
/// may have come, as fast as lately, this part of the way that is free.
const LONGEST_WAIT: u32 = 16;
const PART_OF_WAY: f32 = 0.5;

/// For each particle a tick looks at so many nodes and pairs of features at most, in searches and in going through what was found; and at
/// so many however many particles there are.
const MOST_WORK: usize = 1 << 17;
const MOST_WORK_OF_ALL: usize = 1 << 28;

/// As long as particles come nearer to each other by less than this part of the thickness, those that are pushed are held by the
/// mean of their last pushes in this many sub-steps at most.
const HELD: f32 = 0.1;
const LONGEST_HOLD: u32 = 3;

/// Only what rests on something is held: what holds it takes momentum, from slower motion than this (m/s).
const RESTING_SPEED: f32 = 0.25;

/// Contact of cloths with themselves and with each other, from tick to tick. May be dropped at any time.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MutualContact {
    circumstances: Circumstances,
    #[cfg_attr(feature = "serialize", serde(skip))]
    search: Search,
    pairs: Vec<Pair>,
    members: Members,
    /// Which member each particle of each cloth is, if any.
    member_of: Vec<Vec<u32>>,
    /// The last pair that names each member as its vertex, if any.
    last_of: Vec<u32>,
    /// The same before the last search.
    members_before: Members,
    member_of_before: Vec<Vec<u32>>,
    /// Where all particles were at the last search, and how much nearer to each other any two may come before the next (m).
    origin: Origin,
    margin: f32,
    /// How much nearer to each other any two may have come by now, at most (m).
    nearer: f32,
    is_searched: bool,
    near: NearPairs,
    zones: Zones,
    /// For how many sub-steps nothing has to be looked at, and since how many nothing was.
    wait: u32,
    waited: u32,
    /// How much nearer to each other any two may come in a sub-step by what colliders have pushed them since, and may have come (m).
    pushed_pace: f32,
    pushed: f32,
    /// What particles are held by meanwhile.
    hold: Hold,
    /// How much nearer to each other any two may come while they are held (m).
    free: f32,
    /// Where all particles were when layers were last kept apart, or were known to be: as the sub-step began, mostly.
    passed: Origin,
    searches: u32,
    has_touched: bool,
    /// What may be looked at in the rest of the tick.
    work: usize,
    /// Whether there was too much to look at: nothing is kept apart until another search comes to its end.
    is_lost: bool,
    /// In how many sub-steps of the tick that was so.
    lost: u32,
}

/// Where particles that become members were last known to be apart.
#[derive(Debug, Clone, Copy)]
enum Starts {
    /// Where they are: what is under way has been looked at.
    Here,
    /// When layers were last known to be apart.
    Passed,
}

impl MutualContact {
    /// Forgets what was found: the particles are others, or somewhere else.
    pub fn forget(&mut self) {
        self.is_searched = false;
    }

    /// Begins a tick of these cloths, of which `meets` says which two of them touch.
    pub fn begin(&mut self, cloths: &[Participant], meets: impl Fn(usize, usize) -> bool) {
        self.searches = 0;
        self.has_touched = false;
        self.lost = 0;
        let particles = cloths.iter().map(|cloth| cloth.particles.len());
        let particles = particles.sum::<usize>();
        self.work = MOST_WORK.saturating_mul(particles).min(MOST_WORK_OF_ALL);
        let is_same = self.circumstances.renew(cloths, &meets);
        let is_known = is_same && self.is_searched && !self.is_lost && self.origin.is_of(cloths);
        if is_known {
            self.nearer = self.origin.approach(cloths);
            self.members.begin(cloths);
            if let Some(approach) = self.near.approach(cloths) {
                self.near.pass(approach);
            }
        } else {
            // Particles of other cloths, perhaps, or as they were elsewhere.
            self.near.forget();
            self.members.clear();
            self.member_of.clear();
            self.pairs.clear();
        }
        (self.wait, self.waited) = (0, 0);
        if !self.pairs.is_empty() {
            self.passed.set(cloths);
        }
        if !is_known {
            self.search(cloths, meets, 0.0, Starts::Here);
        } else if self.nearer > self.margin {
            let starts = if self.pairs.is_empty() {
                self.passed.copy_from(&self.origin);
                Starts::Passed
            } else {
                Starts::Here
            };
            self.search(cloths, meets, self.nearer - self.margin, starts);
        }
    }

    /// How often in the tick features were searched for.
    pub fn searches(&self) -> u32 {
        self.searches
    }

    /// Whether anything touched in the tick.
    pub fn has_touched(&self) -> bool {
        self.has_touched
    }

    /// In how many sub-steps of the tick nothing was kept apart: what is so fast, so thick or so crowded takes too long to search.
    pub fn lost(&self) -> u32 {
        self.lost
    }

    /// Pairs of features that may come near each other, as found last.
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Pairs of features that were looked at in the last sub-step.
    #[cfg(test)]
    pub fn near(&self) -> usize {
        self.near.contacts.len()
    }

    /// Notes where particles are in a sub-step before colliders push them: against that they do not give way.
    pub fn note_before_colliders(&mut self, cloths: &[Participant]) {
        if !self.pairs.is_empty() && self.waited >= self.wait {
            self.members.note_before_colliders(cloths);
        }
    }

    /// Notes how far colliders have pushed any particle in a sub-step (m), of cloths of which nothing is looked at for a while: what was
    /// pushed goes on as it was pushed.
    pub fn note_push(&mut self, farthest: f32) {
        self.pushed_pace += 2.0 * farthest;
        self.pushed += self.pushed_pace;
        // NaN is looked at.
        let is_less = self.nearer + self.pushed < PART_OF_WAY * self.margin;
        if self.pairs.is_empty() && !is_less && !self.is_lost {
            self.wait = 0;
        }
    }

    /// Keeps the layers of cloths apart at the end of a sub-step of `dt` (s). Says of each cloth whether any of it was pushed.
    /// Returns the farthest that anything was pushed (m).
    pub fn respond(
        &mut self,
        cloths: &mut [Participant],
        meets: impl Fn(usize, usize) -> bool,
        dt: f32,
        is_pushed: &mut [bool],
    ) -> f32 {
        self.waited += 1;
        let mut held = 0.0;
        if self.waited <= self.wait {
            if self.pairs.is_empty() {
                self.lost += u32::from(self.is_lost);
                return 0.0;
            }
            let approach;
            (held, approach) = self.hold.apply(cloths, &self.passed, is_pushed);
            if approach <= self.free {
                return held;
            }
        }
        (self.pushed_pace, self.pushed) = (0.0, 0.0);
        let before = self.nearer;
        self.nearer = self.origin.approach(cloths);
        if self.is_lost {
            self.search(cloths, &meets, 0.0, Starts::Here);
        } else if self.nearer > self.margin {
            // Some may have met on the way to here.
            if self.pairs.is_empty() {
                match self.waited {
                    1 => self.passed.set_to_start(cloths),
                    _ => self.passed.copy_from(&self.origin),
                }
            }
            self.search(cloths, &meets, self.nearer - self.margin, Starts::Passed);
        }
        if self.is_lost {
            self.lost += 1;
            return held;
        }
        if self.pairs.is_empty() {
            let pace = (self.nearer - before).max(0.0) / self.waited as f32;
            (self.wait, self.waited) = (self.free_substeps(pace), 0);
            // Better from here than on the way.
            if self.nearer + pace > self.margin {
                self.search(cloths, &meets, 0.0, Starts::Here);
            }
            return 0.0;
        }
        let waited = std::mem::take(&mut self.waited);
        self.members.gather(cloths);
        let thinnest = thinnest(cloths);
        // How much nearer any two have come, in the sub-step and since near pairs were found.
        let in_substep = self.passed.approach(cloths);
        let mut since = self.near.approach(cloths).unwrap_or(in_substep);
        let mut pushed = 0.0;
        for round in 0..ROUNDS {
            if !self.near.covers(since + pushed) {
                since = in_substep;
                let Some(left) = self.work.checked_sub(self.pairs.len()) else {
                    self.lost += 1;
                    self.members.scatter(cloths, is_pushed, &mut self.hold);
                    self.lose();
                    return 0.5 * pushed + held;
                };
                self.work = left;
                self.near.find(
                    &mut self.pairs,
                    &mut self.members,
                    &self.last_of,
                    (&self.passed, since + pushed),
                    thinnest,
                );
            }
            if round == 0 {
                let NearPairs {
                    contacts, too_near, ..
                } = &mut self.near;
                self.has_touched |= push(contacts, too_near, &mut self.members, dt);
            } else if let Some(nearer) = self.near.may_meet_within(since + pushed) {
                self.work = self.work.saturating_sub(self.near.contacts.len());
                self.zones
                    .certify(&self.near.contacts, nearer, &mut self.members);
            } else {
                break;
            }
            // What was pushed has come nearer to others.
            let farther = 2.0 * self.members.farthest_push();
            if round > 0 && farther <= pushed {
                break;
            }
            pushed = farther;
        }
        self.members.scatter(cloths, is_pushed, &mut self.hold);
        if let Some(after) = self.near.approach(cloths) {
            self.near.pass(after);
        }
        self.free = self
            .near
            .spare()
            .min(self.margin - self.nearer - pushed)
            .min(HELD * thinnest);
        // What is left of it where they are held.
        let pace = self.passed.approach(cloths) / waited as f32;
        self.passed.set(cloths);
        self.wait = match self.members.are_resting(RESTING_SPEED * dt) {
            true => ((PART_OF_WAY * self.free / pace) as u32).min(LONGEST_HOLD),
            false => 0,
        };
        self.near.renew_ahead_of(pace, thinnest);
        let in_substep = in_substep + pushed;
        // Better from here than on the way.
        if self.nearer + in_substep > self.margin {
            self.search(cloths, &meets, 0.0, Starts::Here);
        }
        0.5 * pushed + held
    }

    /// For how many sub-steps particles that come nearer to each other by `pace` (m) in each have far to go.
    fn free_substeps(&self, pace: f32) -> u32 {
        let free = PART_OF_WAY * (self.margin - self.nearer);
        // At no pace, or one that is not finite, too.
        ((free / pace) as u32).min(LONGEST_WAIT)
    }
}
