//! Contact of cloth with cloth: with itself, and with others.
//!
//! Pairs of features, vertex with face and edge with edge, are kept a thickness apart. A search through the trees finds
//! pairs that may come near each other, with a margin. Until particles have moved by that margin, each sub-step tests
//! only these pairs. A nearly flat patch is skipped entirely, by [a proven bound](bounds::Tangents).
//!
//! At the end of each sub-step, pairs are pushed apart in proportion to their inverse masses, with friction. Then [a
//! plane](certificate) between each pair proves that nothing has passed through. If everything is slow, this is done
//! only in some sub-steps, and particles are [held](hold) in between, while none can have come near enough to pass.

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

/// Number of rounds in a sub-step in which pushed features are compared with those that were too far away.
const ROUNDS: u32 = 4;

/// While no two features are near each other, the longest wait between tests in sub-steps, and the largest fraction of
/// the free distance that particles may use up at their recent speed.
const LONGEST_WAIT: u32 = 16;
const PART_OF_WAY: f32 = 0.5;

/// Work limits of a tick for each particle and in total: nodes and pairs of features, in searches and in the tests of
/// pairs.
const MOST_WORK: usize = 1 << 17;
const MOST_WORK_OF_ALL: usize = 1 << 28;

/// While the approach of particles is less than this fraction of the thickness, pushed particles are held by the mean
/// of their last pushes, for this many sub-steps at most.
const HELD: f32 = 0.1;
const LONGEST_HOLD: u32 = 3;

/// Only particles slower than this are held (m/s): a hold takes momentum, so only resting layers are held.
const RESTING_SPEED: f32 = 0.25;

/// Contact of cloths with themselves and with each other, from tick to tick. Can be dropped at any time.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MutualContact {
    circumstances: Circumstances,
    #[cfg_attr(feature = "serialize", serde(skip))]
    search: Search,
    pairs: Vec<Pair>,
    members: Members,
    /// The member of each particle of each cloth, if any.
    member_of: Vec<Vec<u32>>,
    /// The last pair with each member as its vertex, if any.
    last_of: Vec<u32>,
    /// The members before the last search.
    members_before: Members,
    member_of_before: Vec<Vec<u32>>,
    /// Positions of all particles at the last search, and the largest approach of any two before the next (m).
    origin: Origin,
    margin: f32,
    /// Largest approach of any two so far (m).
    nearer: f32,
    is_searched: bool,
    near: NearPairs,
    zones: Zones,
    /// Number of sub-steps left without a test, and number since the last test.
    wait: u32,
    waited: u32,
    /// Largest approach of any two in a sub-step by colliders' pushes since, and in total (m).
    pushed_pace: f32,
    pushed: f32,
    /// The pushes that hold particles between tests.
    hold: Hold,
    /// Largest approach of any two while they are held (m).
    free: f32,
    /// Positions of all particles when layers were last kept apart, or known to be: usually at the beginning of the
    /// sub-step.
    passed: Origin,
    searches: u32,
    has_touched: bool,
    /// Work left in the tick.
    work: usize,
    /// Whether there was too much work: nothing is kept apart until a search completes.
    is_lost: bool,
    /// Number of sub-steps of the tick in which that was so.
    lost: u32,
}

/// Positions at which new members were last known to be apart.
#[derive(Debug, Clone, Copy)]
enum Starts {
    /// Their current positions: the motion up to there has been tested.
    Here,
    /// The positions when layers were last known to be apart.
    Passed,
}

impl MutualContact {
    /// Forgets all pairs: the particles are others, or have jumped.
    pub fn forget(&mut self) {
        self.is_searched = false;
    }

    /// Begins a tick of these cloths. `meets` returns whether two of them may touch.
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
            // Particles of other cloths, or after a jump.
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

    /// Number of searches for features in the tick.
    pub fn searches(&self) -> u32 {
        self.searches
    }

    /// Whether anything touched in the tick.
    pub fn has_touched(&self) -> bool {
        self.has_touched
    }

    /// Number of sub-steps of the tick in which nothing was kept apart, because the cloth was too fast, too thick or
    /// too crowded to search in time.
    pub fn lost(&self) -> u32 {
        self.lost
    }

    /// Number of pairs of features that may come near each other, from the last search.
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Number of pairs of features tested in the last sub-step.
    #[cfg(test)]
    pub fn near(&self) -> usize {
        self.near.contacts.len()
    }

    /// Notes the particles' positions in a sub-step before colliders push them. Particles cannot move against these
    /// pushes.
    pub fn note_before_colliders(&mut self, cloths: &[Participant]) {
        if !self.pairs.is_empty() && self.waited >= self.wait {
            self.members.note_before_colliders(cloths);
        }
    }

    /// Adds the largest push of any particle by colliders in a sub-step without tests (m): pushed particles keep that
    /// motion.
    pub fn note_push(&mut self, farthest: f32) {
        self.pushed_pace += 2.0 * farthest;
        self.pushed += self.pushed_pace;
        // False for NaN.
        let is_less = self.nearer + self.pushed < PART_OF_WAY * self.margin;
        if self.pairs.is_empty() && !is_less && !self.is_lost {
            self.wait = 0;
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
            // Some may have met on the way.
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
            // A search from here is better than one on the way.
            if self.nearer + pace > self.margin {
                self.search(cloths, &meets, 0.0, Starts::Here);
            }
            return 0.0;
        }
        let waited = std::mem::take(&mut self.waited);
        self.members.gather(cloths);
        let thinnest = thinnest(cloths);
        // The approach of any two in the sub-step, and since near pairs were found.
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
            // Pushed features have come nearer to others.
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
        // The remaining pace of held particles.
        let pace = self.passed.approach(cloths) / waited as f32;
        self.passed.set(cloths);
        self.wait = match self.members.are_resting(RESTING_SPEED * dt) {
            true => ((PART_OF_WAY * self.free / pace) as u32).min(LONGEST_HOLD),
            false => 0,
        };
        self.near.renew_ahead_of(pace, thinnest);
        let in_substep = in_substep + pushed;
        // A search from here is better than one on the way.
        if self.nearer + in_substep > self.margin {
            self.search(cloths, &meets, 0.0, Starts::Here);
        }
        0.5 * pushed + held
    }

    /// Number of sub-steps without a test, for particles that approach each other by `pace` (m) in each.
    fn free_substeps(&self, pace: f32) -> u32 {
        let free = PART_OF_WAY * (self.margin - self.nearer);
        // Also for no pace, or one that is not finite.
        ((free / pace) as u32).min(LONGEST_WAIT)
    }
}
