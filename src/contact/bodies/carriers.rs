//! Particles that carry a body between sub-steps.
//!
//! A contact alone gives a body, in a sub-step, at most the momentum of the particles that it pushes. A heavy body on
//! light cloth would displace them far before they held it. So while the springs are solved, each particle that the
//! body has just pushed carries a part `μᵢ` of its mass, a [`Load`]: the more, the harder it is pressed. The springs
//! move it by `Δᵢ`, and the body receives the impulse `μᵢ Δᵢ` there. Momentum and angular momentum are conserved.
//!
//! Let J be the motion of the body's surface at a point per unit of velocity and spin, and W its inverse mass matrix.
//! The body then has the energy `½ ‖Σ Jᵢᵀ μᵢ Δᵢ‖²_W ≤ ½ Σ μᵢ Δᵢ² · K Σ μᵢ`. K is the largest inverse mass of the body
//! at any of these points and directions. So no energy is gained as long as `Σ μᵢ ≤ 1/K`: for a ball, which turns, 2/7
//! of its mass.
//!
//! A particle has one inverse mass, the same along the surface and across it. It begins the sub-step with the body's
//! momentum there, in all directions: a carried body rolls, and does not slide. (With the particle's own momentum along
//! the surface instead, the body came to rest as soon, but without friction it fell through: its particles slipped
//! aside.) Where cloth lies on something, bodies stand on that instead: see the module `standing`.

use std::ops::Range;

use bevy::math::{DVec3, Mat3, Vec3};

use crate::{
    cloth::{Block, ClothParticles, LANES, Load, Slot},
    contact::colliders::BodyMass,
};

/// Number of sub-steps that a particle carries after its last push.
const REMEMBERED: u8 = 3;

/// Largest ratio of a particle's load to its own mass: chains hold larger ones badly.
const MAX_LOAD: f32 = 3.0e3;

/// Weight of the last push in the mean of a particle's pushes. Loads go by these means. If they went by the particles' own masses,
/// corners of triangles that the body hardly presses would hang from it. Balls of four times a cloth's mass then jitter.
const NEWEST: f32 = 0.5;

/// A particle that carries a body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Carrier {
    slot: Slot,
    /// Outward normal of the body at the last contact, of length 1.
    normal: Vec3,
    /// Number of sub-steps left.
    left: u8,
    /// A mean of how far the body has pushed it in the last sub-steps, by friction too (m). Only ratios of these count.
    pressed: f32,
}

impl Carrier {
    /// Whether its block is one of `blocks`.
    pub(crate) fn is_in(&self, blocks: usize) -> bool {
        self.slot.block < blocks && self.slot.lane < LANES
    }
}

/// The particles that carry a body, in the order of the cloth.
#[derive(Debug, Default, Clone)]
pub(crate) struct Carriers {
    pub all: Vec<Carrier>,
    /// Scratch memory for the next list.
    next: Vec<Carrier>,
    /// Range of their loads among those of the particles.
    loads: Range<usize>,
    /// Ratio of the body's mass to that of all particles of a row and a column through the carriers.
    ratio: f32,
}

impl Carriers {
    pub fn clear(&mut self) {
        self.all.clear();
        self.loads = 0..0;
        self.ratio = 0.0;
    }

    /// Ratio of the body's mass to that of the chains that hold it, times the fraction of its weight that the cloth
    /// holds. `held` is the change of its velocity by the cloth (m/s) in a tick; `fall` is that by gravity (m/s).
    pub fn load_ratio(&self, held: f32, fall: f32) -> f32 {
        // Without a fall there is no weight to hold.
        let part = held / fall.max(f32::MIN_POSITIVE);
        let is_held = fall > 0.0 && part > 0.0;
        if is_held {
            self.ratio * part.min(1.0)
        } else {
            0.0
        }
    }

    /// Restores the carriers of an earlier tick.
    pub fn recall(&mut self, carriers: impl Iterator<Item = Carrier>) {
        self.clear();
        self.all.extend(carriers);
    }

    fn position(&self, slot: Slot) -> Result<usize, usize> {
        let key = |slot: Slot| (slot.block, slot.lane);
        (self.all).binary_search_by_key(&key(slot), |carrier| key(carrier.slot))
    }

    /// Notes the particles of a block that the body has just pushed and that may carry it, by the outward normal that `out`
    /// gives at a point. Blocks come in the order of the cloth.
    pub fn note(
        &mut self,
        block: usize,
        [old, new]: [&Block; 2],
        out: impl Fn(Vec3) -> Vec3,
        may_carry: impl Fn(Vec3) -> bool,
    ) {
        for lane in 0..LANES {
            if new.inverse_mass(lane) == 0.0 || new.position(lane) == old.position(lane) {
                continue;
            }
            let slot = Slot { block, lane };
            let normal = out(new.position(lane));
            if !may_carry(normal) {
                continue;
            }
            let push = new.position(lane).distance(old.position(lane));
            let carrier = |pressed| Carrier {
                slot,
                normal,
                left: REMEMBERED,
                pressed,
            };
            match self.position(slot) {
                Ok(at) => self.all[at] = carrier(self.all[at].pressed + NEWEST * push),
                Err(_) => self.next.push(carrier(NEWEST * push)),
            }
        }
    }

    /// Adds the noted particles that are new.
    pub fn add_noted(&mut self) {
        if !self.next.is_empty() {
            self.all.append(&mut self.next);
            (self.all).sort_unstable_by_key(|carrier| (carrier.slot.block, carrier.slot.lane));
        }
    }

    /// Makes the particles carry a body around a centre (m) in the coming sub-step, in which its `surface` moves by
    /// that much at each point. A particle carries one body at a time: the `others` come first.
    pub fn attach_load<'a>(
        &mut self,
        particles: &mut ClothParticles,
        (mass, centre): (&BodyMass, DVec3),
        surface: impl Fn(Vec3) -> Vec3,
        others: impl Iterator<Item = &'a Self> + Clone,
    ) {
        self.all.retain_mut(|carrier| {
            let Slot { block, lane } = carrier.slot;
            let block = particles.blocks().get(block);
            let is_left = carrier.left > 0;
            carrier.left = carrier.left.saturating_sub(1);
            carrier.pressed *= 1.0 - NEWEST;
            let mut others = others.clone();
            is_left
                && block.is_some_and(|block| block.inverse_mass(lane) > 0.0)
                && !others.any(|other| other.position(carrier.slot).is_ok())
        });
        let (mut sum, mut pressed, mut largest) = (0.0, 0.0, 0.0_f32);
        for carrier in &self.all {
            let block = &particles.blocks()[carrier.slot.block];
            let own = block.inverse_mass(carrier.slot.lane).recip();
            sum += own;
            pressed += own * carrier.pressed;
            let arm = block.position(carrier.slot.lane).as_dvec3() - centre;
            largest = largest.max(turning(mass, arm.as_vec3()));
        }
        // The load hangs by as many chains as there are in both directions.
        let count = self.all.len() as f32;
        let ratio = count.sqrt() / (2.0 * sum * mass.inverse_mass);
        self.ratio = if count > 0.0 { ratio } else { 0.0 };
        let most = (mass.inverse_mass + largest).recip();
        let part = (most / pressed).min(f32::MAX);
        let from = particles.loads_mut().len();
        // Not so if one is NaN.
        if pressed > 0.0 && most > 0.0 {
            for carrier in &self.all {
                let slot = carrier.slot;
                let block = &particles.blocks()[slot.block];
                let part = (part * carrier.pressed).min(MAX_LOAD);
                let mass = part / block.inverse_mass(slot.lane);
                let surface = surface(block.position(slot.lane));
                let load = Load::new(slot, mass, carrier.normal, surface);
                particles.loads_mut().push(load);
            }
        }
        self.loads = from..particles.loads_mut().len();
    }

    /// Removes the loads. Returns the linear and angular impulse of the sub-step times its duration (kg·m, kg·m²),
    /// about a centre (m).
    pub fn detach_load(&mut self, particles: &mut ClothParticles, centre: DVec3) -> [DVec3; 2] {
        let [mut push, mut turn] = [DVec3::ZERO; 2];
        for index in std::mem::take(&mut self.loads) {
            let load = &particles.loads_mut()[index];
            let (slot, moved) = (load.slot, load.moved);
            let given = f64::from(load.mass) * moved.as_dvec3();
            let place = particles.blocks()[slot.block].position(slot.lane);
            push += given;
            turn += (place.as_dvec3() - centre).cross(given);
            // A particle pulled away from the body stops carrying it.
            if let Ok(at) = self.position(slot)
                && moved.dot(self.all[at].normal) > 0.0
            {
                self.all[at].left = 0;
            }
        }
        [push, turn]
    }
}

/// The largest inverse mass of a body by rotation at an arm from its centre of mass (m), in any direction (1/kg). It is
/// the largest eigenvalue of `A = [r]ₓ I⁻¹ [r]ₓᵀ`. One eigenvalue, along r, is 0; the other two follow from the traces
/// of A and A².
fn turning(mass: &BodyMass, arm: Vec3) -> f32 {
    let cross = Mat3::from_cols(
        Vec3::new(0.0, arm.z, -arm.y),
        Vec3::new(-arm.z, 0.0, arm.x),
        Vec3::new(arm.y, -arm.x, 0.0),
    );
    let of_arm = cross * mass.inverse_inertia * cross.transpose();
    let columns = [of_arm.x_axis, of_arm.y_axis, of_arm.z_axis];
    let squares: f32 = columns.iter().map(|column| column.length_squared()).sum();
    let trace = of_arm.x_axis.x + of_arm.y_axis.y + of_arm.z_axis.z;
    (trace + (2.0 * squares - trace * trace).max(0.0).sqrt()) / 2.0
}
