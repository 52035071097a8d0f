//! Components of a cloth that the plugin adds and keeps.

use bevy::{
    ecs::{
        change_detection::Tick,
        component::Component,
        entity::{Entity, EntityHashSet},
        reflect::ReflectComponent,
    },
    math::{Affine3A, Isometry3d, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    attach::{Attached, ClothAttachment},
    envelope::Excess,
};
use crate::{
    cloth::{Cloth, ClothGrid, ClothMaterial, ClothParticles, Pins, Springs},
    contact::{Detection, MovingCollider, NarrowPhase, Terms},
    hierarchy::{NodeBounds, QuadTree, SearchMethod, SearchReason, TopDownQuery},
    solver::{
        ClothLimit, ClothSettings, Control, Load, PinMotion, Precision, Rest, Solver, Stretch,
        TickStep,
    },
};

/// What does not change while a cloth moves: its grid, springs and tree. Empty until the first tick. Reflected as
/// nothing: it is made from the other components.
#[derive(Component, Reflect, Debug, Default)]
#[reflect(Component, Default, Debug)]
pub struct ClothTopology {
    #[reflect(ignore)]
    pub(super) grid: ClothGrid,
    #[reflect(ignore)]
    pub(super) springs: Springs,
    #[reflect(ignore)]
    pub(super) tree: QuadTree,
    /// What all this was made from.
    #[reflect(ignore)]
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

    /// Gives pinned particles the masses that the material gives them.
    pub(super) fn release_pins(&self, particles: &mut ClothParticles) {
        let Some((_, material, _)) = &self.woven else {
            return;
        };
        if !self.fits(particles) {
            return;
        }
        for index in 0..particles.len() {
            if particles.inverse_mass(index) == Some(0.0) {
                particles.reweigh(index, &self.grid, material, &Pins::none());
            }
        }
    }

    /// Whether springs and tree are those of `particles`: not before the first tick, nor once a game has
    /// emptied the particles, until the next.
    pub(super) fn fits(&self, particles: &ClothParticles) -> bool {
        !particles.is_empty() && particles.fit(&self.grid)
    }
}

/// The bounding volumes of the last tick in which something was near, and what the search through them found. Reflected
/// as nothing, as it is of one tick.
#[derive(Component, Reflect, Debug, Default)]
#[reflect(Component, Default, Debug)]
pub struct ClothSearch {
    #[reflect(ignore)]
    pub(super) bounds: NodeBounds,
    #[reflect(ignore)]
    pub(super) query: TopDownQuery,
}

impl ClothSearch {
    /// The bounding volumes.
    pub fn bounds(&self) -> &NodeBounds {
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
    /// Time to bring the bounding volumes up to date (ms).
    pub rebuild_ms: f64,
    /// Time of the search (ms).
    pub query_ms: f64,
    /// How the cloth was searched: never `Auto`, unless nothing was.
    pub search: SearchMethod,
    /// Why so.
    pub reason: SearchReason,
    /// Colliders that came near the cloth.
    pub colliders_near: usize,
    /// Those of them that were tested against triangles.
    pub by_triangles: usize,
    /// Nodes of the tree that were looked at.
    pub nodes_visited: usize,
    /// Particles that were tested: leaves among the nodes, or all by a scan.
    pub leaf_tests: usize,
    /// How often particles moved farther within the tick than was expected, and all were searched again.
    pub requeries: u32,
    /// Particles that were pushed out of a collider, once for each; cells where it is tested against triangles.
    pub contacts: usize,
    /// The largest stretch, at the end of the tick.
    pub stretch: Stretch,
    /// Sub-steps of the tick, those included that were done again for the tolerance; 0 for a cloth that sleeps.
    pub substeps: u32,
    /// Whether the cloth sleeps.
    pub is_asleep: bool,
    /// The first limit beyond which it is not simulated well, if it was beyond one as its last tick ended.
    pub exceeded: Option<ClothLimit>,
}

/// Where a cloth may be touched in the tick. Small, so that a thousand cloths which nothing comes near are passed over
/// without a look at anything else.
#[derive(Component, Debug, Default, Clone, Copy)]
pub(super) struct Vicinity {
    /// Around the whole of it, as far as it may get in the tick, in the world (m).
    pub centre: Vec3,
    pub radius: f32,
    /// Whether the cloth takes part in the tick.
    pub takes_part: bool,
    /// Whether it sleeps, touching something that may have gone.
    pub listens: bool,
    /// Whether there is something to search for.
    pub is_searched: bool,
    /// Whether what an earlier search found is still there.
    pub is_stale: bool,
}

/// What one tick's systems hand on to the next. Kept so that a tick does not allocate.
#[derive(Component, Debug, Default)]
pub(super) struct ClothTick {
    /// `None` for a cloth that was not prepared: nothing else of the tick happens to it then.
    pub step: Option<TickStep>,
    /// Whether the last preparation found nothing wrong: what is not sound is neither moved nor drawn.
    pub sound: bool,
    /// What was asked for.
    pub search: SearchMethod,
    /// What the cloth is tested with.
    pub terms: Terms,
    /// As of the positions present: what `RestShape` relies on.
    pub stretch: Stretch,
    /// Pinned particles that the frame or a target carries along.
    pub pins: Vec<PinMotion>,
    /// How far a particle may get in the tick by itself (m).
    pub reach: f32,
    /// Colliders near the cloth, in its frame. What `detection` calls them by is their place here.
    pub near: Vec<(Entity, MovingCollider)>,
    /// Their entities, while others are looked for.
    pub near_set: EntityHashSet,
    pub detection: Detection,
    /// What the cloth, asleep, listens with.
    pub scout: (NodeBounds, TopDownQuery),
    /// When the plugin last wrote the particles: whoever wrote them since was the game.
    pub written: Option<Tick>,
    pub solver: Solver,
    pub precision: Precision,
    pub control: Control,
    pub rest: Rest,
    /// Speed of the fastest particle as the tick begins (m/s).
    pub largest_speed: f32,
    /// What disturbs a cloth at rest when it changes, besides what it is woven from.
    pub known: Option<(ClothSettings, SearchMethod, NarrowPhase, Vec3)>,
    /// Whether there are tethers, and for which acceleration (m/s²); `None` if they have to be made anew.
    pub tethered: Option<(bool, f32)>,
    /// How many particles are pinned, and a number that is new whenever others are.
    pub pinned: usize,
    pub pins_version: u32,
    /// What `attached` was made from.
    pub attachments: Vec<ClothAttachment>,
    pub attached: Vec<Attached>,
    /// Where the attachments' targets are in this tick, in their order.
    pub targets: Vec<Affine3A>,
    /// Whether the cloth jumps in this tick.
    pub teleports: bool,
    /// Where the first attachment's target was.
    pub first_target: Option<Isometry3d>,
    /// The particles as the tick began, for a tick that is done again.
    pub backup: ClothParticles,
    /// What the tick that was just done asked of the cloth.
    pub load: Option<Load>,
    /// The stretch that its material gives by itself.
    pub given_stretch: f32,
    /// Masses of its lightest and heaviest free particle (kg).
    pub masses: [f32; 2],
    /// How far it is beyond each limit.
    pub excess: [Excess; ClothLimit::ALL.len()],
}
