//! Pins that follow other entities, and teleports.

use bevy::{
    ecs::{
        component::Component,
        entity::{Entity, EntityMapper, MapEntities},
        reflect::{ReflectComponent, ReflectMapEntities},
    },
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::Pin;

/// Pins of a cloth that follow other entities by their global transforms, moving smoothly over the sub-steps of a
/// tick: a flag on a pole that sways, a cape on shoulders.
///
/// Each particle keeps the offset that it has when it is attached; scaled and turned with its target. Attached
/// particles are pinned besides those of [`Pins`](crate::cloth::Pins). Move targets before
/// [`ClothSystems::Prepare`](super::ClothSystems). May change at any time: what is no longer attached is released. A
/// predicate is known by itself: set it again as a clone, since another one is another attachment. Before a target is
/// despawned take the attachment off, and the cloth falls; otherwise it stays where it is, with a fault.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn setup(mut commands: Commands) {
///     let pole = commands.spawn(Transform::from_xyz(0.0, 2.0, 0.0)).id();
///     commands.spawn((Cloth::default(), Pins::none(), ClothAttachments::new([(Pin::Column(0), pole)])));
///     // By name, as of a bone in a model.
///     let shoulders = ClothAttachments::new([(Pin::color(0, 0.5), "shoulders")]);
///     commands.spawn((Cloth::mesh(), shoulders));
/// }
/// ```
#[derive(Component, Reflect, MapEntities, Debug, Default, Clone, PartialEq)]
#[reflect(Component, MapEntities, Default, Debug, Clone, PartialEq)]
pub struct ClothAttachments(#[entities] Vec<ClothAttachment>);

/// A pin and the entity that it follows.
#[derive(Reflect, MapEntities, Debug, Default, Clone, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothAttachment {
    /// The particles.
    pub pin: Pin,
    /// What they follow.
    #[entities]
    pub target: ClothTarget,
}

/// What pins follow.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothTarget {
    /// An entity.
    Entity(Entity),
    /// The entity of this `Name`, as a scene or a modelling program gave it; of several the one that was
    /// spawned first. While there is none the cloth stands still, with a fault.
    Named(String),
}

impl Default for ClothTarget {
    /// What has an empty `Name`: nothing, as long as nobody says what.
    fn default() -> Self {
        Self::Named(String::new())
    }
}

impl MapEntities for ClothTarget {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        if let Self::Entity(entity) = self {
            *entity = mapper.get_mapped(*entity);
        }
    }
}

impl From<Entity> for ClothTarget {
    fn from(entity: Entity) -> Self {
        Self::Entity(entity)
    }
}

impl From<&str> for ClothTarget {
    fn from(name: &str) -> Self {
        Self::Named(name.into())
    }
}

impl From<String> for ClothTarget {
    fn from(name: String) -> Self {
        Self::Named(name)
    }
}

impl ClothAttachments {
    /// Each pin's particles follow its entity, or the one of a name.
    pub fn new<T: Into<ClothTarget>>(attachments: impl IntoIterator<Item = (Pin, T)>) -> Self {
        let attach = |(pin, target): (Pin, T)| ClothAttachment {
            pin,
            target: target.into(),
        };
        Self(attachments.into_iter().map(attach).collect())
    }

    /// What is attached to what.
    pub(super) fn as_slice(&self) -> &[ClothAttachment] {
        &self.0
    }

    /// What is attached to what.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &ClothAttachment> {
        self.0.iter()
    }
}

/// Insert this beside a new transform to have a cloth be there at once: it keeps its shape and its velocities, as
/// seen from its entity, from its first attachment's target where it has one, or particle by particle from the pose of a
/// skeleton that it [follows](crate::cloth::ClothSkin), and gets none from the jump.
///
/// On any other entity, as a character, it takes along all cloths and colliders below that, and cloths whose first attachment's
/// target is below: none gets a speed from the jump. [`ClothInertia`](super::ClothInertia) does so by itself.
/// Taken away in the next tick.
///
/// Without it a jump drags the cloth along by its pins. The log names a cloth whose pins jump by more than 2 m in a tick, once.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothTeleport;

/// A particle that follows an entity.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Attached {
    pub particle: u32,
    /// Which attachment it belongs to.
    pub attachment: usize,
    /// Where it is in the target's own frame.
    pub offset: Vec3,
}
