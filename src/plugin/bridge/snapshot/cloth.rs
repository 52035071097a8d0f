//! The snapshot of a single cloth.

use bevy::{
    ecs::entity::MapEntities,
    prelude::{DetectChanges, DetectChangesMut, Entity, Ref, World},
};

use super::error::SnapshotError;
use crate::{
    cloth::{Cloth, ClothParticles, ClothTears},
    contact::MutualContact,
    plugin::{
        authoring::ClothAttachments,
        frame::ClothFrame,
        state::{ClothBuilt, ClothContacts, ClothParts, ClothScratch, ClothState, ClothStats},
    },
};

/// Everything that the next tick of a cloth depends on, except for the game's own components (`Cloth`, `ClothMaterial`,
/// `Transform` …) and the motion of colliders. [`ClothWorldSnapshot`](crate::plugin::ClothWorldSnapshot) holds all cloths and
/// colliders at once: only that continues to the last bit where a cloth touches something.
///
/// Take and restore it between two ticks, in an exclusive system or outside the schedule. With the feature `serialize`,
/// serde writes and reads it. Entities are written as they are, and [`MapEntities`] maps them to those of another
/// world.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// /// Ten ticks back, for a game that rolls back.
/// fn rewind(world: &mut World, cloth: Entity, kept: &[ClothSnapshot]) -> Result<(), SnapshotError> {
///     kept[kept.len() - 10].restore(world, cloth)
/// }
/// ```
#[derive(MapEntities, Debug, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothSnapshot {
    pub(super) version: u32,
    particles: ClothParticles,
    frame: ClothFrame,
    #[entities]
    state: ClothState,
    #[entities]
    contacts: ClothContacts,
    tears: ClothTears,
    /// Contact with itself alone.
    mutual: Option<Box<MutualContact>>,
    /// Whether the game has written the particles since the last tick.
    is_written: bool,
}

impl Default for ClothSnapshot {
    /// An empty snapshot, as memory for [`take`](Self::take).
    fn default() -> Self {
        Self {
            version: Self::VERSION,
            particles: ClothParticles::default(),
            frame: ClothFrame::default(),
            state: ClothState::default(),
            contacts: ClothContacts::default(),
            tears: ClothTears::none(),
            mutual: None,
            is_written: false,
        }
    }
}

impl ClothSnapshot {
    /// Version of the snapshots that this crate writes. It reads no other version.
    pub const VERSION: u32 = 12;

    /// A snapshot of the current state of a cloth.
    ///
    /// # Errors
    /// [`SnapshotError::NoCloth`].
    pub fn of(world: &World, cloth: Entity) -> Result<Self, SnapshotError> {
        let mut snapshot = Self::default();
        snapshot.take(world, cloth)?;
        Ok(snapshot)
    }

    /// Overwrites this snapshot with the current state of a cloth, in the memory that it has.
    ///
    /// # Errors
    /// [`SnapshotError::NoCloth`]; the snapshot stays as it was.
    pub fn take(&mut self, world: &World, cloth: Entity) -> Result<(), SnapshotError> {
        type Parts = (
            Ref<'static, ClothParticles>,
            &'static ClothFrame,
            &'static ClothState,
            &'static ClothContacts,
            &'static ClothScratch,
        );
        let entity = world.get_entity(cloth).ok();
        let parts = entity.and_then(|entity| entity.get_components::<Parts>().ok());
        let (particles, frame, state, contacts, scratch) =
            parts.ok_or(SnapshotError::NoCloth { entity: cloth })?;
        self.version = Self::VERSION;
        self.particles.copy_from(&particles);
        self.frame = *frame;
        self.state.copy_from(state);
        let built = world.get::<ClothBuilt>(cloth);
        let built = built.filter(|built| built.matches(&particles));
        self.state.lod.sphere = built.map(|built| {
            let root = built.tree().root_sphere(&particles, state.stretch.bound);
            (root.center.into(), root.radius())
        });
        self.is_written = state.inputs.written != Some(particles.last_changed());
        self.contacts.clone_from(contacts);
        self.mutual.clone_from(&scratch.mutual);
        let tears = world.get::<ClothTears>(cloth);
        (self.tears).clone_from(tears.unwrap_or(&ClothTears::none()));
        Ok(())
    }

    /// Checks whether [`restore`](Self::restore) would succeed.
    pub(super) fn check(&self, world: &World, cloth: Entity) -> Result<(), SnapshotError> {
        if self.version != Self::VERSION {
            return Err(SnapshotError::Version {
                found: self.version,
                expected: Self::VERSION,
            });
        }
        let is_valid = self.particles.is_valid()
            && self.state.is_valid_for(&self.particles)
            && self.contacts.is_valid_for(self.particles.len());
        if !is_valid {
            return Err(SnapshotError::Damaged { entity: cloth });
        }
        let state = world.get::<ClothState>(cloth);
        let known = state.filter(|_| world.get::<Cloth>(cloth).is_some());
        let error = SnapshotError::NoCloth { entity: cloth };
        known.map(drop).ok_or(error)
    }

    /// Puts a cloth back to this state. The cloth may never have been simulated, as in an app that has just started,
    /// but needs the same `Cloth`, material and pins.
    ///
    /// # Errors
    /// [`SnapshotError`]; nothing is changed then.
    pub fn restore(&self, world: &mut World, cloth: Entity) -> Result<(), SnapshotError> {
        self.check(world, cloth)?;
        let mut entity = world.entity_mut(cloth);
        // A game may have removed some.
        entity.insert_if_new(<(ClothParticles, ClothParts)>::default());
        match entity.get_mut::<ClothTears>() {
            Some(mut tears) => {
                tears.set_if_neq(self.tears.clone());
            }
            None if self.tears.is_empty() => {}
            None => {
                entity.insert(self.tears.clone());
            }
        }
        type Parts = (
            &'static mut ClothParticles,
            &'static mut ClothFrame,
            &'static mut ClothContacts,
            &'static mut ClothState,
            &'static mut ClothStats,
            &'static mut ClothScratch,
            &'static mut ClothBuilt,
        );
        let wanted = entity.get::<ClothAttachments>().cloned();
        let parts = entity.get_components_mut::<Parts>();
        let (mut particles, mut frame, mut contacts, mut state, mut stats, mut scratch, mut built) =
            parts.map_err(|_| SnapshotError::NoCloth { entity: cloth })?;
        // Particles that the game has written have not been weighed yet.
        let is_weighed = state.inputs.written == Some(particles.last_changed());
        let weighs_the_same = is_weighed && particles.weigh_as(&self.particles);
        particles.copy_from(&self.particles);
        *frame = self.frame;
        contacts.clone_from(&self.contacts);
        state.copy_from(&self.state);
        state.inputs.written = Some(particles.last_changed()).filter(|_| !self.is_written);
        // In a file that was edited by hand, they may be anything.
        let survey = self.particles.survey();
        state.is_valid &= survey.is_valid;
        state.largest_speed = survey.largest_speed;
        // Attachments are not written to files: they are the game's components.
        let wanted = wanted.as_ref().map_or(&[][..], ClothAttachments::as_slice);
        let attachments = &mut state.attachments;
        if attachments.given.is_empty() && attachments.targets.len() == wanted.len() {
            attachments.given.extend_from_slice(wanted);
        }
        state.resumes = true;
        stats.is_asleep = self.state.rest.is_asleep();
        scratch.forget_tick();
        scratch.mutual.clone_from(&self.mutual);
        if !weighs_the_same {
            built.refresh_masses(&self.particles);
        }
        Ok(())
    }

    /// The particles in the snapshot.
    pub fn particles(&self) -> &ClothParticles {
        &self.particles
    }
}
