//! Contact against closed forms, against `f64`, and against brute force.

mod body;
mod deep;
#[cfg(feature = "mesh")]
mod deforming;
mod edges;
mod fast;
mod geometry;
mod impulse;
mod lanes;
mod meshes;
mod moving;
mod particle;
mod random;
mod rest;
mod round;
mod shape_memory;
mod shapes;
mod shots;
mod sweep;
mod time;
mod triangle;
mod triangles;
mod volume;

use std::sync::Arc;

use bevy::math::{Isometry3d, Vec3};

use super::{candidates::ContactSettings, colliders::MovingCollider, detection::Detection};
/// What `shots` calls the crate, which the lab reads, too.
use crate as library;
use crate::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Surface},
    solver::SubStep,
};
pub(crate) use random::{Random, is_long};

/// The only sub-step of a tick in which nothing moves by itself.
const ONLY: SubStep = SubStep {
    index: 0,
    count: 1,
    farthest_move: 0.0,
};

/// A sub-step in which any overlap is let out at once (s): for what asks where to, and not how fast.
const LONG: f32 = 100.0;

fn build(columns: u32, rows: u32, spacing: f32) -> (Arc<Surface>, ClothParticles) {
    let surface = Cloth::new(columns, rows, spacing)
        .surface(Vec3::ONE)
        .expect("a valid grid");
    let mut particles =
        ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("a valid material");
    particles.set_substep(LONG);
    (Arc::new(surface), particles)
}

/// A tick in which every particle is a candidate of every collider: nothing can be missed.
fn all_of(
    colliders: &[MovingCollider],
    settings: &ContactSettings,
    surface: &Arc<Surface>,
    particles: &ClothParticles,
) -> Detection {
    let mut detection = Detection::default();
    let colliders: Vec<_> = colliders.iter().enumerate().collect();
    begin_with_all(&mut detection, &colliders, settings, surface, particles);
    detection
}

/// Begins such a tick, with the colliders by their numbers.
fn begin_with_all(
    detection: &mut Detection,
    colliders: &[(usize, &MovingCollider)],
    settings: &ContactSettings,
    surface: &Arc<Surface>,
    particles: &ClothParticles,
) {
    detection.begin(surface, f32::INFINITY);
    let all: Vec<u32> = (0..particles.len() as u32).collect();
    let cloth = particles.bounding_sphere();
    for &(id, collider) in colliders {
        let (_, narrow_phase) = detection.probe(collider, settings, surface, 0.0, &cloth);
        detection.add(id, collider, narrow_phase, &all, particles);
    }
}

/// How deep the deepest free particle is inside of a collider when a part of the tick has passed (m).
fn deepest_at(
    particles: &ClothParticles,
    collider: &MovingCollider,
    part: f32,
    particle_radius: f32,
) -> f64 {
    super::particles::deepest_penetration(
        particles,
        &collider.shape,
        collider.pose_at(part),
        particle_radius,
    )
}

/// Particles of no grid at rest, of mass 1 kg.
fn loose(positions: &[Vec3], displacements: &[Vec3]) -> ClothParticles {
    let mut particles =
        ClothParticles::new(positions, &vec![1.0; positions.len()]).expect("valid particles");
    particles.set_substep(LONG);
    for (index, &displacement) in displacements.iter().enumerate() {
        particles
            .set_displacement(index, displacement)
            .expect("it exists");
    }
    particles
}

fn at(place: Vec3) -> Isometry3d {
    Isometry3d::from_translation(place)
}
