//! The particles of a cloth, as a structure of arrays.

mod density;
mod error;
mod extent;
mod load;
mod loads;
mod past;
mod restored;
#[cfg(test)]
mod tests;
mod upkeep;
mod validity;

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    lanes::{Block, LANES, Layout, Slot, W},
    material::ClothMaterial,
    particle_id::ParticleId,
    pins::Pins,
    quantity::QuantityError,
    surface::Surface,
};

pub use error::ParticleError;

pub(crate) use density::DensityFactors;
pub(crate) use load::Load;
pub(crate) use past::{Earlier, Past, StepKind};

/// The sub-step that displacements span until the first tick says otherwise: 20 a tick of Bevy's 64 Hz.
const DEFAULT_SUBSTEP: f32 = 1.0 / 1280.0;

/// Sub-steps of first order after a particle's position or mass was set.
const AFTER_A_JUMP: u32 = 3;

/// The particles of a cloth: position, displacement and inverse mass, stored as arrays of eight lanes.
///
/// The particles of a grid are in rows. Those of a mesh are in one row, ordered so that neighbours are near each other:
/// [`Surface::particle_of_vertex`] gives the particle of a vertex.
///
/// Everything is in metres in the cloth's own frame: the entity's global translation and rotation, with the scale
/// already applied. The state is (position, displacement) rather than two positions: the difference of two rounded
/// positions loses gravity as steps shrink.
///
/// Empty until the first tick after the [`Cloth`](crate::cloth::Cloth) was spawned. Games may read and write it between ticks.
/// To rebuild the cloth at rest, empty it: `*particles = default()`.
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothParticles {
    layout: Layout,
    blocks: Vec<Block>,
    substep: f32,
    #[reflect(ignore)]
    pub(crate) past: Past,
    /// Loads in the coming sub-step; empty between ticks.
    #[reflect(ignore)]
    #[cfg_attr(feature = "serialize", serde(skip))]
    loads: Vec<Load>,
}

impl Default for ClothParticles {
    fn default() -> Self {
        Self {
            layout: Layout::default(),
            blocks: Vec::new(),
            substep: DEFAULT_SUBSTEP,
            past: Past::default(),
            loads: Vec::new(),
        }
    }
}

impl ClothParticles {
    /// The particles of a surface at rest, all free, with masses from `material`.
    ///
    /// # Errors
    /// [`QuantityError`] for a particle mass outside 10⁻¹⁵ to 10¹⁵ kg.
    pub fn at_rest(surface: &Surface, material: &ClothMaterial) -> Result<Self, QuantityError> {
        let mut particles = Self::of_layout(surface.layout());
        let places = surface.rest_positions().iter();
        for (position, slot) in places.zip(particles.layout.slots()) {
            particles.blocks[slot.block].set_position(slot.lane, *position);
        }
        let factors = DensityFactors::default();
        particles.assign_masses(surface, material, &factors, &Pins::none())?;
        Ok(particles)
    }

    /// Particles at rest, from positions (m) and inverse masses (1/kg, 0 for a pinned particle), in the order of their
    /// indices.
    ///
    /// They are one row. A [`Cloth`](crate::cloth::Cloth) that is a grid with as many particles lays them out in its rows in the
    /// next tick: the particle at (row, column) is number `row × columns + column`.
    ///
    /// # Errors
    /// [`ParticleError::InverseMassCount`] if the two slices differ in length; [`ParticleError::NotFinite`] for the
    /// first invalid particle.
    pub fn new(positions: &[Vec3], inverse_masses: &[f32]) -> Result<Self, ParticleError> {
        if positions.len() != inverse_masses.len() {
            return Err(ParticleError::InverseMassCount {
                positions: positions.len(),
                inverse_masses: inverse_masses.len(),
            });
        }
        let mut particles = Self::of_layout(Layout::new(positions.len() as u32, 1));
        let state = positions.iter().zip(inverse_masses);
        for ((&position, &inverse_mass), slot) in state.zip(particles.layout.slots()) {
            let block = &mut particles.blocks[slot.block];
            block.set_position(slot.lane, position);
            block.set_inverse_mass(slot.lane, inverse_mass);
        }
        particles.validate()?;
        Ok(particles)
    }

    /// The particles laid out as those of a surface of as many, by their indices; `None` of another number.
    pub(crate) fn laid_out(&self, surface: &Surface) -> Option<Self> {
        let (from, to) = (self.valid_layout(), surface.layout());
        if from.len() != to.len() {
            return None;
        }
        let mut new = Self {
            substep: self.substep,
            ..Self::of_layout(to)
        };
        for (old, slot) in from.slots().zip(to.slots()) {
            let (was, block) = (&self.blocks[old.block], &mut new.blocks[slot.block]);
            block.set_position(slot.lane, was.position(old.lane));
            block.set_displacement(slot.lane, was.displacement(old.lane));
            block.set_inverse_mass(slot.lane, was.inverse_mass(old.lane));
        }
        Some(new)
    }

    /// The particles of the surface with other tears: each one takes place, motion and mass of its parent, and of the mass
    /// the share of its area. `is_parted` leaves a gap between those of one parent, for contact of cloth with cloth.
    pub(crate) fn torn(
        &self,
        from: &Surface,
        to: &Surface,
        parents: &[u32],
        is_parted: bool,
    ) -> Self {
        let slots: Vec<Slot> = self.layout.slots().collect();
        let of_parent = |parent: &u32| slots[*parent as usize];
        let mut new = Self {
            substep: self.substep,
            past: (self.past).of_parents(parents.iter().map(of_parent), to.layout()),
            ..Self::of_layout(to.layout())
        };
        for ((index, parent), slot) in parents.iter().enumerate().zip(new.layout.slots()) {
            let old = of_parent(parent);
            let (was, block) = (&self.blocks[old.block], &mut new.blocks[slot.block]);
            block.set_position(slot.lane, was.position(old.lane));
            block.set_displacement(slot.lane, was.displacement(old.lane));
            let share = from.area_of(*parent as usize) / to.area_of(index);
            block.set_inverse_mass(slot.lane, was.inverse_mass(old.lane) * share);
        }
        if is_parted {
            let places: Vec<Vec3> = new.positions().collect();
            let places = to.parted(&places, |particle| parents[particle as usize]);
            for (place, slot) in places.into_iter().zip(new.layout.slots()) {
                new.blocks[slot.block].set_position(slot.lane, place);
            }
        }
        new
    }

    fn of_layout(layout: Layout) -> Self {
        Self {
            layout,
            blocks: vec![Block::EMPTY; layout.blocks()],
            ..Self::default()
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.valid_layout().len()
    }

    /// Whether there are no particles, as before the first tick.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of particles in a row: all of them, unless they are those of a grid that is neither torn nor mapped.
    pub fn columns(&self) -> u32 {
        let layout = self.valid_layout();
        if layout.has_cells {
            layout.columns
        } else {
            layout.len() as u32
        }
    }

    /// Number of particles in a column: 1, unless they are those of a grid that is neither torn nor mapped.
    pub fn rows(&self) -> u32 {
        let layout = self.valid_layout();
        if layout.has_cells { layout.rows } else { 1 }
    }

    /// The index of a particle, if it exists.
    pub fn index(&self, id: impl Into<ParticleId>) -> Option<usize> {
        let index = match id.into() {
            ParticleId::Index(index) => index,
            ParticleId::Cell(row, column) if column < self.columns() => {
                row as usize * self.columns() as usize + column as usize
            }
            ParticleId::Cell(..) => return None,
        };
        (index < self.len()).then_some(index)
    }

    /// Position (m).
    pub fn position(&self, id: impl Into<ParticleId>) -> Option<Vec3> {
        self.index(id).map(|index| self.position_at(index))
    }

    /// Position − previous position (m), over one sub-step.
    pub fn displacement(&self, id: impl Into<ParticleId>) -> Option<Vec3> {
        let slot = self.slot(id)?;
        Some(self.blocks[slot.block].displacement(slot.lane))
    }

    /// Velocity (m/s): the displacement divided by its sub-step. If the previous displacement is known, half of the
    /// last change is added (second order).
    pub fn velocity(&self, id: impl Into<ParticleId>) -> Option<Vec3> {
        let slot = self.slot(id)?;
        let moved = self.blocks[slot.block].displacement(slot.lane);
        let known = self.past.known();
        let before = known.map_or(moved, |past| past[slot.block].before(slot.lane));
        Some((moved + 0.5 * (moved - before)) / self.substep)
    }

    /// Inverse mass (1/kg); 0 for a pinned particle.
    pub fn inverse_mass(&self, id: impl Into<ParticleId>) -> Option<f32> {
        let slot = self.slot(id)?;
        Some(self.blocks[slot.block].inverse_mass(slot.lane))
    }

    /// Whether any particle is pinned.
    pub(crate) fn has_pinned(&self) -> bool {
        let weights = self.blocks.iter().map(|block| &block.view()[W..W + LANES]);
        let free = weights.map(|weights| weights.iter().filter(|&&weight| weight > 0.0).count());
        free.sum::<usize>() < self.len()
    }

    /// Whether the particle is pinned: only its pin moves it.
    pub fn is_pinned(&self, id: impl Into<ParticleId>) -> Option<bool> {
        Some(self.inverse_mass(id)? == 0.0)
    }

    /// Moves a particle (m) and keeps its velocity: the jump itself adds none. A pinned particle stays at the new
    /// position.
    ///
    /// # Errors
    /// [`ParticleError::NoSuchParticle`].
    pub fn set_position(
        &mut self,
        id: impl Into<ParticleId>,
        position: Vec3,
    ) -> Result<(), ParticleError> {
        let Slot { block, lane } = self.existing(id.into())?;
        self.blocks[block].set_position(lane, position);
        self.past.forget(AFTER_A_JUMP);
        Ok(())
    }

    /// Sets position − previous position (m), over one sub-step. A pinned particle ignores it.
    ///
    /// # Errors
    /// [`ParticleError::NoSuchParticle`].
    pub fn set_displacement(
        &mut self,
        id: impl Into<ParticleId>,
        displacement: Vec3,
    ) -> Result<(), ParticleError> {
        let Slot { block, lane } = self.existing(id.into())?;
        self.blocks[block].set_displacement(lane, displacement);
        self.past.forget(0);
        Ok(())
    }

    /// Sets the velocity (m/s). A pinned particle ignores it.
    ///
    /// # Errors
    /// [`ParticleError::NoSuchParticle`].
    pub fn set_velocity(
        &mut self,
        id: impl Into<ParticleId>,
        velocity: Vec3,
    ) -> Result<(), ParticleError> {
        let substep = self.substep;
        self.set_displacement(id, velocity * substep)
    }

    /// Sets the inverse mass (1/kg); 0 pins the particle. Lasts until the material or the pins change.
    ///
    /// # Errors
    /// [`ParticleError::NoSuchParticle`].
    pub fn set_inverse_mass(
        &mut self,
        id: impl Into<ParticleId>,
        inverse_mass: f32,
    ) -> Result<(), ParticleError> {
        let Slot { block, lane } = self.existing(id.into())?;
        self.blocks[block].set_inverse_mass(lane, inverse_mass);
        self.past.forget(AFTER_A_JUMP);
        Ok(())
    }

    /// All positions (m), in the order of the indices.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.each(Block::position)
    }

    /// All displacements (m), in the order of the indices.
    pub fn displacements(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.each(Block::displacement)
    }

    /// All inverse masses (1/kg), in the order of the indices.
    pub fn inverse_masses(&self) -> impl ExactSizeIterator<Item = f32> + '_ {
        self.each(Block::inverse_mass)
    }

    fn each<'a, T: 'a>(
        &'a self,
        of: fn(&Block, usize) -> T,
    ) -> impl ExactSizeIterator<Item = T> + 'a {
        let slots = self.valid_layout().slots();
        slots.map(move |Slot { block, lane }| of(&self.blocks[block], lane))
    }

    /// Checks that every number is finite, no length exceeds 10¹⁸ m, and each inverse mass is from 0 to 10¹⁵ 1/kg.
    ///
    /// # Errors
    /// [`ParticleError::NotFinite`] for the first invalid particle.
    pub fn validate(&self) -> Result<(), ParticleError> {
        if self.survey().is_valid {
            return Ok(());
        }
        let valid = |slot: Slot| {
            let block = &self.blocks[slot.block];
            let squares = block.position(slot.lane).length_squared()
                + block.displacement(slot.lane).length_squared();
            validity::is_valid(squares, block.inverse_mass(slot.lane))
        };
        let mut slots = self.valid_layout().slots().enumerate();
        let Some((index, slot)) = slots.find(|(_, slot)| !valid(*slot)) else {
            return Ok(());
        };
        let block = &self.blocks[slot.block];
        Err(ParticleError::NotFinite {
            index,
            position: block.position(slot.lane),
            displacement: block.displacement(slot.lane),
            inverse_mass: block.inverse_mass(slot.lane),
        })
    }

    /// The largest speed of any particle (m/s).
    pub fn largest_speed(&self) -> f32 {
        self.survey().largest_speed
    }

    fn slot(&self, id: impl Into<ParticleId>) -> Option<Slot> {
        self.index(id).map(|index| self.layout.slot_of(index))
    }

    fn existing(&self, id: ParticleId) -> Result<Slot, ParticleError> {
        self.slot(id).ok_or(ParticleError::NoSuchParticle {
            id,
            columns: self.columns(),
            rows: self.rows(),
        })
    }
}
