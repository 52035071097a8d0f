//! What one tick's systems hand on to the next, and memory that a tick works in.

use bevy::{
    ecs::{
        component::Component,
        entity::{Entity, EntityHashSet},
    },
    math::Affine3A,
};

use crate::{
    cloth::ClothParticles,
    contact::{
        BodyChange, ClothSelfCollision, ContactSettings, Detection, MovingCollider, MutualContact,
    },
    hierarchy::{NodeBounds, SearchMethod, TopDownQuery},
    solver::{LimitInputs, MotionConstraints, PinMotion, Substepping, TickStep},
};

use super::{inertia::Carried, skin::Pose};

/// What is of one tick. Kept so that a tick does not allocate; it may be dropped between two ticks
/// (`*scratch = ClothScratch::default()`) without any change of what follows, but for the last bits of layers that touch each other:
/// where they are nearest is found anew.
#[derive(Component, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub struct ClothScratch {
    /// `None` for a cloth that was not prepared: nothing else of the tick happens to it then.
    pub(super) step: Option<TickStep>,
    pub(super) substepping: Substepping,
    /// What was asked for.
    pub(super) search: SearchMethod,
    /// What the cloth is tested with.
    pub(super) contact_settings: ContactSettings,
    /// Pinned particles that the frame or a target carries along.
    pub(super) pins: Vec<PinMotion>,
    /// Where the attachments' targets are, in their order.
    pub(super) targets: Vec<Affine3A>,
    /// The pose as the tick begins, in the frame that it ends with.
    pub(super) pose: Pose,
    /// How far particles may be from it.
    pub(super) constraints: MotionConstraints,
    /// What carries the cloth along as the tick begins.
    pub(super) carried: Option<Carried>,
    /// Whether the cloth jumps.
    pub(super) teleports: bool,
    /// How far its pins jump in the tick, which drags it along (m); 0 if they do not.
    pub(super) dragged: f32,
    /// Whether it was built and has not been moved since.
    pub(super) begins: bool,
    /// How far a particle may get by itself (m).
    pub(super) reach: f32,
    /// Colliders near the cloth, in its frame. What `detection` calls them by is their place here.
    pub(super) near: Vec<(Entity, MovingCollider)>,
    /// Their entities, while others are looked for.
    pub(super) near_set: EntityHashSet,
    pub(super) detection: Detection,
    /// How it touches cloth, and whether other cloths are near that it is moved with.
    pub(super) self_collision: Option<ClothSelfCollision>,
    pub(super) is_in_island: bool,
    /// Contact with itself alone.
    pub(super) mutual: Option<Box<MutualContact>>,
    /// Whether its particles are others since the last tick, or somewhere else.
    pub(super) was_put: bool,
    /// The bodies that the cloth pushed in the tick, and what it changed of their motion, in the world.
    pub(super) pushed: Vec<(Entity, BodyChange)>,
    /// What a cloth that sleeps is searched with.
    pub(super) sleep_query: (NodeBounds, TopDownQuery),
    /// The particles as the tick began, for one that is done again.
    pub(super) backup: ClothParticles,
    /// What the tick that was just done asked of the cloth.
    pub(super) limit_inputs: Option<LimitInputs>,
}

impl ClothScratch {
    /// Forgets what was to be done in a tick.
    pub(super) fn forget_tick(&mut self) {
        self.step = None;
        self.pins.clear();
        self.constraints.clear();
        self.carried = None;
        self.dragged = 0.0;
        self.pushed.clear();
    }
}
