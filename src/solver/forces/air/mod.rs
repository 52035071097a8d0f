//! Air: drag and lift of a wind, and pressure.
//!
//! The air moves at U, and a face with the normal n at v. So the face feels `u = U − v`: `u_n` along its normal, and
//! `u_t` in its plane. The force on a face of the area A is
//!
//! ```text
//!        U ──▶  │                F = ρ/2 A (C_d |u_n| + C_l u_t) u_n n
//!               │──▶ n
//!        ──▶    │                C_d: a plate that the wind meets broadside
//!               face             C_l: the slope of a plate's normal force at grazing angles
//! ```
//!
//! A hinged sheet of `ρ_s` kg/m² leans in the wind by the angle t with `sin t = ρ U² (C_d cos² t + C_l sin t cos t)/(2
//! ρ_s g)`. A flat sheet falls with the terminal speed `√(2 ρ_s g/(ρ C_d))`. Neither depends on its resolution or its
//! sub-steps (`cargo test --test truth air`).
//!
//! **Faces.** Each particle has a face: on a grid half of the diamond of its neighbours, on a mesh a third of each of
//! its triangles. So the force on a face acts along one normal on one particle, and its damping is a number, not a
//! matrix.
//!
//! **Steps.** Between two evaluations of the faces, each sub-step follows the force along its slope over the particle's
//! velocity, `a = b − κ n (n·v)` with `κ = ρ A (C_d |u_n| + C_l u_t/2)/m`. The force is quadratic, so the new velocity
//! lies between the particle's velocity and that of the wind: no wind and no tick makes it overshoot.
//!
//! The velocity is that at the start of the sub-step. With the predicted velocity at its end, before springs have
//! acted, the air would resist motion that springs undo, and a wind load would count by only 1/(1 + κ Δt). Where κ Δt
//! is above 1 (cotton in 20 sub-steps of 1/64 s: from 130 m/s on), b and κ are divided by it. A particle then reaches
//! its final speed in one sub-step, and the load is smaller than it should be.
//!
//! **Cost** (64², 20 sub-steps, one thread): 4 % of a tick in a uniform wind, 6 % in any other (`cargo bench --profile
//! dev --bench solver -- air`).

mod gas;
mod pressure;
#[cfg(test)]
mod tests;
mod wind;

use bevy::math::{DVec3, Vec3};

pub(super) use self::gas::Gas;
pub use self::pressure::ClothPressure;
use crate::{
    cloth::{Block, ClothParticles, LANES, Lanes, Layout, MapInline, Surface},
    solver::kernels::{
        AeroCoefficients, Enclosed, Kernels, LinearForce, Rows, Triangles, Vec3Lanes,
    },
};
use wind::LocalWind;

/// The air around a cloth. By default it has no density.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct Air {
    /// Density (kg/m³).
    pub density: f32,
    /// `C_d`: the drag coefficient of a face broadside to the wind.
    pub drag: f32,
    /// `C_l`: the slope of a face's normal force coefficient over the sine of a small angle to the wind.
    pub lift: f32,
    /// Velocity of the air (m/s).
    pub wind: Vec3,
}

/// The effect of the air, outside and inside, on the particles of a surface.
#[derive(Debug, Default, Clone)]
pub(super) struct Airflow {
    air: Air,
    /// Of the air inside.
    pressure: Option<ClothPressure>,
    layout: Layout,
    /// Of a mesh.
    triangles: Option<Triangles>,
    local: LocalWind,
    /// Whether the wind is `local`, and not the same everywhere.
    is_local: bool,
    /// Of a row, or of all of a mesh.
    areas: Vec<Vec3Lanes>,
    winds: Vec<Vec3Lanes>,
    /// As the faces were looked at.
    enclosed: Enclosed,
}

impl Airflow {
    /// Of this air outside and inside, if there is any, with a uniform wind. `known` is that of the same surface before.
    pub fn of(
        air: Option<Air>,
        pressure: Option<ClothPressure>,
        known: Option<Self>,
        surface: &Surface,
    ) -> Option<Self> {
        (air.is_some() || pressure.is_some()).then(|| Self {
            air: air.unwrap_or_default(),
            pressure,
            is_local: false,
            ..known.unwrap_or_else(|| Self::new(surface))
        })
    }

    fn new(surface: &Surface) -> Self {
        let layout = surface.layout();
        let is_grid = surface.as_grid().is_some();
        // A grid's are found row by row.
        let at_once = if is_grid {
            layout.strip as usize
        } else {
            layout.blocks()
        };
        Self {
            layout,
            triangles: (!is_grid).then(|| Triangles::new(surface)),
            areas: vec![[[0.0; LANES]; 3]; at_once],
            winds: vec![[[0.0; LANES]; 3]; at_once],
            ..Self::default()
        }
    }

    /// Sets a wind that depends on the position (m, m/s), and is evaluated at some positions.
    pub fn set_local_wind(&mut self, particles: &ClothParticles, at: impl FnMut(Vec3) -> Vec3) {
        let is_grid = self.triangles.is_none();
        self.local.sample(particles, is_grid, at);
        self.is_local = true;
    }

    /// The volume (m³) that a mesh under pressure encloses, as of the last evaluation of the faces, and its gauge
    /// pressure (Pa).
    pub fn enclosed(&self, gas: &Gas) -> (f32, f32) {
        let pressure = match self.pressure {
            None => return (0.0, 0.0),
            Some(ClothPressure::Gauge(pressure)) => pressure,
            Some(ClothPressure::Gas { .. }) => gas.pressure as f32,
        };
        (self.enclosed.volume.abs() as f32, pressure)
    }

    /// Adds the displacements by gas to the predicted displacements of a sub-step of `seconds`, with this weight (s²).
    /// Returns the impulse (N s).
    pub fn press(&self, gas: &mut Gas, blocks: &mut [Block], weight: f32, seconds: f32) -> DVec3 {
        let Some(ClothPressure::Gas { volume, outside }) = self.pressure else {
            return DVec3::ZERO;
        };
        let amount = [volume, outside].map_inline(f64::from);
        let (weight, seconds) = (weight.into(), seconds.into());
        gas.press(amount, self.enclosed, blocks, &self.areas, weight, seconds)
    }

    /// Evaluates the force on the faces, for sub-steps of this length (s). On a mesh, a wind that depends on the position is
    /// kept from the last evaluation unless `wind_is_asked`.
    pub fn evaluate(
        &mut self,
        particles: &ClothParticles,
        kernels: &Kernels,
        (substep, wind_is_asked): (f32, bool),
        linearized: &mut [LinearForce],
        places: &mut [Lanes],
    ) {
        let air = self.air;
        let mut coefficients = AeroCoefficients {
            drag: air.density * air.drag,
            lift: 0.5 * air.density * air.lift,
            pressure: 0.0,
            substep,
            inverse_substep: 1.0 / substep,
        };
        let (layout, blocks) = (self.layout, particles.blocks());
        let (rows, strip) = (layout.rows as usize, layout.strip as usize);
        let (areas, winds) = (&mut self.areas, &mut self.winds);
        if !self.is_local {
            winds.fill(air.wind.to_array().map_inline(|of| [of; LANES]));
        }
        if let Some(triangles) = &mut self.triangles {
            let enclosed = triangles.areas(blocks, layout, areas);
            if let Some(ClothPressure::Gauge(pressure)) = self.pressure {
                let outwards = enclosed.outwards * enclosed.volume.signum();
                coefficients.pressure = pressure * outwards as f32;
            }
            self.enclosed = enclosed;
            if self.is_local && wind_is_asked {
                self.local.of_mesh(particles, winds);
            }
            (kernels.air_linearize)(blocks, areas, winds, &coefficients, linearized, places);
            return;
        }
        let last = layout.slot(0, layout.columns - 1);
        let row = |row: usize| &blocks[row * strip..(row + 1) * strip];
        let outs = linearized.chunks_mut(strip).zip(places.chunks_mut(strip));
        for (index, (linearized, places)) in outs.enumerate() {
            let around = Rows {
                own: row(index),
                above: row(index.saturating_sub(1)),
                below: row((index + 1).min(rows - 1)),
                last,
            };
            (kernels.air_areas)(&around, areas);
            if self.is_local {
                self.local.of_row(index, layout, winds);
            }
            (kernels.air_linearize)(row(index), areas, winds, &coefficients, linearized, places);
        }
    }
}
