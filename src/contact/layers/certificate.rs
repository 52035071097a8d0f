//! Proves in each sub-step that no features have passed through each other, and corrects those without a proof.
//!
//! The nearest points of two features define a separating plane across the line between them, with one feature on
//! either side. Particles move along straight lines. Let all of them be on the same sides of a plane with that normal
//! at the end of a sub-step. Then they were so all along, and the features have not met. The same normal serves in the
//! next sub-step, until nearest points are found again.
//!
//! Pairs that are not contacts are a thickness apart without a test. If all vertices with faces and all edges with
//! edges are apart, no two triangles intersect.

use bevy::math::Vec3A;

use super::{members::Members, pair::NearPair, work::Counts};
use crate::cloth::MapInline;

/// Smallest gap left between features, as a fraction of the thickness and of the distance at the beginning of the
/// sub-step.
pub(super) const LEFT_OF_THICKNESS: f32 = 0.05;
const LEFT_OF_DISTANCE: f32 = 0.25;

/// Number of pushes on features that would pass, before they are made to move as one.
const PUSHES: u32 = 8;

/// Largest number of enlargements of zones.
const ZONES: u32 = 24;

/// Below this distance at the beginning of a sub-step (m), features have met before, and no plane separates them.
const MET: f32 = 1.0e-7;

/// Sets of particles that move as one.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Zones {
    parent: Vec<u32>,
    sums: Vec<Sum>,
    /// Of each member the last round in which its pairs have to be tested: the one after it was moved.
    #[cfg_attr(feature = "serialize", serde(skip))]
    retest_in: Vec<u32>,
}

/// Sums over a zone.
#[derive(Debug, Default, Clone, Copy)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Sum {
    count: u32,
    mass: f32,
    momentum: Vec3A,
    pinned: u32,
    carried: Vec3A,
}

impl Zones {
    /// Stops pairs from passing through each other. Returns whether any had to be stopped. Counts the tests, and
    /// whether all pairs are certain.
    pub fn certify(
        &mut self,
        pairs: &[NearPair],
        members: &mut Members,
        counts: &mut Counts,
    ) -> bool {
        let (mut has_zones, mut has_moved) = (false, false);
        counts.is_certain = false;
        self.retest_in.clear();
        self.retest_in.resize(members.len(), 0);
        for round in 0..PUSHES + ZONES {
            let (mut is_certain, mut tests) = (true, 0);
            for pair in pairs {
                let is_due = |&member: &u32| self.retest_in[member as usize] >= round;
                if !pair.members.iter().any(is_due) {
                    continue;
                }
                tests += 1;
                let Some(lack) = lack(pair, members) else {
                    continue;
                };
                (is_certain, has_moved) = (false, true);
                for member in pair.members {
                    self.retest_in[member as usize] = round + 1;
                }
                if round < PUSHES {
                    part(pair, lack, members);
                } else {
                    if !has_zones {
                        self.clear(members.len());
                        has_zones = true;
                    }
                    self.join(pair.members);
                }
            }
            if has_zones && !is_certain {
                tests += 2 * members.len();
                self.move_as_one(members, round + 1);
            }
            counts.take(pairs.len() / 4 + tests);
            counts.is_certain = is_certain;
            if is_certain || counts.work == 0 {
                break;
            }
        }
        has_moved
    }

    fn clear(&mut self, members: usize) {
        self.parent.clear();
        self.parent.extend(0..members as u32);
    }

    fn find(&mut self, mut member: u32) -> u32 {
        while self.parent[member as usize] != member {
            let above = self.parent[member as usize];
            self.parent[member as usize] = self.parent[above as usize];
            member = above;
        }
        member
    }

    fn join(&mut self, members: [u32; 4]) {
        let root = self.find(members[0]);
        for member in &members[1..] {
            let other = self.find(*member);
            self.parent[other as usize] = root;
        }
    }

    /// Moves each zone from its start by the mean of its motions, which conserves momentum, or with its pins.
    fn move_as_one(&mut self, members: &mut Members, next_round: u32) {
        let count = members.len() as u32;
        self.sums.clear();
        self.sums.resize(count as usize, Sum::default());
        for member in 0..count {
            let root = self.find(member) as usize;
            let index = member as usize;
            let moved = members.states[index].place - members.states[index].start;
            let sum = &mut self.sums[root];
            sum.count += 1;
            let inverse_mass = members.states[index].inverse_mass;
            if inverse_mass > 0.0 {
                let mass = 1.0 / inverse_mass;
                sum.mass += mass;
                sum.momentum += moved * mass;
            } else {
                sum.pinned += 1;
                sum.carried += moved;
            }
        }
        for member in 0..count {
            let root = self.find(member) as usize;
            let sum = self.sums[root];
            let index = member as usize;
            if sum.count < 2 || members.states[index].inverse_mass == 0.0 {
                continue;
            }
            let moved = if sum.pinned > 0 {
                sum.carried / sum.pinned as f32
            } else {
                sum.momentum / sum.mass
            };
            self.retest_in[index] = next_round;
            let state = &mut members.states[index];
            state.place = state.start + moved;
            state.moved = moved;
        }
    }
}

/// The missing distance to a plane between two features (m), if there is none.
#[inline]
fn lack(pair: &NearPair, members: &Members) -> Option<f32> {
    let distance = pair.nearest.distance;
    if distance <= MET {
        return None;
    }
    let wanted = (LEFT_OF_THICKNESS * pair.thickness).min(LEFT_OF_DISTANCE * distance);
    let left = pair.clearance(members.states(pair.members));
    // NaN is not a lack.
    (left < wanted).then_some(2.0 * wanted - left)
}

/// Pushes apart the two particles, one of each feature, that are farthest beyond the plane.
fn part(pair: &NearPair, lack: f32, members: &mut Members) {
    let normal = pair.nearest.normal;
    let states = members.states(pair.members);
    let along = states.map_inline(|state| normal.dot(state.place));
    let first = (0..pair.split).min_by(|&a, &b| along[a].total_cmp(&along[b]));
    let second = (pair.split..4).max_by(|&a, &b| along[a].total_cmp(&along[b]));
    let (Some(first), Some(second)) = (first, second) else {
        return;
    };
    let [a, b] = [first, second].map_inline(|index| states[index]);
    let mobility = a.inverse_mass + b.inverse_mass;
    if mobility == 0.0 {
        return;
    }
    let push = normal * (lack / mobility);
    let nearing = -normal.dot(a.moved - b.moved);
    let stop = normal * (nearing.max(0.0) / mobility);
    for (index, sign) in [(first, 1.0), (second, -1.0)] {
        let state = &mut members.states[pair.members[index] as usize];
        let share = sign * state.inverse_mass;
        state.place += push * share;
        state.moved += stop * share;
    }
}
