//! Figures of a cloth's last tick.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::lod::ClothLodLevel;
use crate::{
    hierarchy::{SearchMethod, SearchReason},
    solver::{ClothLimit, Stretch},
};

/// Figures of a cloth's last tick.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
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
    /// Pairs of its features, or of its and of other cloths', that may come near each other: vertices with faces, edges with
    /// edges. 0 without [`ClothSelfCollision`](crate::contact::ClothSelfCollision).
    pub layer_pairs: usize,
    /// How often in the tick these were searched for.
    pub layer_searches: u32,
    /// The largest stretch, at the end of the tick.
    pub stretch: Stretch,
    /// The impulse (N s, in the world) that the air gave the cloth in the tick, by drag, lift and pressure; 0 for one that sleeps.
    pub air_impulse: Vec3,
    /// What a cloth with a [`ClothPressure`](crate::solver::ClothPressure) encloses (m³), and the pressure in it over that of the outside (Pa):
    /// of the last tick in which it was awake.
    pub enclosed_volume: f32,
    /// See [`enclosed_volume`](Self::enclosed_volume).
    pub gauge_pressure: f32,
    /// Sub-steps of the tick, those included that were done again for the tolerance; 0 for a cloth that sleeps, is frozen, or waits
    /// for a tick in which it is moved.
    pub substeps: u32,
    /// The level of detail that the cloth is at.
    pub level: ClothLodLevel,
    /// Whether the cloth sleeps.
    pub is_asleep: bool,
    /// The first limit beyond which it is not simulated well, if it was beyond one as its last tick ended.
    pub exceeded: Option<ClothLimit>,
}
