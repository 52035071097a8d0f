//! Takes over changes of a cloth that keeps its particles.

use std::sync::Arc;

use bevy::prelude::{DetectChangesMut, Mut};

use super::build_inputs::{Build, Building};
use crate::{
    cloth::{ClothError, ClothMaterial, ClothParticles, ParticleError, Surface},
    plugin::state::{Recipe, Shared, Stiffnesses},
};

impl Building<'_, '_> {
    /// Takes over another grain, or none: springs and bending follow other directions, the particles stay as they are.
    pub(super) fn follow_grain(&mut self) -> Result<Build, ClothError> {
        let (wanted, sources) = (self.wanted, self.sources);
        wanted.check_material()?;
        wanted.pins.validate(self.built.surface())?;
        let Some(known) = &self.built.shared.recipe else {
            return Ok(Build::Kept);
        };
        let recipe = Recipe {
            grain: wanted.grain.cloned(),
            ..known.clone()
        };
        let of = |surface: &Surface| wanted.factors(surface);
        let (shared, _) = self.parts.get(&recipe, wanted.material, None, of, || {
            recipe.surface(&sources.mesh(&recipe)?)
        })?;
        // A change that fails leaves the springs as they are.
        self.follow_masses()?;
        self.take_springs(shared);
        if let Some(from) = &mut self.built.from {
            from.changes.grain = wanted.changes.grain;
        }
        Ok(Build::Kept)
    }

    /// Takes over the springs of the same particles.
    fn take_springs(&mut self, shared: Arc<Shared>) {
        let mut solver = shared.new_solver();
        self.built.shared = shared;
        solver.take_tethers_of(&mut self.built.solver);
        self.built.solver = solver;
        // The stretch that bounds rely on is measured over other springs now.
        self.state.inputs.written = None;
    }

    /// Takes over another material, map of it, or other pins, and springs, if these change.
    pub(super) fn follow_changes(&mut self) -> Result<(), ClothError> {
        let are_others = self.follow_masses()?;
        let known = &self.built.shared;
        if let (Some(from), Some(recipe), true) = (&self.built.from, &known.recipe, are_others) {
            let of = |_: &Surface| Ok(from.factors.clone());
            // It exists, so it is not made.
            let surface = || Ok((*known.surface).clone());
            let (shared, _) = (self.parts).get(recipe, self.wanted.material, None, of, surface)?;
            self.take_springs(shared);
        }
        Ok(())
    }

    /// Takes over another material, map of it, or other pins: masses only where they change, so that a mass that the game has set
    /// outlasts a change of damping. Returns whether the springs are others.
    pub(super) fn follow_masses(&mut self) -> Result<bool, ClothError> {
        let wanted = self.wanted;
        let (built, state) = (&mut *self.built, &mut *self.state);
        let (particles, material, pins) = (&mut *self.particles, wanted.material, wanted.pins);
        check_count(particles, built.surface())?;
        let Some(from) = &mut built.from else {
            return Ok(false);
        };
        let is_mapped_otherwise = from.changes.map != wanted.changes.map;
        let are_others_pinned = from.pins != *pins;
        if from.material == *material && !are_others_pinned && !is_mapped_otherwise {
            return Ok(false);
        }
        wanted.check_material()?;
        let surface = &built.shared.surface;
        pins.validate(surface)?;
        let factors = match is_mapped_otherwise {
            true => wanted.factors(surface)?,
            false => from.factors.clone(),
        };
        from.changes.map = wanted.changes.map;
        if from.material == *material && !are_others_pinned && from.factors == factors {
            // Written, and not changed.
            return Ok(false);
        }
        factors.density.check(surface, material)?;
        if from.factors.density != factors.density {
            // Their motion goes on: nothing that rests on where they are has to be looked at again.
            let particles = particles.bypass_change_detection();
            particles.weigh(surface, material, &factors.density)?;
            built.masses = particles.free_masses();
        }
        if from.material.areal_density != material.areal_density || are_others_pinned {
            particles.assign_masses(surface, material, &factors.density, pins)?;
            // They are pinned again with the offsets that they have.
            for attached in &state.attachments.attached {
                particles.pin(attached.particle as usize);
            }
        }
        let tethered_by = |of: &ClothMaterial| {
            let compliances = (of.stretch_compliances(), of.shear_compliance);
            (of.areal_density, compliances, of.stiffening)
        };
        let is_as_stiff = from.factors.stiffness == factors.stiffness;
        let stiffnesses = |of: &ClothMaterial| Stiffnesses::of(of, &factors.stiffness);
        let gives_otherwise = tethered_by(&from.material) != tethered_by(material);
        let is_sprung_otherwise =
            !is_as_stiff || stiffnesses(&from.material) != stiffnesses(material);
        (from.material, from.pins, from.factors) = (*material, pins.clone(), factors);
        if are_others_pinned || gives_otherwise || !is_as_stiff {
            built.forget_tethers();
        }
        state.wake();
        Ok(is_sprung_otherwise)
    }
}

/// Whether the particles are as many as the surface has. One row of them is laid out as the surface is, and a grid as its mesh.
pub(super) fn check_count(
    particles: &mut Mut<ClothParticles>,
    surface: &Surface,
) -> Result<(), ParticleError> {
    if particles.matches(surface) {
        return Ok(());
    }
    let rows = [particles.columns(), particles.rows()];
    let is_grid_as_mesh = || {
        let grid = surface.rest_grid();
        grid.is_some_and(|grid| rows == [grid.columns(), grid.rows()])
    };
    if (rows[1] == 1 || is_grid_as_mesh())
        && let Some(laid_out) = particles.laid_out(surface)
    {
        **particles = laid_out;
        return Ok(());
    }
    Err(if particles.len() == surface.len() {
        ParticleError::Layout {
            cloth: surface.to_string(),
            columns: particles.columns(),
            rows: particles.rows(),
        }
    } else {
        ParticleError::Count {
            expected: surface.len(),
            found: particles.len(),
        }
    })
}
