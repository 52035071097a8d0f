//! Builds what does not exist yet or was made from other components than those present.

use super::prepare::PreparingItem;
use crate::{
    cloth::{ClothError, ClothGrid, ClothMaterial, ClothParticles, Pins, SpringKind, Springs},
    hierarchy::QuadTree,
    plugin::{ClothAttachments, ClothTopology},
    solver::{Solver, Tethers, given_stretch},
};

use bevy::math::Vec3;

/// The pins of a cloth from which the game took its [`Pins`]. In place of other components the defaults count.
static NO_PINS: Pins = Pins::none();

impl PreparingItem<'_, '_> {
    /// Weaves a new cloth, or follows changes of an old one. Returns whether it had been woven before. Changes
    /// nothing on an error.
    pub(super) fn weave(
        &mut self,
        material: &ClothMaterial,
        scale: Vec3,
    ) -> Result<bool, ClothError> {
        let woven = self.topology.woven.as_ref();
        let was_woven =
            woven.is_some_and(|(cloth, ..)| cloth == self.cloth) && !self.particles.is_empty();
        if was_woven {
            self.follow_changes(material)?;
        } else {
            self.weave_anew(material, scale)?;
            self.tick.rest.disturb();
        }
        Ok(was_woven)
    }

    fn weave_anew(&mut self, material: &ClothMaterial, scale: Vec3) -> Result<(), ClothError> {
        let pins = self.pins.unwrap_or(&NO_PINS);
        let grid = self.cloth.grid(scale)?;
        material.validate()?;
        pins.validate(&grid)?;
        // Particles that came with a newly spawned cloth are kept as they are, masses included; those of another
        // grid are not.
        let mut particles = if self.topology.woven.is_some() || self.particles.is_empty() {
            let mut particles = ClothParticles::at_rest(&grid, material)?;
            particles.weigh(&grid, material, pins)?;
            // What is attached will be pinned where it is.
            let mut is_held = vec![false; grid.len()];
            let attached = self
                .attachments
                .into_iter()
                .flat_map(ClothAttachments::iter);
            for attachment in attached.filter(|each| each.pin.validate(&grid).is_ok()) {
                attachment
                    .pin
                    .for_each(&grid, |index| is_held[index] = true);
            }
            particles.make_uneven(&grid, self.cloth.unevenness, |index| is_held[index]);
            particles
        } else {
            check_count(&self.particles, &grid)?;
            self.particles.clone()
        };
        pins.for_each(&grid, |index| particles.pin(index));
        let springs = Springs::of_grid(&grid, material);
        let tree = QuadTree::of_grid(&grid, springs.has(SpringKind::Shear));
        self.tick.solver = Solver::new(&springs, &particles);
        self.tick.tethered = None;
        self.tick.attached.clear();
        self.tick.attachments.clear();
        self.tick.first_target = None;
        *self.particles = particles;
        *self.topology = ClothTopology {
            grid,
            springs,
            tree,
            woven: Some((*self.cloth, *material, pins.clone())),
        };
        Ok(())
    }

    /// Takes over another material or other pins: masses, springs and tree only where they change, so that a
    /// mass that the game has set outlasts a change of damping.
    fn follow_changes(&mut self, material: &ClothMaterial) -> Result<(), ClothError> {
        let pins = self.pins.unwrap_or(&NO_PINS);
        let topology = &mut *self.topology;
        check_count(&self.particles, &topology.grid)?;
        let Some((_, was, were_pinned)) = &mut topology.woven else {
            return Ok(());
        };
        if was == material && were_pinned == pins {
            return Ok(());
        }
        material.validate()?;
        if was.areal_density != material.areal_density || were_pinned != pins {
            self.particles.weigh(&topology.grid, material, pins)?;
            // They are pinned anew with the offsets that they have.
            for attached in &self.tick.attached {
                self.particles.pin(attached.particle as usize);
            }
        }
        let compliances = |of: &ClothMaterial| {
            [
                of.stretch_compliance,
                of.shear_compliance,
                of.bend_compliance,
            ]
        };
        let tethered_by =
            |of: &ClothMaterial| [of.areal_density, of.stretch_compliance, of.shear_compliance];
        if were_pinned != pins || tethered_by(was) != tethered_by(material) {
            self.tick.tethered = None;
        }
        if compliances(was) != compliances(material) {
            let had_diagonals = topology.springs.has(SpringKind::Shear);
            topology.springs = Springs::of_grid(&topology.grid, material);
            let has_diagonals = topology.springs.has(SpringKind::Shear);
            if had_diagonals != has_diagonals {
                topology.tree = QuadTree::of_grid(&topology.grid, has_diagonals);
            }
            let tethers = self.tick.solver.take_tethers();
            self.tick.solver = Solver::new(&topology.springs, &self.particles);
            self.tick.solver.set_tethers(tethers);
            // The stretch that bounds rely on is measured over other springs now.
            self.tick.written = None;
        }
        (*was, *were_pinned) = (*material, pins.clone());
        self.tick.rest.disturb();
        Ok(())
    }

    /// Makes tethers anew if what they were made for has changed: the pins, the material, or what pulls at them; and
    /// what follows from the same.
    pub(super) fn tether(&mut self, wanted: bool, material: &ClothMaterial, acceleration: f32) {
        let grid = &self.topology.grid;
        if self.tick.tethered.is_none() {
            self.tick.pinned = self
                .particles
                .inverse_masses()
                .filter(|w| *w == 0.0)
                .count();
            self.tick.masses = self.particles.free_masses();
            self.tick.pins_version = self.tick.pins_version.wrapping_add(1);
        }
        self.tick.given_stretch = given_stretch(grid, material, self.tick.pinned, acceleration);
        let acceleration = Tethers::made_for(acceleration);
        let made_for = Some((wanted, acceleration));
        if self.tick.tethered == made_for {
            return;
        }
        self.tick.tethered = made_for;
        let tethers = if wanted {
            Tethers::new(&self.topology.grid, material, &self.particles, acceleration)
        } else {
            Tethers::default()
        };
        self.tick.solver.set_tethers(tethers);
    }
}

/// Whether the particles are as many as the grid has, in as many columns.
fn check_count(particles: &ClothParticles, grid: &ClothGrid) -> Result<(), ClothError> {
    if particles.fit(grid) {
        return Ok(());
    }
    Err(ClothError::ParticleCount {
        expected: grid.len(),
        found: particles.len(),
    })
}
