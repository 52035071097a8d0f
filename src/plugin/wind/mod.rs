//! The air of the world, and that of one cloth.

mod field;
mod prepare;
mod zone;

use bevy::{
    ecs::{
        component::Component,
        reflect::{ReflectComponent, ReflectResource},
        resource::Resource,
    },
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

pub(super) use field::{Breeze, WindField};
pub(super) use prepare::prepare_wind;
pub(super) use zone::PlacedZone;
pub use zone::{ClothWindShape, ClothWindZone};

use crate::cloth::ClothError;

/// Of air at 20 °C and sea level (kg/m³).
const DENSITY: f32 = 1.2;

/// The air of the world. Not there unless a game inserts it: without it, a [`ClothWindZone`] and a [`ClothAir`] with a velocity of
/// its own there is no air, and it costs nothing. One of no velocity is still air, in which cloth falls no faster than its weight and
/// its drag let it.
///
/// May change in every tick: nothing is built again. Cloth that sleeps wakes when it changes, and does not sleep while gusts or
/// turbulence blow; in a steady wind it sleeps once it is at rest.
///
/// What it is at a place follows from the time of the simulation's clock, from the way that the air has come and from the seed, so
/// that the same run is the same wind:
///
/// ```text
///   U = velocity · (1 + gusts · n(t ⁄ gust_period))                       n: noise from −1 to 1
///   u(x) = U + |U| · turbulence · n₃((x − ∫ U dt) ⁄ turbulence_length)    it goes along with the wind (Taylor 1938)
/// ```
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct ClothWind {
    /// Where the air goes (m/s), at most 10⁶ along each axis.
    pub velocity: Vec3,
    /// Density (kg/m³), from 0 to 10⁶. Air of none does nothing, and costs nothing.
    pub density: f32,
    /// By what part of itself the speed rises and falls at most, zero or more: 0.3 is a gusty day.
    pub gusts: f32,
    /// From gust to gust, about (s), positive.
    pub gust_period: f32,
    /// By what part of the speed the air strays from it at each place, along each axis, at most; zero or more: 0.2 over a field, 0.5
    /// among houses.
    pub turbulence: f32,
    /// How large its eddies are, about (m), positive. Those smaller than an eighth of a grid, or a quarter of a mesh, are not felt as what
    /// they are.
    pub turbulence_length: f32,
    /// Another one is another wind.
    pub seed: i32,
}

impl Default for ClothWind {
    /// Still air of 1.2 kg/m³; gusts, if any, each 4 s, and eddies of 1 m.
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
    /// A steady wind (m/s), all else by default.
    pub fn new(velocity: Vec3) -> Self {
        Self {
            velocity,
            ..Self::default()
        }
    }

    /// A wind (m/s) with gusts and turbulence as over open land: both by a fifth.
    pub fn gusty(velocity: Vec3) -> Self {
        Self {
            gusts: 0.2,
            turbulence: 0.2,
            ..Self::new(velocity)
        }
    }

    /// Whether each value is in its range.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        check_velocity(self.velocity)?;
        let density = "density of the air (kg/m³)";
        ClothError::check(self.density, is_moderate, density, "from 0 to 10⁶")?;
        for (part, quantity) in [(self.gusts, "gusts"), (self.turbulence, "turbulence")] {
            ClothError::check(part, is_moderate, quantity, "from 0 to 10⁶")?;
        }
        for (value, quantity) in [
            (self.gust_period, "period of gusts (s)"),
            (self.turbulence_length, "length of turbulence (m)"),
        ] {
            let is_some = |v: f32| (1.0e-6..=1.0e12).contains(&v);
            ClothError::check(value, is_some, quantity, "from 10⁻⁶ to 10¹²")?;
        }
        Ok(())
    }
}

/// How the air acts on one cloth. Without it the defaults count.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothAir {
    /// `C_d`, the coefficient of drag of cloth that the wind meets broadside, from 0 to 10⁶.
    pub drag: f32,
    /// `C_l`, the slope of the coefficient of the normal force over the sine of a small angle to the wind, from 0 to 10⁶.
    pub lift: f32,
    /// A velocity of the air (m/s) for this cloth alone, in place of [`ClothWind`]: inside of a vehicle, that of the vehicle. Zones
    /// come on top, as to the world's.
    pub velocity: Option<Vec3>,
}

impl Default for ClothAir {
    /// Those of a square plate: 1.2 broadside (S. F. Hoerner 1965, Fluid-Dynamic Drag, chapter 3: 1.17), and the slope of 1.48 of a
    /// wing as wide as it is long, `2 π Λ/(√(Λ² + 4) + 2)` with Λ = 1 (H. B. Helmbold 1942).
    fn default() -> Self {
        Self {
            drag: 1.2,
            lift: 1.5,
            velocity: None,
        }
    }
}

impl ClothAir {
    /// Whether each value is in its range.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        let range = "from 0 to 10⁶";
        ClothError::check(self.drag, is_moderate, "coefficient of drag", range)?;
        ClothError::check(self.lift, is_moderate, "coefficient of lift", range)?;
        self.velocity.map_or(Ok(()), check_velocity)
    }
}

fn is_moderate(value: f32) -> bool {
    (0.0..=1.0e6).contains(&value)
}

fn check_velocity(velocity: Vec3) -> Result<(), ClothError> {
    for value in velocity.to_array() {
        let is_moderate = |v: f32| v.abs() <= 1.0e6;
        ClothError::check(
            value,
            is_moderate,
            "velocity of the air (m/s)",
            "finite, and at most 10⁶",
        )?;
    }
    Ok(())
}
