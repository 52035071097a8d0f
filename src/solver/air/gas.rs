//! Gas that is enclosed in a mesh.
//!
//! Boyle's law gives its pressure over that of the outside, `p = p₀ (V₀/V − 1)`, and virtual work the force on a particle, `p A`, where
//! A is the gradient of the volume: a third of the areas of its triangles. Air at p₀ = 10⁵ Pa in light cloth is stiff: a ball of the radius r
//! and ρ kg/m² breathes at √(3 p₀/(ρ r)), some 900 times a second at 0.15 m and 60 g/m². So each sub-step solves for the pressure with which
//! the volume at its end agrees. That is V* without it and V* + S p with it, S = Δt² Σ w A²: a quadratic equation, with one positive
//! volume for any V*, of a mesh that is flat or turned inside out too.
//!
//! Springs and contact take back a part of what the gas gives, in a taut balloon all of it. They are taken to do so as they did in the
//! sub-step before: a balloon at rest then has the pressure of its volume, not of one that is a push larger. The two together are stable:
//! for springs that take back the share β, and any stiffness of the gas, all roots of the scheme are within the unit circle
//! (β from 0 to 1 in 41 steps, K = S dp/dV from 10⁻² to 10⁵ in 40).

use bevy::math::{DVec3, Vec3};

use super::areas::Enclosed;
use crate::{
    cloth::{Block, DX, DY, DZ, LANES, W},
    solver::pentadiagonal::Trio,
};

/// How fast gas moves a face outwards at most (m/s): a flat balloon of 0.3 m fills in a thirtieth of a second.
pub(crate) const FILLING: f32 = 10.0;

/// An amount of gas, and what it is in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Amount {
    /// Volume that it has at the pressure outside (m³).
    pub volume: f64,
    /// Pressure outside (Pa).
    pub outside: f64,
}

/// What a cloth's gas is known by from sub-step to sub-step.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Gas {
    /// The volume that would be if nothing held against the gas, and what the gas made of it in the last sub-step (m³).
    expected: f64,
    push: f64,
    /// Of the inside over the outside (Pa).
    pub pressure: f64,
}

impl Gas {
    /// Adds to the displacements of a sub-step what the gas adds, with this weight (s²). `seconds` is its length. Returns the impulse (N s).
    pub fn press(
        &mut self,
        amount: Amount,
        enclosed: Enclosed,
        blocks: &mut [Block],
        areas: &[Trio],
        weight: f64,
        seconds: f64,
    ) -> DVec3 {
        let (mut swept, mut give) = (0.0, 0.0);
        let mut total = DVec3::ZERO;
        for (block, area) in blocks.iter().zip(areas) {
            let view = block.view();
            for l in 0..LANES {
                let area = Vec3::new(area[0][l], area[1][l], area[2][l]);
                let moved = Vec3::new(view[DX + l], view[DY + l], view[DZ + l]);
                swept += f64::from(area.dot(moved));
                give += f64::from(view[W + l] * area.length_squared());
                if view[W + l] > 0.0 {
                    total += area.as_dvec3();
                }
            }
        }
        let give = give * weight;
        // Nothing that it could move, or what is not finite and a fault.
        let known = enclosed.volume + self.expected + self.push;
        if !(give > 0.0 && (give + swept + known).is_finite()) {
            *self = Self::default();
            return DVec3::ZERO;
        }
        let taken = if self.push == 0.0 {
            0.0
        } else {
            let most = 2.0 * self.push.abs();
            (self.expected - enclosed.volume).clamp(-most, most)
        };
        let without = enclosed.volume + enclosed.outwards * swept;
        let widest = enclosed.volume + enclosed.area * f64::from(FILLING) * seconds;
        self.pressure = amount.pressure(without - taken, give, widest);
        self.push = self.pressure * give;
        self.expected = without + self.push;
        let pressure = enclosed.outwards * self.pressure;
        let push = (pressure * weight) as f32;
        for (block, area) in blocks.iter_mut().zip(areas) {
            let view = block.view_mut();
            for l in 0..LANES {
                let push = push * view[W + l];
                view[DX + l] += push * area[0][l];
                view[DY + l] += push * area[1][l];
                view[DZ + l] += push * area[2][l];
            }
        }
        total * (pressure * seconds)
    }
}

impl Amount {
    /// The pressure (Pa) with which a volume that is `without` it and grows by `give` m³ for each pascal is that of the gas, but none by
    /// which it would become wider than `widest` m³.
    fn pressure(&self, without: f64, give: f64, widest: f64) -> f64 {
        let Self { volume, outside } = *self;
        // V² − (V* − S p₀) V − S p₀ V₀ = 0.
        let held = give * outside;
        let (linear, constant) = (without - held, held * volume);
        let root = (linear * linear + 4.0 * constant).sqrt();
        let end = if linear > 0.0 {
            0.5 * (linear + root)
        } else {
            2.0 * constant / (root - linear)
        };
        let filling = (widest - without) / give;
        (outside * (volume / end - 1.0)).min(filling.max(0.0))
    }
}
