//! The parameters of a sub-step for springs.

use crate::cloth::ClothStiffening;

/// The part of a spring's length that its pull has given, at most.
const MOST_GIVEN: f32 = 0.95;

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
    /// The squared length at which it has no force, in squared lengths at rest, and one over it.
    pub squares: [f32; 2],
    /// Its compliance as a part of the spring's own.
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
        squares: [1.0; 2],
        compliance: 1.0,
    };

    /// ```text
    ///  force          /      beyond the strain s, with r = 1/factor and e₀ the
    ///    |           /       strain of a spring that does not stiffen,
    ///    |          /        e = s (1 − r) + r e₀
    ///    |      __-´
    ///    |  __-´
    ///    o-´───────┴──── strain e
    ///              s
    /// ```
    pub fn of(stiffening: &ClothStiffening) -> Self {
        let compliance = 1.0 / stiffening.factor;
        let length = 1.0 + stiffening.strain * (1.0 - compliance);
        let square = length * length;
        Self {
            from: (1.0 + stiffening.strain).powi(2),
            squares: [square, 1.0 / square],
            compliance,
        }
    }

    /// The strain of a spring whose force over its length, times its compliance, is this.
    pub fn strain(&self, part: f32) -> f32 {
        let length = |part: f32| 1.0 / (1.0 - part.clamp(0.0, MOST_GIVEN));
        let soft = length(part);
        if soft * soft <= self.from {
            return soft - 1.0;
        }
        self.squares[0].sqrt() * length(self.compliance * part) - 1.0
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The strain of a spring follows from its force F as that of the material does: e₀ = α F below the knee, and beyond it what the
    /// formula says.
    #[test]
    fn strain_is_that_of_the_material() {
        for (strain, factor) in [(0.01, 2.0), (0.2, 10.0), (1.0, 100.0), (3.0, 1.0)] {
            let stiffening = ClothStiffening { strain, factor };
            let stiffer = Stiffer::of(&stiffening);
            for linear in [0.0, 0.005, 0.1, 0.5, 2.0, 8.0] {
                let expected = stiffening.strain_of(linear);
                // Its force over its length.
                let found = stiffer.strain(linear / (1.0 + expected));
                let allowed = 1.0e-5 * (1.0 + expected);
                assert!((found - expected).abs() < allowed, "{found} {expected}");
            }
        }
        assert!((Stiffer::NONE.strain(0.5) - 1.0).abs() < 1.0e-6);
    }
}
