//! Keeps a change of the sub-step from adding energy.
//!
//! In a sub-step of Δt, springs pull back their stretch, or a part of it where chains carry others. So unsolved
//! stretch acts like springs of the stiffness 1/Δt², and shorter sub-steps find the stretch of longer ones in stiffer
//! springs. A sheet of 64² that five points stop in its fall gained 12 % of the energy that its weight can give. The
//! stretch is as long as the sheet, so neither a hundred sweeps nor sub-steps of first order remove it. So the energy
//! that comes back after such a change is measured, and the motion within the cloth is slowed down by the excess.

use bevy::math::{DVec3, Vec3};

use crate::cloth::{Block, ClothParticles, Earlier, LANES, Lanes, W};

/// Ticks after a change to shorter sub-steps in which no energy is gained, and after each in which more than this part
/// of the motion came back. Unsolved stretch comes back within a few; after a fall that one pin stops, it takes longer.
const WATCHED_TICKS: u32 = 20;
const RETURNING: f64 = 0.01;

/// Energy of the particles (J), without that in springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Energy {
    /// Kinetic, and potential under the tick's acceleration.
    total: f64,
    /// Kinetic, but for that of the centre of mass where nothing is pinned.
    inner: f64,
    /// Whether nothing is pinned.
    is_free: bool,
    /// Energy that was lost in the ticks before, and may come back.
    lost: f64,
}

impl Energy {
    /// As a tick in sub-steps of `dt` (s) begins, if it is one of the first after a change to shorter ones.
    pub fn watched(particles: &mut ClothParticles, dt: f32, acceleration: Vec3) -> Option<Self> {
        if dt < particles.substep() {
            particles.past.watch(WATCHED_TICKS);
        }
        let lost = particles.past.next_watched()?;
        Some(Self {
            lost,
            ..Self::of(particles, acceleration)
        })
    }

    /// Of `particles` under an `acceleration` (m/s²).
    fn of(particles: &ClothParticles, acceleration: Vec3) -> Self {
        let (mut mass, mut momentum) = (0.0, DVec3::ZERO);
        let (mut kinetic, mut potential) = (0.0, 0.0);
        let (mut free, acceleration) = (0, acceleration.as_dvec3());
        let earlier = particles.past.known();
        for (index, block) in particles.blocks().iter().enumerate() {
            let view = block.view();
            for lane in 0..LANES {
                if view[W + lane] == 0.0 {
                    continue;
                }
                let moved = block.displacement(lane);
                let before = earlier.map_or(moved, |earlier| earlier[index].before(lane));
                let velocity = (moved + 0.5 * (moved - before)).as_dvec3();
                let own = 1.0 / f64::from(view[W + lane]);
                mass += own;
                momentum += own * velocity;
                kinetic += own * velocity.length_squared();
                potential -= own * block.position(lane).as_dvec3().dot(acceleration);
                free += 1;
            }
        }
        let is_free = free == particles.len();
        let as_one = if is_free {
            momentum.length_squared() / mass
        } else {
            0.0
        };
        // Of displacements so far.
        let to_joules = 0.5 / f64::from(particles.substep()).powi(2);
        Self {
            total: kinetic * to_joules + potential,
            inner: (kinetic - as_one) * to_joules,
            is_free,
            lost: 0.0,
        }
    }

    /// Takes away the energy that `particles` have gained in a tick, beyond their losses in the ticks before. `self` is
    /// their energy as the tick began. Remembers the energy that may come back.
    pub fn limit(self, particles: &mut ClothParticles, acceleration: Vec3) {
        let now = Self::of(particles, acceleration);
        if now.total - self.total > RETURNING * now.inner {
            particles.past.watch(WATCHED_TICKS);
        }
        let excess = now.total - self.total - self.lost;
        // NaN stays for those who look for it.
        if excess > 0.0 && now.inner > 0.0 {
            let kept = (1.0 - excess / now.inner).max(0.0).sqrt();
            slow_down(particles, kept as f32, now.is_free);
        }
        particles.past.set_lost((-excess).max(0.0));
    }
}

/// Keeps this part of all velocities: of those relative to the centre of mass where nothing is pinned.
fn slow_down(particles: &mut ClothParticles, kept: f32, is_free: bool) {
    let (blocks, past) = particles.blocks_and_past();
    for column in 0..COLUMNS {
        let mut mean = 0.0;
        if is_free {
            let (mut sum, mut mass) = (0.0, 0.0);
            for (index, block) in blocks.iter_mut().enumerate() {
                let weights: Lanes = std::array::from_fn(|lane| block.inverse_mass(lane));
                for (moved, weight) in moved(block, past.get_mut(index), column).zip(weights) {
                    if weight > 0.0 {
                        sum += f64::from(*moved) / f64::from(weight);
                        mass += 1.0 / f64::from(weight);
                    }
                }
            }
            mean = (sum / mass) as f32;
        }
        for (index, block) in blocks.iter_mut().enumerate() {
            for moved in moved(block, past.get_mut(index), column) {
                *moved = mean + kept * (*moved - mean);
            }
        }
    }
}

/// x, y and z of three displacements: the last, the one before and the one before that.
const COLUMNS: usize = 9;

/// One of them, of eight particles, if it is remembered.
fn moved<'a>(
    block: &'a mut Block,
    earlier: Option<&'a mut Earlier>,
    column: usize,
) -> impl Iterator<Item = &'a mut f32> {
    let lanes = match column.checked_sub(3) {
        None => Some(&mut block.displacements_mut()[column * LANES..][..LANES]),
        Some(column) => earlier.map(|Earlier(earlier)| &mut earlier[column][..]),
    };
    lanes.into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3Swizzles;

    use super::*;
    use crate::cloth::StepKind;

    const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

    /// Five particles of 2 kg that move about, remembered or not; the first pinned or not.
    fn moving(is_pinned: bool, is_remembered: bool) -> ClothParticles {
        let places: [Vec3; 5] = std::array::from_fn(|index| {
            Vec3::new(index as f32, 2.0, 3.0 * index as f32).map(f32::sin)
        });
        let mut particles = ClothParticles::new(&places, &[0.5; 5]).expect("five particles");
        for (index, place) in places.into_iter().enumerate() {
            particles
                .set_velocity(index, 3.0 * place.zxy() + Vec3::X)
                .expect("it exists");
        }
        if is_pinned {
            particles.pin(0);
            particles.zero_pin_displacements();
        }
        if is_remembered {
            while particles.next_step() != StepKind::Start {}
            let (blocks, past) = particles.blocks_and_past();
            for lane in 0..5 {
                let moved = blocks[0].displacement(lane).to_array();
                for (axis, moved) in moved.into_iter().enumerate() {
                    past[0].0[axis][lane] = 0.9 * moved;
                    past[0].0[axis + 3][lane] = 0.8 * moved;
                }
            }
        }
        particles
    }

    /// What is beyond what was lost is taken, and no more; nothing is where there is none. To the rounding of velocities.
    #[test]
    fn an_excess_is_taken_out_of_motion() {
        for (is_pinned, is_remembered) in [(false, false), (false, true), (true, true)] {
            let mut particles = moving(is_pinned, is_remembered);
            let now = Energy::of(&particles, GRAVITY);
            let (gain, lost) = (0.5 * now.inner, 0.2 * now.inner);
            let before = |lost: f64| Energy {
                total: now.total - gain,
                lost,
                ..now
            };
            before(lost).limit(&mut particles, GRAVITY);
            assert_eq!(particles.past.lost(), 0.0);
            let after = Energy::of(&particles, GRAVITY);
            let excess = after.total - (before(lost).total + lost);
            assert!(excess.abs() < 1.0e-6 * now.inner, "{excess} {now:?}");

            let kept = particles.clone();
            before(2.0 * gain).limit(&mut particles, GRAVITY);
            assert!(particles.positions().eq(kept.positions()));
            assert!(particles.displacements().eq(kept.displacements()));
            let (left, expected) = (particles.past.lost(), 2.0 * gain - lost);
            assert!((left - expected).abs() < 1.0e-6 * gain, "{left} {expected}");
        }
    }

    /// More than there is can't be taken: what is not pinned flies on as one then.
    #[test]
    fn a_free_cloth_keeps_its_momentum() {
        let mut particles = moving(false, true);
        let momentum = |particles: &ClothParticles| {
            let all = (0..5).filter_map(|index| particles.velocity(index));
            2.0 * all.sum::<Vec3>()
        };
        let before = momentum(&particles);
        let begins = Energy {
            total: -1.0e6,
            ..Energy::of(&particles, GRAVITY)
        };
        begins.limit(&mut particles, GRAVITY);
        let after = momentum(&particles);
        assert!((after - before).length() < 1.0e-5 * before.length());
        let each = particles.velocity(3).expect("it exists");
        assert!((10.0 * each - before).length() < 1.0e-5 * before.length());
    }
}
