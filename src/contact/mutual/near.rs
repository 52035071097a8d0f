//! Which of all pairs have to be looked at in a sub-step, and which of these may be left out.

use super::{
    certificate::LEFT_OF_THICKNESS,
    members::Members,
    origin::Origin,
    pair::{NOBODY, NearPair, Nearest, Pair, VERTEX_AND_FACE},
    participant::Participant,
};

/// By how much of the smallest thickness particles may come nearer to each other before nearest points are found anew: so far
/// their normals and weights stand for what they were.
const FRESH: f32 = 0.1;

/// For so many sub-steps they should.
const AHEAD: f32 = 8.0;

/// By how much of the smallest thickness particles may come nearer to each other before all pairs are gone through again.
const SLACK: f32 = 0.25;

/// Pairs that are near each other, until particles have come nearer to each other by a little.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct NearPairs {
    listed: Vec<u32>,
    found: Vec<u32>,
    /// Those that may come nearer to each other than their thickness.
    pub contacts: Vec<NearPair>,
    /// Those of them that came much nearer, in the last sub-step.
    pub too_near: Vec<u32>,
    /// How near any two of them were to passing through each other when they were found (m).
    closest: f32,
    /// Where all particles were when contacts were found; how much nearer to each other any two may come from there, and can have
    /// come up to where the sub-step began (m).
    origin: Origin,
    room: f32,
    used: f32,
    /// How much nearer to each other any two particles can have come when the list has to be made anew, and by the time contacts
    /// were found last (m).
    until: f32,
    odometer: f32,
    /// Counts sub-steps: where they begin is the same when nearest points are found more than once in one.
    substep: u32,
    is_listed: bool,
    is_found: bool,
    is_used_up: bool,
}

impl NearPairs {
    /// Forgets them: the pairs are others.
    pub fn forget(&mut self) {
        self.listed.clear();
        self.contacts.clear();
        (self.odometer, self.is_listed, self.is_found) = (0.0, false, false);
    }

    /// How much nearer to each other any two particles can have come since contacts were found (m); none if they are not.
    pub fn approach(&self, cloths: &[Participant]) -> Option<f32> {
        self.is_found.then(|| self.origin.approach(cloths))
    }

    /// Whether they are still all that are near when any two particles can have come nearer to each other by this much since they
    /// were found (m).
    pub fn covers(&self, approach: f32) -> bool {
        self.is_found && !self.is_used_up && approach <= self.room
    }

    /// Of those that were found no nearer than this to each other (m), none can have passed through another in the sub-step, since
    /// which began any two particles can have come nearer by `approach` since they were found (m).
    pub fn may_meet_within(&self, approach: f32) -> Option<f32> {
        let nearer = approach.max(self.used);
        (self.closest <= nearer).then_some(nearer)
    }

    /// How much nearer to each other any two particles may still come before some may be near that are not known to be, or may have
    /// passed through each other (m).
    pub fn spare(&self) -> f32 {
        self.room.min(self.closest) - self.used
    }

    /// Has them be found anew before the next sub-step, if they will soon have to be, with particles that come nearer to each other by
    /// `pace` (m) in each.
    pub fn renew_ahead_of(&mut self, pace: f32, thinnest: f32) {
        let wanted = AHEAD * pace;
        self.is_used_up = self.spare() < wanted && 2.0 * wanted < FRESH * thinnest;
    }

    /// The sub-step ends, and any two particles can have come nearer to each other by `approach` since contacts were found (m).
    pub fn pass(&mut self, approach: f32) {
        self.used = approach;
        self.substep = (self.substep + 1) % NOBODY;
    }

    /// Finds those that may touch before any two particles have come nearer to each other by `approach` (m) and a little of the
    /// thickness, with their nearest points where the sub-step began. The last pair of each vertex with a face begins its list.
    pub fn find(
        &mut self,
        pairs: &mut [Pair],
        members: &mut Members,
        last_of: &[u32],
        (origin, approach): (&Origin, f32),
        thinnest: f32,
    ) {
        members.note_travel();
        self.odometer += self.used;
        (self.used, self.is_found, self.is_used_up) = (0.0, true, false);
        self.origin.copy_from(origin);
        self.room = approach + FRESH * thinnest;
        if !self.is_listed || self.odometer + self.room > self.until {
            self.list(pairs, members, thinnest);
        }
        self.found.clear();
        // Each of four particles travels half as far as two come nearer to each other.
        for &index in &self.listed {
            let pair = &mut pairs[index as usize];
            let travelled = members.travelled(pair.members);
            pair.is_near = false;
            if pair.far_until > travelled + self.room {
                continue;
            }
            if pair.found_in != self.substep {
                pair.nearest = Nearest::of(pair.split, members.starts(pair.members));
                pair.found_in = self.substep;
            }
            let apart = pair.nearest.distance - pair.thickness;
            pair.far_until = travelled + apart;
            if apart <= self.room {
                pair.is_near = true;
                self.found.push(index);
            }
        }
        self.contacts.clear();
        self.closest = f32::INFINITY;
        for &index in &self.found {
            let pair = &pairs[index as usize];
            let near = NearPair::of(pair);
            let left = near.until_met(LEFT_OF_THICKNESS);
            self.closest = self.closest.min(left);
            let is_left_out = if pair.split == VERTEX_AND_FACE {
                is_implied(pairs, last_of[pair.members[0] as usize], index)
            } else {
                // Ends of edges are vertices, which are kept away from faces by more.
                let mut weights = pair.nearest.weights.iter();
                !weights.all(|weight| weight.abs() > 0.0 && weight.abs() < 1.0)
            };
            // Whatever may be passed through has to be certain.
            if !is_left_out || left <= self.room {
                self.contacts.push(NearPair {
                    is_pushed: !is_left_out,
                    ..near
                });
            }
        }
    }

    /// Goes through all pairs for those that may touch before particles have come nearer to each other by a little.
    fn list(&mut self, pairs: &mut [Pair], members: &Members, thinnest: f32) {
        self.is_listed = true;
        let slack = (SLACK * thinnest).max(0.5 * self.room);
        self.until = self.odometer + self.room + slack;
        let ahead = self.room + 2.0 * slack;
        self.listed.clear();
        for (index, pair) in pairs.iter_mut().enumerate() {
            // What is not listed is not near.
            pair.is_near = false;
            if pair.far_until <= members.travelled(pair.members) + ahead {
                self.listed.push(index as u32);
            }
        }
    }
}

/// Whether a vertex is kept away from a face by keeping it away from another one, which is nearer: the face's nearest point is on
/// its edge, and that is the other's edge too.
fn is_implied(pairs: &[Pair], last: u32, index: u32) -> bool {
    let pair = &pairs[index as usize];
    let nearest = &pair.nearest;
    if nearest.weights.iter().all(|&weight| weight != 0.0) {
        return false;
    }
    let mut next = last;
    while next != NOBODY {
        let other = &pairs[next as usize];
        let is_nearer = other.nearest.distance < nearest.distance
            || (other.nearest.distance == nearest.distance && next < index);
        if next != index
            && other.is_near
            && other.thickness >= pair.thickness
            && is_nearer
            && (1..4).all(|corner| {
                nearest.weights[corner] == 0.0 || other.members[1..].contains(&pair.members[corner])
            })
        {
            return true;
        }
        next = other.before;
    }
    false
}
