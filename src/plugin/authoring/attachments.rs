//! Pins that follow other entities, and teleports.

use bevy::{
    ecs::{entity::MapEntities, reflect::ReflectMapEntities},
    prelude::{Component, Entity, Reflect, ReflectComponent, ReflectDefault, Vec3},
};

use crate::cloth::Pin;

/// Pins of a cloth that follow other entities by their global transforms: a flag on a swaying pole, a cape on
/// shoulders. They move smoothly over the sub-steps of a tick.
///
/// Each attached particle keeps the offset from its target that it has when it is attached, scaled and rotated with the
/// target. Attached particles are pinned in addition to those of [`Pins`](crate::cloth::Pins). Move targets before
/// [`ClothSystems::Prepare`](crate::plugin::ClothSystems). The component may change at any time: the plugin releases what is no
/// longer attached. Remove an attachment before its target is despawned, and the cloth falls. Otherwise the cloth stops
/// where it is, with a [`ClothFault`](crate::plugin::ClothFault).
///
/// A predicate (a closure) is compared by identity: clone it when you set the component again, because another closure
/// counts as another attachment.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn setup(mut commands: Commands) {
///     let pole = commands.spawn(Transform::from_xyz(0.0, 2.0, 0.0)).id();
///     commands.spawn((Cloth::default(), Pins::none(), ClothAttachments::new([(Pin::Column(0), pole)])));
///     // By name, such as that of a bone in a model.
///     let shoulders = ClothAttachments::new([(Pin::color(0, 0.5), "shoulders")]);
///     commands.spawn((Cloth::mesh(), shoulders));
/// }
/// ```
#[derive(Component, Reflect, MapEntities, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, MapEntities, Default, Debug, Clone, PartialEq)]
pub struct ClothAttachments(#[entities] Vec<ClothAttachment>);

/// A pin and the entity that it follows.
#[derive(Reflect, MapEntities, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothAttachment {
    /// The particles.
    pub pin: Pin,
    /// The entity that they follow.
    #[entities]
    pub target: ClothTarget,
}

/// The entity that pins follow, or the cloth of a side of a [`ClothSeam`](crate::plugin::ClothSeam).
#[derive(Reflect, MapEntities, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothTarget {
    /// An entity.
    Entity(#[entities] Entity),
    /// The entity with this `Name`, for instance from a scene or a modelling program. If several have it, it is the one
    /// that has the nearest common ancestor with the cloth or the seam. So each copy of a character finds its own. Among
    /// equals it is the one with the lowest generation and index. Once found, it stays the same one while it has the name, whatever comes later.
    /// While there is none, the cloth stands still, with a fault; a seam has the fault itself.
    Named(String),
}

impl Default for ClothTarget {
    /// An empty `Name`, which matches nothing until you set it.
    fn default() -> Self {
        Self::Named(String::new())
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
    /// Attaches the particles of each pin to an entity, given by its id or by its `Name`.
    pub fn new<T: Into<ClothTarget>>(attachments: impl IntoIterator<Item = (Pin, T)>) -> Self {
        let attach = |(pin, target): (Pin, T)| ClothAttachment {
            pin,
            target: target.into(),
        };
        Self(attachments.into_iter().map(attach).collect())
    }

    /// Attaches the particles of one more pin to an entity.
    pub fn attach(&mut self, pin: Pin, target: impl Into<ClothTarget>) {
        let target = target.into();
        self.0.push(ClothAttachment { pin, target });
    }

    /// Detaches all particles that are attached to this target. Give its ID or its `Name`, as when you attached them.
    pub fn detach(&mut self, target: impl Into<ClothTarget>) {
        let target = target.into();
        self.0.retain(|each| each.target != target);
    }

    /// Whether anything is attached to an entity, given by its ID.
    pub(crate) fn has_target(&self, target: Entity) -> bool {
        let target = ClothTarget::Entity(target);
        self.0.iter().any(|each| each.target == target)
    }

    /// The attachments.
    pub(crate) fn as_slice(&self) -> &[ClothAttachment] {
        &self.0
    }

    /// The attachments.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &ClothAttachment> {
        self.0.iter()
    }
}

/// Moves a cloth instantly: insert it together with a new transform. The cloth keeps its shape and its velocities, and
/// gains no speed from the jump. Both are kept as seen from its entity, or from the target of its first attachment if
/// it has one. A cloth that [follows](crate::cloth::ClothSkin) a skeleton keeps them particle by particle, as seen from
/// the pose.
///
/// On any other entity, such as a character, it also moves all cloths and colliders below that entity in the hierarchy,
/// and cloths whose first attachment's target is below it. None of them gains speed from the jump.
/// [`ClothInertia`](crate::plugin::ClothInertia) does the same automatically when its entity jumps. The plugin removes the
/// component in the next tick.
///
/// Without it a jump drags the cloth along by its pins. The log names a cloth whose pins jump by more than 2 m in a
/// tick, once.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothTeleport;

/// A particle that follows an entity.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Attached {
    pub particle: u32,
    /// The index of its attachment.
    pub attachment: usize,
    /// Where it is in the target's own frame.
    pub offset: Vec3,
}
