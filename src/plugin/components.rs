//! Components of a cloth that the plugin adds and keeps.

use std::ops::Range;

use bevy::{
    ecs::{
        change_detection::Tick, component::Component, entity::Entity, reflect::ReflectComponent,
    },
    math::{Isometry3d, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::attach::Attached;
use crate::{
    cloth::{Cloth, ClothGrid, ClothMaterial, ClothParticles, Pin, Pins, Springs},
    contact::MovingBall,
    hierarchy::{BoundRule, QuadTree, SphereBounds, TopDownQuery},
    solver::{ClothSettings, Control, PinMotion, Precision, Rest, Solver, Stretch, TickStep},
};

/// What does not change while a cloth moves: its grid, springs and tree. Empty until the first tick.
#[derive(Component, Debug, Default)]
pub struct ClothTopology {
    pub(super) grid: ClothGrid,
    pub(super) springs: Springs,
    pub(super) tree: QuadTree,
    /// What all this was made from.
    pub(super) woven: Option<(Cloth, ClothMaterial, Pins)>,
}

impl ClothTopology {
    /// The grid of particles, scaled.
    pub fn grid(&self) -> &ClothGrid {
        &self.grid
    }

    /// The springs, colour by colour.
    pub fn springs(&self) -> &Springs {
        &self.springs
    }

    /// The quad-tree.
    pub fn tree(&self) -> &QuadTree {
        &self.tree
    }

    /// Whether springs and tree are those of `particles`: not before the first tick, nor once a game has
    /// emptied the particles, until the next.
    pub(super) fn fits(&self, particles: &ClothParticles) -> bool {
        !particles.is_empty() && particles.fit(&self.grid)
    }
}

/// The bounding spheres of the last tick, and what the search through them found.
#[derive(Component, Debug, Default)]
pub struct ClothSearch {
    pub(super) bounds: SphereBounds,
    pub(super) query: TopDownQuery,
}

impl ClothSearch {
    /// The bounding spheres.
    pub fn bounds(&self) -> &SphereBounds {
        &self.bounds
    }

    /// Which nodes were visited and which touched, and the candidates.
    pub fn query(&self) -> &TopDownQuery {
        &self.query
    }
}

/// Figures of a cloth's last tick.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothStats {
    /// Time of all sub-steps, the stretch measured in the last of them (ms): the solver's call.
    pub integrate_ms: f64,
    /// Time to bring the bounding spheres up to date (ms).
    pub rebuild_ms: f64,
    /// Time of the search (ms).
    pub query_ms: f64,
    /// Nodes of the tree that were looked at.
    pub nodes_visited: usize,
    /// Leaves among them.
    pub leaf_tests: usize,
    /// Particles that were pushed out of a collider, once for each.
    pub contacts: usize,
    /// The largest stretch, at the end of the tick.
    pub stretch: Stretch,
    /// Sub-steps of the tick, those included that were done again for the tolerance; 0 for a cloth that sleeps.
    pub substeps: u32,
    /// Whether the cloth sleeps.
    pub is_asleep: bool,
}

/// A ball that may touch the cloth in this tick, and its candidates.
#[derive(Debug, Clone)]
pub(super) struct BallInReach {
    pub collider: Entity,
    pub ball: MovingBall,
    /// Its part of the query's candidates.
    pub candidates: Range<usize>,
    pub deepest: f32,
}

/// What one tick's systems hand on to the next. Kept so that a tick does not allocate.
#[derive(Component, Debug, Default)]
pub(super) struct ClothTick {
    /// `None` for a cloth that was not prepared: nothing else of the tick happens to it then.
    pub step: Option<TickStep>,
    /// Whether the last preparation found nothing wrong: what is not sound is neither moved nor drawn.
    pub sound: bool,
    pub rule: BoundRule,
    /// Coulomb's μ.
    pub friction: f32,
    /// Radius of each particle (m).
    pub particle_radius: f32,
    /// As of the positions present: what `RestShape` relies on.
    pub stretch: Stretch,
    /// Pinned particles that the frame or a target carries along.
    pub pins: Vec<PinMotion>,
    /// How far a particle may get in the tick by itself (m).
    pub reach: f32,
    pub balls: Vec<BallInReach>,
    /// One flag a candidate: pushed out in this tick.
    pub touched: Vec<bool>,
    /// When the plugin last wrote the particles: whoever wrote them since was the game.
    pub written: Option<Tick>,
    pub solver: Solver,
    pub precision: Precision,
    pub control: Control,
    pub rest: Rest,
    /// Speed of the fastest particle as the tick begins (m/s).
    pub largest_speed: f32,
    /// What disturbs a cloth at rest when it changes, besides what it is woven from.
    pub known: Option<(ClothSettings, BoundRule, Vec3)>,
    /// Whether there are tethers, and for which acceleration (m/s²); `None` if they have to be made anew.
    pub tethered: Option<(bool, f32)>,
    /// What `attached` was made from.
    pub attachments: Vec<(Pin, Entity)>,
    pub attached: Vec<Attached>,
    /// Where the first attachment's target was.
    pub first_target: Option<Isometry3d>,
    /// The particles as the tick began, for a tick that is done again.
    pub backup: ClothParticles,
    /// Whether it was said that the sub-steps don't suffice.
    pub cap_is_told: bool,
}
