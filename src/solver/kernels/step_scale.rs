//! The parameters of a sub-step for springs.

/// The parameters of a sub-step in the equations of springs.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct StepScale {
    /// 1/(c Δt²) (1/s²), where c Δt² w is the displacement per force of a particle with inverse mass w.
    pub inverse_weight: f32,
    /// κ = 1/(1 + τ/Δt), with τ the decay time of a stretch by damping along springs (s): 1 without damping.
    pub kept: f32,
}

impl StepScale {
    /// With a weight c Δt² (s²), of a sub-step of `dt` (s), and damping of `retardation` (s).
    pub fn new(weight: f32, dt: f32, retardation: f32) -> Self {
        Self {
            inverse_weight: 1.0 / weight,
            kept: dt / (dt + retardation),
        }
    }
}
