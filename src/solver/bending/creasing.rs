//! Bending that stays: what a crease is.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::{Allowed, QuantityError};

/// Creases: cloth that is bent beyond its yield curvature keeps a part of that. Folded paper stays folded, a leather strap
/// remembers the buckle. A cloth without this component springs back from any fold, and pays nothing.
///
/// It is the plasticity of a beam with linear kinematic hardening (Simo and Hughes 1998, chapter 1). With the flexural rigidity D
/// of the [material](crate::cloth::ClothMaterial::bend_rigidity), a strip that is bent to the curvature κ has the moment D κ
/// up to `κ_y`, and `D (κ_y + h (κ − κ_y))` beyond that. Released, it keeps the curvature `(1 − h) (κ − κ_y)`, but at most
/// [`largest_crease`](Self::largest_crease). In two directions at once, the norm of the curvature yields, `√(κ_xx² + κ_yy² + 2 κ_xy²)`.
///
/// Creases follow once a tick. They are kept in snapshots, while the cloth sleeps, when its material changes, and where it tears. They are
/// smoothed out when this component is removed, or when the cloth is built anew, as for another resolution. So are those of a
/// mesh that becomes a grid again, as one that is mended. A
/// material that bends freely has no creases, whatever this says.
///
/// A grid bends by at most 2 ⁄ spacing, which is flat on itself. So the yield curvature has to be well below that: finer
/// cloth takes sharper creases.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothCreasing {
    /// `κ_y`, the curvature beyond which it yields (1/m): 1 over the radius of the tightest bend that leaves nothing. Positive,
    /// finite.
    pub yield_curvature: f32,
    /// h, a ratio of stiffnesses: that beyond the yield curvature over D. From 0, which is perfectly plastic, to less than 1.
    pub hardening: f32,
}

impl Default for ClothCreasing {
    fn default() -> Self {
        Self::PAPER
    }
}

impl ClothCreasing {
    /// Office paper of 0.1 mm, an estimate: its outer fibres yield at a strain of about 0.5 %, so `κ_y` = 2 × 0.005 ⁄ 0.1 mm. The
    /// hardening is a guess.
    pub const PAPER: Self = Self {
        yield_curvature: 100.0,
        hardening: 0.1,
    };
    /// Leather, as in a strap or a jacket: a guess.
    pub const LEATHER: Self = Self {
        yield_curvature: 25.0,
        hardening: 0.4,
    };

    /// Checks that each value is in its range.
    ///
    /// # Errors
    /// [`QuantityError`] for the first value that is out of range.
    pub fn validate(&self) -> Result<(), QuantityError> {
        let positive = Allowed(|of| of > 0.0 && of.is_finite(), "positive, and finite");
        positive.check("yield curvature (1/m)", [self.yield_curvature])?;
        let part = Allowed(|of| (0.0..1.0).contains(&of), "from 0 to less than 1");
        part.check("hardening of creases", [self.hardening])
    }

    /// The largest curvature that a released strip keeps, `κ_y (1 − h) ⁄ h` (1/m): one that is bent further yields again on
    /// its way back. Infinite without hardening.
    pub fn largest_crease(&self) -> f32 {
        self.yield_curvature * (1.0 - self.hardening) / self.hardening
    }

    /// The elastic curvature less the back stress over D, which yields (1/m).
    pub(super) fn trial(&self, curvature: f32, crease: f32) -> f32 {
        curvature - crease / (1.0 - self.hardening)
    }

    /// The part of the trial that becomes a crease, by the square of the trial's norm (1/m²).
    pub(super) fn flow(&self, norm_squared: f32) -> f32 {
        let yields_at = self.yield_curvature;
        if norm_squared > yields_at * yields_at && norm_squared.is_finite() {
            (1.0 - self.hardening) * (1.0 - yields_at / norm_squared.sqrt())
        } else {
            0.0
        }
    }
}

/// Replaces rest curvatures, with 0 if their number differs. Returns whether they change.
pub(super) fn recall(own: &mut [f32], rest: &[f32]) -> bool {
    if own == rest {
        return false;
    }
    if own.len() == rest.len() {
        own.copy_from_slice(rest);
    } else {
        own.fill(0.0);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    const CREASING: ClothCreasing = ClothCreasing {
        yield_curvature: 10.0,
        hardening: 0.25,
    };

    fn bend(curvature: f32, crease: &mut f32) {
        let trial = CREASING.trial(curvature, *crease);
        *crease += CREASING.flow(trial * trial) * trial;
    }

    /// M ⁄ D of a strip bent there and back, against the corners of the hysteresis of linear kinematic hardening: loading along
    /// `κ_y + h (κ − κ_y)`, unloading along κ for `2 κ_y`, and again along h. f32 rounds numbers up to 100 by 1e−5 in all.
    #[test]
    fn hysteresis_is_that_of_kinematic_hardening() {
        let mut crease = 0.0;
        for (curvature, moment) in [
            (8.0, 8.0),
            (30.0, 15.0),
            (10.0, -5.0),
            (0.0, -7.5),
            (-40.0, -17.5),
            (-20.0, 2.5),
            (30.0, 15.0),
        ] {
            bend(curvature, &mut crease);
            assert!(
                (curvature - crease - moment).abs() < 1.0e-4,
                "{curvature} {crease}"
            );
        }
        // Released, it can't keep more than the largest.
        bend(200.0, &mut crease);
        for _ in 0..200 {
            let released = crease;
            bend(released, &mut crease);
        }
        assert!((crease / CREASING.largest_crease() - 1.0).abs() < 1.0e-5);
    }

    #[test]
    fn each_bad_value_is_named() {
        for creasing in [CREASING, ClothCreasing::PAPER, ClothCreasing::LEATHER] {
            assert_eq!(creasing.validate(), Ok(()));
        }
        for yield_curvature in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let bad = ClothCreasing {
                yield_curvature,
                ..CREASING
            };
            let message = bad.validate().expect_err("bad").to_string();
            assert!(message.contains("yield curvature"), "{message}");
        }
        for hardening in [1.0, -0.1, f32::NAN, f32::INFINITY] {
            let bad = ClothCreasing {
                hardening,
                ..CREASING
            };
            let message = bad.validate().expect_err("bad").to_string();
            assert!(message.contains("hardening"), "{message}");
        }
    }
}
