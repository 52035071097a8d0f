//! The proof, in each sub-step, that no features have passed through each other; and what is done where it can't be given.
//!
//! As a sub-step begins, the nearest points of two features have a plane between them, across the line that joins them, with all of
//! one feature on one side and all of the other on the other. Particles move along straight lines, so if all of them are on the
//! same sides of a plane of that direction as the sub-step ends, they were so all along, and the features have not met. Where that
//! is so of all vertices with faces and of all edges with edges that were near enough, no two triangles intersect.

use bevy::math::Vec3;

use super::{members::Members, pair::Pair};

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
pub(super) struct Zones {
    parent: Vec<u32>,
    sums: Vec<Sum>,
}

/// Of a zone.
#[derive(Debug, Default, Clone, Copy)]
struct Sum {
    count: u32,
    mass: f32,
    momentum: Vec3,
    pinned: u32,
    carried: Vec3,
}

impl Zones {
    /// Has no pair that is `near` pass through itself. Returns how far any particle was moved at most (m).
    pub fn certify(&mut self, pairs: &[Pair], near: &[u32], members: &mut Members) -> f32 {
        let mut farthest = 0.0_f32;
        let mut has_zones = false;
        for round in 0..PUSHES + ZONES {
            let mut is_certain = true;
            for &index in near {
                let pair = &pairs[index as usize];
                let Some(lack) = lack(pair, members) else {
                    continue;
                };
                is_certain = false;
                if round < PUSHES {
                    farthest = farthest.max(part(pair, lack, members));
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
                farthest = farthest.max(self.move_as_one(members));
            }
        }
        farthest
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

    /// Has each zone move from where it was by the mean of its motions, which keeps its momentum; or as its pins do. Returns how far
    /// that took a particle away from where it was going (m).
    fn move_as_one(&mut self, members: &mut Members) -> f32 {
        let count = members.len() as u32;
        self.sums.clear();
        self.sums.resize(count as usize, Sum::default());
        for member in 0..count {
            let root = self.find(member) as usize;
            let index = member as usize;
            let moved = members.place[index] - members.start[index];
            let sum = &mut self.sums[root];
            sum.count += 1;
            if members.inverse_mass[index] > 0.0 {
                let mass = 1.0 / members.inverse_mass[index];
                sum.mass += mass;
                sum.momentum += moved * mass;
            } else {
                sum.pinned += 1;
                sum.carried += moved;
            }
        }
        let mut farthest = 0.0_f32;
        for member in 0..count {
            let root = self.find(member) as usize;
            let sum = self.sums[root];
            let index = member as usize;
            if sum.count < 2 || members.inverse_mass[index] == 0.0 {
                continue;
            }
            let moved = if sum.pinned > 0 {
                sum.carried / sum.pinned as f32
            } else {
                sum.momentum / sum.mass
            };
            let place = members.start[index] + moved;
            farthest = farthest.max(place.distance(members.place[index]));
            members.place[index] = place;
            members.moved[index] = moved;
        }
        farthest
    }
}

/// How much two features lack of having a plane between them (m), if they do.
#[inline]
fn lack(pair: &Pair, members: &Members) -> Option<f32> {
    let distance = pair.nearest.distance;
    if distance <= MET {
        return None;
    }
    let wanted = (LEFT_OF_THICKNESS * pair.thickness).min(LEFT_OF_DISTANCE * distance);
    let left = pair.clearance(members.places(pair.members));
    // NaN is no lack.
    (left < wanted).then_some(2.0 * wanted - left)
}

/// Pushes those two particles apart, one of each feature, that are farthest beyond the plane. Returns how far (m).
fn part(pair: &Pair, lack: f32, members: &mut Members) -> f32 {
    let normal = pair.nearest.normal;
    let along = members.places(pair.members).map(|place| normal.dot(place));
    let first = (0..pair.split).min_by(|&a, &b| along[a].total_cmp(&along[b]));
    let second = (pair.split..4).max_by(|&a, &b| along[a].total_cmp(&along[b]));
    let (Some(first), Some(second)) = (first, second) else {
        return 0.0;
    };
    let [a, b] = [first, second].map(|index| pair.members[index] as usize);
    let [wa, wb] = [members.inverse_mass[a], members.inverse_mass[b]];
    let mobility = wa + wb;
    if mobility == 0.0 {
        return 0.0;
    }
    let push = normal * (lack / mobility);
    members.place[a] += push * wa;
    members.place[b] -= push * wb;
    let nearing = -normal.dot(members.moved[a] - members.moved[b]);
    if nearing > 0.0 {
        let stop = normal * (nearing / mobility);
        members.moved[a] += stop * wa;
        members.moved[b] -= stop * wb;
    }
    push.length() * wa.max(wb)
}
