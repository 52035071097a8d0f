//! A tick allocates nothing, neither its search nor its sub-steps. Alone in its program: the count is of all threads.

mod apps;
#[path = "../shared/meshes.rs"]
#[expect(dead_code, reason = "no regular mesh is needed here")]
mod meshes;
mod steps;

use std::alloc::System;

/// `meshes` calls the crate by this name: the crate's own tests include that file, too.
use bevy_drape as library;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// One test: what runs beside it would count, too.
#[test]
fn a_tick_does_not_allocate() {
    steps::a_step_does_not_allocate();
    steps::sharp_colliders_do_not_allocate();
    steps::a_mesh_does_not_allocate();
    steps::air_does_not_allocate();
    steps::neither_forces_nor_damping_allocate();
    apps::what_is_attached_or_animated_allocates_nothing();
    apps::what_is_pushed_allocates_nothing();
    apps::a_hand_allocates_nothing();
    apps::what_touches_itself_allocates_nothing();
    apps::what_moves_together_allocates_nothing();
    apps::pieces_allocate_nothing();
    apps::characters_allocate_nothing_more();
    apps::cloths_made_alike_share_all_but_their_particles();
}
