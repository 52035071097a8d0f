//! Figures of a cloth's last tick.

use bevy::prelude::{Component, Reflect, ReflectComponent, ReflectDefault, Vec3};

use crate::{
    hierarchy::{SearchMethod, SearchReason},
    plugin::authoring::ClothLodLevel,
    solver::{ClothLimit, Stretch},
};

/// Figures of a cloth's last tick.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ClothStats {
    /// Time of the solver (ms): all sub-steps, and measuring the stretch in the last of them.
    pub integrate_ms: f64,
    /// Time to update the bounding volumes (ms).
    pub rebuild_ms: f64,
    /// Time of the search (ms).
    pub query_ms: f64,
    /// How the cloth was searched. Never `Auto`, unless nothing was searched.
    pub search: SearchMethod,
    /// The reason for that.
    pub reason: SearchReason,
    /// Number of colliders that came near the cloth.
    pub colliders_near: usize,
    /// Number of these colliders that were tested against triangles.
    pub by_triangles: usize,
    /// Nodes of the tree that the search visited.
    pub nodes_visited: usize,
    /// Particles that were tested: the leaves among the visited nodes, or all particles in a scan.
    pub leaf_tests: usize,
    /// Number of times that the search was repeated within the tick, because particles moved farther than expected.
    pub requeries: u32,
    /// Particles that were pushed out of a collider, counted once for each collider. A particle whose triangles are
    /// tested stands for them.
    pub contacts: usize,
    /// Pairs of features that may come near each other, within the cloth or between it and other cloths: vertices with
    /// faces, edges with edges. 0 without [`ClothSelfCollision`](crate::contact::ClothSelfCollision).
    pub layer_pairs: usize,
    /// Number of times that the features of two patches of a few faces were compared in the tick, to find these pairs.
    pub layer_searches: u32,
    /// The largest stretch, at the end of the tick.
    pub stretch: Stretch,
    /// Impulse that the air gave the cloth in the tick by drag, lift and pressure, in the world (N s); 0 while the
    /// cloth sleeps.
    pub air_impulse: Vec3,
    /// Volume that a cloth with a [`ClothPressure`](crate::solver::ClothPressure) encloses (m³), as of the last tick in
    /// which it was awake.
    pub enclosed_volume: f32,
    /// Pressure inside such a cloth, less that of the outside (Pa), as of the same tick as
    /// [`enclosed_volume`](Self::enclosed_volume).
    pub gauge_pressure: f32,
    /// Sub-steps of the tick, including those repeated for the tolerance. 0 for a cloth that sleeps, is frozen, or is
    /// not simulated in this tick because of its level of detail.
    pub substeps: u32,
    /// Current level of detail of the cloth.
    pub level: ClothLodLevel,
    /// Free particles of pieces that sleep, of a torn cloth that does not sleep as a whole.
    pub sleeping_particles: usize,
    /// Whether the cloth sleeps.
    pub is_asleep: bool,
    /// The first limit that the cloth exceeded as its last tick ended, if any. Beyond it, the cloth is not simulated
    /// well.
    pub exceeded: Option<ClothLimit>,
}
