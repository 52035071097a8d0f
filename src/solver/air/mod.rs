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
//! **Steps.** The faces are evaluated a few times per tick ([`LONGEST`]), whatever the sub-steps. In between, each
//! sub-step follows the force along its slope over the particle's velocity, `a = b − κ n (n·v)` with `κ = ρ A (C_d
//! |u_n| + C_l u_t/2)/m`. The force is quadratic, so the new velocity lies between the particle's velocity and that of
//! the wind: no wind and no tick makes it overshoot.
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

pub(crate) use self::gas::FILLING;
pub use self::pressure::ClothPressure;
use super::kernels::{
    AeroCoefficients, Enclosed, Kernels, LinearizedDrag, Rows, Triangles, Vec3Lanes,
};
use crate::cloth::{Block, ClothParticles, LANES, Lanes, Layout, MapInline, Surface};
use gas::{Amount, Gas};
use wind::LocalWind;

/// The faces are evaluated again after this time (s) at the latest: twice in a tick of 1/64 s. A flag of 1.4 × 0.9 m in
/// 8 m/s then waves 4.7 times a second (80 sub-steps, 200 s). It waves 5.0 times with four evaluations, and 5.15 times
/// with 80; four cost 13 % of a tick instead of 4 (64²).
const LONGEST: f32 = 0.01;

/// Larger impulses (N s) on a row of a grid, or on a mesh, are not counted: they belong to no game, and `f32` may not hold them.
const LARGEST_IMPULSE: f64 = 1.0e25;

/// An impulse (N s), or none if it is NaN or too large.
fn counted(given: DVec3) -> DVec3 {
    match given.abs().max_element() < LARGEST_IMPULSE {
        true => given,
        false => DVec3::ZERO,
    }
}

/// The air around a cloth, in the cloth's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Air {
    /// Density (kg/m³).
    pub density: f32,
    /// `C_d`: the drag coefficient of a face broadside to the wind.
    pub drag: f32,
    /// `C_l`: the slope of a face's normal force coefficient over the sine of a small angle to the wind.
    pub lift: f32,
    /// Velocity of the air (m/s).
    pub wind: Vec3,
    /// The air inside a closed mesh.
    pub pressure: Option<ClothPressure>,
}

impl Air {
    /// Air of zero density: only pressure is left.
    pub const NONE: Self = Self {
        density: 0.0,
        drag: 0.0,
        lift: 0.0,
        wind: Vec3::ZERO,
        pressure: None,
    };
}

/// The effect of the air on the particles of a surface.
#[derive(Debug, Clone)]
pub(super) struct Airflow {
    air: Air,
    layout: Layout,
    /// Of a mesh.
    triangles: Option<Triangles>,
    local: LocalWind,
    /// Whether the wind is `local`, and not the same everywhere.
    is_local: bool,
    linearized: Vec<LinearizedDrag>,
    /// As the faces were looked at, see [`LinearizedDrag`].
    places: Vec<Lanes>,
    /// Of a row, or of all of a mesh.
    areas: Vec<Vec3Lanes>,
    winds: Vec<Vec3Lanes>,
    /// Sub-steps between two looks, and since the last.
    stride: u32,
    /// Sub-steps between two looks at the wind.
    wind_stride: u32,
    since: u32,
    substep: f32,
    /// Impulse that the air gave the cloth in the tick (N s).
    impulse: DVec3,
    /// Memory for the next tick.
    memory: AirMemory,
    /// As the faces were looked at.
    enclosed: Enclosed,
}

/// Memory of an airflow for the next tick.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct AirMemory {
    /// The mean force of the air between the last two looks (N), in the cloth's frame.
    pub force: Vec3,
    gas: Gas,
}

impl Airflow {
    pub fn new(surface: &Surface, air: Air) -> Self {
        let layout = surface.layout();
        let is_grid = surface.as_grid().is_some();
        // A grid's are found row by row.
        let at_once = if is_grid {
            layout.strip as usize
        } else {
            layout.blocks()
        };
        Self {
            air,
            layout,
            triangles: (!is_grid).then(|| Triangles::new(surface)),
            local: LocalWind::default(),
            is_local: false,
            linearized: vec![LinearizedDrag::NONE; layout.blocks()],
            places: vec![[0.0; LANES]; layout.blocks()],
            areas: vec![[[0.0; LANES]; 3]; at_once],
            winds: vec![[[0.0; LANES]; 3]; at_once],
            stride: 1,
            wind_stride: 1,
            since: 0,
            substep: 0.0,
            impulse: DVec3::ZERO,
            memory: AirMemory::default(),
            enclosed: Enclosed::default(),
        }
    }

    /// Sets a uniform wind.
    pub fn set(&mut self, air: Air) {
        self.air = air;
        self.is_local = false;
    }

    /// Sets a wind that depends on the position (m, m/s), and is evaluated at some positions.
    pub fn set_local_wind(&mut self, particles: &ClothParticles, at: impl FnMut(Vec3) -> Vec3) {
        let is_grid = self.triangles.is_none();
        self.local.sample(particles, is_grid, at);
        self.is_local = true;
    }

    /// Impulse that the air gave the cloth in the last tick (N s).
    pub fn impulse(&self) -> Vec3 {
        self.impulse.as_vec3()
    }

    pub fn memory(&self) -> AirMemory {
        self.memory
    }

    pub fn set_memory(&mut self, memory: AirMemory) {
        self.memory = memory;
    }

    /// The volume (m³) that a mesh under pressure encloses, as of the last evaluation of the faces, and its gauge
    /// pressure (Pa).
    pub fn enclosed(&self) -> (f32, f32) {
        let pressure = match self.air.pressure {
            None => return (0.0, 0.0),
            Some(ClothPressure::Gauge(pressure)) => pressure,
            Some(ClothPressure::Gas { .. }) => self.memory.gas.pressure as f32,
        };
        (self.enclosed.volume.abs() as f32, pressure)
    }

    /// Adds the displacements by gas to the predicted displacements of a sub-step, with this weight (s²).
    pub fn press(&mut self, blocks: &mut [Block], weight: f32) {
        let Some(ClothPressure::Gas { volume, outside }) = self.air.pressure else {
            return;
        };
        let amount = Amount {
            volume: volume.into(),
            outside: outside.into(),
        };
        let (weight, seconds) = (weight.into(), self.substep.into());
        let (gas, areas) = (&mut self.memory.gas, &self.areas);
        let given = gas.press(amount, self.enclosed, blocks, areas, weight, seconds);
        self.impulse += counted(given);
    }

    /// Begins a tick of `seconds` in this many sub-steps.
    pub fn begin(&mut self, seconds: f32, substeps: u32) {
        // The size of an inflated cloth follows from its pressure and its springs in each sub-step.
        let looks = ((seconds / LONGEST).ceil() as u32).clamp(1, substeps);
        self.wind_stride = substeps.div_ceil(looks);
        self.stride = match self.air.pressure {
            None => self.wind_stride,
            Some(_) => 1,
        };
        self.substep = seconds / substeps as f32;
        self.since = 0;
        self.impulse = DVec3::ZERO;
    }

    /// Before a sub-step: evaluates the faces if it is time.
    pub fn before_substep(&mut self, index: u32, particles: &ClothParticles, kernels: &Kernels) {
        if index.is_multiple_of(self.stride) {
            self.settle(particles, kernels);
            self.look(particles, kernels, index.is_multiple_of(self.wind_stride));
        }
        self.since += 1;
    }

    /// Adds the impulse of the air since the last evaluation.
    pub fn settle(&mut self, particles: &ClothParticles, kernels: &Kernels) {
        if self.since == 0 {
            return;
        }
        let strip = self.layout.strip as usize;
        let seconds = self.since as f32 * self.substep;
        let rows = particles.blocks().chunks(strip);
        let known = self.linearized.chunks(strip).zip(self.places.chunks(strip));
        let before = self.impulse;
        for (row, (linearized, places)) in rows.zip(known) {
            let mut sum = [[0.0; LANES]; 3];
            (kernels.air_impulse)(row, linearized, places, seconds, &mut sum);
            let given = DVec3::from(sum.map_inline(|lanes| lanes.into_iter().map(f64::from).sum()));
            self.impulse += counted(given);
        }
        self.memory.force = (self.impulse - before).as_vec3() / seconds;
        self.since = 0;
    }

    /// The air's action on each particle of a row.
    pub fn linearized(&self) -> &[LinearizedDrag] {
        &self.linearized
    }

    /// On a mesh, a wind that depends on the position is kept from the last evaluation unless `wind_is_asked`.
    fn look(&mut self, particles: &ClothParticles, kernels: &Kernels, wind_is_asked: bool) {
        let Air {
            density,
            drag,
            lift,
            wind,
            pressure,
        } = self.air;
        let mut coefficients = AeroCoefficients {
            drag: density * drag,
            lift: 0.5 * density * lift,
            pressure: 0.0,
            substep: self.substep,
            inverse_substep: 1.0 / self.substep,
        };
        let (layout, blocks) = (self.layout, particles.blocks());
        let (rows, strip) = (layout.rows as usize, layout.strip as usize);
        let Self {
            triangles,
            local,
            is_local,
            areas,
            winds,
            linearized,
            places,
            ..
        } = self;
        if !*is_local {
            winds.fill(wind.to_array().map_inline(|of| [of; LANES]));
        }
        if let Some(triangles) = triangles {
            let enclosed = triangles.areas(blocks, layout, areas);
            if let Some(ClothPressure::Gauge(pressure)) = pressure {
                let outwards = enclosed.outwards * enclosed.volume.signum();
                coefficients.pressure = pressure * outwards as f32;
            }
            self.enclosed = enclosed;
            if *is_local && wind_is_asked {
                local.of_mesh(particles, winds);
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
            if *is_local {
                local.of_row(index, layout, winds);
            }
            (kernels.air_linearize)(row(index), areas, winds, &coefficients, linearized, places);
        }
    }
}
