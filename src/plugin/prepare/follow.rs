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
    wanted.material.validate()?;
    wanted.pins.validate(built.surface())?;
    let Some(known) = &built.shared.recipe else {
        return Ok(Build::Kept);
    };
    let recipe = Recipe {
        grain: wanted.grain.map(|(grain, _)| grain.clone()),
        ..known.clone()
    };
    let shared = parts.get(&recipe, wanted.material, || sources.surface(&recipe))?;
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
    let is_weighed_otherwise = from.weighed != wanted.weighed();
    if was == material && !are_others_pinned && !is_weighed_otherwise {
        return Ok(());
    }
    material.validate()?;
    let surface = &built.shared.surface;
    if is_weighed_otherwise {
        let factors = wanted.factors(surface)?;
        pins.validate(surface)?;
        // The same as before leaves masses that the game has set.
        if factors != from.factors {
            // Their motion goes on: nothing that rests on where they are has to be looked at again.
            let particles = particles.bypass_change_detection();
            particles.weigh(surface, material, &factors)?;
            built.masses = particles.free_masses();
            from.factors = factors;
        }
        from.weighed = wanted.weighed();
    }
    if was.areal_density != material.areal_density || are_others_pinned {
        particles.assign_masses(surface, material, &from.factors, pins)?;
        // They are pinned again with the offsets that they have.
        for attached in &state.attachments.attached {
            particles.pin(attached.particle as usize);
        }
    }
    let tethered_by = |of: &ClothMaterial| {
        let [weft, warp] = of.stretch_compliances();
        [of.areal_density, weft, warp, of.shear_compliance]
    };
    let gives_otherwise = tethered_by(was) != tethered_by(material);
    let is_sprung_otherwise = Stiffnesses::of(was) != Stiffnesses::of(material);
    (from.material, from.pins) = (*material, pins.clone());
    if are_others_pinned || gives_otherwise {
        built.forget_tethers();
    }
    if is_sprung_otherwise {
        let shared = parts.with_material(&built.shared, material);
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
