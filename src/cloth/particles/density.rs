//! The masses that a material gives to particles.

use crate::cloth::{Allowed, QuantityError, material::ClothMaterial, surface::Surface};

/// Factors of a cloth's areal density.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DensityFactors {
    /// One a particle; empty if all are 1.
    of_particles: Vec<f32>,
    /// Their mean over the area.
    pub mean: f32,
    /// The smallest.
    pub least: f32,
    /// The largest.
    pub most: f32,
}

impl Default for DensityFactors {
    /// 1 everywhere.
    fn default() -> Self {
        Self {
            of_particles: Vec::new(),
            mean: 1.0,
            least: 1.0,
            most: 1.0,
        }
    }
}

impl DensityFactors {
    /// Of these factors, one a particle; of none, 1 everywhere.
    pub fn new(of_particles: Vec<f32>, surface: &Surface) -> Self {
        if of_particles.is_empty() {
            return Self::default();
        }
        let area = |(index, factor)| f64::from(factor * surface.area_of(index));
        let sum: f64 = of_particles.iter().copied().enumerate().map(area).sum();
        Self {
            mean: (sum / f64::from(surface.area())) as f32,
            least: of_particles.iter().copied().fold(f32::INFINITY, f32::min),
            most: of_particles.iter().copied().fold(0.0, f32::max),
            of_particles,
        }
    }

    /// The mass of a particle (kg).
    pub fn mass(&self, index: usize, surface: &Surface, material: &ClothMaterial) -> f32 {
        let factor = self.of_particles.get(index).copied().unwrap_or(1.0);
        factor * material.areal_density * surface.area_of(index)
    }

    /// Whether all masses are in their range.
    ///
    /// # Errors
    /// A particle mass outside 10⁻¹⁵ to 10¹⁵ kg.
    pub fn check(&self, surface: &Surface, material: &ClothMaterial) -> Result<(), QuantityError> {
        let masses = (0..surface.len()).map(|index| self.mass(index, surface, material));
        let ends = masses.fold([f32::INFINITY, 0.0], |[least, most]: [f32; 2], mass| {
            [least.min(mass), most.max(mass)]
        });
        let usable = |mass: f32| (1.0e-15..1.0e15).contains(&mass);
        Allowed(usable, "from 10⁻¹⁵ to 10¹⁵").check("the mass of a particle (kg)", ends)
    }
}
