//! What keeps layers apart at the end of a sub-step.

use bevy::math::Vec3A;

use super::{members::Members, pair::NearPair};

/// How fast layers that were too near each other as the sub-step began part again, at most (m/s). So much is motion: in a pile it is
/// what carries those above.
const RELEASE: f32 = 0.25;

/// Of the thickness, what is always kept of it at once: so much no sub-step may leave for the next.
const KEPT: f32 = 0.3;

/// Pairs that touched are gone through once more where they are still nearer than this part of their thickness.
const AGAIN: f32 = 0.5;

/// Of the mobility of a pair, what colliders have to leave of it.
const LEAST_FREE: f32 = 0.01;

/// Keeps those that are near each other apart, and lists those that touched.
pub(super) fn push(pairs: &[NearPair], touched: &mut Vec<u32>, members: &mut Members, dt: f32) {
    touched.clear();
    for (index, pair) in pairs.iter().enumerate() {
        if pair.is_pushed && push_pair(pair, pair.thickness, members, dt) {
            touched.push(index as u32);
        }
    }
    for &index in &*touched {
        let pair = &pairs[index as usize];
        push_pair(pair, AGAIN * pair.thickness, members, dt);
    }
}

/// Pushes two features apart that are nearer than `floor` (m), and slows them against each other by Coulomb's law. What both came
/// towards each other in the sub-step is what velocity has to lose; an older overlap gives no more of it than is slow. Returns
/// whether they touch.
#[inline]
fn push_pair(pair: &NearPair, floor: f32, members: &mut Members, dt: f32) -> bool {
    let NearPair {
        weights, normal, ..
    } = *pair;
    let combined = |[a, b, c, d]: [Vec3A; 4]| {
        a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
    };
    let states = members.states(pair.members);
    let between = combined(states.map(|state| state.place));
    let gap = normal.dot(between);
    if gap >= floor || normal == Vec3A::ZERO {
        return false;
    }
    // What a collider holds from behind moves along its surface alone.
    let mut ways = [normal; 4];
    let (mut mobility, mut free) = (0.0, 0.0);
    for ((way, state), weight) in ways.iter_mut().zip(states).zip(weights) {
        let share = weight * weight * state.inverse_mass;
        let towards = normal.dot(state.support);
        let along = if towards * weight < 0.0 { towards } else { 0.0 };
        *way -= state.support * along;
        mobility += share * (1.0 - along * along);
        free += share;
    }
    if free == 0.0 {
        return false;
    }
    if mobility < LEAST_FREE * free {
        // Held from both sides.
        (ways, mobility) = ([normal; 4], free);
    }
    let depth = pair.thickness - gap;
    // Of the way, and of velocity, what brought them nearer.
    let motion = combined(states.map(|state| state.moved));
    let nearing = -normal.dot(motion);
    let start = combined(states.map(|state| state.start));
    let [came, stopped] =
        [normal.dot(start) - gap, nearing].map(|nearer| depth.min(nearer).max(0.0));
    let released = (depth - came).min(RELEASE * dt);
    let least = (KEPT * pair.thickness - gap - came - released).max(0.0);
    let held = |slid: Vec3A, pressed: f32| {
        let tangential = slid - normal * normal.dot(slid);
        let (slip, most) = (tangential.length(), pair.friction * pressed);
        let grip = if slip > most { most / slip } else { 1.0 };
        tangential * (-grip / free)
    };
    let held_place = held(between - start, came + released);
    let held_motion = held(motion, stopped + released);
    let pushed = (came + released + least) / mobility;
    let slowed = (stopped + released) / mobility;
    for ((member, way), weight) in pair.members.into_iter().zip(ways).zip(weights) {
        let state = &mut members.states[member as usize];
        let share = weight * state.inverse_mass;
        state.place += (way * pushed + held_place) * share;
        state.moved += (way * slowed + held_motion) * share;
    }
    true
}
