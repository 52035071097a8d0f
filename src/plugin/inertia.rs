//! How much of a character's motion its cloth feels, and teleports of whole characters.

use bevy::{
    ecs::{
        component::Component,
        entity::Entity,
        entity_disabling::Disabled,
        hierarchy::ChildOf,
        query::{Allow, With},
        reflect::ReflectComponent,
        resource::Resource,
        system::{Query, Res, ResMut, SystemParam},
    },
    math::{Isometry3d, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
    time::Time,
};

use super::{
    ClothFrame, ClothTeleport,
    frame::{Places, Shift, relative, rigid, unusable},
};
use crate::cloth::ClothError;

/// How strongly cloths below an entity in the hierarchy, or attached below it, feel its motion. Add it to a character,
/// so that a cape does not fly off a sprinting hero. Without it, cloths feel all of the motion.
///
/// The rest of the motion carries the cloths along as if they were one rigid body with the entity, without giving them
/// speed. With a share of 0.3, cloth behaves as on a wearer who accelerates at 0.3 of the rate. Colliders are met where
/// they are, at their speed relative to the carried cloth. The component applies to all cloths at and below the entity,
/// and to cloths whose first attachment's target is at or below it. If several apply, the nearest one counts.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn setup(mut commands: Commands) {
///     commands.spawn((Transform::default(), ClothInertia { linear: 0.3, angular: 0.5, ..default() }));
/// }
/// ```
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(RootMotion)]
pub struct ClothInertia {
    /// Share of its translation that cloth feels, from 0 to 1.
    pub linear: f32,
    /// Share of its rotation that cloth feels, from 0 to 1.
    pub angular: f32,
    /// A move of more than this in one tick (m) is a [`ClothTeleport`] instead of a motion. Positive; infinity for
    /// never.
    pub teleport_distance: f32,
    /// A rotation of more than this in one tick (rad) is a [`ClothTeleport`] too. Positive; π for never, as no rotation
    /// is larger.
    pub teleport_angle: f32,
}

impl Default for ClothInertia {
    /// Cloth feels all motion. A move of more than 2 m in a tick is a teleport; no rotation is.
    fn default() -> Self {
        Self {
            linear: 1.0,
            angular: 1.0,
            teleport_distance: 2.0,
            teleport_angle: std::f32::consts::PI,
        }
    }
}

impl ClothInertia {
    /// Cloth feels this share of translation and rotation, from 0 to 1.
    pub fn share(share: f32) -> Self {
        Self {
            linear: share,
            angular: share,
            ..Self::default()
        }
    }

    /// Checks that each value is in its range.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first value that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        for share in [self.linear, self.angular] {
            let is_share = |v: f32| (0.0..=1.0).contains(&v);
            ClothError::check(
                share,
                is_share,
                "the share of motion that is felt",
                "from 0 to 1",
            )?;
        }
        for (value, quantity) in [
            (self.teleport_distance, "the teleport distance (m)"),
            (self.teleport_angle, "the teleport angle (rad)"),
        ] {
            ClothError::check(value, |v| v > 0.0, quantity, "positive")?;
        }
        Ok(())
    }
}

/// How an entity with a [`ClothInertia`] has moved.
#[derive(Component, Debug, Default)]
pub(super) struct RootMotion {
    /// Where it was as the last tick ended.
    last: Option<Isometry3d>,
    /// The motion that carries cloths in this tick, if there is one; `error` says why there is none.
    carried: Option<Carried>,
    error: Option<ClothError>,
}

impl RootMotion {
    /// Where it was as the last tick ended.
    pub fn last(&self) -> Option<Isometry3d> {
        self.last
    }

    /// Shifts it with the world's origin; its entity is at `now`.
    pub fn shift(&mut self, shift: Shift, now: Option<Isometry3d>) {
        self.last = self.last.map(|last| shift.rigid(last, now));
    }

    /// Restores the place where it was, from a snapshot.
    pub fn recall(&mut self, last: Option<Isometry3d>) {
        self.last = last;
    }
}

/// The motion that carries a cloth along as a tick begins: that of a rigid body from one place in the world to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Carried {
    from: Isometry3d,
    to: Isometry3d,
}

impl Carried {
    /// Carries a place along as the tick begins. The result is as seen from a frame.
    pub fn seen_from(&self, frame: &ClothFrame, place: Isometry3d) -> Isometry3d {
        relative(frame.isometry(), self.to) * relative(self.from, place)
    }

    /// The transform that undoes this motion in a frame.
    #[cfg(feature = "mesh")]
    pub fn undone_in(&self, frame: &ClothFrame) -> Isometry3d {
        relative(frame.isometry(), self.from) * relative(self.to, frame.isometry())
    }
}

/// Entities that teleport in this tick, with everything below them.
#[derive(Resource, Debug, Default)]
pub(super) struct Jumped(Vec<Entity>);

/// Notes how far each root carries the cloths below it, and which roots teleport.
pub(super) fn follow_roots(
    mut roots: Query<(Entity, &ClothInertia, &mut RootMotion)>,
    marked: Query<Entity, With<ClothTeleport>>,
    places: Places,
    time: Res<Time>,
    mut jumped: ResMut<Jumped>,
) {
    jumped.0.clear();
    jumped.0.extend(&marked);
    for (entity, inertia, mut motion) in &mut roots {
        let place = places.of(entity).map(|place| rigid(&place.affine()));
        let checked = inertia.validate().and(place).and_then(|place| {
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
        let way = Vec3::from(place.translation - last.translation);
        let turn = last.rotation.angle_between(place.rotation);
        if way.length() > inertia.teleport_distance || turn > inertia.teleport_angle {
            jumped.0.push(entity);
        } else if last != place && (inertia.linear < 1.0 || inertia.angular < 1.0) {
            let rotation = last.rotation.slerp(place.rotation, 1.0 - inertia.angular);
            motion.carried = Some(Carried {
                from: last,
                to: Isometry3d::new(
                    Vec3::from(last.translation) + way * (1.0 - inertia.linear),
                    rotation,
                ),
            });
        }
    }
}

/// The roots that carry cloths, and those that teleport.
#[derive(SystemParam)]
pub(super) struct Roots<'w, 's> {
    roots: Query<'w, 's, &'static RootMotion>,
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
    jumped: Res<'w, Jumped>,
}

impl Roots<'_, '_> {
    /// Whether an entity, or one above it, teleports.
    pub fn jumps(&self, entity: Entity) -> bool {
        let has_jumped = |entity: Entity| self.jumped.0.contains(&entity);
        !self.jumped.0.is_empty()
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
