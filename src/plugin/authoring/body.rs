//! Colliders that cloth pushes back.

use bevy::prelude::{
    BVec3, Component, Mat3, Quat, Reflect, ReflectComponent, ReflectDefault, Vec3,
};

use crate::{
    cloth::{Allowed, QuantityError},
    contact::BodyMass,
};

/// Lets cloth push a [`ClothCollider`](crate::contact::ClothCollider) back, by giving it a mass. Without this
/// component, cloth never moves a collider. It moves no skinned mesh.
///
/// Move the body, by a physics engine or by your own systems, before [`ClothSystems::Prepare`](crate::plugin::ClothSystems).
/// During the sub-steps of the tick the body yields to the cloth according to its mass. Then the plugin writes the
/// body's new place into its `Transform`, unless it is a child of another entity. The change of its velocity is in
/// [`ClothPush`]: the code that moves the body has to add it. With the feature `rapier`, a `ClothPushBack` on a rapier
/// body does all of this.
///
/// Where cloth lies on another collider, the body stands on that through the cloth, two particle radii above it and a
/// little more, with the cloth's friction.
///
/// Where a body has come to rest on a cloth, the cloth falls asleep, and holds the body where it is
/// ([`ClothPush::is_held`]). A motion that is not gravity's wakes the cloth, if its force is more than a twentieth of the
/// body's weight. A body that several cloths push keeps them awake, and so does one that is a child of another entity.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(ClothPush)]
pub struct ClothBody {
    /// Mass (kg), positive.
    pub mass: f32,
    /// Moments of inertia about the principal axes through the centre of mass (kg·m²), positive. Infinite about an axis
    /// about which the body can't rotate.
    pub inertia: Vec3,
    /// Rotation of the principal axes in the entity's frame.
    pub axes: Quat,
    /// Position of the centre of mass in the entity's frame, unscaled (m).
    pub centre_of_mass: Vec3,
    /// World axes along which cloth does not move the centre of mass.
    pub locked_translation: BVec3,
    /// World axes about which cloth does not rotate the body.
    pub locked_rotation: BVec3,
}

/// How the cloths that touch a [`ClothBody`] changed its motion in the last tick, in the world.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothPush {
    /// Change of the velocity of its centre of mass (m/s).
    pub velocity: Vec3,
    /// Change of its angular velocity (rad/s).
    pub angular_velocity: Vec3,
    /// Whether a cloth that sleeps holds it where it is. The change of velocity is then minus the way that it went in the tick, by
    /// the tick's length. The code that moves it may put it to sleep, and wakes it when this is false again.
    pub is_held: bool,
}

impl Default for ClothBody {
    /// A solid ball of 1 kg with the radius of the default collider, 1 m.
    fn default() -> Self {
        Self::ball(1.0, 1.0)
    }
}

impl ClothBody {
    /// A body with a mass (kg) and moments of inertia about the entity's axes (kg·m²). Its centre of mass is at the
    /// entity's origin.
    pub const fn new(mass: f32, inertia: Vec3) -> Self {
        Self {
            mass,
            inertia,
            axes: Quat::IDENTITY,
            centre_of_mass: Vec3::ZERO,
            locked_translation: BVec3::FALSE,
            locked_rotation: BVec3::FALSE,
        }
    }

    /// A solid ball with a mass (kg) and a radius (m).
    pub const fn ball(mass: f32, radius: f32) -> Self {
        Self::new(mass, Vec3::splat(0.4 * mass * radius * radius))
    }

    /// The part of a motion of its centre of mass that is not locked.
    pub(crate) fn free_translation(&self, motion: Vec3) -> Vec3 {
        Vec3::select(self.locked_translation, Vec3::ZERO, motion)
    }

    /// The same for a rotation.
    pub(crate) fn free_rotation(&self, turn: Vec3) -> Vec3 {
        Vec3::select(self.locked_rotation, Vec3::ZERO, turn)
    }

    /// Its mass where the entity is turned by `rotation`, about the entity's origin.
    ///
    /// # Errors
    /// [`QuantityError`] for a value that is out of range.
    pub(crate) fn mass_at(&self, rotation: Quat) -> Result<BodyMass, QuantityError> {
        let positive = Allowed(|v| v > 0.0 && v.recip().is_finite(), "positive");
        let is_usable = |v: f32| v > 0.0 && v.is_finite() && v.recip().is_finite();
        let usable = Allowed(is_usable, "positive and finite");
        positive.check("the body's inertia (kg·m²)", self.inertia.to_array())?;
        let quantity = "the distance of the body's centre of mass from its entity (m)";
        Allowed::FINITE.check(quantity, [self.centre_of_mass.length()])?;
        let quantity = "the length of the quaternion of the body's axes";
        usable.check(quantity, [self.axes.length()])?;
        usable.check("the body's mass (kg)", [self.mass])?;
        let body = BodyMass {
            inverse_mass: self.mass.recip(),
            inverse_inertia: Mat3::from_diagonal(self.inertia.recip()),
            centre: Vec3::ZERO,
            free: Mat3::IDENTITY,
            is_settled: false,
        };
        let turned = body.turned(rotation * self.axes.normalize());
        let turns = Mat3::from_diagonal(self.free_rotation(Vec3::ONE));
        Ok(BodyMass {
            inverse_inertia: turns * turned.inverse_inertia * turns,
            centre: rotation * self.centre_of_mass,
            free: Mat3::from_diagonal(self.free_translation(Vec3::ONE)),
            ..turned
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Axes of no length, or of no number, can't be made those of a rotation.
    #[test]
    fn axes_are_checked() {
        for length in [0.0, 1.0e-30, f32::NAN, f32::INFINITY] {
            let body = ClothBody {
                axes: Quat::from_xyzw(0.0, length, 0.0, 0.0),
                ..ClothBody::ball(1.0, 0.1)
            };
            let outcome = body.mass_at(Quat::IDENTITY);
            assert!(
                matches!(outcome, Err(QuantityError { quantity, .. }) if quantity.contains("axes")),
                "{length}: {outcome:?}"
            );
        }
        let long = ClothBody {
            axes: Quat::from_xyzw(0.0, 3.0, 0.0, 0.0),
            ..ClothBody::ball(1.0, 0.1)
        };
        assert!(long.mass_at(Quat::IDENTITY).is_ok());
    }

    /// Locked are the world's axes, however the body is turned.
    #[test]
    fn locks_are_the_worlds() {
        let body = ClothBody {
            locked_rotation: BVec3::new(true, false, false),
            locked_translation: BVec3::new(false, true, false),
            ..ClothBody::new(2.0, Vec3::new(1.0, 2.0, 3.0))
        };
        let mass = body
            .mass_at(Quat::from_rotation_y(0.7))
            .expect("a valid body");
        for moment in [Vec3::X, Vec3::Y, Vec3::Z] {
            assert_eq!((mass.inverse_inertia * moment).x, 0.0);
        }
        assert_eq!(mass.inverse_inertia * Vec3::X, Vec3::ZERO);
        assert!((mass.inverse_inertia * Vec3::Y).distance(Vec3::Y / 2.0) < 1.0e-6);
        assert_eq!(mass.free * Vec3::ONE, Vec3::new(1.0, 0.0, 1.0));
    }
}
