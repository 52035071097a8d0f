//! All that a cloth's next tick depends on, besides its public components.

use bevy::{
    ecs::{change_detection::Tick, component::Component, entity::Entity},
    math::{Isometry3d, Vec3},
};

use super::{
    ClothAttachment, air::KnownAir, attachments::Attached, excess::Excess, lod_state::LodState,
    skin::Pose,
};
use crate::{
    contact::{Carrier, ClothSelfCollision, MovingCollider, NarrowPhase},
    hierarchy::SearchMethod,
    solver::{ClothLimit, ClothSettings, Control, Rest, Stretch},
};

/// What a cloth remembers from tick to tick, besides its [`ClothParticles`](crate::cloth::ClothParticles) and its
/// [`ClothFrame`](super::ClothFrame). The next tick depends on this, on those, on what the game says in other components, from
/// which [`ClothBuilt`](super::ClothBuilt) follows, and on how colliders move; on nothing else.
#[derive(Component, Debug, Default, Clone)]
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
    pub(super) attachments: Vec<ClothAttachment>,
    pub(super) targets: Vec<Entity>,
    pub(super) attached: Vec<Attached>,
    /// Where the first attachment's target was.
    pub(super) first_target: Option<Isometry3d>,
    /// The pose that it follows, as the last tick ended.
    pub(super) pose: Pose,
    /// The colliders that it touched as it fell asleep, each where it was then.
    pub(super) rests_on: Vec<(Entity, MovingCollider)>,
    /// The particles that carried bodies as the last tick ended.
    pub(super) carriers: Vec<(Entity, Carrier)>,
    /// The largest gravity that it has known, as 9.81 or a doubling of that (m/s²): tethers are made for it.
    pub(super) largest_gravity: f32,
    /// How far it is beyond each limit.
    pub(super) excess: [Excess; ClothLimit::ALL.len()],
}

impl ClothState {
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
