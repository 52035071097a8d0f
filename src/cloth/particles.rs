//! The particles of a cloth, in columns.

use bevy::{
    ecs::component::Component,
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{ClothError, ClothGrid, ClothMaterial, Pins};

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

/// The particles of a cloth: columns of position, displacement and inverse mass.
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
    columns: u32,
    position: Vec<Vec3>,
    displacement: Vec<Vec3>,
    inverse_mass: Vec<f32>,
    substep: f32,
}

impl Default for ClothParticles {
    fn default() -> Self {
        Self {
            columns: 0,
            position: Vec::new(),
            displacement: Vec::new(),
            inverse_mass: Vec::new(),
            substep: DEFAULT_SUBSTEP,
        }
    }
}

/// The columns, borrowed together for a kernel.
pub(crate) struct Columns<'a> {
    pub position: &'a mut [Vec3],
    pub displacement: &'a mut [Vec3],
    pub inverse_mass: &'a [f32],
}

impl ClothParticles {
    /// The particles of `grid`, at rest, all of them free and with masses from `material`.
    ///
    /// # Errors
    /// A mass that a float can't hold or invert.
    pub fn at_rest(grid: &ClothGrid, material: &ClothMaterial) -> Result<Self, ClothError> {
        Self::check_mass(grid, material)?;
        let mut particles = Self {
            columns: grid.columns(),
            position: grid
                .cells()
                .map(|(r, c)| grid.rest_position(r, c))
                .collect(),
            displacement: vec![Vec3::ZERO; grid.len()],
            inverse_mass: vec![0.0; grid.len()],
            substep: DEFAULT_SUBSTEP,
        };
        particles.weigh(grid, material, &Pins::none())?;
        Ok(particles)
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
        for ((row, column), inverse_mass) in grid.cells().zip(&mut self.inverse_mass) {
            *inverse_mass = 1.0 / (material.areal_density * grid.tributary_area(row, column));
        }
        pins.for_each(grid, |index| self.inverse_mass[index] = 0.0);
        Ok(())
    }

    fn check_mass(grid: &ClothGrid, material: &ClothMaterial) -> Result<(), ClothError> {
        ClothError::check(
            material.areal_density * grid.tributary_area(0, 0),
            |corner| corner.is_normal() && (4.0 / corner).is_normal() && corner < f32::MAX / 4.0,
            "the mass of a particle (kg)",
            "of a size that a float can invert",
        )?;
        Ok(())
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no particle, as before the first tick.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Particles a row.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Particles a column.
    pub fn rows(&self) -> u32 {
        (self.len() as u32).checked_div(self.columns).unwrap_or(0)
    }

    /// The index of a particle, if there is such a one.
    pub fn index(&self, id: impl Into<ParticleId>) -> Option<usize> {
        let index = match id.into() {
            ParticleId::Index(index) => index,
            ParticleId::Cell(row, column) if column < self.columns => {
                row as usize * self.columns as usize + column as usize
            }
            ParticleId::Cell(..) => return None,
        };
        (index < self.len()).then_some(index)
    }

    /// Position (m).
    pub fn position(&self, id: impl Into<ParticleId>) -> Option<Vec3> {
        self.index(id).map(|index| self.position[index])
    }

    /// Position − previous position (m), over one sub-step.
    pub fn displacement(&self, id: impl Into<ParticleId>) -> Option<Vec3> {
        self.index(id).map(|index| self.displacement[index])
    }

    /// Displacement over the sub-step that it spans (m/s).
    pub fn velocity(&self, id: impl Into<ParticleId>) -> Option<Vec3> {
        self.displacement(id).map(|moved| moved / self.substep)
    }

    /// Inverse mass (1/kg); 0 for a pinned particle.
    pub fn inverse_mass(&self, id: impl Into<ParticleId>) -> Option<f32> {
        self.index(id).map(|index| self.inverse_mass[index])
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
        let index = self.existing(id.into())?;
        self.position[index] = position;
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
        let index = self.existing(id.into())?;
        self.displacement[index] = displacement;
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
        let index = self.existing(id.into())?;
        self.inverse_mass[index] = inverse_mass;
        Ok(())
    }

    /// All positions (m), in the order of the indices.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + DoubleEndedIterator + '_ {
        self.position.iter().copied()
    }

    /// All displacements (m), in the order of the indices.
    pub fn displacements(&self) -> impl ExactSizeIterator<Item = Vec3> + DoubleEndedIterator + '_ {
        self.displacement.iter().copied()
    }

    /// All inverse masses (1/kg), in the order of the indices.
    pub fn inverse_masses(&self) -> impl ExactSizeIterator<Item = f32> + DoubleEndedIterator + '_ {
        self.inverse_mass.iter().copied()
    }

    /// Whether every number is finite, none is beyond all measure (10¹⁸ m), and no inverse mass is negative.
    ///
    /// # Errors
    /// [`ClothError::ParticleNotFinite`] for the first particle that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        let sound = |index: usize| {
            let (position, displacement) = (self.position[index], self.displacement[index]);
            let inverse_mass = self.inverse_mass[index];
            // False for NaN too.
            position.length_squared() + displacement.length_squared() < FARTHEST * FARTHEST
                && inverse_mass >= 0.0
                && inverse_mass.is_finite()
        };
        match (0..self.len()).find(|&index| !sound(index)) {
            None => Ok(()),
            Some(index) => Err(ClothError::ParticleNotFinite {
                index,
                position: self.position[index],
                displacement: self.displacement[index],
                inverse_mass: self.inverse_mass[index],
            }),
        }
    }

    /// The largest speed of a particle (m/s).
    pub fn largest_speed(&self) -> f32 {
        let squared = self.displacement.iter().map(|d| d.length_squared());
        squared.fold(0.0, f32::max).sqrt() / self.substep
    }

    /// Whether there are as many as `grid` has, in as many columns.
    pub(crate) fn fit(&self, grid: &ClothGrid) -> bool {
        (self.len(), self.columns) == (grid.len(), grid.columns())
    }

    pub(crate) fn positions_slice(&self) -> &[Vec3] {
        &self.position
    }

    pub(crate) fn columns_mut(&mut self) -> Columns<'_> {
        Columns {
            position: &mut self.position,
            displacement: &mut self.displacement,
            inverse_mass: &self.inverse_mass,
        }
    }

    /// Has displacements span `substep` seconds from now on, at the same velocities.
    pub(crate) fn respan(&mut self, substep: f32) {
        if substep != self.substep {
            let ratio = substep / self.substep;
            for displacement in &mut self.displacement {
                *displacement *= ratio;
            }
            self.substep = substep;
        }
    }

    fn existing(&self, id: ParticleId) -> Result<usize, ClothError> {
        self.index(id).ok_or(ClothError::NoSuchParticle {
            id,
            columns: self.columns,
            rows: self.rows(),
        })
    }
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
