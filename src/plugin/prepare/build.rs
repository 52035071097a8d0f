//! Builds cloths that are new or whose components have changed.

use std::sync::Arc;

use bevy::math::Vec3;

use super::{
    build_inputs::{Build, BuildInputs, Building},
    follow::check_count,
    resample::{is_same_rectangle, resample},
};
use crate::{
    cloth::{
        ClothError, ClothParticles, ClothShape, ClothTears, DensityFactors, MeshError, Surface,
    },
    plugin::state::{BuildRequest, BuiltFrom, Changes, FailedBuild, KnownShape, Recipe, Shared},
    solver::{TickStep, TimeOrder},
};

impl Building<'_, '_> {
    /// Builds a new cloth, or follows changes of an old one. Changes nothing on an error.
    pub(super) fn build(&mut self) -> Result<Build, ClothError> {
        let wanted = self.wanted;
        let is_built = self.is_built() && !self.particles.is_empty();
        let (built, state) = (&*self.built, &*self.state);
        let has_grain = is_built && built.has_grain(wanted.grain, wanted.changes.grain);
        // A snapshot may be from between a tear and its opening, or from before a map.
        let (opened, as_mesh) = (state.inputs.opened, state.inputs.as_mesh);
        let is_open = !state.resumes
            || built.tears().edges().len() == opened && built.is_as_mesh() == as_mesh;
        let has_form = built.is_torn_by(wanted.tears, wanted.changes.tears)
            && built.is_as_mesh() == wanted.is_as_mesh();
        let is_kept = has_grain && is_open && has_form;
        let failing = |particles: &ClothParticles| FailedBuild {
            changes: wanted.changes,
            source: wanted.source,
            material: *wanted.material,
            pins: wanted.pins.clone(),
            scale: wanted.scale,
            particles: [particles.columns(), particles.rows()],
        };
        // Inputs that failed once are not tried again: checking a mesh takes milliseconds.
        if let Some((before, error)) = &built.refused
            && *before == failing(self.particles)
        {
            return Err(error.clone());
        }
        let resumes = state.resumes;
        let new = if is_kept {
            self.follow_changes().map(|()| Build::Kept)
        } else if has_grain && !resumes {
            self.follow_tears()
        } else if is_built && !has_grain && !resumes {
            self.follow_grain()
        } else {
            self.build_new()
        };
        let refused = new.as_ref().err();
        let refused = refused.filter(|error| **error != ClothError::Mesh(MeshError::Loading));
        self.built.refused = refused.map(|error| (failing(self.particles), error.clone()));
        let build = new?;
        let (built, state) = (&mut *self.built, &mut *self.state);
        if is_kept {
            if let Some(from) = &mut built.from {
                from.changes = wanted.changes;
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
    fn is_built(&mut self) -> bool {
        let wanted = self.wanted;
        let (Some(from), Some(recipe)) = (&mut self.built.from, &self.built.shared.recipe) else {
            return false;
        };
        if recipe.source != wanted.source {
            return false;
        }
        // A mesh of the game's is long to compare with.
        if from.changes.cloth != wanted.changes.cloth {
            let is_same =
                from.unevenness == wanted.cloth.unevenness && *recipe.shape.0 == wanted.cloth.shape;
            if !is_same {
                return false;
            }
            from.changes.cloth = wanted.changes.cloth;
        }
        true
    }

    fn build_new(&mut self) -> Result<Build, ClothError> {
        let (wanted, sources) = (self.wanted, self.sources);
        let (cloth, material, pins) = (wanted.cloth, wanted.material, wanted.pins);
        cloth.validate()?;
        wanted.check_material()?;
        let inputs = &self.state.inputs;
        let (tears, as_mesh) = match self.state.resumes {
            true => (wanted.tears.first(inputs.opened), inputs.as_mesh),
            false => (wanted.tears.clone(), wanted.is_as_mesh()),
        };
        let is_open =
            tears.edges().len() == wanted.tears.edges().len() && as_mesh == wanted.is_as_mesh();
        let recipe = Recipe {
            shape: KnownShape(Arc::new(cloth.shape.clone())),
            scale: scale_of(wanted),
            source: wanted.source,
            grain: wanted.grain.cloned(),
            tears,
            as_mesh,
        };
        let request = (wanted.is_async && !self.state.resumes).then(|| BuildRequest {
            recipe: recipe.clone(),
            material: *material,
            map: wanted.map.cloned(),
            before: None,
        });
        // The known parts don't keep it.
        let _kept_alive = match request {
            Some(request) => self.parts.get_built(&request, || sources.mesh(&recipe))?,
            None => None,
        };
        let of = |surface: &Surface| wanted.factors(surface);
        let (shared, factors) = self.parts.get(&recipe, material, None, of, || {
            recipe.surface(&sources.mesh(&recipe)?)
        })?;
        let surface = &shared.surface;
        pins.validate(surface)?;
        let (build, new) = self.new_particles(&shared, &factors.density)?;
        if let Some(mut new) = new {
            pins.for_each(surface, |index| new.pin(index));
            self.state.detach();
            **self.particles = new;
        }
        let built = &mut *self.built;
        built.solver = shared.new_solver();
        built.forget_tethers();
        built.shared = shared;
        built.noticed.is_due = true;
        built.from = Some(BuiltFrom {
            unevenness: cloth.unevenness,
            changes: Changes {
                tears: wanted.changes.tears.filter(|_| is_open),
                ..wanted.changes
            },
            material: *material,
            factors,
            pins: pins.clone(),
        });
        if !is_open {
            return self.follow_tears();
        }
        Ok(build)
    }

    /// The particles of a cloth that is built anew; `None` to keep those that it has. Particles that came with a newly spawned cloth are
    /// kept as they are, masses included; those of another surface are not.
    fn new_particles(
        &mut self,
        shared: &Shared,
        factors: &DensityFactors,
    ) -> Result<(Build, Option<ClothParticles>), ClothError> {
        let surface = &shared.surface;
        if self.state.resumes {
            // The particles are those of a snapshot, with its pins and attachments.
            check_count(self.particles, surface)?;
            return Ok((Build::Kept, None));
        }
        if let Some(resampled) = self.resampled(shared, factors)? {
            return Ok((Build::Resampled, Some(resampled)));
        }
        if self.built.from.is_some() || self.particles.is_empty() {
            return Ok((Build::New, Some(at_rest(self.wanted, surface, factors)?)));
        }
        check_count(self.particles, surface)?;
        Ok((Build::New, Some((**self.particles).clone())))
    }

    /// The particles of a cloth of which only the resolution has changed, while the rectangle is the same; `None` for any
    /// other change.
    fn resampled(
        &self,
        shared: &Shared,
        factors: &DensityFactors,
    ) -> Result<Option<ClothParticles>, ClothError> {
        let (wanted, built, particles) = (self.wanted, &*self.built, &**self.particles);
        let surface = &shared.surface;
        let (Some(from), Some(to)) = (built.surface().rest_grid(), surface.rest_grid()) else {
            return Ok(None);
        };
        let is_torn = |tears: &ClothTears| !tears.edges().is_empty();
        if is_torn(built.tears()) || is_torn(wanted.tears) {
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
        wanted.for_each_attached(surface, |index| new.pin(index));
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
    let mut is_held = vec![false; surface.len()];
    wanted.for_each_attached(surface, |index| is_held[index] = true);
    particles.make_uneven(surface, wanted.cloth.unevenness, |index| is_held[index]);
    Ok(particles)
}
