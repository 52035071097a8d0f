//! All cloths and colliders of a world.

use bevy::{
    ecs::{
        entity::{Entity, EntityHashSet, EntityMapper, MapEntities},
        hierarchy::ChildOf,
        query::With,
        world::World,
    },
    math::{DVec3, Isometry3d, Quat, Vec3},
    transform::components::Transform,
};

use super::{
    super::{
        ClothState,
        colliders::{ColliderMemory, ColliderMotion},
        inertia::RootMotion,
        islands::{Island, Islands},
        wind::{ClothWindZone, WindField},
    },
    ClothSnapshot, SnapshotError,
};
use crate::cloth::Cloth;

/// All that the next ticks of all cloths of a world depend on, besides what the game says in its components: a
/// [`ClothSnapshot`] of each, where colliders and roots come from, what cloths that touch each other know of each other, how the wind blows,
/// and the `Transform`s of all of these, of what carries them and of what is above them.
///
/// Taken and restored between two ticks, in the same app or in one that has just begun with the same entities, ticks go on to the last
/// bit: the same particles, contacts and messages. Cloths and colliders that have come since stay as they are; a cloth or collider that has gone is an error.
/// Other components of the game's, such as a material that is animated, are the game's to restore. What holds in one
/// tick alone (`ClothTeleport` that was not used yet) is the game's too.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// /// The last ten ticks, for a game that rolls back.
/// #[derive(Resource, Default)]
/// struct Ticks(Vec<ClothWorldSnapshot>);
///
/// fn save(world: &mut World) {
///     world.resource_scope(|world, mut ticks: Mut<Ticks>| {
///         // The oldest one's memory is used again.
///         let mut snapshot = if ticks.0.len() < 10 {
///             ClothWorldSnapshot::default()
///         } else {
///             ticks.0.remove(0)
///         };
///         snapshot.take(world);
///         ticks.0.push(snapshot);
///     });
/// }
///
/// fn roll_back(world: &mut World) -> Result<(), SnapshotError> {
///     world.resource_scope(|world, ticks: Mut<Ticks>| ticks.0[0].restore(world))
/// }
/// ```
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothWorldSnapshot {
    cloths: Vec<(Entity, ClothSnapshot)>,
    colliders: Vec<(Entity, ColliderMemory)>,
    /// Where each root was.
    roots: Vec<(Entity, Option<Isometry3d>)>,
    islands: Vec<Island>,
    /// For how long the wind has blown (s), and how far (m).
    wind: (f64, DVec3),
    /// Translation (m), rotation and scale of `Transform`s.
    transforms: Vec<(Entity, (Vec3, Quat, Vec3))>,
}

impl ClothWorldSnapshot {
    /// Of a world as it is.
    pub fn of(world: &mut World) -> Self {
        let mut snapshot = Self::default();
        snapshot.take(world);
        snapshot
    }

    /// Becomes that of a world as it is, in the memory that it has.
    pub fn take(&mut self, world: &mut World) {
        let mut cloths = world.query_filtered::<Entity, (With<Cloth>, With<ClothState>)>();
        let mut taken = 0;
        for cloth in cloths.iter(world) {
            // Mostly the same one's as before, of as many particles.
            if taken == self.cloths.len() {
                self.cloths.push((cloth, ClothSnapshot::default()));
            }
            let (entity, snapshot) = &mut self.cloths[taken];
            if snapshot.take(world, cloth).is_ok() {
                *entity = cloth;
                taken += 1;
            }
        }
        self.cloths.truncate(taken);
        let mut colliders = world.query::<(Entity, &ColliderMotion)>();
        let colliders = colliders.iter(world);
        self.colliders.clear();
        (self.colliders).extend(colliders.map(|(entity, motion)| (entity, motion.memory())));
        let mut roots = world.query::<(Entity, &RootMotion)>();
        let roots = roots.iter(world);
        self.roots.clear();
        self.roots
            .extend(roots.map(|(entity, root)| (entity, root.last())));
        let islands = world.get_resource::<Islands>();
        self.islands.clear();
        (self.islands).extend(
            islands
                .into_iter()
                .flat_map(|islands| islands.all.iter().cloned()),
        );
        let field = world.get_resource::<WindField>();
        self.wind = field.map_or_else(Default::default, WindField::memory);
        let mut zones = world.query_filtered::<Entity, With<ClothWindZone>>();
        let zones: Vec<Entity> = zones.iter(world).collect();
        self.take_transforms(world, &zones);
    }

    /// Takes where all of them and these zones of wind are, what carries them, and what is above them.
    fn take_transforms(&mut self, world: &World, zones: &[Entity]) {
        let mut known = EntityHashSet::default();
        self.transforms.clear();
        let own = (self.cloths.iter().map(|(entity, _)| *entity))
            .chain(self.colliders.iter().map(|(entity, _)| *entity))
            .chain(self.roots.iter().map(|(entity, _)| *entity))
            .chain(zones.iter().copied());
        let own: Vec<Entity> = own.collect();
        for entity in own {
            let state = world.get::<ClothState>(entity);
            let carriers = state.map_or(&[][..], |state| &state.targets);
            #[cfg(feature = "mesh")]
            let joints = joints(world, entity);
            #[cfg(not(feature = "mesh"))]
            let joints: [Entity; 0] = [];
            for entity in carriers.iter().copied().chain([entity]).chain(joints) {
                let mut next = Some(entity);
                while let Some(entity) = next.filter(|entity| known.insert(*entity)) {
                    if let Some(&place) = world.get::<Transform>(entity) {
                        let place = (place.translation, place.rotation, place.scale);
                        self.transforms.push((entity, place));
                    }
                    next = world.get::<ChildOf>(entity).map(ChildOf::parent);
                }
            }
        }
    }

    /// Has a world go on from here.
    ///
    /// # Errors
    /// [`SnapshotError`]; nothing is changed.
    pub fn restore(&self, world: &mut World) -> Result<(), SnapshotError> {
        for (entity, snapshot) in &self.cloths {
            snapshot.check(world, *entity)?;
        }
        let colliders = self.colliders.iter().map(|(entity, _)| *entity);
        for entity in colliders {
            has::<ColliderMotion>(world, entity, "ClothCollider")?;
        }
        for (entity, _) in &self.roots {
            has::<RootMotion>(world, *entity, "ClothInertia")?;
        }
        for (entity, _) in &self.transforms {
            has::<Transform>(world, *entity, "Transform")?;
        }
        for &(entity, (translation, rotation, scale)) in &self.transforms {
            // As a change: whoever is moved looks where it is now.
            if let Some(mut place) = world.get_mut::<Transform>(entity) {
                *place = Transform {
                    translation,
                    rotation,
                    scale,
                };
            }
        }
        for (entity, snapshot) in &self.cloths {
            snapshot.restore(world, *entity)?;
        }
        for (entity, memory) in &self.colliders {
            if let Some(mut motion) = world.get_mut::<ColliderMotion>(*entity) {
                motion.recall(*memory);
            }
        }
        for (entity, last) in &self.roots {
            if let Some(mut root) = world.get_mut::<RootMotion>(*entity) {
                root.recall(*last);
            }
        }
        if let Some(mut islands) = world.get_resource_mut::<Islands>() {
            islands.all.clone_from(&self.islands);
        }
        if let Some(mut field) = world.get_resource_mut::<WindField>() {
            field.recall(self.wind);
        }
        Ok(())
    }

    /// All entities that a world needs for [`restore`](Self::restore), each once: cloths, colliders, roots, what carries them, zones of
    /// wind, and the parents of all of these. Save a name of your own for each, and
    /// [`map_entities`](MapEntities::map_entities) takes the snapshot to the entities that have these names in another world.
    pub fn entities(&self) -> impl Iterator<Item = Entity> + '_ {
        let mut seen = EntityHashSet::default();
        let cloths = self.cloths.iter().map(|(entity, _)| *entity);
        let colliders = self.colliders.iter().map(|(entity, _)| *entity);
        let roots = self.roots.iter().map(|(entity, _)| *entity);
        let transforms = self.transforms.iter().map(|(entity, _)| *entity);
        (cloths.chain(colliders).chain(roots).chain(transforms))
            .filter(move |entity| seen.insert(*entity))
    }

    /// The cloths, each with its entity.
    pub fn cloths(&self) -> impl ExactSizeIterator<Item = (Entity, &ClothSnapshot)> {
        self.cloths
            .iter()
            .map(|(entity, snapshot)| (*entity, snapshot))
    }
}

/// # Errors
/// [`SnapshotError::Gone`] if an entity has it no more.
fn has<C: bevy::ecs::component::Component>(
    world: &World,
    entity: Entity,
    component: &'static str,
) -> Result<(), SnapshotError> {
    match world.get::<C>(entity) {
        Some(_) => Ok(()),
        None => Err(SnapshotError::Gone { entity, component }),
    }
}

/// The joints that a skinned mesh hangs by.
#[cfg(feature = "mesh")]
fn joints(world: &World, entity: Entity) -> Vec<Entity> {
    let skin = world.get::<bevy::mesh::skinning::SkinnedMesh>(entity);
    let skeleton = world.get::<crate::plugin::ClothSkeleton>(entity);
    let joints = skin.map(|skin| &skin.joints);
    let joints = joints.or(skeleton.map(|skeleton| &skeleton.joints));
    joints.cloned().unwrap_or_default()
}

impl MapEntities for ClothWorldSnapshot {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for (entity, snapshot) in &mut self.cloths {
            *entity = mapper.get_mapped(*entity);
            snapshot.map_entities(mapper);
        }
        let colliders = self.colliders.iter_mut().map(|(entity, _)| entity);
        let roots = self.roots.iter_mut().map(|(entity, _)| entity);
        let transforms = self.transforms.iter_mut().map(|(entity, _)| entity);
        let islands = (self.islands.iter_mut()).flat_map(|island| &mut island.cloths);
        for entity in colliders.chain(roots).chain(transforms).chain(islands) {
            *entity = mapper.get_mapped(*entity);
        }
    }
}
