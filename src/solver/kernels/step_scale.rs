//! The parameters of a sub-step for springs.

use crate::cloth::ClothStiffening;

/// The part of a spring's length that its pull has given, at most.
const MOST_GIVEN: f32 = 0.9;

/// The parameters of a sub-step in the equations of springs.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct StepScale {
    /// 1/(c Δt²) (1/s²), where c Δt² w is the displacement per force of a particle with inverse mass w.
    pub inverse_weight: f32,
    /// κ = 1/(1 + τ/Δt), with τ the decay time of a stretch by damping along springs (s): 1 without damping.
    pub kept: f32,
    pub stiffer: Stiffer,
}

/// The other line of springs that stiffen beyond a length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stiffer {
    /// Squared length from which it holds, in squared lengths at rest; infinite for springs that do not stiffen.
    pub from: f32,
    /// Where the line has no force, in lengths at rest, and one over it.
    pub rest: f32,
    pub inverse_rest: f32,
    /// Its compliance, in parts of the spring's.
    pub compliance: f32,
}

impl Default for Stiffer {
    fn default() -> Self {
        Self::NONE
    }
}

impl Stiffer {
    /// Of springs that do not stiffen.
    pub const NONE: Self = Self {
        from: f32::INFINITY,
        rest: 1.0,
        inverse_rest: 1.0,
        compliance: 1.0,
    };

    /// ```text
    /// force      / e = s + r (e₀ − s), with e₀ the strain of a spring that does not stiffen,
    ///   |       /    s where it stiffens, and r = 1/factor:
    ///   |  ____/     without a force at e = s (1 − r)
    ///   | /
    ///   o───┴─── strain e
    /// ```
    pub fn of(stiffening: &ClothStiffening) -> Self {
        let compliance = 1.0 / stiffening.factor;
        let rest = 1.0 + stiffening.strain * (1.0 - compliance);
        Self {
            from: (1.0 + stiffening.strain).powi(2),
            rest,
            inverse_rest: 1.0 / rest,
            compliance,
        }
    }

    /// The strain of a spring whose pull, without it, would give this part of its length.
    pub fn strain(&self, part: f32) -> f32 {
        let length = |part: f32| 1.0 / (1.0 - part.clamp(0.0, MOST_GIVEN));
        let soft = length(part);
        if soft * soft <= self.from {
            return soft - 1.0;
        }
        self.rest * length(self.compliance * part * self.inverse_rest) - 1.0
    }

    /// Whether any spring stiffens.
    #[inline(always)]
    pub fn is_some(&self) -> bool {
        self.from < f32::INFINITY
    }
}

impl StepScale {
    /// With a weight c Δt² (s²), of a sub-step of `dt` (s), and damping of `retardation` (s).
    pub fn new(weight: f32, dt: f32, retardation: f32) -> Self {
        Self {
            inverse_weight: 1.0 / weight,
            kept: dt / (dt + retardation),
            stiffer: Stiffer::NONE,
        }
    }
}
