//! Local winds.

use bevy::{
    ecs::entity::MapEntities,
    math::Affine3A,
    prelude::{Component, Entity, Quat, Reflect, ReflectComponent, ReflectDefault, Vec3},
};

use super::wind::{LARGE, check_velocity};
use crate::{
    cloth::{Allowed, ClothError, QuantityError},
    plugin::frame::{Places, Shift, unusable},
};

/// A local wind, such as that of a fan, added to the wind of the world. Its entity's `GlobalTransform` moves, scales
/// and rotates it. It may move freely, in systems before `ClothSystems::Prepare`. Inside it there is air even if the
/// world has none.
///
/// It blows at full strength in the middle and falls off smoothly towards the border, over the fraction `softness` of
/// its size.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothWindZone {
    /// The shape in which it blows.
    pub shape: ClothWindShape,
    /// Velocity of the air (m/s), rotated with the entity and not scaled; at most 10⁶ along each axis.
    pub velocity: Vec3,
    /// Fraction of its size over which it falls off towards the border, from 0 to 1.
    pub softness: f32,
}

/// A shape around an entity's origin, in the entity's frame: the entity's scale applies to its lengths.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothWindShape {
    /// A ball.
    Ball {
        /// Radius (m), positive.
        radius: f32,
    },
    /// A box.
    Cuboid {
        /// Half of its side lengths (m), positive.
        half_size: Vec3,
    },
    /// The jet of a fan: a cone from the origin along −z, which is `forward` of a `Transform`.
    Cone {
        /// Length (m), positive. The wind falls off along all of it.
        length: f32,
        /// Angle from its axis to its side (rad), positive and less than a right angle.
        angle: f32,
    },
}

impl Default for ClothWindShape {
    /// A ball of 1 m.
    fn default() -> Self {
        Self::Ball { radius: 1.0 }
    }
}

impl Default for ClothWindZone {
    /// A ball of 1 m with a wind of 5 m/s forward, which falls off over half of it.
    fn default() -> Self {
        Self {
            shape: ClothWindShape::default(),
            velocity: Vec3::NEG_Z * 5.0,
            softness: 0.5,
        }
    }
}

impl ClothWindZone {
    /// A wind in a ball with this radius (m), with this velocity (m/s).
    pub fn ball(radius: f32, velocity: Vec3) -> Self {
        Self::of(ClothWindShape::Ball { radius }, velocity)
    }

    /// A wind in a box with these half side lengths (m), with this velocity (m/s).
    pub fn cuboid(half_size: Vec3, velocity: Vec3) -> Self {
        Self::of(ClothWindShape::Cuboid { half_size }, velocity)
    }

    /// A fan that blows forward, along −z: with `speed` (m/s) at the fan, falling to zero at this `length` (m) and at
    /// this `angle` (rad) from its axis.
    pub fn fan(length: f32, angle: f32, speed: f32) -> Self {
        Self::of(ClothWindShape::Cone { length, angle }, Vec3::NEG_Z * speed)
    }

    fn of(shape: ClothWindShape, velocity: Vec3) -> Self {
        Self {
            shape,
            velocity,
            ..Self::default()
        }
    }

    /// Checks that each value is in its range.
    ///
    /// # Errors
    /// [`QuantityError`] for the first value that is not.
    pub fn validate(&self) -> Result<(), QuantityError> {
        check_velocity(self.velocity)?;
        Allowed::SHARE.check("softness of a wind zone", [self.softness])?;
        let lengths = match self.shape {
            ClothWindShape::Ball { radius } => Vec3::splat(radius),
            ClothWindShape::Cuboid { half_size } => half_size,
            ClothWindShape::Cone { length, angle } => {
                let is_acute = |a: f32| a > 0.0 && a < std::f32::consts::FRAC_PI_2;
                let acute = Allowed(is_acute, "positive, and less than π/2");
                acute.check("angle of a wind zone (rad)", [angle])?;
                Vec3::splat(length)
            }
        };
        LARGE.check("size of a wind zone (m)", lengths.to_array())
    }
}

impl ClothWindShape {
    /// Relative distance of a position from the middle: 1 at the border, more outside.
    fn depth(&self, place: Vec3) -> f32 {
        match *self {
            Self::Ball { radius } => place.length() / radius,
            Self::Cuboid { half_size } => (place / half_size).abs().max_element(),
            Self::Cone { length, angle } => {
                let along = -place.z;
                let beside = place.truncate().length();
                if along <= 0.0 {
                    return f32::INFINITY;
                }
                (along / length).max(beside / (along * angle.tan()))
            }
        }
    }

    /// A ball around it: its centre and its radius.
    fn around(&self) -> (Vec3, f32) {
        match *self {
            Self::Ball { radius } => (Vec3::ZERO, radius),
            Self::Cuboid { half_size } => (Vec3::ZERO, half_size.length()),
            Self::Cone { length, angle } => {
                (Vec3::NEG_Z * length, length.max(length * angle.tan()))
            }
        }
    }
}

/// A zone at its place in the tick.
#[derive(MapEntities, Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PlacedZone {
    #[entities]
    pub entity: Entity,
    zone: ClothWindZone,
    from_world: Affine3A,
    /// In the world (m/s).
    velocity: Vec3,
    centre: Vec3,
    radius: f32,
}

impl PlacedZone {
    /// Reads the place of a zone.
    ///
    /// # Errors
    /// The error of the zone, or of its transform.
    pub fn new(entity: Entity, zone: &ClothWindZone, places: &Places) -> Result<Self, ClothError> {
        zone.validate()?;
        let place = places.of(entity)?;
        let affine = place.affine();
        let from_world = affine.inverse();
        let (scale, rotation, _) = affine.to_scale_rotation_translation();
        let rotation: Quat = rotation.normalize();
        if !(affine.is_finite() && from_world.is_finite() && rotation.is_finite()) {
            return Err(unusable(affine));
        }
        let (centre, radius) = zone.shape.around();
        Ok(Self {
            entity,
            zone: *zone,
            from_world,
            velocity: rotation * zone.velocity,
            centre: affine.transform_point3(centre),
            radius: radius * scale.abs().max_element(),
        })
    }

    /// The zone after a jump of the world's origin. If that differs from `now` by no more than rounding, it is `now`.
    pub fn shifted(self, shift: Shift, now: Option<Self>) -> Self {
        let place = self.from_world.inverse();
        let moved = shift.affine(place, now.map(|now| now.from_world.inverse()));
        match now {
            Some(now) if now.from_world.inverse() == moved => now,
            _ => Self {
                from_world: moved.inverse(),
                centre: self.centre + shift.0,
                ..self
            },
        }
    }

    /// Whether it may blow in a ball (m).
    pub fn reaches(&self, centre: Vec3, radius: f32) -> bool {
        let reach = self.radius + radius;
        self.centre.distance_squared(centre) <= reach * reach
    }

    /// Its velocity at a position in the world (m/s): the full velocity, less `3 s² − 2 s³` of it, with s the fraction
    /// of the soft border.
    pub fn at(&self, place: Vec3) -> Vec3 {
        let place = self.from_world.transform_point3(place);
        let depth = self.zone.shape.depth(place);
        // A fan's wind falls off all along its way.
        let inner = match self.zone.shape {
            ClothWindShape::Cone { .. } => 0.0,
            _ => 1.0 - self.zone.softness,
        };
        if depth <= inner {
            return self.velocity;
        }
        if depth >= 1.0 {
            return Vec3::ZERO;
        }
        let s = (depth - inner) / (1.0 - inner);
        self.velocity * (1.0 - s * s * (3.0 - 2.0 * s))
    }

    /// Its speed in the middle (m/s).
    pub fn fastest(&self) -> f32 {
        self.velocity.length()
    }
}
