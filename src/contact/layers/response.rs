//! Keeps layers apart at the end of a sub-step.

use bevy::math::Vec3A;

use super::{
    contacts::Contacts,
    members::Members,
    pair::{NearPair, Nearest},
};
use crate::cloth::MapInline;

/// Number of times that overlapping pairs are pushed in a sub-step: the weight of a pile has to reach the floor through
/// its layers. With 1, ten sheets shake each other by so much that friction does not hold them.
const PASSES: usize = 3;

/// Fraction of an older overlap that is released in a pass, and the largest release speed (m/s). It counts as motion: in
/// a pile it carries the layers above.
const RELEASED: f32 = 0.5;
const RELEASE: f32 = 0.25;

/// Tolerated overlap of touching layers, as a fraction of their thickness: within it they are stopped, but not pushed.
/// So resting layers stay in contact while they tremble by less.
const RESTING: f32 = 0.02;

/// Tolerated rest of older overlaps, as a fraction of their thickness.
const LEFT: f32 = 0.04;

/// Fraction of the thickness that is restored at once, in the same sub-step.
const KEPT: f32 = 0.3;

/// At last, pairs are pushed again that are still nearer than this fraction of their thickness.
const AGAIN: f32 = 0.5;

/// Number of interleaved groups of pairs: neighbouring pairs share particles, and would have to wait for each other.
const APART: usize = 4;

/// Smallest fraction of a pair's mobility that colliders must leave.
const LEAST_FREE: f32 = 0.01;

/// Pushes near pairs apart. Lists those that overlap by more than layers at rest. Returns how many touched.
pub(super) fn push(contacts: &mut Contacts, members: &mut Members, dt: f32) -> u32 {
    let Contacts {
        pairs, overlapping, ..
    } = contacts;
    overlapping.clear();
    let mut touched = 0;
    let part = pairs.len().div_ceil(APART);
    let order = (0..part).flat_map(|first| (first..pairs.len()).step_by(part));
    for index in order {
        let pair = &pairs[index];
        if pair.is_pushed
            && let Some(gap) = push_pair(pair, pair.thickness, members, dt)
        {
            touched += 1;
            if gap < (1.0 - LEFT) * pair.thickness {
                overlapping.push(index as u32);
            }
        }
    }
    let floors = (1..PASSES).map(|_| 1.0).chain([AGAIN]);
    for floor in floors {
        for &index in &*overlapping {
            let pair = &pairs[index as usize];
            push_pair(pair, floor * pair.thickness, members, dt);
        }
    }
    touched
}

/// Pushes two features apart that are nearer than `floor` (m), with Coulomb friction. Velocity loses the approach of
/// the sub-step; the release of an older overlap adds only a slow velocity. Returns their distance if they touch (m).
#[inline]
fn push_pair(pair: &NearPair, floor: f32, members: &mut Members, dt: f32) -> Option<f32> {
    let Nearest {
        weights, normal, ..
    } = pair.nearest;
    let combined = |[a, b, c, d]: [Vec3A; 4]| {
        a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
    };
    let states = members.states(pair.members);
    let between = combined(states.map_inline(|state| state.place));
    let gap = normal.dot(between);
    if gap >= floor || normal == Vec3A::ZERO {
        return None;
    }
    let mut free = 0.0;
    for (state, weight) in states.iter().zip(weights) {
        free += weight * weight * state.inverse_mass;
    }
    if free == 0.0 {
        return None;
    }
    // A particle with a collider behind it moves only along the collider's surface.
    let (mut along, mut mobility) = ([0.0; 4], free);
    if states.iter().any(|state| state.is_supported) {
        for (index, (state, weight)) in states.into_iter().zip(weights).enumerate() {
            let towards = normal.dot(state.support);
            if towards * weight < 0.0 {
                along[index] = towards;
                mobility -= weight * weight * state.inverse_mass * towards * towards;
            }
        }
        if mobility < LEAST_FREE * free {
            // Held from both sides.
            (along, mobility) = ([0.0; 4], free);
        }
    }
    let depth = pair.thickness - gap;
    // The approaching part of the displacement and of the velocity.
    let motion = combined(states.map_inline(|state| state.moved));
    let nearing = -normal.dot(motion);
    let start = combined(states.map_inline(|state| state.start));
    let came = (depth - RESTING * pair.thickness)
        .min(normal.dot(start) - gap)
        .max(0.0);
    let stopped = depth.min(nearing).max(0.0);
    let older = depth - LEFT * pair.thickness - came;
    let released = (RELEASED * older).clamp(0.0, RELEASE * dt);
    // It adds velocity only up to its own, else each sub-step would add to the last and throw layers apart.
    let added = (released + nearing.min(0.0)).max(0.0);
    let least = (KEPT * pair.thickness - gap - came - released).max(0.0);
    let pushed = (came + released + least) / mobility;
    let slowed = (stopped + added) / mobility;
    // Friction changes the velocity and the way in this sub-step alike: otherwise layers creep.
    let slid = motion - normal * normal.dot(motion);
    let (square, most) = (slid.length_squared(), pair.friction * (stopped + added));
    let grip = if square > most * most {
        most / square.sqrt()
    } else {
        1.0
    };
    let friction = slid * (-grip / free);
    let place = normal * pushed + friction;
    let moved = normal * slowed + friction;
    for (index, member) in pair.members.into_iter().enumerate() {
        let state = &mut members.states[member as usize];
        let (along, share) = (along[index], weights[index] * state.inverse_mass);
        let mut by = [place, moved];
        if along != 0.0 {
            by[0] -= state.support * (along * pushed);
            by[1] -= state.support * (along * slowed);
        }
        state.place += by[0] * share;
        state.moved += by[1] * share;
    }
    Some(gap)
}
