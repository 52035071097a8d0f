//! Which of all pairs have to be looked at in a sub-step, and which of these may be left out.

use super::{
    certificate::LEFT_OF_THICKNESS,
    members::Members,
    pair::{NOBODY, Nearest, Pair, VERTEX_AND_FACE},
};

/// By how much of the smallest thickness particles may come nearer to each other before all pairs are gone through again.
const SLACK: f32 = 0.25;

/// Pairs that are near each other, until particles have come nearer to each other by a little. What is done to them in a sub-step
/// follows from where that began and ended alone, whatever was known before.
#[derive(Debug, Default, Clone)]
pub(super) struct NearPairs {
    listed: Vec<u32>,
    /// Those that may come nearer to each other than their thickness.
    pub pushed: Vec<u32>,
    /// Those of the first that did, in the last sub-step.
    pub touched: Vec<u32>,
    /// Those that might meet, as far as distances say.
    pub certified: Vec<u32>,
    /// Until the odometer says this (m), no others are near.
    until: f32,
    is_known: bool,
}

impl NearPairs {
    /// Forgets them: the pairs are others.
    pub fn forget(&mut self) {
        self.listed.clear();
        self.pushed.clear();
        self.certified.clear();
        self.is_known = false;
    }

    pub fn is_empty(&self) -> bool {
        self.pushed.is_empty() && self.certified.is_empty()
    }

    /// Whether they are still all that are near when the odometer says this (m).
    pub fn covers(&self, odometer: f32) -> bool {
        self.is_known && odometer <= self.until
    }

    /// Finds those that may touch in the sub-step, with their nearest points where it began. In it any two particles have come nearer
    /// to each other by at most `approach` (m), and the `odometer` says so already. The last pair of each vertex with a face begins
    /// its list.
    pub fn update(
        &mut self,
        pairs: &mut [Pair],
        members: &Members,
        last_of: &[u32],
        approach: f32,
        odometer: f32,
    ) {
        if !self.covers(odometer) {
            self.list(pairs, members, approach, odometer);
        }
        self.pushed.clear();
        self.certified.clear();
        for &index in &self.listed {
            let pair = &mut pairs[index as usize];
            let [before, now] = members.travelled(pair.members);
            pair.is_near = false;
            if pair.far_until > now {
                continue;
            }
            pair.nearest = Nearest::of(pair.split, members.starts(pair.members));
            pair.far_until = before + pair.nearest.distance - pair.thickness;
            if pair.far_until > now {
                continue;
            }
            pair.is_near = true;
            self.pushed.push(index);
            if pair.far_until + (1.0 - LEFT_OF_THICKNESS) * pair.thickness <= now {
                self.certified.push(index);
            }
        }
        let pairs = &*pairs;
        self.pushed.retain(|&index| {
            let pair = &pairs[index as usize];
            if pair.split == VERTEX_AND_FACE {
                !is_implied(pairs, last_of[pair.members[0] as usize], index)
            } else {
                // Ends of edges are vertices, which are kept away from faces by more.
                let mut weights = pair.nearest.weights.iter();
                weights.all(|weight| weight.abs() > 0.0 && weight.abs() < 1.0)
            }
        });
    }

    /// Goes through all pairs for those that may touch before particles have come nearer to each other by a little.
    fn list(&mut self, pairs: &[Pair], members: &Members, approach: f32, odometer: f32) {
        self.forget();
        self.is_known = true;
        let thinnest = pairs
            .iter()
            .map(|pair| pair.thickness)
            .fold(f32::INFINITY, f32::min);
        let slack = (SLACK * thinnest).max(0.5 * approach);
        self.until = odometer + slack;
        // Each of four particles travels half as far as two come nearer to each other.
        let ahead = 2.0 * slack;
        for (index, pair) in pairs.iter().enumerate() {
            let [_, now] = members.travelled(pair.members);
            if pair.far_until <= now + ahead {
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
