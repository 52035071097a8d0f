//! The proof, in each sub-step, that no features have passed through each other; and what is done where it can't be given.
//!
//! When nearest points of two features are found, there is a plane between them, across the line that joins them, with all of one
//! feature on one side and all of the other on the other. Particles move along straight lines, so if all of them are on the same
//! sides of a plane of that direction as a sub-step ends, they were so all along, and the features have not met. The same direction
//! then does for the next sub-step, until nearest points are found anew. Features that were farther from each other than any two
//! particles have come nearer since have such a plane without being looked at. Where that is so of all vertices with faces and of all
//! edges with edges, no two triangles intersect.

use bevy::math::Vec3A;

use super::{members::Members, pair::NearPair};

/// Of the thickness, and of the distance as the sub-step began, what has to be left between features.
pub(super) const LEFT_OF_THICKNESS: f32 = 0.05;
const LEFT_OF_DISTANCE: f32 = 0.25;

/// How often those that would pass are pushed apart, before they are made to move as one.
const PUSHES: u32 = 8;

/// How often zones are made larger, at most.
const ZONES: u32 = 24;

/// Nearer than that as a sub-step begins (m), features have met before, and no plane is between them.
const MET: f32 = 1.0e-7;

/// Particles that move as one.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Zones {
    parent: Vec<u32>,
    sums: Vec<Sum>,
}

/// Of a zone.
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
    /// Has no pair pass through itself of those that can have met: all that were found when they were no nearer to it than `nearer` (m).
    pub fn certify(&mut self, pairs: &[NearPair], nearer: f32, members: &mut Members) {
        let mut has_zones = false;
        for round in 0..PUSHES + ZONES {
            let mut is_certain = true;
            for pair in pairs {
                if pair.until_met(LEFT_OF_THICKNESS) > nearer {
                    continue;
                }
                let Some(lack) = lack(pair, members) else {
                    continue;
                };
                is_certain = false;
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
            if is_certain {
                break;
            }
            if has_zones {
                self.move_as_one(members);
            }
        }
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

    /// Has each zone move from where it was by the mean of its motions, which keeps its momentum; or as its pins do.
    fn move_as_one(&mut self, members: &mut Members) {
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
            let state = &mut members.states[index];
            state.place = state.start + moved;
            state.moved = moved;
        }
    }
}

/// How much two features lack of having a plane between them (m), if they do.
#[inline]
fn lack(pair: &NearPair, members: &Members) -> Option<f32> {
    let distance = pair.distance;
    if distance <= MET {
        return None;
    }
    let wanted = (LEFT_OF_THICKNESS * pair.thickness).min(LEFT_OF_DISTANCE * distance);
    let left = pair.clearance(members.states(pair.members));
    // NaN is no lack.
    (left < wanted).then_some(2.0 * wanted - left)
}

/// Pushes those two particles apart, one of each feature, that are farthest beyond the plane.
fn part(pair: &NearPair, lack: f32, members: &mut Members) {
    let normal = pair.normal;
    let states = members.states(pair.members);
    let along = states.map(|state| normal.dot(state.place));
    let first = (0..pair.split).min_by(|&a, &b| along[a].total_cmp(&along[b]));
    let second = (pair.split..4).max_by(|&a, &b| along[a].total_cmp(&along[b]));
    let (Some(first), Some(second)) = (first, second) else {
        return;
    };
    let [a, b] = [first, second].map(|index| states[index]);
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
