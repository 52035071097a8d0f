//! The snapshot of all cloths and colliders of a world.

use bevy::{
    ecs::entity::{EntityHashSet, MapEntities},
    math::DVec3,
    prelude::{ChildOf, Entity, EntityMapper, Isometry3d, Quat, Transform, Vec3, With, World},
};

use super::{cloth::ClothSnapshot, error::SnapshotError};
use crate::{
    cloth::Cloth,
    plugin::{
        authoring::{ClothOrder, ClothSeam, ClothStitches, ClothWindZone, RootMotion},
        prepare::{ColliderMemory, ColliderMotion, Island, Islands},
        state::{ClothState, WindField},
    },
    solver::Seam,
};

/// Everything that the next ticks of all cloths of a world depend on, except for the game's own components. It holds a
/// [`ClothSnapshot`] of each cloth, the motion of colliders, contacts between cloths, the stitches of seams, and the state of the wind. It
/// also holds the `Transform`s of all of these, of their carriers, and of everything above them in the hierarchy.
///
/// Take and restore it between two ticks, in the same app or in an app that has just started with the same entities.
/// The simulation then continues to the last bit, with the same particles, contacts and messages. Cloths and colliders
/// that were added since stay as they are; a cloth or collider that is gone is an error. Restore the game's own data
/// yourself: other components, such as an animated material, and components of a single tick, such as a `ClothTeleport`
/// that was not used yet.
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
    /// Last place of each root.
    roots: Vec<(Entity, Option<Isometry3d>)>,
    islands: Vec<Island>,
    orders: Vec<(Entity, ClothOrder)>,
    /// The stitches of each seam, and the cloths that it joins.
    seams: Vec<(Entity, Option<[Entity; 2]>, Seam)>,
    /// Time for which the wind has blown (s), and the distance that it has travelled (m).
    wind: (f64, DVec3),
    /// Translation (m), rotation and scale of `Transform`s.
    transforms: Vec<(Entity, (Vec3, Quat, Vec3))>,
}

impl ClothWorldSnapshot {
    /// A snapshot of the current state of a world.
    pub fn of(world: &mut World) -> Self {
        let mut snapshot = Self::default();
        snapshot.take(world);
        snapshot
    }

    /// Overwrites this snapshot with the current state of a world, in the memory that it has.
    pub fn take(&mut self, world: &mut World) {
        let mut cloths = world.query_filtered::<Entity, (With<Cloth>, With<ClothState>)>();
        let mut taken = 0;
        for cloth in cloths.iter(world) {
            // Usually of the same cloth as before, with the same number of particles.
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
        let new = || (Entity::PLACEHOLDER, ColliderMemory::default());
        self.colliders.resize_with(colliders.len(), new);
        for ((known, memory), (entity, motion)) in self.colliders.iter_mut().zip(colliders) {
            *known = entity;
            motion.remember(memory);
        }
        let mut roots = world.query::<(Entity, &RootMotion)>();
        let roots = roots.iter(world).map(|(entity, root)| (entity, root.last));
        self.roots.clear();
        self.roots.extend(roots);
        let mut orders = world.query::<(Entity, &ClothOrder)>();
        let orders = orders.iter(world).map(|(entity, order)| (entity, *order));
        self.orders.clear();
        self.orders.extend(orders);
        self.take_seams(world);
        let islands = world.get_resource::<Islands>();
        self.islands.clear();
        let all = islands.into_iter().flat_map(|islands| &islands.all);
        self.islands.extend(all.cloned());
        let field = world.get_resource::<WindField>();
        self.wind = field.map_or_else(Default::default, WindField::memory);
        let mut zones = world.query_filtered::<Entity, With<ClothWindZone>>();
        let zones: Vec<Entity> = zones.iter(world).collect();
        self.take_transforms(world, &zones);
    }

    fn take_seams(&mut self, world: &mut World) {
        let mut seams = world.query_filtered::<(Entity, &ClothStitches), With<ClothSeam>>();
        let seams = seams.iter(world);
        let new = || (Entity::PLACEHOLDER, None, Seam::default());
        self.seams.resize_with(seams.len(), new);
        for ((entity, cloths, known), (seam, stitches)) in self.seams.iter_mut().zip(seams) {
            (*entity, *cloths) = (seam, stitches.cloths);
            known.clone_from(&stitches.seam);
        }
    }

    /// Takes the transforms of all of them and of these wind zones, of their carriers, and of everything above them.
    fn take_transforms(&mut self, world: &World, zones: &[Entity]) {
        let mut known = EntityHashSet::default();
        self.transforms.clear();
        let own = firsts(&self.cloths).chain(firsts(&self.colliders));
        let others = firsts(&self.roots).chain(zones.iter().copied());
        let own: Vec<Entity> = own.chain(others).collect();
        for entity in own {
            let state = world.get::<ClothState>(entity);
            let carriers = state.map_or(&[][..], |state| &state.attachments.targets);
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

    /// Puts a world back to this state.
    ///
    /// # Errors
    /// [`SnapshotError`]; nothing is changed then.
    pub fn restore(&self, world: &mut World) -> Result<(), SnapshotError> {
        for (entity, snapshot) in &self.cloths {
            snapshot.check(world, *entity)?;
        }
        have::<ColliderMotion>(world, firsts(&self.colliders), "ClothCollider")?;
        have::<RootMotion>(world, firsts(&self.roots), "ClothInertia")?;
        let seams = self.seams.iter().map(|(entity, ..)| *entity);
        have::<ClothSeam>(world, seams, "ClothSeam")?;
        have::<Transform>(world, firsts(&self.transforms), "Transform")?;
        for &(entity, (translation, rotation, scale)) in &self.transforms {
            // Marked as changed, so that the transform is read again.
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
                motion.recall(memory);
            }
        }
        for (entity, last) in &self.roots {
            if let Some(mut root) = world.get_mut::<RootMotion>(*entity) {
                root.last = *last;
            }
        }
        for (entity, order) in &self.orders {
            if let Ok(mut entity) = world.get_entity_mut(*entity) {
                entity.insert(*order);
            }
        }
        for (entity, cloths, seam) in &self.seams {
            let known = world.get::<ClothSeam>(*entity).cloned();
            if let Some(mut stitches) = world.get_mut::<ClothStitches>(*entity) {
                stitches.seam.clone_from(seam);
                (stitches.cloths, stitches.surfaces, stitches.known) = (*cloths, None, known);
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

    /// All entities that a world needs for [`restore`](Self::restore), each once: cloths, colliders, roots, what carries them, seams, zones of
    /// wind, and the parents of all of these. Save a name of your own for each, and
    /// [`map_entities`](MapEntities::map_entities) takes the snapshot to the entities that have these names in another world.
    pub fn entities(&self) -> impl Iterator<Item = Entity> + '_ {
        let mut seen = EntityHashSet::default();
        let placed = firsts(&self.roots).chain(firsts(&self.transforms));
        let seams = self.seams.iter().map(|(entity, ..)| *entity);
        let own = firsts(&self.cloths).chain(firsts(&self.colliders));
        let all = own.chain(placed).chain(seams);
        all.filter(move |entity| seen.insert(*entity))
    }

    /// The cloths, each with its entity.
    pub fn cloths(&self) -> impl ExactSizeIterator<Item = (Entity, &ClothSnapshot)> {
        let cloths = self.cloths.iter();
        cloths.map(|(entity, snapshot)| (*entity, snapshot))
    }
}

/// # Errors
/// [`SnapshotError::Gone`] if an entity no longer has the component.
fn have<C: bevy::ecs::component::Component>(
    world: &World,
    mut entities: impl Iterator<Item = Entity>,
    component: &'static str,
) -> Result<(), SnapshotError> {
    let gone = entities.find(|entity| world.get::<C>(*entity).is_none());
    gone.map_or(Ok(()), |entity| {
        Err(SnapshotError::Gone { entity, component })
    })
}

fn firsts<T>(all: &[(Entity, T)]) -> impl Iterator<Item = Entity> + '_ {
    all.iter().map(|(entity, _)| *entity)
}

/// The joints that a skinned mesh hangs by.
#[cfg(feature = "mesh")]
fn joints(world: &World, entity: Entity) -> Vec<Entity> {
    let skin = world.get::<bevy::mesh::skinning::SkinnedMesh>(entity);
    let skeleton = world.get::<crate::plugin::authoring::ClothSkeleton>(entity);
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
        let islands = islands.map(|(_, cloth)| cloth);
        let orders = self.orders.iter_mut().map(|(entity, _)| entity);
        let seams = (self.seams.iter_mut())
            .flat_map(|(seam, cloths, _)| cloths.iter_mut().flatten().chain([seam]));
        let all = colliders.chain(roots).chain(transforms).chain(seams);
        for entity in all.chain(islands).chain(orders) {
            *entity = mapper.get_mapped(*entity);
        }
    }
}
