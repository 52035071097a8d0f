//! Penetration depth over all particles, in f64.

use bevy::math::{DQuat, DVec3, Isometry3d, Vec3};

use crate::cloth::MapInline;
use crate::{cloth::ClothParticles, contact::colliders::ColliderShape};

/// The penetration of the deepest free particle into a shape (m), with the shape's pose in the cloth's frame; 0 if none
/// is inside.
///
/// For a geometry, parry computes the depth in f32. A mesh that deforms is as at the end of the tick.
pub fn deepest_penetration(
    particles: &ClothParticles,
    shape: &ColliderShape,
    pose: Isometry3d,
    particle_radius: f32,
) -> f64 {
    let (core, radius) = shape.core(pose);
    let reach = f64::from(radius) + f64::from(particle_radius);
    let distance = |position: Vec3| match shape {
        ColliderShape::Cuboid { half_size } => {
            let beyond = seen_from(pose, position).abs() - half_size.as_dvec3();
            beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
        }
        ColliderShape::Ball { .. } | ColliderShape::Capsule { .. } | ColliderShape::HalfSpace => {
            core.distance(position)
        }
        _ => {
            let local = seen_from(pose, position).as_vec3();
            f64::from(radius) + f64::from(shape.nearest_within(local, f32::MAX).distance)
        }
    };
    let free = particles
        .positions()
        .zip(particles.inverse_masses())
        .filter(|&(_, mass)| mass > 0.0);
    let depth = free.map(|(position, _)| reach - distance(position));
    depth.fold(0.0, f64::max)
}

fn seen_from(pose: Isometry3d, point: Vec3) -> DVec3 {
    let rotation = DQuat::from_array(pose.rotation.to_array().map_inline(f64::from)).normalize();
    rotation.inverse() * (point.as_dvec3() - Vec3::from(pose.translation).as_dvec3())
}
