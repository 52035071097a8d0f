//! The particles of a cloth, in columns.

use bevy::{
    ecs::component::Component,
    math::{Isometry3d, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    ClothError, ClothGrid, ClothMaterial, Pins,
    lanes::{Block, DX, DY, DZ, LANES, Layout, Slot, W, X},
};

/// The sub-step that displacements span until the first tick says otherwise: 20 a tick of Bevy's 64 Hz.
const DEFAULT_SUBSTEP: f32 = 1.0 / 1280.0;

/// Where a particle may be at most (m): distances between such can still be squared in `f32`.
const FARTHEST: f32 = 1.0e18;

/// Which particle: an index, or (row, column).
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParticleId {
    /// `row × columns + column`.
    Index(usize),
    /// (row, column), from the top left.
    Cell(u32, u32),
}

impl From<usize> for ParticleId {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

impl From<(u32, u32)> for ParticleId {
    fn from((row, column): (u32, u32)) -> Self {
        Self::Cell(row, column)
    }
}

/// The particles of a cloth: position, displacement and inverse mass, in columns of eight lanes.
///
/// Everything is in metres in the cloth's own frame: the entity's global translation and rotation, with the
/// scale already multiplied in. The state is (position, displacement) rather than two positions because
/// position − previous position, taken from rounded numbers, loses gravity as steps shrink.
///
/// Empty until the first tick after the [`Cloth`](super::Cloth) was spawned. Games may read and write between
/// ticks; emptying it (`*particles = default()`) weaves the cloth anew at rest.
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothParticles {
    layout: Layout,
    blocks: Vec<Block>,
    substep: f32,
}

impl Default for ClothParticles {
    fn default() -> Self {
        Self {
            layout: Layout::default(),
            blocks: Vec::new(),
            substep: DEFAULT_SUBSTEP,
        }
    }
}

/// What one pass over the particles finds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Survey {
    /// Whether all is as [`ClothParticles::validate`] wants it.
    pub is_sound: bool,
    /// Speed of the fastest particle (m/s).
    pub largest_speed: f32,
}

impl ClothParticles {
    /// The particles of `grid`, at rest, all of them free and with masses from `material`.
    ///
    /// # Errors
    /// A mass that a float can't hold or invert.
    pub fn at_rest(grid: &ClothGrid, material: &ClothMaterial) -> Result<Self, ClothError> {
        Self::check_mass(grid, material)?;
        let mut particles = Self::of_layout(Layout::new(grid.columns(), grid.rows()));
        for ((row, column), slot) in grid.cells().zip(particles.layout.slots()) {
            let position = grid.rest_position(row, column);
            particles.blocks[slot.block].set_position(slot.lane, position);
        }
        particles.weigh(grid, material, &Pins::none())?;
        Ok(particles)
    }

    /// Particles of no grid, at rest: positions (m) and inverse masses (1/kg, 0 for a pinned one), in one row.
    ///
    /// # Errors
    /// [`ClothError::ParticleCount`] if there are not as many of either;
    /// [`ClothError::ParticleNotFinite`] for the first that is not.
    pub fn new(positions: &[Vec3], inverse_masses: &[f32]) -> Result<Self, ClothError> {
        if positions.len() != inverse_masses.len() {
            return Err(ClothError::ParticleCount {
                expected: positions.len(),
                found: inverse_masses.len(),
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

    fn of_layout(layout: Layout) -> Self {
        Self {
            layout,
            blocks: vec![Block::EMPTY; layout.blocks()],
            substep: DEFAULT_SUBSTEP,
        }
    }

    /// Sets the inverse masses from the grid's areas, the material's density and the pins.
    ///
    /// # Errors
    /// A mass that a float can't hold or invert; a pin out of range. Nothing is changed then.
    pub(crate) fn weigh(
        &mut self,
        grid: &ClothGrid,
        material: &ClothMaterial,
        pins: &Pins,
    ) -> Result<(), ClothError> {
        pins.validate(grid)?;
        Self::check_mass(grid, material)?;
        for ((row, column), slot) in grid.cells().zip(self.layout.slots()) {
            let mass = material.areal_density * grid.tributary_area(row, column);
            self.blocks[slot.block].set_inverse_mass(slot.lane, 1.0 / mass);
        }
        pins.for_each(grid, |index| self.pin(index));
        Ok(())
    }

    /// Has nothing but its pin move a particle.
    pub(crate) fn pin(&mut self, index: usize) {
        let slot = self.layout.slot_of(index);
        self.blocks[slot.block].set_inverse_mass(slot.lane, 0.0);
    }

    fn check_mass(grid: &ClothGrid, material: &ClothMaterial) -> Result<(), ClothError> {
        ClothError::check(
            material.areal_density * grid.tributary_area(0, 0),
            |corner| (1.0e-15..1.0e15).contains(&corner),
            "the mass of a particle (kg)",
            "from 10⁻¹⁵ to 10¹⁵",
        )?;
        Ok(())
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.layout.len()
    }

    /// Whether there is no particle, as before the first tick.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Particles a row.
    pub fn columns(&self) -> u32 {
        self.layout.columns
    }

    /// Particles a column.
    pub fn rows(&self) -> u32 {
        self.layout.rows
    }

    /// The index of a particle, if there is such a one.
    pub fn index(&self, id: impl Into<ParticleId>) -> Option<usize> {
        let index = match id.into() {
            ParticleId::Index(index) => index,
            ParticleId::Cell(row, column) if column < self.layout.columns => {
                row as usize * self.layout.columns as usize + column as usize
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
        self.slot(id)
            .map(|Slot { block, lane }| self.blocks[block].displacement(lane))
    }

    /// Displacement over the sub-step that it spans (m/s).
    pub fn velocity(&self, id: impl Into<ParticleId>) -> Option<Vec3> {
        self.displacement(id).map(|moved| moved / self.substep)
    }

    /// Inverse mass (1/kg); 0 for a pinned particle.
    pub fn inverse_mass(&self, id: impl Into<ParticleId>) -> Option<f32> {
        self.slot(id)
            .map(|Slot { block, lane }| self.blocks[block].inverse_mass(lane))
    }

    /// Whether nothing but its pin moves the particle.
    pub fn is_pinned(&self, id: impl Into<ParticleId>) -> Option<bool> {
        self.inverse_mass(id)
            .map(|inverse_mass| inverse_mass == 0.0)
    }

    /// Moves a particle (m); it keeps its velocity, and gets none from the jump. A pinned one stays where it
    /// is put.
    ///
    /// # Errors
    /// [`ClothError::NoSuchParticle`].
    pub fn set_position(
        &mut self,
        id: impl Into<ParticleId>,
        position: Vec3,
    ) -> Result<(), ClothError> {
        let Slot { block, lane } = self.existing(id.into())?;
        self.blocks[block].set_position(lane, position);
        Ok(())
    }

    /// Sets position − previous position (m), over one sub-step. A pinned particle ignores it.
    ///
    /// # Errors
    /// [`ClothError::NoSuchParticle`].
    pub fn set_displacement(
        &mut self,
        id: impl Into<ParticleId>,
        displacement: Vec3,
    ) -> Result<(), ClothError> {
        let Slot { block, lane } = self.existing(id.into())?;
        self.blocks[block].set_displacement(lane, displacement);
        Ok(())
    }

    /// Sets the velocity (m/s). A pinned particle ignores it.
    ///
    /// # Errors
    /// [`ClothError::NoSuchParticle`].
    pub fn set_velocity(
        &mut self,
        id: impl Into<ParticleId>,
        velocity: Vec3,
    ) -> Result<(), ClothError> {
        let substep = self.substep;
        self.set_displacement(id, velocity * substep)
    }

    /// Sets the inverse mass (1/kg); 0 pins the particle. Holds until the material or the pins change.
    ///
    /// # Errors
    /// [`ClothError::NoSuchParticle`].
    pub fn set_inverse_mass(
        &mut self,
        id: impl Into<ParticleId>,
        inverse_mass: f32,
    ) -> Result<(), ClothError> {
        let Slot { block, lane } = self.existing(id.into())?;
        self.blocks[block].set_inverse_mass(lane, inverse_mass);
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
        let slots = self.layout.slots();
        slots.map(move |Slot { block, lane }| of(&self.blocks[block], lane))
    }

    /// Whether every number is finite, none is beyond all measure (10¹⁸ m), and no inverse mass is negative.
    ///
    /// # Errors
    /// [`ClothError::ParticleNotFinite`] for the first particle that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        if self.survey().is_sound {
            return Ok(());
        }
        let sound = |slot: Slot| {
            let block = &self.blocks[slot.block];
            let squares = block.position(slot.lane).length_squared()
                + block.displacement(slot.lane).length_squared();
            is_sound(squares, block.inverse_mass(slot.lane))
        };
        let Some((index, slot)) = self
            .layout
            .slots()
            .enumerate()
            .find(|(_, slot)| !sound(*slot))
        else {
            return Ok(());
        };
        let block = &self.blocks[slot.block];
        Err(ClothError::ParticleNotFinite {
            index,
            position: block.position(slot.lane),
            displacement: block.displacement(slot.lane),
            inverse_mass: block.inverse_mass(slot.lane),
        })
    }

    /// Looks at every particle once.
    pub(crate) fn survey(&self) -> Survey {
        let mut sound = [true; LANES];
        let mut largest = [0.0_f32; LANES];
        for block in &self.blocks {
            let view = block.view();
            let square = |from: usize, lane: usize| {
                let [a, b, c] = [0, LANES, 2 * LANES].map(|next| view[from + next + lane]);
                a * a + b * b + c * c
            };
            for lane in 0..LANES {
                let moved = square(DX, lane);
                sound[lane] &= is_sound(square(X, lane) + moved, view[W + lane]);
                largest[lane] = if moved > largest[lane] {
                    moved
                } else {
                    largest[lane]
                };
            }
        }
        Survey {
            is_sound: sound == [true; LANES],
            largest_speed: largest.into_iter().fold(0.0, f32::max).sqrt() / self.substep,
        }
    }

    /// The largest speed of a particle (m/s).
    pub fn largest_speed(&self) -> f32 {
        self.survey().largest_speed
    }

    /// Whether there are as many as `grid` has, in as many columns.
    pub(crate) fn fit(&self, grid: &ClothGrid) -> bool {
        (self.rows(), self.columns()) == (grid.rows(), grid.columns())
    }

    /// Position (m) of a particle that exists.
    pub(crate) fn position_at(&self, index: usize) -> Vec3 {
        let Slot { block, lane } = self.layout.slot_of(index);
        self.blocks[block].position(lane)
    }

    /// How the particles lie in memory.
    pub(crate) fn layout(&self) -> Layout {
        self.layout
    }

    /// The memory that they lie in.
    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// The memory that they lie in.
    pub(crate) fn blocks_mut(&mut self) -> &mut [Block] {
        &mut self.blocks
    }

    /// Forgets what the pinned particles were moved by.
    pub(crate) fn still_pins(&mut self) {
        for block in &mut self.blocks {
            let view = block.view_mut();
            for from in [DX, DY, DZ] {
                for lane in 0..LANES {
                    let moved = view[from + lane];
                    view[from + lane] = if view[W + lane] > 0.0 { moved } else { 0.0 };
                }
            }
        }
    }

    /// Has a pinned particle be at `position` when the sub-step ends.
    pub(crate) fn lead_pin(&mut self, index: usize, position: Vec3) {
        let Slot { block, lane } = self.layout.slot_of(index);
        let block = &mut self.blocks[block];
        block.set_displacement(lane, position - block.position(lane));
    }

    /// Moves all particles as one body, velocities along with it.
    pub(crate) fn transform(&mut self, by: Isometry3d) {
        for slot in self.layout.slots() {
            let block = &mut self.blocks[slot.block];
            block.set_position(slot.lane, by * block.position(slot.lane));
            block.set_displacement(slot.lane, by.rotation * block.displacement(slot.lane));
        }
    }

    /// Becomes what `other` is, in the memory that it has.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.layout = other.layout;
        self.blocks.clone_from(&other.blocks);
        self.substep = other.substep;
    }

    /// Puts a particle somewhere.
    pub(crate) fn put(&mut self, index: usize, position: Vec3) {
        let Slot { block, lane } = self.layout.slot_of(index);
        self.blocks[block].set_position(lane, position);
    }

    /// Has displacements span `substep` seconds from now on, at the same velocities.
    pub(crate) fn respan(&mut self, substep: f32) {
        if substep != self.substep {
            let ratio = substep / self.substep;
            for block in &mut self.blocks {
                for displacement in &mut block.view_mut()[DX..] {
                    *displacement *= ratio;
                }
            }
            self.substep = substep;
        }
    }

    fn slot(&self, id: impl Into<ParticleId>) -> Option<Slot> {
        self.index(id).map(|index| self.layout.slot_of(index))
    }

    fn existing(&self, id: ParticleId) -> Result<Slot, ClothError> {
        self.slot(id).ok_or(ClothError::NoSuchParticle {
            id,
            columns: self.columns(),
            rows: self.rows(),
        })
    }
}

/// Whether a particle's numbers are, by the squares of position and displacement (m²) and its inverse mass
/// (1/kg). False for NaN too.
fn is_sound(squares: f32, inverse_mass: f32) -> bool {
    (squares < FARTHEST * FARTHEST) & (inverse_mass >= 0.0) & (inverse_mass < f32::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;

    fn particles() -> ClothParticles {
        let grid = Cloth::new(4, 3, 0.5).grid(Vec3::ONE).expect("a sound grid");
        ClothParticles::at_rest(&grid, &ClothMaterial::COTTON).expect("a sound material")
    }

    #[test]
    fn index_and_cell_name_the_same_particle() {
        let mut particles = particles();
        assert_eq!(particles.index((2, 1)), Some(9));
        assert_eq!(particles.position(9), particles.position((2, 1)));
        particles.set_velocity((2, 1), Vec3::X).expect("it exists");
        assert!((particles.velocity(9).expect("it exists") - Vec3::X).length() < 1e-6);
        assert_eq!((particles.columns(), particles.rows()), (4, 3));
        assert_eq!(
            particles.index((0, 4)),
            None,
            "a column too far is not the next row"
        );
        assert!(matches!(
            particles.set_position((3, 0), Vec3::ZERO),
            Err(ClothError::NoSuchParticle { rows: 3, .. })
        ));
    }

    #[test]
    fn masses_add_up_to_density_times_area() {
        let mass: f32 = particles().inverse_masses().map(f32::recip).sum();
        assert!((mass - 0.15 * 1.5).abs() < 1e-6);
    }

    #[test]
    fn respan_keeps_velocities() {
        let mut particles = particles();
        particles
            .set_velocity(5, Vec3::new(1.0, -2.0, 3.0))
            .expect("it exists");
        particles.respan(0.01);
        let velocity = particles.velocity(5).expect("it exists");
        assert!((velocity - Vec3::new(1.0, -2.0, 3.0)).length() < 1e-6);
        assert!((particles.displacement(5).expect("it exists").x - 0.01).abs() < 1e-8);
    }

    #[test]
    fn each_number_that_is_not_finite_is_found() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.0e30] {
            let mut particles = particles();
            particles
                .set_position(7, Vec3::new(0.0, bad, 0.0))
                .expect("it exists");
            assert!(matches!(
                particles.validate(),
                Err(ClothError::ParticleNotFinite { index: 7, .. })
            ));
            let mut particles = self::particles();
            particles
                .set_displacement(11, Vec3::new(0.0, 0.0, bad))
                .expect("it exists");
            assert!(matches!(
                particles.validate(),
                Err(ClothError::ParticleNotFinite { index: 11, .. })
            ));
        }
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0] {
            let mut particles = particles();
            particles.set_inverse_mass(0, bad).expect("it exists");
            assert!(matches!(
                particles.validate(),
                Err(ClothError::ParticleNotFinite { index: 0, .. })
            ));
        }
        assert_eq!(particles().validate(), Ok(()));
    }
}
