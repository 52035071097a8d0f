//! Particles that carry a body from sub-step to sub-step.
//!
//! A contact alone gives a body, in a sub-step, no more momentum than the particles have that it pushes: a heavy body on light cloth would
//! pull these far out of place before they held it. So while the springs are solved, each particle that the body has just pushed is
//! heavier by a part `μᵢ` of the body, a [`Load`]; what the springs then move it by, `Δᵢ`, the body gets as an impulse `μᵢ Δᵢ` in that
//! place. Momentum and angular momentum are kept. With J the motion of the body's surface that its velocity and spin make in a place,
//! and W its inverse mass matrix, the body then has the energy `½ ‖Σ Jᵢᵀ μᵢ Δᵢ‖²_W ≤ ½ Σ μᵢ Δᵢ² · K Σ μᵢ`, K being the largest inverse
//! mass that the body shows in any of these places and directions. So none is gained as long as `Σ μᵢ ≤ 1/K`: of a ball, which
//! turns, 2/7 of its mass.
//!
//! A particle has one inverse mass, so it is as heavy along the surface as across it. It begins the sub-step with the momentum that the
//! body has there, in all directions: what it carries rolls, and does not slide. (With its own momentum along the surface instead, the
//! body came to rest as soon, and without friction fell through: its particles slipped aside from under it.)

use bevy::math::{DVec3, Mat3, Vec3};

use super::BodyMass;
use crate::cloth::{Block, ClothParticles, LANES, Load, Slot};

/// In how many sub-steps a particle still carries that is not pushed again.
const REMEMBERED: u8 = 3;

/// How many times as heavy as a particle its load is at most: more than that threads do not hold well.
const MAX_LOAD: f32 = 3.0e3;

/// A particle that carries a body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Carrier {
    slot: Slot,
    /// Out of the body where it lay on it last, of length 1.
    normal: Vec3,
    /// For how many sub-steps it still counts.
    left: u8,
}

impl Carrier {
    /// Whether it can be one of so many blocks.
    pub(crate) fn is_in(&self, blocks: usize) -> bool {
        self.slot.block < blocks && self.slot.lane < LANES
    }
}

/// The particles that carry a body, in the order of the cloth.
#[derive(Debug, Default, Clone)]
pub(super) struct Carriers {
    all: Vec<Carrier>,
    /// Where the next ones are put together.
    next: Vec<Carrier>,
    /// From where to where their loads are among the particles'.
    loads: [usize; 2],
    /// How many times as heavy as all particles of a row and a column through the carriers the body is.
    ratio: f32,
}

impl Carriers {
    pub fn clear(&mut self) {
        self.all.clear();
        self.loads = [0; 2];
        self.ratio = 0.0;
    }

    /// How many times as heavy as the particles of the threads by which it hangs the body is: as far as the cloth holds it, which has
    /// changed its velocity by `held` (m/s) in a tick in which it would fall by another (m/s).
    pub fn load_ratio(&self, held: f32, fall: f32) -> f32 {
        // Without a fall nothing has to be held.
        let part = held / fall.max(f32::MIN_POSITIVE);
        if fall > 0.0 && part > 0.0 {
            self.ratio * part.min(1.0)
        } else {
            0.0
        }
    }

    pub fn as_slice(&self) -> &[Carrier] {
        &self.all
    }

    /// Takes over those of an earlier tick.
    pub fn recall(&mut self, carriers: impl Iterator<Item = Carrier>) {
        self.clear();
        self.all.extend(carriers);
    }

    fn position(&self, slot: Slot) -> Result<usize, usize> {
        let key = |slot: Slot| (slot.block, slot.lane);
        self.all
            .binary_search_by_key(&key(slot), |carrier| key(carrier.slot))
    }

    /// Notes the particles of a block that the body has just pushed, with what leads `out` of it in a place. Blocks come in the order of
    /// the cloth.
    pub fn note(&mut self, block: usize, [old, new]: [&Block; 2], out: impl Fn(Vec3) -> Vec3) {
        for lane in 0..LANES {
            if new.inverse_mass(lane) == 0.0 || new.position(lane) == old.position(lane) {
                continue;
            }
            let slot = Slot { block, lane };
            let normal = out(new.position(lane));
            let carrier = Carrier {
                slot,
                normal,
                left: REMEMBERED,
            };
            match self.position(slot) {
                Ok(at) => self.all[at] = carrier,
                Err(_) => self.next.push(carrier),
            }
        }
    }

    /// Adds those that were noted and not known.
    pub fn add_noted(&mut self) {
        if !self.next.is_empty() {
            self.all.append(&mut self.next);
            self.all
                .sort_unstable_by_key(|carrier| (carrier.slot.block, carrier.slot.lane));
        }
    }

    /// Has the particles carry a body around a centre (m) in the coming sub-step, in which its `surface` goes so far in each place. A
    /// particle carries one body at a time: the `others` come first.
    pub fn lend<'a>(
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
            is_left
                && block.is_some_and(|block| block.inverse_mass(lane) > 0.0)
                && !others
                    .clone()
                    .any(|other| other.position(carrier.slot).is_ok())
        });
        let (mut sum, mut largest) = (0.0, 0.0_f32);
        for carrier in &self.all {
            let block = &particles.blocks()[carrier.slot.block];
            sum += block.inverse_mass(carrier.slot.lane).recip();
            let arm = block.position(carrier.slot.lane).as_dvec3() - centre;
            largest = largest.max(turning(mass, arm.as_vec3()));
        }
        // What they carry hangs by as many threads as there are along two ways.
        let count = self.all.len() as f32;
        self.ratio = if count > 0.0 {
            count.sqrt() / (2.0 * sum * mass.inverse_mass)
        } else {
            0.0
        };
        let most = (mass.inverse_mass + largest).recip();
        let part = (most / sum).min(MAX_LOAD);
        let from = particles.loads_mut().len();
        if part.is_finite() && part > 0.0 {
            for &Carrier { slot, normal, .. } in &self.all {
                let block = &particles.blocks()[slot.block];
                let mass = part / block.inverse_mass(slot.lane);
                let surface = surface(block.position(slot.lane));
                let load = Load::new(slot, mass, normal, surface);
                particles.loads_mut().push(load);
            }
        }
        self.loads = [from, particles.loads_mut().len()];
    }

    /// Takes back what they carried. Returns the push and the turn that the sub-step gave to that (kg·m, kg·m²), about a centre (m).
    pub fn take_back(&mut self, particles: &mut ClothParticles, centre: DVec3) -> [DVec3; 2] {
        let [mut push, mut turn] = [DVec3::ZERO; 2];
        let [from, to] = std::mem::take(&mut self.loads);
        for index in from..to {
            let Load {
                slot, mass, moved, ..
            } = particles.loads_mut()[index];

            let given = f64::from(mass) * moved.as_dvec3();
            let place = particles.blocks()[slot.block].position(slot.lane);
            push += given;
            turn += (place.as_dvec3() - centre).cross(given);
            // What is drawn away from the body carries it no longer.
            if let Ok(at) = self.position(slot)
                && moved.dot(self.all[at].normal) > 0.0
            {
                self.all[at].left = 0;
            }
        }
        [push, turn]
    }
}

/// The largest inverse mass that a body shows in any direction, so far from its centre of mass (m), by its turning (1/kg): the largest
/// eigenvalue of `A = [r]ₓ I⁻¹ [r]ₓᵀ`. Along r nothing turns it; the sum of the other two is the trace, that of their squares A's.
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
