//! The pairs that have to be tested in a sub-step.

use super::{
    certificate::LEFT_OF_THICKNESS,
    members::Members,
    origin::Origin,
    pair::{NOBODY, NearPair, Nearest, Pair, VERTEX_AND_FACE},
    participant::Participant,
};

/// Approach of particles, as a fraction of the smallest thickness, before nearest points are found again. Until then,
/// their normals and weights are reused.
const FRESH: f32 = 0.1;

/// Number of sub-steps that they should last.
const AHEAD: f32 = 8.0;

/// Approach of particles, as a fraction of the smallest thickness, before all pairs are listed again.
const SLACK: f32 = 0.25;

/// Pairs that are near each other, until particles have approached each other a little.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct NearPairs {
    listed: Vec<u32>,
    found: Vec<u32>,
    /// Pairs that may come nearer than their thickness.
    pub contacts: Vec<NearPair>,
    /// Those that came much nearer in the last sub-step.
    pub too_near: Vec<u32>,
    /// Smallest gap of any pair when they were found, before it passes through (m).
    closest: f32,
    /// Positions of all particles when contacts were found. The allowed approach from there, and the approach up to the
    /// beginning of the sub-step (m).
    origin: Origin,
    room: f32,
    used: f32,
    /// Approach at which the list has to be made again, and the approach when contacts were last found (m).
    until: f32,
    odometer: f32,
    /// Counts sub-steps: nearest points at the beginning of one are the same if they are found more than once.
    substep: u32,
    is_listed: bool,
    is_found: bool,
    is_used_up: bool,
}

impl NearPairs {
    /// Forgets everything for other pairs.
    pub fn forget(&mut self) {
        self.listed.clear();
        self.contacts.clear();
        (self.odometer, self.is_listed, self.is_found) = (0.0, false, false);
    }

    /// Largest approach of any two particles since contacts were found (m); `None` before that.
    pub fn approach(&self, cloths: &[Participant]) -> Option<f32> {
        self.is_found.then(|| self.origin.approach(cloths))
    }

    /// Whether the contacts still include all near pairs after this approach (m).
    pub fn covers(&self, approach: f32) -> bool {
        self.is_found && !self.is_used_up && approach <= self.room
    }

    /// The approach in the sub-step (m), if any pair can have passed through. `approach` is that of any two particles
    /// since contacts were found (m). Pairs found at a larger distance cannot have passed.
    pub fn may_meet_within(&self, approach: f32) -> Option<f32> {
        let nearer = approach.max(self.used);
        (self.closest <= nearer).then_some(nearer)
    }

    /// Remaining approach of any two particles before unknown pairs may be near, or may have passed through each other
    /// (m).
    pub fn spare(&self) -> f32 {
        self.room.min(self.closest) - self.used
    }

    /// Makes the next sub-step find contacts again if they would soon be used up, at a `pace` of approach (m per
    /// sub-step).
    pub fn renew_ahead_of(&mut self, pace: f32, thinnest: f32) {
        let wanted = AHEAD * pace;
        self.is_used_up = self.spare() < wanted && 2.0 * wanted < FRESH * thinnest;
    }

    /// Ends the sub-step. `approach` is that of any two particles since contacts were found (m).
    pub fn pass(&mut self, approach: f32) {
        self.used = approach;
        self.substep = (self.substep + 1) % NOBODY;
    }

    /// Finds the pairs that may touch within an `approach` (m) and a little of the thickness, with their nearest points
    /// at the beginning of the sub-step. Each vertex has a linked list of its pairs with faces, which begins with the
    /// last.
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
        // Each of four particles travels half of the approach.
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
                // Ends of edges are vertices, which faces keep farther away.
                let mut weights = pair.nearest.weights.iter();
                !weights.all(|weight| weight.abs() > 0.0 && weight.abs() < 1.0)
            };
            // Pairs that may pass through must be tested.
            if !is_left_out || left <= self.room {
                self.contacts.push(NearPair {
                    is_pushed: !is_left_out,
                    ..near
                });
            }
        }
    }

    /// Lists all pairs that may touch after a small approach.
    fn list(&mut self, pairs: &mut [Pair], members: &Members, thinnest: f32) {
        self.is_listed = true;
        let slack = (SLACK * thinnest).max(0.5 * self.room);
        self.until = self.odometer + self.room + slack;
        let ahead = self.room + 2.0 * slack;
        self.listed.clear();
        for (index, pair) in pairs.iter_mut().enumerate() {
            // Unlisted pairs are not near.
            pair.is_near = false;
            if pair.far_until <= members.travelled(pair.members) + ahead {
                self.listed.push(index as u32);
            }
        }
    }
}

/// Whether a nearer face already keeps a vertex away from a face: the nearest point is on an edge of both faces.
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
