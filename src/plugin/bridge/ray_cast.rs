//! Rays that hit cloth.

use std::borrow::Cow;

use bevy::{
    ecs::system::SystemParam,
    prelude::{Dir3, Entity, Local, Query, Ray3d, Transform, Vec3},
};

use super::surface_now::surface_now;
use crate::{
    cloth::{ClothParticles, ClothTears},
    hierarchy::{QuadTree, RayQuery},
    plugin::{
        authoring::ClothGrab,
        frame::ClothFrame,
        state::{ClothBuilt, ClothState},
    },
};

/// Casts rays at cloth, through its tree of bounding volumes: for a mouse, a bullet, a line of sight. It needs neither a
/// mesh nor a window.
///
/// Cloth is where it was at the end of the last tick. A particle that the game has moved since then may be missed. Both
/// sides of a cloth are hit. A cloth that has not been simulated yet is not hit.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn shoot(mut rays: ClothRayCast) {
///     let ray = Ray3d::new(Vec3::new(0.0, 1.0, 5.0), Dir3::NEG_Z);
///     if let Some(hit) = rays.cast(ray, 100.0) {
///         info!("{} is hit at {}, {} m away", hit.cloth, hit.point, hit.distance);
///     }
/// }
/// # bevy::ecs::system::assert_is_system(shoot);
/// ```
#[derive(SystemParam)]
pub struct ClothRayCast<'w, 's> {
    cloths: Query<'w, 's, Hittable>,
    query: Local<'s, RayQuery>,
}

type Hittable = (
    Entity,
    &'static ClothBuilt,
    &'static ClothParticles,
    &'static ClothFrame,
    &'static ClothState,
    Option<&'static ClothTears>,
);

/// Where a ray hits a cloth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClothHit {
    /// The cloth.
    pub cloth: Entity,
    /// Index of the face in [`Surface::triangles`](crate::cloth::Surface::triangles), or that of the first particle of a
    /// rope's segment.
    pub face: usize,
    /// Indices of the particles at the corners of the face. The last two of a rope's segment are the same.
    pub particles: [u32; 3],
    /// The nearest of them.
    pub particle: u32,
    /// Barycentric coordinates of the point: one weight for each corner, together 1.
    pub weights: [f32; 3],
    /// The point, in the world (m).
    pub point: Vec3,
    /// Unit normal of the face, towards the origin of the ray. On a rope, it is opposite to the ray.
    pub normal: Vec3,
    /// Distance from the origin of the ray (m).
    pub distance: f32,
}

impl ClothHit {
    /// The components of a hand that takes hold of the cloth here.
    pub fn grab(&self) -> (ClothGrab, Transform) {
        let grab = ClothGrab {
            cloth: self.cloth,
            particle: self.particle,
            target: self.point,
            ..ClothGrab::default()
        };
        (grab, Transform::from_translation(self.point))
    }
}

impl ClothRayCast<'_, '_> {
    /// The first hit of a ray, in the world, at most `max_distance` away (m). There is none if an input is not a number.
    pub fn cast(&mut self, ray: Ray3d, max_distance: f32) -> Option<ClothHit> {
        self.cast_where(ray, max_distance, |_| true)
    }

    /// The same, among the cloths for which `includes` returns true.
    pub fn cast_where(
        &mut self,
        ray: Ray3d,
        max_distance: f32,
        includes: impl Fn(Entity) -> bool,
    ) -> Option<ClothHit> {
        let mut first: Option<ClothHit> = None;
        for (entity, built, particles, frame, state, tears) in &self.cloths {
            if !includes(entity) {
                continue;
            }
            let Some(surface) = surface_now(built, state, tears, particles) else {
                continue;
            };
            let farthest = first.map_or(max_distance, |hit| hit.distance);
            let to_cloth = frame.isometry().inverse();
            let Ok(direction) = Dir3::new(to_cloth.rotation * *ray.direction) else {
                continue;
            };
            let own = Ray3d::new(to_cloth * ray.origin, direction);
            let tree = match &surface {
                Cow::Borrowed(_) => Cow::Borrowed(built.tree()),
                Cow::Owned(surface) => Cow::Owned(QuadTree::of_surface(surface, false)),
            };
            let stretch = state.stretch.bound;
            let found = (self.query).cast(&surface, &tree, particles, stretch, own, farthest);
            let Some(found) = found else { continue };
            let face = found.particles;
            let [a, b, c] = face.map(|particle| particles.position_at(particle as usize));
            let normal = (b - a).cross(c - a).normalize_or(-*direction);
            let is_behind = normal.dot(*direction) > 0.0;
            let normal = if is_behind { -normal } else { normal };
            let [u, v, w] = found.weights;
            let point = a * u + b * v + c * w;
            let far = |corner: usize| [a, b, c][corner].distance_squared(point);
            let nearest = (0..3).min_by(|&one, &other| far(one).total_cmp(&far(other)));
            let is_nearer = first.is_none_or(|first| found.distance < first.distance);
            if is_nearer {
                first = Some(ClothHit {
                    cloth: entity,
                    face: found.face,
                    particles: face,
                    particle: face[nearest.unwrap_or(0)],
                    weights: found.weights,
                    point: frame.to_world(point),
                    normal: frame.isometry().rotation * normal,
                    distance: found.distance,
                });
            }
        }
        first
    }
}
