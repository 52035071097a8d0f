//! The motion of characters in a tick, and their teleports.

use bevy::{
    ecs::{entity_disabling::Disabled, system::SystemParam},
    prelude::{Allow, ChildOf, Entity, Isometry3d, Query, Res, ResMut, Resource, Time, Vec3, With},
};

use crate::{
    cloth::ClothError,
    plugin::{
        authoring::{Carried, ClothInertia, ClothTeleport, RootMotion},
        frame::{Places, rigid, unusable},
    },
};

/// Entities that teleport in this tick, with everything below them.
#[derive(Resource, Debug, Default)]
pub(crate) struct Teleporting(Vec<Entity>);

/// Notes how far each root carries the cloths below it, and which roots teleport.
pub(crate) fn follow_roots(
    mut roots: Query<(Entity, &ClothInertia, &mut RootMotion)>,
    marked: Query<Entity, With<ClothTeleport>>,
    places: Places,
    time: Res<Time>,
    mut teleporting: ResMut<Teleporting>,
) {
    teleporting.0.clear();
    teleporting.0.extend(&marked);
    for (entity, inertia, mut motion) in &mut roots {
        let checked = inertia.validate().map_err(ClothError::from).and_then(|()| {
            let place = rigid(&places.of(entity)?.affine());
            let is_finite = place.translation.is_finite() && place.rotation.is_finite();
            is_finite.then_some(place).ok_or_else(|| unusable(place))
        });
        motion.carried = None;
        let place = match checked {
            Ok(place) => place,
            Err(error) => {
                motion.error = Some(error);
                motion.last = None;
                continue;
            }
        };
        motion.error = None;
        // If it is moved while no time passes, the motion counts in the next tick with time.
        let last = *motion.last.get_or_insert(place);
        if time.delta_secs() == 0.0 {
            continue;
        }
        motion.last = Some(place);
        let displacement = Vec3::from(place.translation - last.translation);
        let turn = last.rotation.angle_between(place.rotation);
        if displacement.length() > inertia.teleport_distance || turn > inertia.teleport_angle {
            teleporting.0.push(entity);
        } else if last != place && (inertia.linear < 1.0 || inertia.angular < 1.0) {
            let rotation = last.rotation.slerp(place.rotation, 1.0 - inertia.angular);
            motion.carried = Some(Carried {
                from: last,
                to: Isometry3d::new(
                    Vec3::from(last.translation) + displacement * (1.0 - inertia.linear),
                    rotation,
                ),
            });
        }
    }
}

/// The roots that carry cloths, and those that teleport.
#[derive(SystemParam)]
pub(crate) struct Roots<'w, 's> {
    roots: Query<'w, 's, &'static RootMotion>,
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
    teleporting: Res<'w, Teleporting>,
}

impl Roots<'_, '_> {
    /// Whether an entity, or one above it, teleports.
    pub fn jumps(&self, entity: Entity) -> bool {
        let has_jumped = |entity: Entity| self.teleporting.0.contains(&entity);
        !self.teleporting.0.is_empty()
            && (has_jumped(entity) || self.parents.iter_ancestors(entity).any(has_jumped))
    }

    /// The motion that carries a cloth, which may be attached to an entity.
    ///
    /// # Errors
    /// The error of its root.
    pub fn carry(
        &self,
        cloth: Entity,
        target: Option<Entity>,
    ) -> Result<Option<Carried>, ClothError> {
        if self.roots.is_empty() {
            return Ok(None);
        }
        let above = |entity: Entity| {
            let all = std::iter::once(entity).chain(self.parents.iter_ancestors(entity));
            all.filter_map(|entity| self.roots.get(entity).ok()).next()
        };
        let root = above(cloth).or_else(|| above(target?));
        match root {
            Some(RootMotion {
                error: Some(error), ..
            }) => Err(error.clone()),
            root => Ok(root.and_then(|root| root.carried)),
        }
    }
}
