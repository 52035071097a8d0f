//! The angular momentum of a cloth that hangs by an upright line, as a flag by its pole.
//!
//! Neither springs nor pins turn such a cloth around that line, and gravity only where the line leans. So its angular momentum
//! there is known: it changes by gravity's torque and by damping, whether the line stands still or moves without turning. But a sweep
//! does turn it. The correction of one spring turns the springs after it, by a torque of the order of (tension/mass)² Δt², always
//! to the same side. Only damping resists that. A limp flag of 24 × 16 particles circled its pole for ever, at 0.25 rad/s with
//! 20 sub-steps in 1/64 s, and at a tenth of that with 80.
//!
//! Pins need not be exactly on the line. Beside it they turn the cloth by their distance times their pull, which is left out: by
//! less than the sweep, as far as they count as on it.

use bevy::math::Vec3;

use super::{
    free_pieces::FreePieces,
    step::{PinMotion, TickStep},
};
use crate::cloth::{ClothParticles, DX, LANES, MapInline, Slot, View, W, X};

/// Largest distance of pins from the line, as a fraction of its length, and largest difference of their motions.
const STRAIGHT: f32 = 0.02;
const SAME_MOTION: f32 = 1.0e-3;

/// The cosine of the largest angle between the line and gravity: 10°.
const UPRIGHT: f32 = 0.985;

/// Largest angle by which a cloth is turned back in a tick (rad).
const LARGEST_TURN: f32 = 0.01;

/// The rotation of a cloth around the line of its pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spin {
    /// A point of the line as the tick begins, and the direction of the line, of length 1.
    origin: Vec3,
    axis: Vec3,
    /// Displacement of the line in the tick, and in a sub-step (m).
    shift: Vec3,
    displacement: Vec3,
    /// Its displacement in a sub-step, relative to the damping frame (m).
    against: Vec3,
    substeps: u32,
    /// Gravity (m/s²), and the lengths of a tick and of a sub-step, multiplied (s²).
    gravity: Vec3,
    seconds: f32,
    /// As the tick begins.
    before: Turning,
}

/// How a cloth turns, as seen from the line.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Turning {
    /// Angular momentum times the length of a sub-step (kg m²).
    momentum: f32,
    /// Moment of inertia (kg m²).
    inertia: f32,
    /// Angular momentum of the line's own motion in a sub-step, relative to the damping frame, if the cloth moved along
    /// (kg m²).
    carried: f32,
    /// Gravity's torque (N m).
    torque: f32,
}

impl Spin {
    /// Of a cloth whose pins are on one upright line, which stands still or moves without turning, if they are. Damping is
    /// relative to what moves by `drift` in a sub-step (m).
    pub fn of(
        particles: &ClothParticles,
        step: &TickStep,
        pins: &[PinMotion],
        drift: Vec3,
        free_pieces: &FreePieces,
    ) -> Option<Self> {
        let down = step.acceleration.try_normalize()?;
        let layout = particles.layout();
        let blocks = particles.blocks().iter().enumerate();
        // Most blocks hold no pin: they are passed over as a whole.
        let mut pinned = blocks
            .filter(|(_, block)| block.view()[W..W + LANES].contains(&0.0))
            .flat_map(|(index, block)| {
                let is_pinned = move |lane: &usize| {
                    let exists = layout.index_at(index, *lane).is_some();
                    block.inverse_mass(*lane) == 0.0 && exists && !free_pieces.hold(index, *lane)
                };
                (0..LANES)
                    .filter(is_pinned)
                    .map(|lane| block.position(lane))
            });
        let origin = pinned.clone().next()?;
        // From the first pin to the one that is farthest from it; of a single pin the vertical.
        let far = |far: Vec3, pin: Vec3| {
            let is_farther = pin.distance_squared(origin) > far.distance_squared(origin);
            if is_farther { pin } else { far }
        };
        let along = pinned.clone().fold(origin, far) - origin;
        let axis = along.try_normalize().unwrap_or(down);
        let axis = axis * axis.dot(down).signum();
        let mut count = 0;
        let on_line = |pin: Vec3| {
            count += 1;
            let beside = (pin - origin).reject_from_normalized(axis);
            beside.length() <= STRAIGHT * along.length()
        };
        if axis.dot(down) < UPRIGHT || !pinned.all(on_line) {
            return None;
        }
        let shift = pins.first().map_or(Vec3::ZERO, |pin| pin.to - pin.from);
        // To a rounding of where they are.
        let is_along = |moved: Vec3, at: Vec3| {
            moved.distance(shift)
                <= SAME_MOTION * shift.length() + 1.0e-6 * (at.length() + origin.length())
        };
        let mut moved = pins.iter();
        let some_stay = pins.len() < count && !is_along(Vec3::ZERO, origin);
        let moves_as_one = !some_stay && moved.all(|pin| is_along(pin.to - pin.from, pin.to));
        moves_as_one.then(|| {
            let substeps = step.substeps.max(1);
            let mut spin = Self {
                origin,
                axis,
                shift,
                displacement: shift / substeps as f32,
                against: shift / substeps as f32 - drift,
                substeps,
                gravity: step.acceleration,
                seconds: step.seconds * step.seconds / substeps as f32,
                before: Turning::default(),
            };
            spin.before = spin.measure(particles, origin, free_pieces);
            spin
        })
    }

    /// Pieces that no pin holds do not count.
    fn measure(
        &self,
        particles: &ClothParticles,
        origin: Vec3,
        free_pieces: &FreePieces,
    ) -> Turning {
        let mut sums = [[0.0_f32; LANES]; 4];
        for (index, block) in particles.blocks().iter().enumerate() {
            let view = block.view();
            for lane in 0..LANES {
                let turned = self.axis.cross(lane_of(view, X, lane) - origin);
                let moved = lane_of(view, DX, lane) - self.displacement;
                let is_free = view[W + lane] > 0.0 && !free_pieces.hold(index, lane);
                let mass = if is_free { 1.0 / view[W + lane] } else { 0.0 };
                sums[0][lane] += mass * turned.dot(moved);
                sums[1][lane] += mass * turned.length_squared();
                sums[2][lane] += mass * turned.dot(self.against);
                sums[3][lane] += mass * turned.dot(self.gravity);
            }
        }
        let [momentum, inertia, carried, torque] = sums.map_inline(|lanes| lanes.iter().sum());
        Turning {
            momentum,
            inertia,
            carried,
            torque,
        }
    }

    /// Turns the cloth as a whole, so that its angular momentum is that after gravity's torque and damping. The torque is the mean of
    /// that at both ends of the tick. Damping keeps the fraction `kept` of each velocity. Also takes back the angle by which it was turned in the tick, in which the difference has grown
    /// evenly.
    pub fn restore(&self, particles: &mut ClothParticles, kept: f32, free_pieces: &FreePieces) {
        let origin = self.origin + self.shift;
        let after = self.measure(particles, origin, free_pieces);
        // Damping holds against what it is relative to, which need not be the line.
        let pulled = 0.5 * (self.before.torque + after.torque) * self.seconds;
        let expected = kept * self.before.momentum - (1.0 - kept) * self.before.carried + pulled;
        let turn = (expected - after.momentum) / after.inertia;
        if !turn.is_finite() {
            return;
        }
        // So little that the arc is its tangent.
        let back = turn * self.substeps as f32 / 2.0;
        let back = back.clamp(-LARGEST_TURN, LARGEST_TURN);
        for index in 0..particles.blocks().len() {
            for lane in 0..LANES {
                let block = &mut particles.blocks_mut()[index];
                let turned = self.axis.cross(lane_of(block.view(), X, lane) - origin);
                if block.inverse_mass(lane) > 0.0 && !free_pieces.hold(index, lane) {
                    block.set_position(lane, block.position(lane) + turned * back);
                    particles.accelerate(Slot { block: index, lane }, turned * turn);
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
