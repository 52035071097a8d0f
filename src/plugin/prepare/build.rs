//! Builds cloths that are new or whose components have changed.

use std::sync::Arc;

use bevy::{ecs::change_detection::Mut, math::Vec3};

use super::{
    build_inputs::{Build, BuildInputs},
    follow::{check_count, follow_changes, follow_grain},
    resample::{is_same_rectangle, resample},
    source::Sources,
    tears::follow_tears,
};
use crate::{
    cloth::{
        ClothError, ClothParticles, ClothShape, ClothTears, DensityFactors, MaterialFactors,
        MeshError, Surface,
    },
    plugin::state::{
        BuiltFrom, ClothBuilt, ClothState, FailedBuild, KnownShape, Recipe, Shared, SharedParts,
    },
    solver::{TickStep, TimeOrder},
};

/// Builds a new cloth, or follows changes of an old one. Changes nothing on an error.
pub(crate) fn build(
    wanted: &BuildInputs,
    sources: &Sources,
    parts: &mut SharedParts,
    particles: &mut Mut<ClothParticles>,
    built: &mut ClothBuilt,
    state: &mut ClothState,
) -> Result<Build, ClothError> {
    let is_built = is_built(wanted, built) && !particles.is_empty();
    let has_grain = is_built && built.has_grain(wanted.grain);
    // A snapshot may be from between a tear and its opening, or from before a map.
    let (opened, as_mesh) = (state.inputs.opened, state.inputs.as_mesh);
    let is_open =
        !state.resumes || built.tears().edges().len() == opened && built.is_as_mesh() == as_mesh;
    let has_form = built.is_torn_by(wanted.tears) && built.is_as_mesh() == wanted.is_as_mesh();
    let is_kept = has_grain && is_open && has_form;
    let failing = |particles: &ClothParticles| FailedBuild {
        changed: wanted.changed,
        source: wanted.source,
        material: *wanted.material,
        grained: wanted.grain.map(|(_, changed)| changed),
        mapped: wanted.mapped(),
        torn: wanted.torn(),
        pins: wanted.pins.clone(),
        scale: wanted.scale,
        particles: [particles.columns(), particles.rows()],
    };
    // Inputs that failed once are not tried again: checking a mesh takes milliseconds.
    if let Some((before, error)) = &built.refused
        && *before == failing(particles)
    {
        return Err(error.clone());
    }
    let resumes = state.resumes;
    let new = if is_kept {
        follow_changes(wanted, parts, particles, built, state).map(|()| Build::Kept)
    } else if has_grain && !resumes {
        follow_tears(wanted, parts, particles, built, state)
    } else if is_built && !has_grain && !resumes {
        follow_grain(wanted, sources, parts, particles, built, state)
    } else {
        build_new(wanted, sources, parts, particles, built, state)
    };
    let refused = new.as_ref().err();
    let refused = refused.filter(|error| **error != ClothError::Mesh(MeshError::Loading));
    built.refused = refused.map(|error| (failing(particles), error.clone()));
    let build = new?;
    if is_kept {
        if let Some(from) = &mut built.from {
            from.torn = wanted.torn();
        }
        return Ok(build);
    }
    state.inputs.opened = built.tears().edges().len();
    state.inputs.as_mesh = built.is_as_mesh();
    if !resumes {
        state.wake();
        state.resting.pieces.forget();
    }
    Ok(build)
}

/// Whether the built data belongs to that cloth, whatever its pins and material.
fn is_built(wanted: &BuildInputs, built: &mut ClothBuilt) -> bool {
    let (Some(from), Some(recipe)) = (&mut built.from, &built.shared.recipe) else {
        return false;
    };
    if recipe.source != wanted.source {
        return false;
    }
    // A mesh of the game's is long to compare with.
    if from.changed != wanted.changed {
        let is_same =
            from.unevenness == wanted.cloth.unevenness && *recipe.shape.0 == wanted.cloth.shape;
        if !is_same {
            return false;
        }
        from.changed = wanted.changed;
    }
    true
}

fn build_new(
    wanted: &BuildInputs,
    sources: &Sources,
    parts: &mut SharedParts,
    particles: &mut Mut<ClothParticles>,
    built: &mut ClothBuilt,
    state: &mut ClothState,
) -> Result<Build, ClothError> {
    let BuildInputs {
        cloth,
        material,
        pins,
        ..
    } = *wanted;
    cloth.validate()?;
    wanted.check_material()?;
    let recipe = Recipe {
        shape: KnownShape(Arc::new(cloth.shape.clone())),
        scale: scale_of(wanted),
        source: wanted.source,
        grain: wanted.grain.map(|(grain, _)| grain.clone()),
        tears: match state.resumes {
            true => wanted.tears().first(state.inputs.opened),
            false => wanted.tears(),
        },
        as_mesh: match state.resumes {
            true => state.inputs.as_mesh,
            false => wanted.is_as_mesh(),
        },
    };
    let is_open = recipe.tears.edges().len() == wanted.tears().edges().len()
        && recipe.as_mesh == wanted.is_as_mesh();
    let mut factors = MaterialFactors::default();
    let of = |surface: &Surface| {
        factors = wanted.factors(surface)?;
        Ok(factors.stiffness.clone())
    };
    // The known parts don't keep it.
    let _kept_alive = match wanted.is_async && !state.resumes {
        true => parts.get_built(&wanted.request(&recipe), || sources.mesh(&recipe))?,
        false => None,
    };
    let shared = parts.get(&recipe, material, None, of, || {
        recipe.surface(&sources.mesh(&recipe)?)
    })?;
    let surface = &shared.surface;
    pins.validate(surface)?;
    let (build, new) = new_particles(wanted, &shared, &factors.density, particles, built, state)?;
    if let Some(mut new) = new {
        pins.for_each(surface, |index| new.pin(index));
        state.detach();
        **particles = new;
    }
    built.solver = shared.new_solver();
    built.forget_tethers();
    built.shared = shared;
    built.noticed.is_due = true;
    built.from = Some(BuiltFrom {
        unevenness: cloth.unevenness,
        changed: wanted.changed,
        material: *material,
        grained: wanted.grained(),
        mapped: wanted.mapped(),
        factors,
        pins: pins.clone(),
        torn: wanted.torn().filter(|_| is_open),
    });
    if !is_open {
        return follow_tears(wanted, parts, particles, built, state);
    }
    Ok(build)
}

/// The particles of a cloth that is built anew; `None` to keep those that it has. Particles that came with a newly spawned cloth are
/// kept as they are, masses included; those of another surface are not.
fn new_particles(
    wanted: &BuildInputs,
    shared: &Shared,
    factors: &DensityFactors,
    particles: &mut Mut<ClothParticles>,
    built: &ClothBuilt,
    state: &ClothState,
) -> Result<(Build, Option<ClothParticles>), ClothError> {
    let surface = &shared.surface;
    if state.resumes {
        // The particles are those of a snapshot, with its pins and attachments.
        check_count(particles, surface)?;
        return Ok((Build::Kept, None));
    }
    if let Some(resampled) = resampled(wanted, shared, factors, particles, built)? {
        return Ok((Build::Resampled, Some(resampled)));
    }
    if built.from.is_some() || particles.is_empty() {
        return Ok((Build::New, Some(at_rest(wanted, surface, factors)?)));
    }
    check_count(particles, surface)?;
    Ok((Build::New, Some((**particles).clone())))
}

/// The particles of a cloth of which only the resolution has changed, while the rectangle is the same; `None` for any
/// other change.
fn resampled(
    wanted: &BuildInputs,
    shared: &Shared,
    factors: &DensityFactors,
    particles: &ClothParticles,
    built: &ClothBuilt,
) -> Result<Option<ClothParticles>, ClothError> {
    let surface = &shared.surface;
    let (Some(from), Some(to)) = (built.surface().rest_grid(), surface.rest_grid()) else {
        return Ok(None);
    };
    let is_torn = |tears: &ClothTears| !tears.edges().is_empty();
    if is_torn(built.tears()) || is_torn(&wanted.tears()) {
        return Ok(None);
    }
    let is_known = built.matches(particles) && particles.validate().is_ok();
    let known = built.shared.recipe.as_ref().map(|recipe| &*recipe.shape.0);
    let (path, known) = (wanted.cloth.shape.path(), known.and_then(ClothShape::path));
    // The rectangle of a path's grid says how long it is, and not where it leads.
    let is_alike = path == known && (path.is_none() || from.scale() == to.scale());
    if !is_known || !is_alike || !is_same_rectangle(from, to) {
        return Ok(None);
    }
    let mut new = ClothParticles::at_rest(surface, wanted.material)?;
    new.assign_masses(surface, wanted.material, factors, wanted.pins)?;
    // Attached particles will be pinned where they are.
    for attachment in wanted.attachments {
        if attachment.pin.validate(surface).is_ok() {
            attachment.pin.for_each(surface, |index| new.pin(index));
        }
    }
    // Sub-steps in which nothing pulls and no velocity is kept: chains get the lengths that they have, without a jolt.
    let step = TickStep {
        seconds: 1.0 / 16.0,
        substeps: 80,
        damping: 1.0,
        order: TimeOrder::First,
        ..TickStep::default()
    };
    resample((particles, from), (&mut new, to), |new| {
        shared.solver.clone().advance(new, step, &[], |_, _| false);
    })?;
    Ok(Some(new))
}

/// The scale of a cloth. That of a mesh without its last digits, which depend on how the cloth is turned: so that those made
/// alike share one surface.
fn scale_of(wanted: &BuildInputs) -> Vec3 {
    if wanted.cloth.as_grid().is_some() {
        return wanted.scale;
    }
    let round = |number: f32| f32::from_bits(number.to_bits().wrapping_add(16) & !31);
    Vec3::from_array(wanted.scale.to_array().map(round))
}

/// The particles of a new cloth.
fn at_rest(
    wanted: &BuildInputs,
    surface: &Surface,
    factors: &DensityFactors,
) -> Result<ClothParticles, ClothError> {
    let mut particles = ClothParticles::at_rest(surface, wanted.material)?;
    particles.assign_masses(surface, wanted.material, factors, wanted.pins)?;
    // Attached particles will be pinned where they are.
    let mut is_held = vec![false; surface.len()];
    for attachment in wanted.attachments {
        if attachment.pin.validate(surface).is_ok() {
            attachment
                .pin
                .for_each(surface, |index| is_held[index] = true);
        }
    }
    particles.make_uneven(surface, wanted.cloth.unevenness, |index| is_held[index]);
    Ok(particles)
}
