//! Colliders on the bones of a character.

use bevy::{
    ecs::{
        change_detection::{DetectChanges, Ref},
        component::Component,
        entity::Entity,
        entity_disabling::Disabled,
        hierarchy::{ChildOf, Children},
        lifecycle::Remove,
        name::Name,
        observer::On,
        query::{Allow, Changed, Or},
        reflect::ReflectComponent,
        system::{Commands, Query},
    },
    math::{Quat, Vec3},
    platform::collections::HashMap,
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::components::{GlobalTransform, Transform},
};

use super::{
    ClothFault,
    frame::{Places, unusable},
    naming::Part,
};
use crate::{cloth::ClothError, contact::ClothCollider};

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
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(BoneColliders)]
pub struct ClothBones(Vec<ClothBone>);

/// A ball around a bone's head, or a capsule from there to the head of another bone.
#[derive(Reflect, Debug, Clone, PartialEq)]
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
pub(super) struct BoneColliders {
    all: Vec<Entity>,
    /// Whether names were missing when they were looked for.
    waits: bool,
}

/// On such a collider: the entity with the [`ClothBones`]. Reflected and mapped, so that a collider in a scene, or one
/// that was cloned with its skeleton, is recognised and replaced.
#[derive(Component, Reflect, Debug, Clone, Copy)]
#[reflect(Component)]
pub(super) struct BoneColliderOf(#[entities] Entity);

type Owners<'w, 's> = Query<'w, 's, (Entity, &'static BoneColliderOf), Allow<Disabled>>;

/// Despawns the colliders of a skeleton.
fn despawn_colliders(skeleton: Entity, owners: &Owners, commands: &mut Commands) {
    for (collider, of) in owners {
        if of.0 == skeleton {
            commands.entity(collider).try_despawn();
        }
    }
}

/// Makes the colliders of bones that have been found, or found again.
pub(super) fn make_bone_colliders(
    mut all: Query<(
        Entity,
        Ref<ClothBones>,
        &mut BoneColliders,
        Option<&ClothFault>,
    )>,
    living: Query<(), Allow<Disabled>>,
    named: Query<(Option<&Name>, Option<&Children>), Allow<Disabled>>,
    renamed: Query<(), (Or<(Changed<Name>, Changed<Children>)>, Allow<Disabled>)>,
    owners: Owners,
    places: Places,
    mut commands: Commands,
) {
    for (entity, bones, mut made, fault) in &mut all {
        let are_there = made.all.len() == bones.0.len()
            && made.all.iter().all(|collider| living.contains(*collider));
        // A missing bone can have appeared only if an entity was named or got children.
        let is_known = are_there || made.waits && renamed.is_empty();
        if is_known && !bones.is_changed() {
            continue;
        }
        let colliders = names_below(entity, &named).map(|names| {
            let each = bones.0.iter().map(|bone| collider(bone, &names, &places));
            each.collect::<Result<Vec<_>, _>>()
        });
        made.waits = matches!(colliders, None | Some(Err(ClothError::NoSuchBone { .. })));
        let outcome = match colliders {
            // Its scene is on its way.
            None => Ok(()),
            Some(colliders) => colliders.map(|colliders| {
                despawn_colliders(entity, &owners, &mut commands);
                made.all.clear();
                made.all.extend(colliders.into_iter().map(|bundle| {
                    let collider = (bundle, BoneColliderOf(entity));
                    commands.spawn(collider).id()
                }));
            }),
        };
        ClothFault::report(&mut commands, entity, fault, Part::Collider, outcome);
    }
}

/// Removes the colliders of a skeleton that has lost its [`ClothBones`].
pub(super) fn remove_bone_colliders(
    removed: On<Remove, ClothBones>,
    mut made: Query<&mut BoneColliders, Allow<Disabled>>,
    owners: Owners,
    mut commands: Commands,
) {
    if let Ok(mut made) = made.get_mut(removed.entity) {
        made.all.clear();
    }
    despawn_colliders(removed.entity, &owners, &mut commands);
}

/// An entity and all entities below it by their names, the first of each name. `None` as long as no entity below has a
/// name.
fn names_below<'a>(
    root: Entity,
    named: &'a Query<(Option<&Name>, Option<&Children>), Allow<Disabled>>,
) -> Option<HashMap<&'a str, Entity>> {
    let mut names = HashMap::default();
    let mut is_named = false;
    let mut open = vec![root];
    while let Some(entity) = open.pop() {
        let Ok((name, children)) = named.get(entity) else {
            continue;
        };
        if let Some(name) = name {
            names.entry(name.as_str()).or_insert(entity);
            is_named |= entity != root;
        }
        open.extend(
            children
                .into_iter()
                .flat_map(|children| children.iter().rev()),
        );
    }
    is_named.then_some(names)
}

/// A bone's collider.
fn collider(
    bone: &ClothBone,
    names: &HashMap<&str, Entity>,
    places: &Places,
) -> Result<(Name, ClothCollider, Transform, ChildOf), ClothError> {
    let find = |name: &String| -> Result<(Entity, GlobalTransform), ClothError> {
        let found = names.get(name.as_str());
        let entity = *found.ok_or_else(|| ClothError::NoSuchBone { name: name.clone() })?;
        Ok((entity, places.of(entity)?))
    };
    let (entity, place) = find(&bone.bone)?;
    let to_bone = place.affine().inverse();
    // The radius is in the world.
    let scale = place.scale().abs().max_element();
    let scale = Vec3::splat(scale.recip());
    if !(to_bone.is_finite() && scale.is_finite()) {
        return Err(unusable(place.affine()));
    }
    let (shape, transform) = match &bone.end {
        None => (ClothCollider::ball(bone.radius), Transform::default()),
        Some(end) => {
            let end = find(end)?.1.translation();
            let length = end.distance(place.translation());
            let along = to_bone.transform_point3(end);
            let transform = Transform {
                translation: along / 2.0,
                rotation: Quat::from_rotation_arc(Vec3::Y, along.normalize_or(Vec3::Y)),
                scale: Vec3::ONE,
            };
            (ClothCollider::capsule(bone.radius, length), transform)
        }
    };
    let name = Name::new(format!("collider of {}", bone.bone));
    Ok((name, shape, transform.with_scale(scale), ChildOf(entity)))
}
