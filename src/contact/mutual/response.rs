//! What keeps layers apart at the end of a sub-step.

use bevy::math::Vec3;

use super::{
    members::Members,
    pair::{Nearest, Pair},
};

/// How fast layers that were too near each other as the sub-step began part again, at most (m/s). So much is motion: in a pile it is
/// what carries those above.
const RELEASE: f32 = 0.25;

/// Of the thickness, what is always kept of it at once: so much no sub-step may leave for the next.
const KEPT: f32 = 0.3;

/// Pairs that touched are gone through once more where they are still nearer than this part of their thickness.
const AGAIN: f32 = 0.5;

/// Keeps those that are `near` apart. Returns the farthest that a particle was pushed by one of them (m).
pub(super) fn push(
    pairs: &[Pair],
    near: &[u32],
    touched: &mut Vec<u32>,
    members: &mut Members,
    dt: f32,
) -> f32 {
    let mut farthest = 0.0_f32;
    touched.clear();
    for &index in near {
        let pair = &pairs[index as usize];
        if let Some(pushed) = push_pair(pair, pair.thickness, members, dt) {
            farthest = farthest.max(pushed);
            touched.push(index);
        }
    }
    for &index in &*touched {
        let pair = &pairs[index as usize];
        if let Some(pushed) = push_pair(pair, AGAIN * pair.thickness, members, dt) {
            farthest = farthest.max(pushed);
        }
    }
    farthest
}

/// Pushes two features apart that are nearer than `floor` (m), and slows them against each other by Coulomb's law. What both came
/// towards each other in the sub-step is what velocity has to lose; an older overlap gives no more of it than is slow. Returns how
/// far a particle was pushed at most (m), if they touch.
#[inline]
fn push_pair(pair: &Pair, floor: f32, members: &mut Members, dt: f32) -> Option<f32> {
    let Nearest {
        weights, normal, ..
    } = pair.nearest;
    let between = pair.nearest.between(members.places(pair.members));
    let gap = normal.dot(between);
    if gap >= floor || normal == Vec3::ZERO {
        return None;
    }
    let inverse_masses = members.inverse_masses(pair.members);
    let mobility: f32 = (0..4)
        .map(|index| weights[index] * weights[index] * inverse_masses[index])
        .sum();
    if mobility == 0.0 {
        return None;
    }
    let depth = pair.thickness - gap;
    // Of the way, and of velocity, what brought them nearer.
    let nearing = -normal.dot(pair.nearest.between(members.motions(pair.members)));
    let start = pair.nearest.between(members.starts(pair.members));
    let [came, stopped] =
        [normal.dot(start) - gap, nearing].map(|nearer| depth.min(nearer).max(0.0));
    let released = (depth - came).min(RELEASE * dt);
    let least = (KEPT * pair.thickness - gap - came - released).max(0.0);
    let slid = between - start;
    let tangential = slid - normal * normal.dot(slid);
    let (slip, most) = (tangential.length(), pair.friction * (came + released));
    let grip = if slip > most { most / slip } else { 1.0 };
    let held = tangential * (-grip / mobility);
    let motion = normal * ((stopped + released) / mobility) + held;
    let all = normal * ((came + released + least) / mobility) + held;
    let mut farthest = 0.0_f32;
    for index in 0..4 {
        let member = pair.members[index] as usize;
        let share = weights[index] * inverse_masses[index];
        members.place[member] += all * share;
        members.moved[member] += motion * share;
        farthest = farthest.max(share.abs());
    }
    Some(farthest * all.length())
}
