//! The air of the world, and that of one cloth.

use bevy::prelude::{
    Component, Reflect, ReflectComponent, ReflectDefault, ReflectResource, Resource, Vec3,
};

use crate::cloth::{Allowed, QuantityError};

/// Of air at 20 °C and sea level (kg/m³).
pub(crate) const DENSITY: f32 = 1.2;

/// The wind of the world. The resource does not exist unless the game inserts it. Without it there is no air and no
/// cost, except for a [`ClothWindZone`](crate::plugin::ClothWindZone), or a [`ClothAir`] with a velocity of its own. A wind with zero velocity is
/// still air, in which drag limits the speed of falling cloth.
///
/// It may change in every tick: nothing is built again. Sleeping cloth wakes when it changes. Cloth does not sleep
/// while gusts or turbulence blow; in a steady wind it sleeps once it is at rest.
///
/// The velocity u at a position x follows from the time of the simulation's clock, the distance that the air has
/// travelled, and the seed. So the same run has the same wind:
///
/// ```text
///   U = velocity · (1 + gusts · n(t ⁄ gust_period))                       n: noise from −1 to 1
///   u(x) = U + |U| · turbulence · n₃((x − ∫ U dt) ⁄ turbulence_length)    it goes along with the wind (Taylor 1938)
/// ```
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct ClothWind {
    /// Velocity of the air (m/s), at most 10⁶ along each axis.
    pub velocity: Vec3,
    /// Density (kg/m³), from 0 to 10⁶. Air of zero density does nothing, and costs nothing.
    pub density: f32,
    /// Largest rise and fall of the speed in gusts, as a fraction of it, zero or more: 0.3 is a gusty day.
    pub gusts: f32,
    /// Approximate time from gust to gust (s), positive.
    pub gust_period: f32,
    /// Largest deviation of the air at each position, along each axis, as a fraction of the speed; zero or more: 0.2
    /// over a field, 0.5 among houses.
    pub turbulence: f32,
    /// Approximate size of its eddies (m), positive. A cloth does not resolve eddies smaller than an eighth of a grid,
    /// or a quarter of a mesh.
    pub turbulence_length: f32,
    /// Seed of the noise: another seed is another wind.
    pub seed: i32,
}

impl Default for ClothWind {
    /// Still air of 1.2 kg/m³. Gusts, if any, come every 4 s, and eddies are 1 m large.
    fn default() -> Self {
        Self {
            velocity: Vec3::ZERO,
            density: DENSITY,
            gusts: 0.0,
            gust_period: 4.0,
            turbulence: 0.0,
            turbulence_length: 1.0,
            seed: 0,
        }
    }
}

impl ClothWind {
    /// A steady wind (m/s), with defaults for everything else.
    pub fn new(velocity: Vec3) -> Self {
        Self {
            velocity,
            ..Self::default()
        }
    }

    /// A wind (m/s) with gusts and turbulence of a fifth each, as over open land.
    pub fn gusty(velocity: Vec3) -> Self {
        Self {
            gusts: 0.2,
            turbulence: 0.2,
            ..Self::new(velocity)
        }
    }

    /// Checks that each value is in its range.
    ///
    /// # Errors
    /// [`QuantityError`] for the first value that is not.
    pub fn validate(&self) -> Result<(), QuantityError> {
        check_velocity(self.velocity)?;
        MODERATE.check("density of the air (kg/m³)", [self.density])?;
        MODERATE.check("gusts", [self.gusts])?;
        MODERATE.check("turbulence", [self.turbulence])?;
        LARGE.check("period of gusts (s)", [self.gust_period])?;
        LARGE.check("length of turbulence (m)", [self.turbulence_length])
    }
}

/// How the air acts on one cloth. A cloth without it uses the defaults.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothAir {
    /// Drag coefficient `C_d` of cloth broadside to the wind, from 0 to 10⁶.
    pub drag: f32,
    /// `C_l`, the slope of the normal force coefficient over the sine of a small angle to the wind, from 0 to 10⁶.
    pub lift: f32,
    /// Velocity of the air (m/s) for this cloth alone, in place of [`ClothWind`]: inside a vehicle, the velocity of the
    /// vehicle. Zones are added to it, as they are to the world's wind.
    pub velocity: Option<Vec3>,
}

impl Default for ClothAir {
    /// The coefficients of a square plate: 1.2 broadside (S. F. Hoerner 1965, Fluid-Dynamic Drag, chapter 3: 1.17), and
    /// the slope of 1.48 of a wing as wide as it is long, `2 π Λ/(√(Λ² + 4) + 2)` with Λ = 1 (H. B. Helmbold 1942).
    fn default() -> Self {
        Self {
            drag: 1.2,
            lift: 1.5,
            velocity: None,
        }
    }
}

impl ClothAir {
    /// Checks that each value is in its range.
    ///
    /// # Errors
    /// [`QuantityError`] for the first value that is not.
    pub fn validate(&self) -> Result<(), QuantityError> {
        MODERATE.check("coefficient of drag", [self.drag])?;
        MODERATE.check("coefficient of lift", [self.lift])?;
        self.velocity.map_or(Ok(()), check_velocity)
    }
}

const MODERATE: Allowed = Allowed(|v| (0.0..=1.0e6).contains(&v), "from 0 to 10⁶");

/// Lengths and times that may be divided by.
pub(super) const LARGE: Allowed = Allowed(|v| (1.0e-6..=1.0e12).contains(&v), "from 10⁻⁶ to 10¹²");

pub(crate) fn check_velocity(velocity: Vec3) -> Result<(), QuantityError> {
    let moderate = Allowed(|v| v.abs() <= 1.0e6, "finite, and at most 10⁶");
    moderate.check("velocity of the air (m/s)", velocity.to_array())
}
