//! The colliders that are read in a tick.

use bevy::transform::components::Transform;
use bevy::{
    ecs::{entity_disabling::Disabled, system::SystemParam},
    prelude::{
        Allow, Changed, ChildOf, Children, Entity, On, Or, Query, Remove, RemovedComponents,
        ResMut, Resource, With,
    },
};

use super::motion::ColliderMotion;
use crate::{contact::ClothCollider, plugin::authoring::ClothBody};

/// A change of a collider's own components.
type OwnChange = (
    With<ColliderMotion>,
    Or<(Changed<Transform>, Changed<ClothCollider>, Changed<ChildOf>)>,
);

/// A change of an entity with children. A disabled entity still has children, and carries them.
type ParentChange = (
    With<Children>,
    Or<(Changed<Transform>, Changed<ChildOf>)>,
    Allow<Disabled>,
);

/// Colliders that a parent may move.
type Carried = (With<ColliderMotion>, With<ChildOf>);

/// Colliders, and entities with children.
type Concerned = (Or<(With<ColliderMotion>, With<Children>)>, Allow<Disabled>);

/// The queries that tell which colliders have moved.
#[derive(SystemParam)]
pub(crate) struct Changes<'w, 's> {
    own: Query<'w, 's, Entity, OwnChange>,
    bodies: Query<'w, 's, Entity, (With<ColliderMotion>, With<ClothBody>)>,
    carried: Query<'w, 's, Entity, Carried>,
    changed_parents: Query<'w, 's, Entity, ParentChange>,
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
    children: Query<'w, 's, &'static Children, Allow<Disabled>>,
    changed: ResMut<'w, ChangedColliders>,
}

/// Colliders, and entities above colliders, that have lost a component since the last tick.
#[derive(Resource, Debug, Default)]
pub(crate) struct ChangedColliders(Vec<Entity>);

/// Removed components.
#[derive(SystemParam)]
pub(crate) struct Removals<'w, 's> {
    bodies: RemovedComponents<'w, 's, ClothBody>,
    parents: RemovedComponents<'w, 's, ChildOf>,
    places: RemovedComponents<'w, 's, Transform>,
    concerned: Query<'w, 's, (), Concerned>,
}

/// Notes the components that colliders have lost. It runs in each frame as well as in each tick, because Bevy forgets
/// removals after two frames, in which there may be no tick.
pub(crate) fn note_removals(mut removals: Removals, mut changed: ResMut<ChangedColliders>) {
    let removed = removals.bodies.read().chain(removals.parents.read());
    let removed = removed.chain(removals.places.read());
    let is_concerned = |entity: &Entity| removals.concerned.contains(*entity);
    changed.0.extend(removed.filter(is_concerned));
}

/// A collider that is enabled again is read, and does not move from its earlier place.
pub(crate) fn note_enabled(
    enabled: On<Remove, Disabled>,
    mut motions: Query<&mut ColliderMotion, Allow<Disabled>>,
    mut changed: ResMut<ChangedColliders>,
) {
    if let Ok(mut motion) = motions.get_mut(enabled.entity) {
        motion.stop();
        changed.0.push(enabled.entity);
    }
}

/// The colliders to read in a tick.
#[derive(Debug, Default)]
pub(crate) struct Awaited {
    /// Colliders to read now, each once.
    now: Vec<Entity>,
    /// Colliders in motion: in the next tick they may have arrived.
    moving: Vec<Entity>,
    /// Entities with children that have changed.
    above: Vec<Entity>,
}

impl Awaited {
    /// The colliders that moved in the last tick, or that have changed since, including changes of their ancestors.
    /// Also returns the list of colliders in motion, to fill for the next tick.
    pub fn find(&mut self, changes: &mut Changes) -> (&[Entity], &mut Vec<Entity>) {
        self.now.clear();
        self.now.append(&mut self.moving);
        self.now.extend(&changes.own);
        self.now.extend(&changes.bodies);
        self.now.extend_from_slice(&changes.changed.0);
        if !changes.carried.is_empty() {
            self.find_carried(changes);
        }
        if !changes.changed.0.is_empty() {
            changes.changed.0.clear();
        }
        self.now.sort_unstable();
        self.now.dedup();
        (&self.now, &mut self.moving)
    }

    /// Colliders below changed entities: found upwards from all colliders with a parent, or downwards from all changed
    /// entities, whichever are fewer. A skeleton's bones all change in each tick, and a level's nodes never do.
    fn find_carried(&mut self, changes: &Changes) {
        self.above.clear();
        self.above.extend(&changes.changed_parents);
        self.above.extend_from_slice(&changes.changed.0);
        if self.above.is_empty() {
            return;
        }
        if self.above.len() < changes.carried.iter().len() {
            while let Some(parent) = self.above.pop() {
                if let Ok(children) = changes.children.get(parent) {
                    self.now.extend(children);
                    self.above.extend(children);
                }
            }
            return;
        }
        self.above.sort_unstable();
        let has_changed = |entity: Entity| self.above.binary_search(&entity).is_ok();
        let carried = changes
            .carried
            .iter()
            .filter(|&collider| changes.parents.iter_ancestors(collider).any(has_changed));
        self.now.extend(carried);
    }
}
