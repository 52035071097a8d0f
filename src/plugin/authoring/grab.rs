//! Hands that hold cloth.

use bevy::{
    ecs::{
        component::Component,
        entity::{Entity, MapEntities},
        reflect::{ReflectComponent, ReflectMapEntities},
    },
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::components::Transform,
};

use crate::cloth::ClothError;

/// A hand that holds a cloth. Spawn it where a ray [hits](crate::plugin::ClothHit::grab) the cloth, move its
/// [`target`](Self::target), and despawn it to let go.
///
/// The plugin writes the entity's `Transform`, so it may have no parent. It follows the target, no faster than its speed, and pulls the cloth no
/// farther from its pins than the cloth reaches. The particle that it holds follows the entity, with the offset from the
/// target that it had at first. A particle that is pinned already stays where it is.
///
/// The particle is among the cloth's [`ClothAttachments`](crate::plugin::ClothAttachments) until the hand lets go. The
/// plugin lets go, by removing the component, when the cloth teleports, gets another surface, or is no cloth any more.
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
    /// How far the cloth is stretched between the hand and its pins at most, as a fraction of its length.
    pub stretch: f32,
    /// Largest speed of the hand (m/s).
    pub speed: f32,
}

impl Default for ClothGrab {
    /// Particle 0 of no cloth, a stretch of 2 %, 10 m/s.
    fn default() -> Self {
        Self {
            cloth: Entity::PLACEHOLDER,
            particle: 0,
            target: Vec3::ZERO,
            stretch: 0.02,
            speed: 10.0,
        }
    }
}

impl ClothGrab {
    /// Checks its numbers.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for a value that is out of range.
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        let is_size = |v: f32| v >= 0.0 && v.is_finite();
        for (value, quantity) in [
            (self.stretch, "the stretch of a grab"),
            (self.speed, "the speed of a grab (m/s)"),
        ] {
            ClothError::check(value, is_size, quantity, "finite and 0 or more")?;
        }
        for component in self.target.to_array() {
            let quantity = "the target of a grab (m)";
            ClothError::check(component, f32::is_finite, quantity, "finite")?;
        }
        Ok(())
    }
}

/// What a hand knows from the tick on in which it took hold.
#[derive(Component, Reflect, Debug, Default)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct ClothGrip {
    /// The cloth, once it holds it.
    #[reflect(ignore)]
    pub cloth: Option<Entity>,
    /// Whether the particle was free.
    #[reflect(ignore)]
    pub is_holding: bool,
    /// Distance of each particle of the cloth from the one that it holds, along the surface at rest (m).
    #[reflect(ignore)]
    pub lengths: Vec<f32>,
    /// From the hand to the particle (m).
    #[reflect(ignore)]
    pub offset: Vec3,
}
