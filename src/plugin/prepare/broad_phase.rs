//! The region around a cloth in which it may touch anything in a tick.

use bevy::math::Vec3;

use super::preparing::PrepareQueryItem;
use crate::{
    cloth::Surface,
    contact::{ContactSettings, NarrowPhase},
    hierarchy::{SearchMethod, SearchReason},
    plugin::state::{BroadPhaseBounds, ClothBuilt, ClothState, ClothStats},
    solver::PinMotion,
};

/// Largest distance that a particle may move in a tick by itself (m): by its speed and acceleration (m/s²), by the
/// carriers of its neighbours' pins, and by the recoil of springs that are stretched now.
pub(crate) fn reach(
    state: &ClothState,
    surface: &Surface,
    pins: &[PinMotion],
    acceleration: f32,
    seconds: f32,
) -> f32 {
    let carried = pins.iter().map(|pin| pin.from.distance(pin.to));
    (state.largest_speed + acceleration * seconds) * seconds
        + carried.fold(0.0, f32::max)
        + state.stretch.bound * surface.longest_spring()
}

/// Largest distance of a triangle's points from the particle that stands for it (m): along a spring or two.
pub(crate) fn cover(settings: &ContactSettings, stretch: f32, built: &ClothBuilt) -> f32 {
    match settings.narrow_phase {
        NarrowPhase::Particles => 0.0,
        NarrowPhase::Auto | NarrowPhase::Triangles => {
            built.tree().face_reach(built.surface()) * (1.0 + stretch) * (1.0 + 1.0e-5)
        }
    }
}

/// Sets the region in which the cloth may touch anything in the tick. Nothing counts as near until it is found.
pub(super) fn update_bounds(cloth: &mut PrepareQueryItem) {
    let (built, bounds) = (&*cloth.built, &mut *cloth.bounds);
    let (state, scratch) = (&mut *cloth.state, &mut *cloth.scratch);
    let stretch = state.stretch.bound;
    let root = built.tree().root_sphere(&cloth.particles, stretch);
    let centre = cloth.frame.to_world(root.center.into());
    let settings = &scratch.contact_settings;
    let around = scratch.reach + settings.particle_radius + cover(settings, stretch, built);
    let is_asleep = state.rest.is_asleep();
    let mut is_stale = bounds.is_searched || bounds.is_stale;
    if !is_asleep {
        scratch.near.clear();
        scratch.detection.begin(built.surface(), scratch.reach);
        let radius = scratch.contact_settings.particle_radius;
        scratch.detection.set_particle_radius(radius);
        if let Some(from) = &built.from {
            scratch.detection.set_grips(&from.factors.grips);
        }
        state.resting.on.clear();
        if is_stale {
            cloth.search.query.clear();
            is_stale = false;
        }
    }
    *bounds = BroadPhaseBounds {
        centre,
        radius: (root.radius() + around) * (1.0 + 1.0e-5) + centre.length() * 1.0e-5,
        takes_part: true,
        // It keeps the colliders that it fell asleep on.
        has_sleeping_contacts: is_asleep && !state.resting.on.is_empty(),
        is_searched: false,
        is_stale,
    };
}

/// The figures of a tick in which nothing has happened yet.
pub(crate) fn clear_stats(stats: &mut ClothStats, is_asleep: bool) {
    stats.search = SearchMethod::Auto;
    stats.reason = if is_asleep {
        SearchReason::Asleep
    } else {
        SearchReason::NothingNear
    };
    (stats.rebuild_ms, stats.query_ms) = (0.0, 0.0);
    (stats.nodes_visited, stats.leaf_tests) = (0, 0);
    (stats.colliders_near, stats.by_triangles) = (0, 0);
    stats.requeries = 0;
    stats.air_impulse = Vec3::ZERO;
    (stats.layer_pairs, stats.layer_searches) = (0, 0);
}
