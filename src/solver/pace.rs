//! What a sub-step is for springs.

/// What of the sub-step the equations of springs depend on.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Pace {
    /// 1/(c Δt²) (1/s²), where c Δt² is what a force is multiplied with to move a particle, besides its inverse mass.
    pub inverse_weight: f32,
    /// κ = 1/(1 + τ/Δt), with τ the time in which damping along springs lets a stretch die away (s): 1 without.
    pub kept: f32,
}

impl Pace {
    /// With a weight c Δt² (s²), of a sub-step of `dt` (s), and damping of `retardation` (s).
    pub fn new(weight: f32, dt: f32, retardation: f32) -> Self {
        Self {
            inverse_weight: 1.0 / weight,
            kept: dt / (dt + retardation),
        }
    }
}
