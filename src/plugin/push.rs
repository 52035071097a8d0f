//! What cloth does to the bodies that it touches.

use bevy::{
    ecs::{
        entity::Entity,
        hierarchy::ChildOf,
        query::Has,
        system::{Local, Query},
    },
    math::{Isometry3d, Quat, Vec3},
    transform::components::Transform,
};

use super::{ClothPush, ClothScratch, colliders::ColliderMotion};
use crate::contact::BodyChange;

/// Sums what all cloths have changed of each body's motion, and moves it to where they left it. What several cloths push is cut
/// into equal parts, one for each, which go on together.
pub(super) fn push_bodies(
    cloths: Query<&ClothScratch>,
    mut bodies: Query<(
        Entity,
        &mut ClothPush,
        &mut ColliderMotion,
        &mut Transform,
        Has<ChildOf>,
    )>,
    mut pushes: Local<Vec<(Entity, BodyChange)>>,
) {
    pushes.clear();
    if bodies.is_empty() {
        return;
    }
    let pushed = cloths.iter().flat_map(|scratch| &scratch.pushed);
    pushes.extend(pushed.copied());
    for (entity, mut push, mut motion, mut transform, is_child) in &mut bodies {
        let parts = motion.cloths() as f32;
        let (mut sum, mut count) = (BodyChange::default(), 0);
        for (_, change) in pushes.iter().filter(|(pushed, _)| *pushed == entity) {
            sum.velocity += change.velocity / parts;
            sum.angular_velocity += change.angular_velocity / parts;
            sum.translation += change.translation / parts;
            sum.rotation += change.rotation / parts;
            count += 1;
        }
        let new = ClothPush {
            velocity: sum.velocity,
            angular_velocity: sum.angular_velocity,
        };
        if *push != new {
            *push = new;
        }
        let is_moved = !is_child && (sum.translation != Vec3::ZERO || sum.rotation != Vec3::ZERO);
        if count == 0 && motion.cloths() == 1 {
            continue;
        }
        motion.pushed(count, |pose: &mut Isometry3d| {
            if is_moved {
                let turned = Quat::from_scaled_axis(sum.rotation);
                transform.translation += sum.translation;
                transform.rotation = (turned * transform.rotation).normalize();
                *pose = Isometry3d::new(transform.translation, transform.rotation);
            }
        });
    }
}
