//! Makes the colliders on the bones of characters.

use bevy::{
    ecs::entity_disabling::Disabled,
    platform::collections::HashMap,
    prelude::{
        Allow, Changed, ChildOf, Children, Commands, DetectChanges, Entity, GlobalTransform, Name,
        On, Or, Quat, Query, Ref, Remove, Transform, Vec3,
    },
};

use crate::{
    cloth::{ClothError, TargetError},
    contact::ClothCollider,
    plugin::{
        authoring::{BoneColliderOf, BoneColliders, ClothBone, ClothBones},
        frame::{Places, unusable},
        naming::Part,
        state::ClothFault,
    },
};

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
pub(crate) fn make_bone_colliders(
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
        let are_there = made.all.len() == bones.iter().len()
            && made.all.iter().all(|collider| living.contains(*collider));
        // A missing bone can have appeared only if an entity was named or got children.
        let is_known = are_there || made.waits && renamed.is_empty();
        if is_known && !bones.is_changed() {
            continue;
        }
        let colliders = names_below(entity, &named).map(|names| {
            let each = bones.iter().map(|bone| collider(bone, &names, &places));
            each.collect::<Result<Vec<_>, _>>()
        });
        made.waits = matches!(
            colliders,
            None | Some(Err(ClothError::Target(TargetError::NoSuchBone { .. })))
        );
        let outcome = match colliders {
            // Its scene is on its way.
            None => Ok(()),
            Some(colliders) => colliders.map(|colliders| {
                despawn_colliders(entity, &owners, &mut commands);
                let owned = colliders.into_iter().map(|of| (of, BoneColliderOf(entity)));
                made.all.clear();
                made.all
                    .extend(owned.map(|collider| commands.spawn(collider).id()));
            }),
        };
        ClothFault::report(&mut commands, entity, fault, Part::Collider, outcome);
    }
}

/// Removes the colliders of a skeleton that has lost its [`ClothBones`].
pub(crate) fn remove_bone_colliders(
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
        open.extend(children.into_iter().flatten().rev());
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
        let entity = *found.ok_or_else(|| TargetError::NoSuchBone { name: name.clone() })?;
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
