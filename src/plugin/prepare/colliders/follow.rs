//! Follows the colliders that move.

use bevy::prelude::{Commands, Local, On, Query, Remove, Res, ResMut, Time};

use super::{
    changes::{Awaited, Changes},
    motion::ColliderMotion,
    tree::ColliderTree,
};
use crate::{
    contact::ClothCollider,
    plugin::{
        authoring::ClothBody,
        frame::Places,
        naming::Part,
        prepare::{roots::Roots, source::ColliderMeshes},
        state::ClothFault,
    },
};

/// The components of a collider. Disabled colliders are not read, since cloth does not touch them.
type Reading = (
    &'static ClothCollider,
    &'static mut ColliderMotion,
    Option<&'static ClothBody>,
    Option<&'static ClothFault>,
);

/// Follows the colliders that move, and notes where they are.
pub(crate) fn prepare_colliders(
    mut awaited: Local<Awaited>,
    mut changes: Changes,
    mut colliders: Query<Reading>,
    mut tree: ResMut<ColliderTree>,
    places: Places,
    mut meshes: ColliderMeshes,
    roots: Roots,
    time: Res<Time>,
    mut commands: Commands,
) {
    let time_passes = time.delta_secs() > 0.0;
    let (now, moving) = awaited.find(&mut changes);
    for &entity in now {
        let Ok((collider, mut motion, body, fault)) = colliders.get_mut(entity) else {
            continue;
        };
        let joint = meshes.joint(entity, collider);
        if roots.jumps(entity) || joint.is_some_and(|joint| roots.jumps(joint)) {
            motion.stop();
        }
        let outcome = motion.follow(collider, body, &places, &mut meshes, entity, time_passes);
        if outcome.is_err() {
            *motion = ColliderMotion::default();
        }
        tree.set(entity, motion.bounds);
        // A mesh asset has to be loaded, and may change.
        if motion.is_moving() || matches!(collider, ClothCollider::Mesh(_)) {
            moving.push(entity);
        }
        ClothFault::report(&mut commands, entity, fault, Part::Collider, outcome);
    }
}

/// Removes an entity that is no collider any more from the tree.
pub(crate) fn forget_collider(removed: On<Remove, ColliderMotion>, mut tree: ResMut<ColliderTree>) {
    tree.remove(removed.entity);
}
