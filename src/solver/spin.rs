//! The angular momentum of a cloth that hangs by a vertical line, as a flag by its pole.
//!
//! Neither springs nor pins nor gravity turn such a cloth around that line, so that its angular momentum there is lost
//! to damping alone. A sweep does turn it: what one spring corrects turns those that are corrected after it, by a torque
//! of the order of (tension/mass)² Δt², always to the same side. Damping is all that holds against it: a limp flag of
//! 24 × 16 particles went round its pole at 0.25 rad/s for ever with 20 sub-steps in 1/64 s, at 0.025 rad/s with 80.

use bevy::math::Vec3;

use crate::cloth::{ClothParticles, DX, LANES, Slot, View, W, X};

/// How far pins may be beside the line, in metres for each metre along it.
const STRAIGHT: f32 = 1.0e-3;

/// How far a cloth is turned back in a tick at most (rad).
const LARGEST_TURN: f32 = 0.01;

/// What a cloth turns by around the line of its pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spin {
    /// A point of the line, and its direction, of length 1.
    origin: Vec3,
    axis: Vec3,
    /// Angular momentum times the length of a sub-step (kg m²).
    momentum: f32,
}

impl Spin {
    /// Of a cloth whose pins are on one line along `acceleration` (m/s²), if they are.
    pub fn of(particles: &ClothParticles, acceleration: Vec3) -> Option<Self> {
        let axis = acceleration.try_normalize()?;
        let layout = particles.layout();
        let is_pinned = |slot: &Slot| particles.blocks()[slot.block].inverse_mass(slot.lane) == 0.0;
        let position = |slot: Slot| particles.blocks()[slot.block].position(slot.lane);
        let mut pinned = layout.slots().filter(is_pinned).map(position);
        let origin = pinned.next()?;
        let on_line = |pin: Vec3| {
            let beside = (pin - origin).reject_from_normalized(axis);
            beside.length() <= STRAIGHT * pin.distance(origin)
        };
        let mut spin = Self {
            origin,
            axis,
            momentum: 0.0,
        };
        pinned.all(on_line).then(|| {
            spin.momentum = spin.measure(particles).0;
            spin
        })
    }

    /// Angular momentum times the length of a sub-step, and moment of inertia (kg m²).
    fn measure(&self, particles: &ClothParticles) -> (f32, f32) {
        let (mut momentum, mut inertia) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for block in particles.blocks() {
            let view = block.view();
            for lane in 0..LANES {
                let turned = self.turned(view, lane);
                let moved = lane_of(view, DX, lane);
                let free = view[W + lane] > 0.0;
                let mass = if free { 1.0 / view[W + lane] } else { 0.0 };
                momentum[lane] += mass * turned.dot(moved);
                inertia[lane] += mass * turned.length_squared();
            }
        }
        (momentum.iter().sum(), inertia.iter().sum())
    }

    /// How a particle moves when the cloth turns around the axis by 1 rad (m).
    fn turned(&self, view: &View, lane: usize) -> Vec3 {
        self.axis.cross(lane_of(view, X, lane) - self.origin)
    }

    /// Has the cloth turn as a whole so that its angular momentum is `kept` of what it was, and takes back by how far it
    /// was turned in the tick's `substeps`, in which the difference has grown evenly.
    pub fn restore(&self, particles: &mut ClothParticles, kept: f32, substeps: u32) {
        let (momentum, inertia) = self.measure(particles);
        let turn = (kept * self.momentum - momentum) / inertia;
        if !turn.is_finite() {
            return;
        }
        // So little that the arc is its tangent.
        let back = (turn * substeps as f32 / 2.0).clamp(-LARGEST_TURN, LARGEST_TURN);
        for block in particles.blocks_mut() {
            for lane in 0..LANES {
                let turned = self.turned(block.view(), lane);
                if block.inverse_mass(lane) > 0.0 {
                    block.set_displacement(lane, block.displacement(lane) + turned * turn);
                    block.set_position(lane, block.position(lane) + turned * back);
                }
            }
        }
    }
}

/// Three coordinates of a particle.
fn lane_of(view: &View, from: usize, lane: usize) -> Vec3 {
    Vec3::new(
        view[from + lane],
        view[from + LANES + lane],
        view[from + 2 * LANES + lane],
    )
}
