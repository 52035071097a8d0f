//! Forces of a game on the particles of a cloth, besides gravity.
//!
//! [`Forces`] alone knows all of them; what calls it names none. Each is a file here, and a field of [`ForceInputs`]. After
//! the air it adds to `LinearForce::push` of all particles but pins. Chains and soft springs, grids and meshes, one
//! thread and many apply the sum. Its impulse and the motion of the centre of mass follow from it.
//!
//! **Steps.** Forces are evaluated a few times per tick (`LONGEST`), whatever the sub-steps. In between, each sub-step
//! follows the sum along its slope over the particle's velocity. A force that changes much within 10 ms, as a stiff one
//! does, is evaluated in each sub-step.

mod air;

use bevy::math::{DVec3, Vec3};

pub use self::air::{Air, ClothPressure};
use super::kernels::{Kernels, LinearForce};
use crate::cloth::{Block, ClothParticles, LANES, Lanes, Layout, MapInline, Surface};
use air::{Airflow, Gas};

/// Forces are evaluated again after this time (s) at the latest: twice in a tick of 1/64 s. A flag of 1.4 × 0.9 m in
/// 8 m/s then waves 4.7 times a second (80 sub-steps, 200 s). It waves 5.0 times with four evaluations, and 5.15 times
/// with 80; four cost 13 % of a tick instead of 4 (64²).
const LONGEST: f32 = 0.01;

/// Larger impulses (N s) on a row of a grid, or on a mesh, are not counted: they belong to no game, and `f32` may not hold them.
const LARGEST_IMPULSE: f64 = 1.0e25;

/// An impulse (N s), or none if it is NaN or too large.
fn counted(given: DVec3) -> DVec3 {
    if given.abs().max_element() < LARGEST_IMPULSE {
        given
    } else {
        DVec3::ZERO
    }
}

/// The forces on a cloth in a tick, in the cloth's frame.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct ForceInputs {
    /// The air around it, with a uniform wind.
    pub air: Option<Air>,
    /// The air inside a closed mesh.
    pub pressure: Option<ClothPressure>,
}

/// The effect of all forces on the particles of a surface.
#[derive(Debug, Default, Clone)]
pub struct Forces {
    inputs: ForceInputs,
    layout: Layout,
    airflow: Option<Airflow>,
    /// Empty without forces.
    linearized: Vec<LinearForce>,
    /// As the forces were evaluated, see [`LinearForce`].
    places: Vec<Lanes>,
    /// Sub-steps between two evaluations, and since the last.
    stride: u32,
    /// Sub-steps between two looks at the wind.
    wind_stride: u32,
    since: u32,
    substep: f32,
    /// Impulse that they gave the cloth in the tick (N s).
    impulse: DVec3,
    pub(crate) memory: ForceMemory,
}

/// Memory of forces for the next tick.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ForceMemory {
    /// Their mean sum between the last two evaluations (N), in the cloth's frame.
    pub force: Vec3,
    gas: Gas,
}

impl Forces {
    /// Sets the forces on the surface that the solver was made for, with a uniform wind. Without any, a tick costs no more.
    pub fn set(&mut self, surface: &Surface, inputs: ForceInputs) {
        if inputs == ForceInputs::default() {
            *self = Self::default();
            return;
        }
        self.inputs = inputs;
        self.layout = surface.layout();
        self.airflow = Airflow::of(inputs.air, inputs.pressure, self.airflow.take(), surface);
        let blocks = surface.layout().blocks();
        self.linearized.resize(blocks, LinearForce::NONE);
        self.places.resize(blocks, [0.0; LANES]);
    }

    /// Sets a wind that depends on the position, in place of [`Air::wind`], until forces are set again. `at` takes a
    /// position (m) to the velocity of the air (m/s), both in the cloth's frame. It is called at some 80 positions
    /// around the current particles, and interpolated between them. These are nine in each direction of a grid, or a
    /// lattice of up to 5 × 5 × 5 around a mesh. Without air it is not called.
    pub fn set_local_wind(&mut self, particles: &ClothParticles, at: impl FnMut(Vec3) -> Vec3) {
        if let Some(airflow) = &mut self.airflow {
            airflow.set_local_wind(particles, at);
        }
    }

    pub(super) fn are_none(&self) -> bool {
        self.linearized.is_empty()
    }

    /// Impulse that they gave the cloth in the last tick, in the cloth's frame (N s).
    pub fn impulse(&self) -> Vec3 {
        self.impulse.as_vec3()
    }

    /// The volume that a closed mesh under pressure encloses (m³), and its gauge pressure (Pa), as of the last sub-step.
    pub fn enclosed(&self) -> (f32, f32) {
        let airflow = self.airflow.as_ref();
        airflow.map_or((0.0, 0.0), |airflow| airflow.enclosed(&self.memory.gas))
    }

    /// Begins a tick of `seconds` in this many sub-steps.
    pub(super) fn begin(&mut self, seconds: f32, substeps: u32) {
        let looks = ((seconds / LONGEST).ceil() as u32).clamp(1, substeps);
        self.wind_stride = substeps.div_ceil(looks);
        // The size of an inflated cloth follows from its pressure and its springs in each sub-step.
        let is_stiff = self.inputs.pressure.is_some();
        self.stride = if is_stiff { 1 } else { self.wind_stride };
        self.substep = seconds / substeps as f32;
        self.since = 0;
        self.impulse = DVec3::ZERO;
    }

    /// Before a sub-step: evaluates the forces if it is time.
    pub(super) fn before_substep(
        &mut self,
        index: u32,
        particles: &ClothParticles,
        kernels: &Kernels,
    ) {
        if self.are_none() {
            return;
        }
        if index.is_multiple_of(self.stride) {
            self.settle(particles, kernels);
            let (linearized, places) = (&mut self.linearized[..], &mut self.places[..]);
            // The air writes; forces after it add.
            if let Some(airflow) = &mut self.airflow {
                let stepped = (self.substep, index.is_multiple_of(self.wind_stride));
                airflow.evaluate(particles, kernels, stepped, linearized, places);
            } else {
                linearized.fill(LinearForce::NONE);
                places.fill([0.0; LANES]);
            }
        }
        self.since += 1;
    }

    /// Adds the impulse since the last evaluation.
    pub(super) fn settle(&mut self, particles: &ClothParticles, kernels: &Kernels) {
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
            (kernels.force_impulse)(row, linearized, places, seconds, &mut sum);
            let given = DVec3::from(sum.map_inline(|lanes| lanes.into_iter().map(f64::from).sum()));
            self.impulse += counted(given);
        }
        self.memory.force = (self.impulse - before).as_vec3() / seconds;
        self.since = 0;
    }

    /// Their action on each particle.
    pub(super) fn linearized(&self) -> Option<&[LinearForce]> {
        (!self.are_none()).then_some(&self.linearized)
    }

    /// Adds what depends on the end of a sub-step to its predicted displacements, with this weight (s²).
    pub(super) fn press(&mut self, blocks: &mut [Block], weight: f32) {
        if let Some(airflow) = &mut self.airflow {
            let gas = &mut self.memory.gas;
            self.impulse += counted(airflow.press(gas, blocks, weight, self.substep));
        }
    }
}
