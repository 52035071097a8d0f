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

    /// The factor of a face's flexural rigidity.
    pub fn of_face(&self, face: [u32; 3]) -> f32 {
        let rigidity = |corner: u32| self.bending.get(corner as usize).copied().unwrap_or(1.0);
        face.map(rigidity).into_iter().sum::<f32>() / 3.0
    }
}
