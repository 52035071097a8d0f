//! Colliders on the bones of a character.

use bevy::prelude::{Component, Entity, Reflect, ReflectComponent, ReflectDefault};

/// Colliders on the bones of a skeleton below this entity, one line for each. Add it to a character's entity; its scene
/// need not have been spawned yet. Bones are found by their `Name`s as soon as they exist, and again when the scene is
/// spawned again. Each collider becomes a child of its bone.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn hero(mut commands: Commands) {
///     commands.spawn((
///         Transform::default(),
///         ClothBones::new([
///             ClothBone::ball("head", 0.12),
///             ClothBone::capsule("hips", "neck", 0.16),
///             ClothBone::capsule("thigh.L", "shin.L", 0.09),
///         ]),
///     ));
/// }
/// ```
#[derive(Component, Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(BoneColliders)]
pub struct ClothBones(Vec<ClothBone>);

/// A ball around a bone's head, or a capsule from there to the head of another bone.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothBone {
    /// `Name` of the bone; the collider becomes its child.
    pub bone: String,
    /// `Name` of the bone where a capsule ends; `None` for a ball.
    pub end: Option<String>,
    /// Radius (m) in the world, whatever the scale of the bone is when it is found.
    pub radius: f32,
}

impl Default for ClothBone {
    /// A ball of 0.1 m around a bone with an empty `Name`, which matches nothing until you set it.
    fn default() -> Self {
        Self::ball("", 0.1)
    }
}

impl ClothBone {
    /// A ball with a radius (m) around a bone's head.
    pub fn ball(bone: impl Into<String>, radius: f32) -> Self {
        Self {
            bone: bone.into(),
            end: None,
            radius,
        }
    }

    /// A capsule with a radius (m) from a bone's head to that of another bone, usually its child. It moves with the
    /// first bone.
    pub fn capsule(bone: impl Into<String>, end: impl Into<String>, radius: f32) -> Self {
        Self {
            end: Some(end.into()),
            ..Self::ball(bone, radius)
        }
    }
}

impl ClothBones {
    /// Makes a collider for each of these bones.
    pub fn new(bones: impl IntoIterator<Item = ClothBone>) -> Self {
        Self(bones.into_iter().collect())
    }

    /// All bones with their colliders.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &ClothBone> {
        self.0.iter()
    }
}

/// The colliders that were made of a [`ClothBones`].
#[derive(Component, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct BoneColliders {
    pub all: Vec<Entity>,
    /// Whether names were missing when they were looked for.
    pub waits: bool,
}

/// On such a collider: the entity with the [`ClothBones`]. Reflected and mapped, so that a collider in a scene, or one
/// that was cloned with its skeleton, is recognised and replaced.
#[derive(Component, Reflect, Debug, Clone, Copy)]
#[type_path = "bevy_drape"]
#[reflect(Component)]
pub(crate) struct BoneColliderOf(#[entities] pub Entity);
