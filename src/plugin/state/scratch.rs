//! Data that the systems of a tick hand on to each other, and the working memory of a tick.

use bevy::{
    ecs::entity::EntityHashSet,
    math::Affine3A,
    prelude::{Component, Entity},
};

use super::pose::Pose;
use crate::{
    cloth::{ClothParticles, Slot},
    contact::{
        BodyChange, ClothSelfCollision, ContactSettings, Detection, MovingCollider, MutualContact,
    },
    hierarchy::{NodeBounds, SearchMethod, TopDownQuery},
    plugin::authoring::Carried,
    solver::{LimitInputs, MotionConstraints, PinMotion, RestRule, Substepping, TickStep},
};

/// Data of a single tick, and working memory that is kept so that a tick does not allocate. You may drop it between two
/// ticks (`*scratch = ClothScratch::default()`). The following ticks are the same, except for the last bits of touching
/// layers, whose nearest points are found anew.
#[derive(Component, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub struct ClothScratch {
    /// `None` for a cloth that was not prepared: nothing else of the tick happens to it then.
    pub(crate) step: Option<TickStep>,
    pub(crate) substepping: Substepping,
    /// The search that the game chose.
    pub(crate) search: SearchMethod,
    /// The settings for contact.
    pub(crate) contact_settings: ContactSettings,
    /// Pinned particles that the frame or a target carries along.
    pub(crate) pins: Vec<PinMotion>,
    /// Particles of pieces that sleep in the tick, which are held as if pinned, and their inverse masses (1/kg).
    pub(crate) held: Vec<(Slot, f32)>,
    /// How it and its pieces are expected to move at rest.
    pub(crate) rest_rule: RestRule,
    /// Places of the attachments' targets, in their order.
    pub(crate) targets: Vec<Affine3A>,
    /// The pose as the tick begins, in the frame that it ends with.
    pub(crate) pose: Pose,
    /// Largest distances of the particles from it.
    pub(crate) constraints: MotionConstraints,
    /// The motion that carries the cloth along as the tick begins.
    pub(crate) carried: Option<Carried>,
    /// Whether the cloth teleports.
    pub(crate) teleports: bool,
    /// Distance by which its pins jump in the tick, which drags it along (m); 0 if they do not.
    pub(crate) dragged: f32,
    /// Ticks in which its stretch is still that of a jump.
    pub(crate) settling: u32,
    /// Whether it was built and has not been moved since.
    pub(crate) begins: bool,
    /// Largest distance that a particle may move by itself (m).
    pub(crate) reach: f32,
    /// Colliders near the cloth, in its frame. `detection` refers to them by their index here.
    pub(crate) near: Vec<(Entity, MovingCollider)>,
    /// Their entities, while others are looked for.
    pub(crate) near_set: EntityHashSet,
    pub(crate) detection: Detection,
    /// Its contact with cloth, and whether it is moved together with other cloths that are near.
    pub(crate) self_collision: Option<ClothSelfCollision>,
    pub(crate) is_in_island: bool,
    /// Contact with itself alone.
    pub(crate) mutual: Option<Box<MutualContact>>,
    /// Whether its particles were replaced or moved since the last tick.
    pub(crate) was_put: bool,
    /// The bodies that the cloth pushed in the tick, the changes of their motion, in the world, and the parts of these by what
    /// they stand on.
    pub(crate) pushed: Vec<(Entity, [BodyChange; 2])>,
    /// Memory for the search of a cloth that sleeps.
    pub(crate) sleep_query: (NodeBounds, TopDownQuery),
    /// The particles as the tick began, for a tick that is repeated.
    pub(crate) backup: ClothParticles,
    /// The quantities of the last tick that are compared with the limits.
    pub(crate) limit_inputs: Option<LimitInputs>,
}

impl ClothScratch {
    /// Forgets the work that was prepared for a tick.
    pub(crate) fn forget_tick(&mut self) {
        self.step = None;
        self.pins.clear();
        self.constraints.clear();
        self.carried = None;
        self.dragged = 0.0;
        self.pushed.clear();
    }
}
