//! Builds cloths that are new or whose components have changed.

use std::sync::Arc;

use bevy::{
    ecs::change_detection::{DetectChangesMut, Mut, Tick},
    math::Vec3,
};

use super::{
    resample::{is_same_rectangle, resample},
    source::Sources,
    tears::follow_tears,
};
use crate::{
    cloth::{
        Cloth, ClothDensity, ClothError, ClothGrain, ClothMaterial, ClothParticles, ClothTears,
        DensityFactors, Pins, Surface,
    },
    plugin::{
        authoring::ClothAttachment,
        state::{
            BuiltFrom, ClothBuilt, ClothState, FailedBuild, Recipe, Shared, SharedParts, Source,
            Stiffnesses,
        },
    },
    solver::{TickStep, TimeOrder},
};

/// The game's description of a cloth. Removed components count as their defaults, and as no pins.
pub(crate) struct BuildInputs<'a> {
    pub cloth: &'a Cloth,
    /// When the cloth was last changed.
    pub changed: Tick,
    /// Its mesh, if it is made from one.
    pub source: Option<Source>,
    pub material: &'a ClothMaterial,
    /// The grain of a mesh with a weft, and when it was last changed.
    pub grain: Option<(&'a ClothGrain, Option<Tick>)>,
    /// Its density, and when that was last changed.
    pub density: Option<(&'a ClothDensity, Tick)>,
    /// Its tears, and when they were last changed.
    pub tears: Option<(&'a ClothTears, Tick)>,
    pub pins: &'a Pins,
    pub attachments: &'a [ClothAttachment],
    pub scale: Vec3,
}

impl BuildInputs<'_> {
    /// When its density was last changed.
    fn weighed(&self) -> Option<Tick> {
        self.density.map(|(_, changed)| changed)
    }

    /// When its grain was last changed.
    fn grained(&self) -> Option<Tick> {
        self.grain.and_then(|(_, changed)| changed)
    }

    /// When its tears were last changed.
    pub(super) fn torn(&self) -> Option<Tick> {
        self.tears.map(|(_, changed)| changed)
    }

    pub(super) fn tears(&self) -> ClothTears {
        self.tears
            .map_or_else(ClothTears::none, |(tears, _)| tears.clone())
    }

    pub(super) fn factors(&self, surface: &Surface) -> Result<DensityFactors, ClothError> {
        self.density.map_or_else(
            || Ok(DensityFactors::default()),
            |(density, _)| density.factors(surface),
        )
    }
}

/// The result of building.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Build {
    /// The particles are those of the last tick.
    Kept,
    /// Of another resolution, or torn, at the places of the last tick.
    Resampled,
    /// New particles.
    New,
}

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
    if has_grain && built.is_torn_by(wanted.tears) {
        follow_changes(wanted, parts, particles, built, state)?;
        return Ok(Build::Kept);
    }
    // Inputs that failed once are not tried again: checking a mesh takes milliseconds.
    let tried = FailedBuild {
        changed: wanted.changed,
        source: wanted.source,
        material: *wanted.material,
        grained: wanted.grain.map(|(_, changed)| changed),
        weighed: wanted.weighed(),
        torn: wanted.torn(),
        pins: wanted.pins.clone(),
        scale: wanted.scale,
        particles: [particles.columns(), particles.rows()],
    };
    if let Some((before, error)) = &built.refused
        && *before == tried
    {
        return Err(error.clone());
    }
    let resumes = state.resumes;
    let new = if has_grain && !resumes {
        follow_tears(wanted, parts, particles, built, state)
    } else if is_built && !has_grain {
        follow_grain(wanted, sources, parts, particles, built, state)
    } else {
        build_new(wanted, sources, parts, particles, built, state)
    };
    built.refused = new.as_ref().err().map(|error| (tried, error.clone()));
    let build = new?;
    if !resumes {
        state.rest.disturb();
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
            from.unevenness == wanted.cloth.unevenness && recipe.shape == wanted.cloth.shape;
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
    material.validate()?;
    let recipe = Recipe {
        shape: cloth.shape.clone(),
        scale: scale_of(wanted),
        source: wanted.source,
        grain: wanted.grain.map(|(grain, _)| grain.clone()),
        tears: wanted.tears(),
    };
    let shared = parts.get(&recipe, material, || sources.surface(&recipe))?;
    let surface = &shared.surface;
    pins.validate(surface)?;
    let factors = wanted.factors(surface)?;
    // Particles that came with a newly spawned cloth are kept as they are, masses included; those of another surface are
    // not.
    let (build, new) = if state.resumes {
        // The particles are those of a snapshot, with its pins and attachments.
        check_count(particles, surface)?;
        (Build::Kept, None)
    } else if let Some(resampled) = resampled(wanted, &shared, &factors, particles, built)? {
        (Build::Resampled, Some(resampled))
    } else if built.from.is_some() || particles.is_empty() {
        (Build::New, Some(at_rest(wanted, surface, &factors)?))
    } else {
        check_count(particles, surface)?;
        (Build::New, Some((**particles).clone()))
    };
    if let Some(mut new) = new {
        pins.for_each(surface, |index| new.pin(index));
        state.detach();
        **particles = new;
    }
    built.solver = shared.solver.clone();
    built.forget_tethers();
    built.shared = shared;
    built.noticed.is_due = true;
    built.from = Some(BuiltFrom {
        unevenness: cloth.unevenness,
        changed: wanted.changed,
        material: *material,
        grained: wanted.grained(),
        weighed: wanted.weighed(),
        factors,
        pins: pins.clone(),
        torn: wanted.torn(),
    });
    Ok(build)
}

/// Takes over another grain, or none: springs and bending follow other directions, the particles stay as they are.
fn follow_grain(
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
    let (Some(from), Some(to)) = (built.surface().as_grid(), surface.as_grid()) else {
        return Ok(None);
    };
    let is_known = built.matches(particles) && particles.validate().is_ok();
    if !is_known || !is_same_rectangle(from, to) {
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
