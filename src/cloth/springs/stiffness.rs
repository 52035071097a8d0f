//! Stiffness that differs from place to place.

/// Factors of a material's stiffness, one a particle; empty if all are 1.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct StiffnessFactors {
    /// Against stretch and shear.
    pub stretch: Vec<f32>,
    /// Of the flexural rigidity.
    pub bending: Vec<f32>,
}

impl StiffnessFactors {
    /// The smallest against stretch.
    pub fn softest(&self) -> f32 {
        let softest = self.stretch.iter().copied().reduce(f32::min);
        softest.unwrap_or(1.0)
    }

    /// The factor of a compliance between two particles: half of each material, one after the other.
    pub fn of_spring(&self, ends: [u32; 2]) -> f32 {
        let compliance = |end: u32| self.stretch.get(end as usize).map_or(1.0, |of| 1.0 / of);
        let [a, b] = ends.map(compliance);
        (a + b) / 2.0
    }

    /// The mean factor of the flexural rigidity at some particles.
    pub fn mean_bending(&self, particles: &[u32]) -> f32 {
        let of = |particle: &u32| self.bending.get(*particle as usize).copied();
        let sum: f32 = particles.iter().map(|at| of(at).unwrap_or(1.0)).sum();
        sum / particles.len() as f32
    }
}
