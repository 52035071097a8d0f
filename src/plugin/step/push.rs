//! Pushes of cloth on the bodies that it touches.

use bevy::prelude::{
    ChildOf, DetectChangesMut, Entity, Has, Local, Mut, Query, Res, Time, Transform, Vec3,
};

use crate::{
    contact::BodyChange,
    plugin::{
        authoring::{ClothBody, ClothOrder, ClothPush, Ordered},
        prepare::ColliderMotion,
        state::{ClothScratch, ClothState},
    },
};

/// The bodies that may be pushed. One without a collider or a transform is not: its push is zero.
type PushedBody = (
    Entity,
    &'static mut ClothPush,
    Option<&'static ClothBody>,
    Option<&'static mut ColliderMotion>,
    Option<&'static mut Transform>,
    Has<ChildOf>,
);

/// Sums the changes of each body's motion by all cloths, and moves the body by them. A body that several cloths push is
/// cut into equal parts, one for each cloth, which move on together.
pub(crate) fn push_bodies(
    cloths: Query<(Entity, Option<&ClothOrder>, &ClothScratch, &ClothState)>,
    mut bodies: Query<PushedBody>,
    time: Option<Res<Time>>,
    mut pushes: Local<Vec<(Ordered, Entity, [BodyChange; 2])>>,
    mut held: Local<Vec<Entity>>,
) {
    pushes.clear();
    held.clear();
    if bodies.is_empty() {
        return;
    }
    held.reserve(bodies.iter().len());
    for (cloth, order, scratch, state) in &cloths {
        // One that stands still by its level of detail is not prepared.
        if state.rest.is_asleep() && scratch.step.is_some() {
            let bodies = state.resting.on.iter().filter(|on| on.is_body());
            held.extend(bodies.map(|on| on.entity));
        }
        let cloth = (order.copied().unwrap_or_default(), cloth);
        let pushed = scratch.pushed.iter();
        pushes.extend(pushed.map(|&(body, change)| (cloth, body, change)));
    }
    held.sort_unstable();
    let seconds = time.map_or(0.0, |time| time.delta_secs());
    // A sum of floats is that of its order.
    pushes.sort_unstable_by_key(|(cloth, body, _)| (*cloth, *body));
    for (entity, mut push, body, motion, transform, is_child) in &mut bodies {
        let (Some(body), Some(mut motion), Some(mut transform)) = (body, motion, transform) else {
            push.set_if_neq(ClothPush::default());
            continue;
        };
        let of_this = pushes.iter().filter(|(_, pushed, _)| *pushed == entity);
        let count = of_this.clone().count() as u32;
        if count == 0 && !is_child && held.binary_search(&entity).is_ok() {
            hold(&mut push, &mut motion, &mut transform, (body, seconds));
            continue;
        }
        let sum = sum(of_this.map(|(_, _, change)| change), motion.cloths(), body);
        push.set_if_neq(ClothPush {
            velocity: sum.velocity,
            angular_velocity: sum.angular_velocity,
            is_held: false,
        });
        if count > 0 || motion.cloths() > 1 {
            motion.set_cloths(count);
        }
        if is_child {
            motion.unsettle();
            continue;
        }
        if sum.translation != Vec3::ZERO || sum.rotation != Vec3::ZERO {
            let (gone, turned) = motion.pushed(&sum, body);
            transform.translation += gone;
            transform.rotation = (turned * transform.rotation).normalize();
        }
        motion.note_stay(seconds);
    }
}

/// Holds a body that lies on sleeping cloth where it was before the tick. `seconds` is the length of that.
fn hold(
    push: &mut Mut<ClothPush>,
    motion: &mut ColliderMotion,
    transform: &mut Mut<Transform>,
    (body, seconds): (&ClothBody, f32),
) {
    let [mut velocity, mut angular_velocity] = [Vec3::ZERO; 2];
    if seconds > 0.0
        && let Some((back, place)) = motion.put_back()
    {
        velocity = body.free_translation(back[0] / seconds);
        angular_velocity = body.free_rotation(back[1] / seconds);
        (transform.translation, transform.rotation) = (place.translation.into(), place.rotation);
    }
    push.set_if_neq(ClothPush {
        velocity,
        angular_velocity,
        is_held: true,
    });
}

/// The total of changes by several cloths, each of which pushed a part of the body. Of a change, the second part comes from
/// what the body stands on, which stops all of it, through whichever cloth. Changes that are not finite count as zero.
fn sum<'a>(
    changes: impl Iterator<Item = &'a [BodyChange; 2]>,
    parts: u32,
    body: &ClothBody,
) -> BodyChange {
    let [mut pushed, mut held] = [BodyChange::default(); 2];
    let mut holding = 0.0_f32;
    for [change, by_ground] in changes {
        pushed = pushed.plus(change.plus(by_ground.times(-1.0)));
        held = held.plus(*by_ground);
        if *by_ground != BodyChange::default() {
            holding += 1.0;
        }
    }
    let sum = (pushed.times(1.0 / parts as f32)).plus(held.times(1.0 / holding.max(1.0)));
    if !sum.is_finite() {
        return BodyChange::default();
    }
    // To the last bit, which they lost on their way from the cloths' frames.
    BodyChange {
        velocity: body.free_translation(sum.velocity),
        angular_velocity: body.free_rotation(sum.angular_velocity),
        translation: sum.translation,
        rotation: body.free_rotation(sum.rotation),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One cloth whose change is no number does not move the body.
    #[test]
    fn what_is_no_number_moves_nothing() {
        let body = ClothBody::ball(1.0, 0.1);
        let fine = BodyChange {
            velocity: Vec3::X,
            ..BodyChange::default()
        };
        for bad in [f32::NAN, f32::INFINITY] {
            let bad = BodyChange {
                rotation: Vec3::new(0.0, bad, 0.0),
                ..fine
            };
            let none = BodyChange::default();
            let both = [[fine, none], [bad, none]];
            assert_eq!(sum(both.iter(), 2, &body), none);
            assert_eq!(sum([[fine, none]; 2].iter(), 2, &body), fine);
            // What two cloths hold is stopped once, by each alone or by both.
            assert_eq!(sum([[fine, fine]; 2].iter(), 1, &body), fine);
            assert_eq!(sum([[fine, fine]].iter(), 2, &body), fine);
        }
    }
}
