//! Colliders that cloth pushes back.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::{Mat3, Quat, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::{cloth::ClothError, contact::BodyMass};

/// Has cloth push a [`ClothCollider`](crate::contact::ClothCollider) back: how heavy it is. Without this, nothing that cloth
/// does moves a collider.
///
/// Whatever moves the body, a physics engine or the game itself, does so before
/// [`ClothSystems::Prepare`](super::ClothSystems). In the tick's sub-steps the body gives way to the cloth by its mass, and it
/// is then taken from where it was sent to where the cloth has left it: that is written into its `Transform`, if it is no
/// child of another entity. What became of its velocity is in [`ClothPush`], to be added by whoever moves it. With feature
/// `rapier` a `ClothPushBack` on a rapier body does all of this.
///
/// A cloth that pushes a body does not sleep.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[require(ClothPush)]
pub struct ClothBody {
    /// Mass (kg), positive.
    pub mass: f32,
    /// Moments of inertia about the principal axes through the centre of mass (kg·m²), positive; infinite for one that can't be
    /// turned.
    pub inertia: Vec3,
    /// How the principal axes are turned against the entity's.
    pub axes: Quat,
    /// Where the centre of mass is, seen from the entity, unscaled (m).
    pub centre_of_mass: Vec3,
}

/// What the cloths that touch a [`ClothBody`] changed of its motion in the last tick, in the world.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothPush {
    /// Of the velocity of its centre of mass (m/s).
    pub velocity: Vec3,
    /// Of its angular velocity (rad/s).
    pub angular_velocity: Vec3,
}

impl ClothBody {
    /// A body of a mass (kg) and of moments of inertia about the entity's axes (kg·m²), which meet in its centre of mass.
    pub const fn new(mass: f32, inertia: Vec3) -> Self {
        Self {
            mass,
            inertia,
            axes: Quat::IDENTITY,
            centre_of_mass: Vec3::ZERO,
        }
    }

    /// A solid ball of a mass (kg) and a radius (m).
    pub const fn ball(mass: f32, radius: f32) -> Self {
        Self::new(mass, Vec3::splat(0.4 * mass * radius * radius))
    }

    /// Its mass where the entity is turned by `rotation`.
    pub(super) fn mass_at(&self, rotation: Quat) -> Result<BodyMass, ClothError> {
        let positive = |v: f32| v > 0.0 && v.recip().is_finite();
        for moment in self.inertia.to_array() {
            ClothError::check(moment, positive, "the body's inertia (kg·m²)", "positive")?;
        }
        for value in [self.centre_of_mass.length(), self.axes.length()] {
            let quantity = "the body's centre of mass (m) or the turn of its axes";
            ClothError::check(value, f32::is_finite, quantity, "finite")?;
        }
        let mass = ClothError::check(
            self.mass,
            |v| v > 0.0 && v.is_finite() && v.recip().is_finite(),
            "the body's mass (kg)",
            "positive and finite",
        )?;
        let inverse = Mat3::from_diagonal(self.inertia.recip());
        let body = BodyMass {
            inverse_mass: mass.recip(),
            inverse_inertia: inverse,
            centre: Vec3::ZERO,
        };
        Ok(BodyMass {
            centre: rotation * self.centre_of_mass,
            ..body.turned(rotation * self.axes.normalize())
        })
    }
}
