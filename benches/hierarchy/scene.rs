//! A draped cloth and what touches it.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    hierarchy::{BoundRule, BoundingVolume, NodeBounds, Probe, QuadTree},
    solver::Stretch,
};

/// Distance between particles (m).
pub const SPACING: f32 = 0.05;

/// Two waves across it, three spacings high.
pub struct Draped {
    pub tree: QuadTree,
    pub particles: ClothParticles,
    pub springs: Springs,
    /// The largest.
    pub stretch: f32,
    side: u32,
}

impl Draped {
    pub fn new(side: u32) -> Self {
        let grid = Cloth::new(side, side, SPACING)
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let material = ClothMaterial::COTTON;
        let mut particles =
            ClothParticles::at_rest(&Surface::of_grid(&grid), &material).expect("a valid material");
        for (row, column) in grid.cells() {
            let [across, down] = [column, row].map(|index| index as f32 / (side - 1) as f32);
            let wave = (across * 2.0 * std::f32::consts::TAU).sin() * (down * 3.0).cos();
            let position = grid.rest_position(row, column).with_z(3.0 * SPACING * wave);
            particles
                .set_position((row, column), position)
                .expect("it exists");
        }
        let springs = Springs::of_grid(&grid, &material);
        Self {
            tree: QuadTree::of_grid(&grid, true),
            stretch: Stretch::measure(&springs, &particles).bound,
            particles,
            springs,
            side,
        }
    }

    pub fn rebuild(&self, bounds: &mut NodeBounds, choice: (BoundingVolume, BoundRule)) {
        bounds
            .rebuild(choice, &self.tree, &self.particles, self.stretch)
            .expect("there is such a rule");
    }

    /// A ball of four spacings that touches the cloth near its middle.
    pub fn ball(&self) -> Probe {
        self.ball_at(self.side * 11 / 23, self.side * 12 / 23)
    }

    /// This many balls all over the cloth.
    pub fn balls(&self, count: u32) -> Vec<Probe> {
        let a_side = f64::from(count).sqrt().ceil() as u32;
        let at = |index: u32| (2 * index + 1) * self.side / (2 * a_side);
        (0..count)
            .map(|index| self.ball_at(at(index / a_side), at(index % a_side)))
            .collect()
    }

    fn ball_at(&self, row: u32, column: u32) -> Probe {
        let beneath = self.particles.position((row, column)).expect("it exists");
        Probe::ball(beneath + Vec3::Z * 3.9 * SPACING, 4.0 * SPACING, 0.0)
    }
}
