//! The velocity of the air at a position and a time.

use bevy::{
    math::DVec3,
    prelude::{Resource, Time, Vec3},
};
use fastnoise_lite::{FastNoiseLite, NoiseType};

use crate::{
    cloth::QuantityError,
    plugin::{
        authoring::{ClothAir, ClothWind, DENSITY, PlacedZone},
        frame::Shift,
    },
    solver::forces::Air,
};

/// Far apart in the noise, so that its values along the three axes are independent.
const APART: [f64; 3] = [0.0, 1013.7, 2027.3];

/// The noise repeats after this length, as its cells are counted in 32 bits: with eddies of 1 m in 10 m/s after 20
/// months.
const NOISE: f64 = (1_u32 << 29) as f64;

/// Largest speed of air, gusts and eddies included (m/s).
const FASTEST: f32 = 1.0e6;

/// The world's wind in the tick, and its zones.
#[derive(Resource, Default)]
pub(crate) struct WindField {
    pub zones: Vec<PlacedZone>,
    /// The noise, and what it was made from.
    noise: Option<(i32, FastNoiseLite)>,
    /// Time for which it has blown (s), and the distance that it has travelled (m).
    seconds: f64,
    travelled: DVec3,
    /// The world's wind in the tick.
    world: Option<Result<World, QuantityError>>,
}

/// The world's wind in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
struct World {
    /// Velocity including gusts (m/s).
    velocity: Vec3,
    density: f32,
    /// Largest deviation from that velocity (m/s), and the size of its eddies (m).
    deviation: f32,
    length: f32,
}

/// The air of a cloth in the tick, without zones, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct EffectiveWind {
    pub air: Air,
    /// See [`World`].
    pub deviation: f32,
    /// Whether there is air where no zone is.
    pub is_everywhere: bool,
}

impl EffectiveWind {
    /// Whether it changes in each tick, wherever a cloth is.
    pub fn is_turbulent(&self) -> bool {
        self.deviation > 0.0
    }
}

impl WindField {
    /// Moves the world's wind on.
    pub fn advance(&mut self, wind: Option<&ClothWind>, time: &Time) {
        self.seconds += time.delta_secs_f64();
        self.world = wind.map(|wind| wind.validate().map(|()| self.blow(wind, time)));
    }

    /// Time for which it has blown (s), and the distance that it has travelled (m).
    pub fn memory(&self) -> (f64, DVec3) {
        (self.seconds, self.travelled)
    }

    /// Goes with the world's origin, as eddies do.
    pub fn shift(&mut self, Shift(by): Shift) {
        self.travelled += by.as_dvec3();
    }

    /// Continues from an earlier time, of a snapshot.
    pub fn recall(&mut self, (seconds, travelled): (f64, DVec3)) {
        (self.seconds, self.travelled) = (seconds, travelled);
    }

    fn blow(&mut self, wind: &ClothWind, time: &Time) -> World {
        let mut velocity = wind.velocity;
        if wind.gusts > 0.0 {
            let along = (self.seconds / f64::from(wind.gust_period)).rem_euclid(NOISE);
            let noise = self.noise(wind.seed);
            velocity *= 1.0 + wind.gusts * noise.get_noise_2d(along, APART[1]);
            velocity = velocity.clamp_length_max(FASTEST);
        }
        self.travelled += velocity.as_dvec3() * time.delta_secs_f64();
        let deviation = (wind.turbulence * velocity.length()).min(FASTEST);
        if deviation > 0.0 {
            self.noise(wind.seed);
        }
        World {
            velocity,
            density: wind.density,
            deviation,
            length: wind.turbulence_length,
        }
    }

    fn noise(&mut self, seed: i32) -> &FastNoiseLite {
        if self.noise.as_ref().is_none_or(|(known, _)| *known != seed) {
            let mut noise = FastNoiseLite::with_seed(seed);
            noise.set_noise_type(Some(NoiseType::OpenSimplex2));
            noise.set_frequency(Some(1.0));
            self.noise = Some((seed, noise));
        }
        let (_, noise) = self.noise.as_ref().expect("made above");
        noise
    }

    /// The air of a cloth; `None` where there is none, zones aside.
    ///
    /// # Errors
    /// The first value that is out of range, of the world's wind if it blows here, or of the cloth's own.
    pub fn of_cloth(&self, own: Option<&ClothAir>) -> Result<Option<EffectiveWind>, QuantityError> {
        if let Some(own) = own {
            own.validate()?;
        }
        let of_cloth = own.copied().unwrap_or_default();
        let world = self.world.clone().transpose()?;
        let (density, world) = match (world, of_cloth.velocity) {
            (None, None) if self.zones.is_empty() => return Ok(None),
            (None, _) => (DENSITY, None),
            (Some(world), _) => (world.density, Some(world)),
        };
        // The velocity of a `ClothAir` has neither gusts nor eddies.
        let (velocity, deviation) = match (of_cloth.velocity, world) {
            (Some(own), _) => (own, 0.0),
            (None, Some(world)) => (world.velocity, world.deviation),
            (None, None) => (Vec3::ZERO, 0.0),
        };
        Ok(Some(EffectiveWind {
            is_everywhere: world.is_some() || of_cloth.velocity.is_some(),
            air: Air {
                density,
                drag: of_cloth.drag,
                lift: of_cloth.lift,
                wind: velocity,
            },
            deviation,
        }))
    }

    /// The zones that may blow in a ball (m).
    pub fn near(&self, centre: Vec3, radius: f32) -> impl Iterator<Item = &PlacedZone> {
        let zones = self.zones.iter();
        zones.filter(move |zone| zone.reaches(centre, radius))
    }

    /// Deviation of the air from a cloth's wind at a position in the world (m/s).
    pub fn deviation(&self, wind: &EffectiveWind, place: Vec3) -> Vec3 {
        let (Some(Ok(world)), Some((_, noise))) = (&self.world, &self.noise) else {
            return Vec3::ZERO;
        };
        if wind.deviation == 0.0 {
            return Vec3::ZERO;
        }
        let at = (place.as_dvec3() - self.travelled) / f64::from(world.length);
        let at = at.rem_euclid(DVec3::splat(NOISE));
        let of = |apart: f64| noise.get_noise_3d(at.x + apart, at.y, at.z);
        wind.deviation * Vec3::from(APART.map(of))
    }
}
