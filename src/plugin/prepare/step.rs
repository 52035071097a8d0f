//! The start of a cloth's tick, once the cloth is in place.

use bevy::prelude::{DetectChanges, Vec3};

use super::{
    asleep::ball,
    broad_phase::{reach, update_bounds},
    carry::carrier,
    preparing::{PrepareQueryItem, Surroundings},
};
use crate::{
    contact::ContactSettings,
    plugin::state::{ClothBuilt, ClothState, GameForces, Inputs, RestsOn},
    solver::{RestRule, Substepping, TickStep},
};

/// Decides whether the cloth may sleep, and wakes it if other forces act on it than before.
pub(super) fn see_whether_it_rests(
    cloth: &mut PrepareQueryItem,
    inputs: &Inputs,
    around: &Surroundings,
    forces: GameForces,
    acceleration: Vec3,
    seconds: f32,
) {
    let (particles, state) = (&cloth.particles, &mut *cloth.state);
    let (built, scratch) = (&*cloth.built, &mut *cloth.scratch);
    let settings = inputs.settings;
    scratch.rest_rule = if state.resting.on.iter().any(RestsOn::is_body) {
        RestRule::Carries
    } else if inputs.self_collision.is_some() && state.layer_substeps > 0 {
        RestRule::Layers
    } else {
        RestRule::Free
    };
    let known = Some(*inputs);
    let ball = || ball(built, particles, state.stretch.bound, &cloth.frame);
    let is_still = state.inputs.forces.is_still(forces, &around.field, ball);
    state.inputs.forces.renew(forces, &around.field, ball);
    if state.inputs.known != known || !is_still || !settings.sleeps {
        state.inputs.known = known;
        state.wake();
    } else if !scratch.pins.is_empty() {
        state.rest.disturb();
    } else if !state.rest.is_asleep() {
        let scale = (built.surface().diagonal(), acceleration.length());
        state
            .rest
            .observe(seconds, particles, scale, scratch.rest_rule);
    }
    // The plugin's own writing, up to here.
    state.inputs.written = Some(particles.last_changed());
}

/// Prepares what the solver does in the tick.
pub(super) fn prepare_step(
    cloth: &mut PrepareQueryItem,
    inputs: &Inputs,
    around: &Surroundings,
    acceleration: Vec3,
    (seconds, ticks): (f32, u32),
) {
    let (particles, state) = (&mut cloth.particles, &mut *cloth.state);
    let (built, scratch) = (&mut *cloth.built, &mut *cloth.scratch);
    let Inputs {
        settings, material, ..
    } = inputs;
    built.solver.set_stretch_damping(material.stretch_damping);
    let surface = built.surface().clone();
    follow_creases(built, state, inputs);
    if !state.rest.is_asleep() {
        let (forces, field) = (&mut built.solver.forces, &*around.field);
        (state.inputs.forces).set(forces, &surface, particles, &cloth.frame, field);
    }
    let along = surface.particles_along();
    // A move for several ticks takes the sub-steps of one: that saves the time.
    let one = seconds / ticks as f32;
    let needed = match settings.substepping {
        // Not needed.
        _ if state.rest.is_asleep() => Substepping::needed(along, one),
        Substepping::Fixed(substeps) => substeps,
        _ => (built.solver).needed(particles, along, one, settings.order),
    };
    let needed = match inputs.self_collision {
        Some(_) => needed.max(state.layer_substeps),
        None => needed,
    };
    let by_patches = surface.rest_grid().is_none() || material.stiffening.is_some();
    let for_stress = match settings.substepping {
        Substepping::Automatic if inputs.tearing.is_some() && by_patches => {
            Substepping::for_stress(one)
        }
        _ => 0,
    };
    if !state.rest.is_asleep() {
        // The tick says so again.
        state.layer_substeps = 0;
    }
    scratch.step = Some(TickStep {
        seconds,
        substeps: (state.control.substeps(settings.substepping, needed)).max(for_stress),
        acceleration,
        damping: material.damping,
        damped_against: carrier(&scratch.pins, built.pinned.len(), seconds),
        order: settings.order,
        material_stretch: built.material_stretch,
        has_layers: inputs.self_collision.is_some(),
    });
    scratch.substepping = settings.substepping;
}

/// Hands the solver the creases of the last tick. A cloth that does not crease any more has none.
fn follow_creases(built: &mut ClothBuilt, state: &mut ClothState, inputs: &Inputs) {
    if inputs.creasing.is_none() && state.creases.is_empty() {
        return;
    }
    let (surface, material) = (&built.shared.surface, &inputs.material);
    (built.solver).set_creasing(surface, material, inputs.creasing);
    if inputs.creasing.is_some() {
        built.solver.recall_creases(&state.creases);
    } else {
        state.creases.clear();
    }
}

/// Prepares its search for contacts, and its reach.
pub(super) fn prepare_contact(
    cloth: &mut PrepareQueryItem,
    inputs: &Inputs,
    acceleration: Vec3,
    seconds: f32,
) {
    let state = &mut *cloth.state;
    let (built, scratch) = (&*cloth.built, &mut *cloth.scratch);
    let material = &inputs.material;
    scratch.self_collision = inputs.self_collision;
    if scratch.was_put {
        state.carriers.clear();
    }
    if inputs.self_collision.is_none() {
        scratch.mutual = None;
    } else if let Some(mutual) = &mut scratch.mutual
        && scratch.was_put
    {
        mutual.forget();
    }
    scratch.search = inputs.search;
    scratch.contact_settings = ContactSettings {
        particle_radius: inputs.particle_radius(built.surface()),
        friction: material.friction,
        narrow_phase: inputs.narrow_phase,
        ..ContactSettings::default()
    };
    let least = (built.from.as_ref()).map_or(1.0, |from| from.factors.density.least);
    let lightest = material.areal_density * least;
    let by_forces = (state.inputs.forces).acceleration(lightest, state.largest_speed, seconds);
    let acceleration = acceleration.length() + by_forces;
    let pins = &scratch.pins;
    scratch.reach =
        reach(state, built.surface(), pins, acceleration, seconds) + scratch.constraints.travel();
    state.lod.reach = scratch.reach;
    update_bounds(cloth);
}
