//! Cloths that are to stand still.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

/// On a cloth for which no time passes: it is drawn as it was, touches nothing, and costs nothing but its place in queries. A cloth
/// that was just spawned is built first.
///
/// The mesh of one that is paused goes with its entity's transform. Taken away, the cloth goes on with the shape and the
/// velocities that it had, as seen from its entity, or from its first attachment's target where it has one: as after a
/// [`ClothTeleport`](super::ClothTeleport). Changes of its other components count from then on.
///
/// To *hide* a cloth, use Bevy's `Visibility`: it moves on, and only its mesh is not written. An entity with Bevy's `Disabled` is neither
/// simulated nor drawn. To have no cloth any more, remove [`Cloth`](crate::cloth::Cloth): the entity is drawn as before it was one.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// /// Cloths beyond 50 m stand still.
/// fn pause_far_cloths(
///     camera: Single<&GlobalTransform, With<Camera>>,
///     cloths: Query<(Entity, &GlobalTransform, Has<ClothPaused>), With<Cloth>>,
///     mut commands: Commands,
/// ) {
///     for (cloth, place, is_paused) in &cloths {
///         let is_far = place.translation().distance(camera.translation()) > 50.0;
///         if is_far && !is_paused {
///             commands.entity(cloth).insert(ClothPaused);
///         } else if !is_far && is_paused {
///             commands.entity(cloth).remove::<ClothPaused>();
///         }
///     }
/// }
/// ```
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothPaused;
