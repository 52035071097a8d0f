//! How much of a character's motion its cloth feels.

use bevy::prelude::{Component, Isometry3d, Reflect, ReflectComponent, ReflectDefault};

use crate::{
    cloth::{Allowed, ClothError, QuantityError},
    plugin::frame::{ClothFrame, Shift, relative},
};

/// How strongly cloths below an entity in the hierarchy, or attached below it, feel its motion. Add it to a character,
/// so that a cape does not fly off a sprinting hero. Without it, cloths feel all of the motion.
///
/// The rest of the motion carries the cloths along as if they were one rigid body with the entity, without giving them
/// speed. With a share of 0.3, cloth behaves as on a wearer who accelerates at 0.3 of the rate. Colliders are met where
/// they are, at their speed relative to the carried cloth. The component applies to all cloths at and below the entity,
/// and to cloths whose first attachment's target is at or below it. If several apply, the nearest one counts.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn setup(mut commands: Commands) {
///     commands.spawn((Transform::default(), ClothInertia { linear: 0.3, angular: 0.5, ..default() }));
/// }
/// ```
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(RootMotion)]
pub struct ClothInertia {
    /// Share of its translation that cloth feels, from 0 to 1.
    pub linear: f32,
    /// Share of its rotation that cloth feels, from 0 to 1.
    pub angular: f32,
    /// A move of more than this in one tick (m) is a [`ClothTeleport`](crate::plugin::ClothTeleport) instead of a motion. Positive; infinity for
    /// never.
    pub teleport_distance: f32,
    /// A rotation of more than this in one tick (rad) is a [`ClothTeleport`](crate::plugin::ClothTeleport) too. Positive; π for never, as no rotation
    /// is larger.
    pub teleport_angle: f32,
}

impl Default for ClothInertia {
    /// Cloth feels all motion. A move of more than 2 m in a tick is a teleport; no rotation is.
    fn default() -> Self {
        Self {
            linear: 1.0,
            angular: 1.0,
            teleport_distance: 2.0,
            teleport_angle: std::f32::consts::PI,
        }
    }
}

impl ClothInertia {
    /// Cloth feels this share of translation and rotation, from 0 to 1.
    pub fn share(share: f32) -> Self {
        Self {
            linear: share,
            angular: share,
            ..Self::default()
        }
    }

    /// Checks that each value is in its range.
    ///
    /// # Errors
    /// [`QuantityError`] for the first value that is not.
    pub fn validate(&self) -> Result<(), QuantityError> {
        let quantity = "the share of motion that is felt";
        Allowed::SHARE.check(quantity, [self.linear, self.angular])?;
        let positive = Allowed(|v| v > 0.0, "positive");
        positive.check("the teleport distance (m)", [self.teleport_distance])?;
        positive.check("the teleport angle (rad)", [self.teleport_angle])
    }
}

/// How an entity with a [`ClothInertia`] has moved.
#[derive(Component, Debug, Default)]
pub(crate) struct RootMotion {
    /// Where it was as the last tick ended.
    pub last: Option<Isometry3d>,
    /// The motion that carries cloths in this tick, if there is one; `error` says why there is none.
    pub carried: Option<Carried>,
    pub error: Option<ClothError>,
}

impl RootMotion {
    /// Shifts it with the world's origin; its entity is at `now`.
    pub fn shift(&mut self, shift: Shift, now: Option<Isometry3d>) {
        self.last = self.last.map(|last| shift.rigid(last, now));
    }
}

/// The motion that carries a cloth along as a tick begins: that of a rigid body from one place in the world to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Carried {
    pub from: Isometry3d,
    pub to: Isometry3d,
}

impl Carried {
    /// Carries a place along as the tick begins. The result is as seen from a frame.
    pub fn seen_from(&self, frame: &ClothFrame, place: Isometry3d) -> Isometry3d {
        relative(frame.isometry(), self.to) * relative(self.from, place)
    }

    /// The transform that undoes this motion in a frame.
    #[cfg(feature = "mesh")]
    pub fn undone_in(&self, frame: &ClothFrame) -> Isometry3d {
        relative(frame.isometry(), self.from) * relative(self.to, frame.isometry())
    }
}
