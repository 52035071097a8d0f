//! Hands that hold cloth.

use std::sync::Arc;

use bevy::{
    ecs::{entity::MapEntities, reflect::ReflectMapEntities},
    prelude::{Component, Entity, Reflect, ReflectComponent, ReflectDefault, Transform, Vec3},
};

use crate::cloth::{Allowed, QuantityError, Surface};

/// A hand that holds a particle of a cloth. Spawn it where a ray [hits](crate::plugin::ClothHit::grab) the cloth, move its
/// [`target`](Self::target), and despawn it to let go.
///
/// The entity must have no parent. It takes hold where its target is. From then on the plugin writes its translation: it
/// follows the target, no faster than its speed, and pulls the particle no farther from any pin than the cloth reaches.
/// It slows down where it stretches the cloth beside the particle by more than 10 %, and stops at 30 %. A pin that moves
/// away takes it along. The particle keeps its offset from the entity. While something else pins the particle, the hand
/// moves without it.
///
/// The particle is among the cloth's [`ClothAttachments`](crate::plugin::ClothAttachments) until the hand lets go. If
/// [`cloth`](Self::cloth) or [`particle`](Self::particle) change, the hand takes hold anew. When the cloth teleports, gets
/// another surface or is gone, the plugin removes the component, which lets go, too.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// /// Takes hold of what is in front of a robot's arm.
/// fn take(arm: Single<&GlobalTransform, With<Camera>>, mut rays: ClothRayCast, mut commands: Commands) {
///     let ray = Ray3d::new(arm.translation(), arm.forward());
///     if let Some(hit) = rays.cast(ray, 2.0) {
///         commands.spawn(hit.grab());
///     }
/// }
///
/// /// Lifts it.
/// fn lift(mut hands: Query<&mut ClothGrab>, time: Res<Time>) {
///     hands.iter_mut().for_each(|mut hand| hand.target.y += 0.5 * time.delta_secs());
/// }
/// # bevy::ecs::system::assert_is_system(take);
/// # bevy::ecs::system::assert_is_system(lift);
/// ```
#[derive(Component, Reflect, MapEntities, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, MapEntities, Default, Debug, Clone, PartialEq)]
#[require(Transform, ClothGrip)]
pub struct ClothGrab {
    /// The cloth.
    #[entities]
    pub cloth: Entity,
    /// Index of the particle.
    pub particle: u32,
    /// Where the hand is to be, in the world (m). It takes hold there.
    pub target: Vec3,
    /// Largest stretch of the cloth between the hand and a pin, as a fraction of its length at rest. That is straight
    /// on a flat convex surface, and along the edges on any other.
    pub stretch: f32,
    /// Largest speed of the hand (m/s).
    pub speed: f32,
}

impl Default for ClothGrab {
    /// Particle 0 of no cloth, a stretch of 2 %, 3 m/s.
    fn default() -> Self {
        Self {
            cloth: Entity::PLACEHOLDER,
            particle: 0,
            target: Vec3::ZERO,
            stretch: 0.02,
            speed: 3.0,
        }
    }
}

impl ClothGrab {
    /// Checks its numbers.
    ///
    /// # Errors
    /// [`QuantityError`] for a value that is out of range.
    pub(crate) fn validate(&self) -> Result<(), QuantityError> {
        Allowed::SIZE.check("the stretch of a grab", [self.stretch])?;
        Allowed::SIZE.check("the speed of a grab (m/s)", [self.speed])?;
        let near = Allowed(|v| v.abs() <= 1.0e12, "within 10¹² m of the origin");
        near.check("the target of a grab (m)", self.target.to_array())
    }
}

/// The hold of a hand, as of the tick in which it took hold.
#[derive(Component, Reflect, Debug, Default)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct ClothGrip {
    /// The cloth, once the hand has taken hold.
    #[reflect(ignore)]
    pub cloth: Option<Entity>,
    #[reflect(ignore)]
    pub particle: u32,
    #[reflect(ignore)]
    pub surface: Arc<Surface>,
    /// Distance of each particle from the one that it holds, along the surface at rest (m).
    #[reflect(ignore)]
    pub lengths: Vec<f32>,
    /// Where the particle is in the hand's own frame.
    #[reflect(ignore)]
    pub offset: Vec3,
}
