//! All that a cloth's next tick depends on, besides its public components.

use bevy::{
    ecs::{
        change_detection::Tick,
        component::Component,
        entity::{Entity, EntityMapper, MapEntities},
    },
    math::{Isometry3d, Vec3},
};

use super::{
    ClothAttachment, air::KnownAir, attachments::Attached, excess::Excess, lod_state::LodState,
    resting::RestsOn, skin::Pose,
};
use crate::{
    cloth::ClothParticles,
    contact::{Carrier, ClothSelfCollision, NarrowPhase},
    hierarchy::SearchMethod,
    solver::{ClothLimit, ClothSettings, Control, Rest, Stretch},
};

/// What a cloth remembers from tick to tick, besides its [`ClothParticles`](crate::cloth::ClothParticles) and its
/// [`ClothFrame`](super::ClothFrame). The next tick depends on this, on those, on what the game says in other components, from
/// which [`ClothBuilt`](super::ClothBuilt) follows, and on how colliders move; on nothing else.
#[derive(Component, Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[component(map_entities)]
pub struct ClothState {
    /// Whether the last preparation found nothing wrong: what is not valid is neither moved nor drawn.
    pub(super) is_valid: bool,
    /// At which level of detail it is.
    pub(super) lod: LodState,
    /// Of the coming tick's sub-steps.
    pub(super) control: Control,
    pub(super) rest: Rest,
    /// Whether layers of it, or it and other cloth, touched in the last tick.
    pub(super) touches_cloth: bool,
    /// As of the positions present: what `RestShape` relies on.
    pub(super) stretch: Stretch,
    /// Speed of the fastest particle as the tick begins (m/s).
    pub(super) largest_speed: f32,
    /// When the plugin last wrote the particles: whoever wrote them since was the game.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub(super) written: Option<Tick>,
    /// What disturbs a cloth at rest when it changes, besides what it is built from.
    pub(super) known: Option<(
        ClothSettings,
        SearchMethod,
        NarrowPhase,
        Option<ClothSelfCollision>,
        Vec3,
    )>,
    /// Likewise the air.
    pub(super) air: KnownAir,
    /// What `attached` was made from, and the entities that it names.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub(super) attachments: Vec<ClothAttachment>,
    pub(super) targets: Vec<Entity>,
    pub(super) attached: Vec<Attached>,
    /// Where the first attachment's target was.
    pub(super) first_target: Option<Isometry3d>,
    /// The pose that it follows, as the last tick ended.
    pub(super) pose: Pose,
    /// The colliders that it touched as it fell asleep, each where it was then.
    pub(super) rests_on: Vec<RestsOn>,
    /// The particles that carried bodies as the last tick ended.
    pub(super) carriers: Vec<(Entity, Carrier)>,
    /// The largest gravity that it has known, as 9.81 or a doubling of that (m/s²): tethers are made for it.
    pub(super) largest_gravity: f32,
    /// Whether it is to go on as a snapshot says, though nothing is built yet.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub(super) resumes: bool,
    /// How far it is beyond each limit.
    pub(super) excess: [Excess; ClothLimit::ALL.len()],
    /// Whether it was reported that a jump dragged it along.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub(super) was_dragged: bool,
}

impl ClothState {
    /// Becomes what `other` is, in the memory that it has.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let Self {
            is_valid,
            lod,
            control,
            ref rest,
            touches_cloth,
            stretch,
            largest_speed,
            written,
            known,
            ref air,
            ref attachments,
            ref targets,
            ref attached,
            first_target,
            ref pose,
            ref rests_on,
            ref carriers,
            largest_gravity,
            resumes,
            excess,
            was_dragged,
        } = *other;
        self.rest.copy_from(rest);
        self.air.clone_from(air);
        self.attachments.clone_from(attachments);
        self.targets.clone_from(targets);
        self.attached.clone_from(attached);
        self.pose.copy_from(pose);
        self.rests_on.clone_from(rests_on);
        self.carriers.clone_from(carriers);
        (self.is_valid, self.lod, self.control) = (is_valid, lod, control);
        (self.touches_cloth, self.stretch) = (touches_cloth, stretch);
        (self.largest_speed, self.largest_gravity) = (largest_speed, largest_gravity);
        (self.written, self.known, self.first_target) = (written, known, first_target);
        (self.resumes, self.excess) = (resumes, excess);
        self.was_dragged = was_dragged;
    }

    /// Whether all that it says of particles can be of these, in what somebody has read from a file.
    pub(super) fn is_sound(&self, particles: &ClothParticles) -> bool {
        let len = particles.len();
        let is_of_all = |count: usize| count == 0 || count == len;
        let is_attached = |attached: &Attached| {
            (attached.particle as usize) < len && attached.attachment < self.targets.len()
        };
        let blocks = particles.blocks().len();
        self.rest.is_sound()
            && is_of_all(self.pose.places.len())
            && is_of_all(self.pose.normals.len())
            && self.attached.iter().all(is_attached)
            && self
                .carriers
                .iter()
                .all(|(_, carrier)| carrier.is_in(blocks))
    }

    /// Forgets what it was attached to, what it carried and what pulled at it: the particles are others.
    pub(super) fn detach(&mut self) {
        self.largest_gravity = 0.0;
        self.carriers.clear();
        self.attached.clear();
        self.attachments.clear();
        self.first_target = None;
        self.pose = Pose::default();
    }
}

impl MapEntities for ClothState {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        let targets = self.targets.iter_mut();
        let carried = self.carriers.iter_mut().map(|(entity, _)| entity);
        for entity in targets.chain(carried) {
            *entity = mapper.get_mapped(*entity);
        }
        for attachment in &mut self.attachments {
            attachment.map_entities(mapper);
        }
        for known in &mut self.rests_on {
            known.map_entities(mapper);
        }
        self.air.map_entities(mapper);
    }
}
