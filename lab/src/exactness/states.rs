//! Random cloths of a given stretch, and balls near them.

use std::f32::consts::{PI, TAU};

use bevy::math::{Quat, Vec3};
use bevy_drape::{
    cloth::{Cloth, ClothGrid, ClothMaterial, ClothParticles, Springs, Surface},
    hierarchy::{Probe, QuadTree},
    solver::Stretch,
};

use crate::measure::Random;

/// Distance between particles (m), and the radius of each, in spacings.
const SPACING: f32 = 0.1;
const PARTICLE_RADIUS: f32 = 0.1;

/// A cloth in some state.
pub struct State {
    pub tree: QuadTree,
    pub particles: ClothParticles,
    /// Its largest stretch.
    pub stretch: f32,
}

impl State {
    /// Of 4 to 33 particles a side: bent and folded along its rows without any stretch, then pulled, waved and shaken as
    /// far as makes the largest stretch this, or a little less.
    pub fn new(random: &mut Random, stretch: f32) -> Self {
        let [columns, rows] = [0; 2].map(|_| 4 + random.below(30));
        let grid = Cloth::new(columns, rows, SPACING)
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let material = ClothMaterial::COTTON;
        let springs = Springs::of_grid(&grid, &material);
        let surface = Surface::of_grid(&grid);
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
        let bent = bent(random, &grid);
        let moves = moves(random, &grid, &bent);
        let mut measure = |part: f32| {
            for (index, (position, by)) in bent.iter().zip(&moves).enumerate() {
                particles
                    .set_position(index, *position + *by * part)
                    .expect("it exists");
            }
            Stretch::measure(&springs, &particles).bound
        };
        let mut part = 0.0;
        if stretch > 0.0 {
            let mut too_far = 1.0e-3;
            while measure(too_far) < stretch {
                too_far *= 2.0;
            }
            for _ in 0..16 {
                let middle = f32::midpoint(part, too_far);
                if measure(middle) < stretch {
                    part = middle;
                } else {
                    too_far = middle;
                }
            }
        }
        Self {
            stretch: measure(part),
            tree: QuadTree::of_grid(&grid, true),
            particles,
        }
    }

    /// A ball of a radius in spacings that meets or nearly meets one of its particles.
    pub fn ball(&self, random: &mut Random, radius: f32) -> Probe {
        let near = random.below(self.particles.len() as u32) as usize;
        let near = self.particles.position(near).expect("it exists");
        let away = (radius + PARTICLE_RADIUS) * random.between(0.0, 1.1);
        let centre = near + direction(random) * away * SPACING;
        Probe::ball(centre, radius * SPACING, PARTICLE_RADIUS * SPACING)
    }
}

fn direction(random: &mut Random) -> Vec3 {
    let [x, y, z] = [0; 3].map(|_| random.between(-1.0, 1.0));
    Vec3::new(x, y, z).normalize_or(Vec3::Z)
}

/// Row after row goes on by a spacing in some direction of its own: springs within rows and between them keep their
/// lengths, and no diagonal grows. Waves, rolls, and half of them with a fold.
fn bent(random: &mut Random, grid: &ClothGrid) -> Vec<Vec3> {
    let (strength, waves, phase) = (
        random.between(0.0, PI),
        random.between(0.0, 0.5),
        random.between(0.0, TAU),
    );
    let fold = if random.part() < 0.5 {
        random.between(0.0, PI)
    } else {
        0.0
    };
    let crease = random.below(grid.rows());
    let turned = Quat::from_scaled_axis(direction(random) * random.between(0.0, PI));
    let mut profile = vec![Vec3::ZERO];
    for row in 1..grid.rows() {
        let angle =
            strength * (waves * row as f32 + phase).sin() + if row > crease { fold } else { 0.0 };
        let (sin, cos) = angle.sin_cos();
        profile.push(profile[row as usize - 1] + Vec3::new(0.0, -cos, sin) * SPACING);
    }
    let position = |(row, column): (u32, u32)| {
        turned * (profile[row as usize] + Vec3::X * column as f32 * SPACING)
    };
    grid.cells().map(position).collect()
}

/// Where each particle is moved from there: along an axis, as it lies; in waves; and each by itself.
fn moves(random: &mut Random, grid: &ClothGrid, bent: &[Vec3]) -> Vec<Vec3> {
    let axis = direction(random);
    let pulled = random.part();
    let [wave, along] = [0; 2].map(|_| direction(random));
    let waved = random.part() * SPACING * 4.0;
    // A little always: what is pulled across itself does not stretch.
    let shaken = random.between(0.05, 1.0).powi(2) * SPACING;
    let cells = grid.cells().zip(bent);
    cells
        .map(|((row, column), position)| {
            let phase = along.x * row as f32 + along.y * column as f32;
            let [x, y, z] = [0; 3].map(|_| random.between(-1.0, 1.0));
            axis * (axis.dot(*position) * pulled)
                + wave * (phase.sin() * waved)
                + Vec3::new(x, y, z) * shaken
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_have_the_stretch_that_was_asked_for() {
        let mut random = Random(3);
        for stretch in [0.0, 0.01, 0.1, 0.5, 2.0] {
            for _ in 0..40 {
                let found = State::new(&mut random, stretch).stretch;
                assert!(
                    found < stretch + 1.0e-4 && found > 0.9 * stretch - 1.0e-4,
                    "{found} for {stretch}"
                );
            }
        }
    }
}
