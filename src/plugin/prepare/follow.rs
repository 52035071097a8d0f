//! Takes over changes of a cloth that keeps its particles.

use std::sync::Arc;

use bevy::ecs::change_detection::{DetectChangesMut, Mut};

use super::{
    build_inputs::{Build, BuildInputs},
    source::Sources,
};
use crate::{
    cloth::{ClothError, ClothMaterial, ClothParticles, Surface},
    plugin::state::{ClothBuilt, ClothState, Recipe, Shared, SharedParts, Stiffnesses},
};

/// Takes over another grain, or none: springs and bending follow other directions, the particles stay as they are.
pub(super) fn follow_grain(
    wanted: &BuildInputs,
    sources: &Sources,
    parts: &mut SharedParts,
    particles: &mut Mut<ClothParticles>,
    built: &mut ClothBuilt,
    state: &mut ClothState,
) -> Result<Build, ClothError> {
    wanted.check_material()?;
    wanted.pins.validate(built.surface())?;
    let Some(known) = &built.shared.recipe else {
        return Ok(Build::Kept);
    };
    let recipe = Recipe {
        grain: wanted.grain.map(|(grain, _)| grain.clone()),
        ..known.clone()
    };
    let of = |surface: &Surface| Ok(wanted.factors(surface)?.stiffness);
    let shared = parts.get(&recipe, wanted.material, of, || {
        recipe.surface(&sources.mesh(&recipe)?)
    })?;
    // A change that fails leaves the springs as they are.
    follow_changes(wanted, parts, particles, built, state)?;
    take_springs(built, shared, state);
    if let Some(from) = &mut built.from {
        from.grained = wanted.grained();
    }
    Ok(Build::Kept)
}

/// Takes over the springs of the same particles.
fn take_springs(built: &mut ClothBuilt, shared: Arc<Shared>, state: &mut ClothState) {
    built.shared = shared;
    let tethers = built.solver.take_tethers();
    built.solver = built.shared.solver.clone();
    built.solver.set_tethers(tethers);
    // The stretch that bounds rely on is measured over other springs now.
    state.inputs.written = None;
}

/// Takes over another material or other pins: masses, springs and tree only where they change, so that a
/// mass that the game has set outlasts a change of damping.
pub(super) fn follow_changes(
    wanted: &BuildInputs,
    parts: &mut SharedParts,
    particles: &mut Mut<ClothParticles>,
    built: &mut ClothBuilt,
    state: &mut ClothState,
) -> Result<(), ClothError> {
    let BuildInputs { material, pins, .. } = *wanted;
    check_count(particles, built.surface())?;
    let Some(from) = &mut built.from else {
        return Ok(());
    };
    let (was, were_pinned) = (&from.material, &from.pins);
    let are_others_pinned = were_pinned != pins;
    let is_mapped_otherwise = from.mapped != wanted.mapped();
    if was == material && !are_others_pinned && !is_mapped_otherwise {
        return Ok(());
    }
    wanted.check_material()?;
    let surface = &built.shared.surface;
    let mut is_as_stiff = true;
    if is_mapped_otherwise {
        let factors = wanted.factors(surface)?;
        pins.validate(surface)?;
        // The same as before leaves masses that the game has set.
        if factors.density != from.factors.density {
            // Their motion goes on: nothing that rests on where they are has to be looked at again.
            let particles = particles.bypass_change_detection();
            particles.weigh(surface, material, &factors.density)?;
            built.masses = particles.free_masses();
        }
        is_as_stiff = factors.stiffness == from.factors.stiffness;
        from.factors = factors;
        from.mapped = wanted.mapped();
    }
    if was.areal_density != material.areal_density || are_others_pinned {
        particles.assign_masses(surface, material, &from.factors.density, pins)?;
        // They are pinned again with the offsets that they have.
        for attached in &state.attachments.attached {
            particles.pin(attached.particle as usize);
        }
    }
    let tethered_by = |of: &ClothMaterial| {
        let compliances = (of.stretch_compliances(), of.shear_compliance);
        (of.areal_density, compliances, of.stiffening)
    };
    let gives_otherwise = tethered_by(was) != tethered_by(material);
    let is_sprung_otherwise = !is_as_stiff || !Stiffnesses::are_alike(was, material);
    let stiffness = from.factors.stiffness.clone();
    (from.material, from.pins) = (*material, pins.clone());
    if are_others_pinned || gives_otherwise || !is_as_stiff {
        built.forget_tethers();
    }
    if is_sprung_otherwise {
        let shared = parts.with_material(&built.shared, material, &stiffness);
        take_springs(built, shared, state);
    }
    state.rest.disturb();
    Ok(())
}

/// Whether the particles are as many as the surface has. One row of them is laid out as the surface is.
pub(super) fn check_count(
    particles: &mut Mut<ClothParticles>,
    surface: &Surface,
) -> Result<(), ClothError> {
    if particles.matches(surface) {
        return Ok(());
    }
    if let Some(laid_out) = particles.laid_out(surface) {
        **particles = laid_out;
        return Ok(());
    }
    Err(if particles.len() == surface.len() {
        ClothError::ParticleLayout {
            cloth: surface.to_string(),
            columns: particles.columns(),
            rows: particles.rows(),
        }
    } else {
        ClothError::ParticleCount {
            expected: surface.len(),
            found: particles.len(),
        }
    })
}
