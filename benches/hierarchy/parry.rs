//! The same search by parry's bounding volume hierarchy.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::ClothParticles,
    hierarchy::{Core, Probe},
};
use parry3d::{
    bounding_volume::Aabb,
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace},
};

pub struct ParryTree {
    tree: Bvh,
    workspace: BvhWorkspace,
    is_moved: bool,
}

impl ParryTree {
    pub fn new(particles: &ClothParticles) -> Self {
        let leaves: Vec<Aabb> = particles
            .positions()
            .map(|position| around(position, 0.0))
            .collect();
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
            workspace: BvhWorkspace::default(),
            is_moved: false,
        }
    }

    /// Updates all leaves, refits, and counts what a ball meets.
    pub fn tick(&mut self, particles: &ClothParticles, probe: &Probe, shift: f32) -> usize {
        self.update(particles, shift);
        self.count(particles, probe)
    }

    /// Updates all leaves and refits.
    pub fn update(&mut self, particles: &ClothParticles, shift: f32) {
        // There and back again, so that the particles themselves stay.
        self.is_moved = !self.is_moved;
        let shift = if self.is_moved {
            Vec3::X * shift * 1.0e-4
        } else {
            Vec3::ZERO
        };
        for (index, position) in particles.positions().enumerate() {
            self.tree
                .insert_or_update_partially(around(position + shift, 0.0), index as u32, 0.0);
        }
        self.tree.refit(&mut self.workspace);
    }

    /// Counts what a ball meets.
    pub fn count(&self, particles: &ClothParticles, probe: &Probe) -> usize {
        let Core::Point(centre) = probe.core else {
            return 0;
        };
        let ball = around(centre, probe.reach() as f32);
        self.tree
            .intersect_aabb(&ball)
            .filter(|&leaf| {
                particles
                    .position(leaf as usize)
                    .is_some_and(|position| probe.meets(position))
            })
            .count()
    }
}

fn around(centre: Vec3, radius: f32) -> Aabb {
    let [low, high] =
        [centre - radius, centre + radius].map(|corner| Vector::new(corner.x, corner.y, corner.z));
    Aabb::new(low, high)
}
