//! The motion of the damping frame through a tick.

use bevy::math::{DVec3, Vec3};

use super::step::{DampingFrame, TickStep};
use crate::cloth::{Block, DX, DY, DZ, LANES, MapInline, W};

/// As many blocks are summed in single precision: their sum is rounded by less than a hundred thousandth.
const SUMMED: usize = 64;

/// Displacement of the damping frame in a sub-step.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct DampingReference {
    /// In the sub-step before the one to come (m).
    displacement: Vec3,
    /// Its gain in a sub-step by an acceleration of all particles (m).
    pull: Vec3,
    /// The sum of forces (N), and the gain by one newton on a kilogram (m).
    force: Vec3,
    unit: f32,
    /// Mass of all that is free (kg).
    mass: f32,
    /// Whether it is the centre of mass, and whether that was pushed since it was measured.
    follows: bool,
    is_stale: bool,
}

impl DampingReference {
    /// The damping frame's motion as a tick begins. Without damping it is not measured.
    pub fn of(step: &TickStep) -> Self {
        let dt = step.seconds / step.substeps.max(1) as f32;
        match step.damped_against {
            _ if step.damping == 0.0 => Self::default(),
            DampingFrame::Still => Self::default(),
            DampingFrame::Moving(velocity) => Self {
                displacement: velocity * dt,
                ..Self::default()
            },
            DampingFrame::CentreOfMass => Self {
                pull: step.acceleration * dt * dt,
                unit: dt * dt,
                follows: true,
                is_stale: true,
                ..Self::default()
            },
        }
    }

    /// Its displacement in the sub-step before, which `blocks` hold as the next begins, and its gain in each sub-step
    /// (m).
    ///
    /// A centre of mass is measured once a tick, and after each push from outside: forces within a cloth do not move it.
    pub fn follow(&mut self, blocks: &[Block]) -> [Vec3; 2] {
        if self.is_stale {
            (self.displacement, self.mass) = mean_displacement(blocks);
            self.is_stale = false;
        }
        [self.displacement, self.gained()]
    }

    /// Forces push the cloth by this sum (N) from now on.
    pub fn set_force(&mut self, force: Vec3) {
        self.force = force;
    }

    /// Ends a sub-step in which the common acceleration counted with this weight.
    pub fn gain(&mut self, weight: f32) {
        self.displacement += self.gained() * weight;
    }

    /// Something from outside has pushed the cloth.
    pub fn note_push(&mut self) {
        self.is_stale = self.follows;
    }

    fn gained(&self) -> Vec3 {
        if self.mass > 0.0 {
            self.pull + self.force * (self.unit / self.mass)
        } else {
            self.pull
        }
    }
}

/// The displacement of the centre of mass of all that is free (m), zero if nothing is; and its mass (kg).
fn mean_displacement(blocks: &[Block]) -> (Vec3, f32) {
    let (mut mass, mut moment) = (0.0_f64, DVec3::ZERO);
    for some in blocks.chunks(SUMMED) {
        let mut sums = [[0.0_f32; LANES]; 4];
        for block in some {
            let view = block.view();
            for l in 0..LANES {
                let own = if view[W + l] > 0.0 {
                    1.0 / view[W + l]
                } else {
                    0.0
                };
                sums[0][l] += own;
                for (sum, at) in sums[1..].iter_mut().zip([DX, DY, DZ]) {
                    sum[l] += own * view[at + l];
                }
            }
        }
        let [own, x, y, z] = sums.map_inline(|lanes| lanes.into_iter().map(f64::from).sum::<f64>());
        mass += own;
        moment += DVec3::new(x, y, z);
    }
    if mass > 0.0 {
        ((moment / mass).as_vec3(), mass as f32)
    } else {
        (Vec3::ZERO, 0.0)
    }
}
