//! Everything that a cloth's next tick depends on, besides its public components.

use bevy::{
    ecs::{change_detection::Tick, entity::MapEntities},
    prelude::{Component, Entity, EntityMapper, Isometry3d},
};

use super::{forces::ForceState, inputs::Inputs, lod::LodState, pieces::Resting, pose::Pose};
use crate::{
    cloth::ClothParticles,
    contact::Carrier,
    plugin::authoring::{Attached, ClothAttachment},
    solver::{ClothLimit, Control, Rest, Stretch},
};

/// The memory of a cloth from tick to tick, besides its [`ClothParticles`](crate::cloth::ClothParticles) and its
/// [`ClothFrame`](crate::plugin::ClothFrame). The next tick depends on these three, on the game's components, from which
/// [`ClothBuilt`](crate::plugin::ClothBuilt) is built, and on the motion of colliders; on nothing else.
#[derive(Component, Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[component(map_entities)]
pub struct ClothState {
    /// Whether the last preparation found no error: an invalid cloth is neither moved nor drawn.
    pub(crate) is_valid: bool,
    /// Its level of detail.
    pub(crate) lod: LodState,
    /// Control of the coming tick's sub-steps.
    pub(crate) control: Control,
    pub(crate) rest: Rest,
    /// Number of sub-steps that its layers want; 0 if none touched in the last tick.
    pub(crate) layer_substeps: u32,
    /// Stretch at the current positions: `RestShape` relies on it.
    pub(crate) stretch: Stretch,
    /// Speed of the fastest particle as the tick begins (m/s).
    pub(crate) largest_speed: f32,
    pub(crate) inputs: InputMemory,
    pub(crate) attachments: AttachmentMemory,
    /// The pose that it follows, as the last tick ended.
    pub(crate) pose: Pose,
    /// The colliders that it rests on, and the rest of its pieces.
    pub(crate) resting: Resting,
    /// The particles that carried bodies as the last tick ended.
    pub(crate) carriers: Vec<(Entity, Carrier)>,
    /// The largest gravity so far, as 9.81 or a doubling of that (m/s²): tethers are made for it.
    pub(crate) largest_gravity: f32,
    /// Whether it continues from a snapshot, though nothing is built yet.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub(crate) resumes: bool,
    pub(crate) reported: Reported,
    /// Rest curvatures of its creases, as its solver has them; none if it does not crease.
    pub(crate) creases: Vec<f32>,
}

/// Excess over limits, and what of it the log knows.
#[derive(Debug, Default, Clone, Copy)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Reported {
    /// Excess over each limit.
    pub excess: [Excess; ClothLimit::ALL.len()],
    /// Whether it was reported that a jump dragged it along.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub was_dragged: bool,
}

/// The attachments of a cloth.
#[derive(MapEntities, Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct AttachmentMemory {
    /// Those from which `attached` was made, and the entities that they name.
    #[cfg_attr(feature = "serialize", serde(skip))]
    #[entities]
    pub given: Vec<ClothAttachment>,
    #[entities]
    pub targets: Vec<Entity>,
    pub attached: Vec<Attached>,
    /// Last place of the first attachment's target.
    pub first_target: Option<Isometry3d>,
}

impl AttachmentMemory {
    fn copy_from(&mut self, other: &Self) {
        self.given.clone_from(&other.given);
        self.targets.clone_from(&other.targets);
        self.attached.clone_from(&other.attached);
        self.first_target = other.first_target;
    }
}

/// The inputs of the last tick.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct InputMemory {
    /// When the plugin last wrote the particles: a later change is the game's.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub written: Option<Tick>,
    pub known: Option<Inputs>,
    pub forces: ForceState,
    /// How many of its torn edges have opened: the last ones do so as the next tick begins.
    pub opened: usize,
    /// Whether it was a grid that has the surface of a mesh, though nothing was torn.
    pub as_mesh: bool,
}

impl ClothState {
    /// Copies `other` into its own memory.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let mut own = std::mem::take(self);
        own.rest.copy_from(&other.rest);
        own.attachments.copy_from(&other.attachments);
        own.pose.copy_from(&other.pose);
        own.resting.copy_from(&other.resting);
        own.carriers.clone_from(&other.carriers);
        own.creases.clone_from(&other.creases);
        *self = Self {
            rest: own.rest,
            inputs: other.inputs.clone(),
            attachments: own.attachments,
            pose: own.pose,
            resting: own.resting,
            carriers: own.carriers,
            creases: own.creases,
            ..*other
        };
    }

    /// Wakes the cloth, and all its pieces.
    pub(crate) fn wake(&mut self) {
        self.rest.disturb();
        self.resting.pieces.wake();
    }

    /// Whether this state, read from a file, matches these particles.
    pub(crate) fn is_valid_for(&self, particles: &ClothParticles) -> bool {
        let len = particles.len();
        let is_of_all = |count: usize| count == 0 || count == len;
        let is_attached = |attached: &Attached| {
            (attached.particle as usize) < len
                && attached.attachment < self.attachments.targets.len()
        };
        let blocks = particles.blocks().len();
        self.rest.is_valid()
            && self.resting.pieces.is_valid_for(len)
            && self.creases.iter().all(|crease| crease.is_finite())
            && is_of_all(self.pose.places.len())
            && is_of_all(self.pose.normals.len())
            && self.attachments.attached.iter().all(is_attached)
            && (self.carriers.iter()).all(|(_, carrier)| carrier.is_in(blocks))
    }

    /// Forgets attachments, carried bodies, gravity and creases, because the particles have been replaced.
    pub(crate) fn detach(&mut self) {
        self.largest_gravity = 0.0;
        self.carriers.clear();
        self.creases.clear();
        self.attachments.attached.clear();
        self.attachments.given.clear();
        self.attachments.first_target = None;
        self.pose = Pose::default();
    }
}

impl MapEntities for ClothState {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for (body, _) in &mut self.carriers {
            body.map_entities(mapper);
        }
        self.attachments.map_entities(mapper);
        self.resting.map_entities(mapper);
        self.inputs.forces.map_entities(mapper);
    }
}

/// Ticks in a row before a report: a blow may stretch a cloth for an instant, which does no harm.
const TICKS: u32 = 8;

/// A quantity that becomes this many times as large as reported is reported again.
const WORSE: f32 = 10.0;

/// The excess of a cloth over a limit.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Excess {
    /// Number of ticks in a row.
    ticks: u32,
    /// The quantity that was reported, 0 before that.
    reported: f32,
}

impl Excess {
    /// Takes the quantity of a tick, if it was beyond the limit then. Returns whether to report it.
    pub fn observe(&mut self, limit: ClothLimit, quantity: Option<f32>) -> bool {
        let Some(quantity) = quantity else {
            self.ticks = 0;
            return false;
        };
        self.ticks = self.ticks.saturating_add(1);
        // A collider passes through in a single tick, and a tolerance holds in each tick or not at all.
        let is_at_once = matches!(
            limit,
            ClothLimit::SmallFastCollider
                | ClothLimit::Tolerance
                | ClothLimit::Layers
                | ClothLimit::Embedded
        );
        let lasts = self.ticks >= TICKS || is_at_once;
        let is_reported = self.reported == 0.0 || quantity >= WORSE * self.reported;
        if lasts && is_reported {
            self.reported = quantity;
        }
        lasts && is_reported
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: ClothLimit = ClothLimit::Stretch;

    #[test]
    fn is_reported_after_eight_ticks_and_again_when_ten_times_worse() {
        let mut excess = Excess::default();
        let mut observe = |quantity| excess.observe(LIMIT, quantity);
        assert!((1..TICKS).all(|_| !observe(Some(0.2))));
        assert!(observe(Some(0.2)));
        assert!(!observe(Some(1.9)));
        assert!(!observe(None));
        assert!((1..TICKS).all(|_| !observe(Some(2.1))), "an instant again");
        assert!(observe(Some(2.1)));
        assert!(!observe(Some(2.2)));
    }
}
