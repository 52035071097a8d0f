//! The forces of a game on a cloth in a tick.

use bevy::{
    ecs::{entity::MapEntities, query::QueryData},
    prelude::{Entity, Vec3},
};

use super::wind_field::{EffectiveWind, WindField};
use crate::{
    cloth::{ClothError, ClothParticles, Surface},
    plugin::{
        authoring::{ClothAir, PlacedZone},
        frame::{ClothFrame, Shift},
    },
    solver::forces::{Air, ClothPressure, ForceInputs, ForceMemory, Forces},
};

/// The components of a cloth that say which forces act on it.
#[derive(QueryData)]
pub(crate) struct ForceQuery {
    air: Option<&'static ClothAir>,
    pressure: Option<&'static ClothPressure>,
}

/// The forces on a cloth in a tick, in the world. A cloth at rest wakes when they change.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct GameForces {
    /// Zones aside.
    wind: Option<EffectiveWind>,
    pressure: Option<ClothPressure>,
}

impl GameForces {
    /// Those of these components.
    ///
    /// # Errors
    /// The first value of the wind or the air that is out of range.
    pub fn of(game: &ForceQueryItem, field: &WindField) -> Result<Self, ClothError> {
        Ok(Self {
            wind: field.of_cloth(game.air)?,
            pressure: game.pressure.copied(),
        })
    }

    /// Those that act on a surface. A closed one that is torn open has burst.
    ///
    /// # Errors
    /// The first value that is out of range, or that the surface cannot have.
    pub fn on(mut self, surface: &Surface) -> Result<Self, ClothError> {
        let is_whole = surface.is_closed() || !surface.was_closed();
        self.pressure = self.pressure.filter(|_| is_whole);
        if let Some(pressure) = self.pressure {
            pressure.validate(surface)?;
        }
        Ok(self)
    }
}

/// The forces by which a cloth was last moved, in the world.
#[derive(MapEntities, Debug, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ForceState {
    /// Without a wind that it does not meet.
    known: GameForces,
    #[entities]
    zones: Vec<PlacedZone>,
    /// The solver's memory of the last tick.
    pub memory: ForceMemory,
}

impl ForceState {
    /// Whether a cloth with these forces meets the same ones as before, and whether they are steady. `ball` is a
    /// ball around the cloth: centre and radius (m).
    pub fn is_still(
        &self,
        mut forces: GameForces,
        field: &WindField,
        ball: impl FnOnce() -> (Vec3, f32),
    ) -> bool {
        let Some(wind) = forces.wind else {
            return self.known == forces;
        };
        let mut zones = self.zones.iter();
        let is_same = if field.zones.is_empty() {
            zones.next().is_none()
        } else {
            let (centre, radius) = ball();
            zones.eq(field.near(centre, radius))
        };
        let feels = wind.is_everywhere || !self.zones.is_empty();
        forces.wind = feels.then_some(wind);
        is_same && self.known == forces && !(feels && wind.is_turbulent())
    }

    /// Takes over the forces that a cloth meets in `ball`.
    pub fn renew(
        &mut self,
        forces: GameForces,
        field: &WindField,
        ball: impl FnOnce() -> (Vec3, f32),
    ) {
        self.known = forces;
        self.zones.clear();
        if forces.wind.is_some() && !field.zones.is_empty() {
            let (centre, radius) = ball();
            self.zones.extend(field.near(centre, radius));
        }
        let is_felt = |wind: &EffectiveWind| wind.is_everywhere || !self.zones.is_empty();
        self.known.wind = forces.wind.filter(is_felt);
    }

    /// Shifts them with the world's origin; `placed` gives the current place of a zone.
    pub fn shift(&mut self, shift: Shift, placed: impl Fn(Entity) -> Option<PlacedZone>) {
        for zone in &mut self.zones {
            *zone = zone.shifted(shift, placed(zone.entity));
        }
    }

    /// Sets these forces in the solver of a cloth.
    pub fn set(
        &mut self,
        forces: &mut Forces,
        surface: &Surface,
        particles: &ClothParticles,
        frame: &ClothFrame,
        field: &WindField,
    ) {
        let to_cloth = frame.isometry().rotation.inverse();
        // Air without density does nothing.
        let wind = self.known.wind.filter(|wind| wind.air.density > 0.0);
        let inputs = ForceInputs {
            air: wind.map(|EffectiveWind { air, .. }| Air {
                wind: to_cloth * air.wind,
                ..air
            }),
            pressure: self.known.pressure,
        };
        forces.memory = self.memory;
        forces.set(surface, inputs);
        self.memory = forces.memory;
        if let Some(wind) = wind
            && (wind.is_turbulent() || !self.zones.is_empty())
        {
            forces.set_local_wind(particles, |place| {
                let place = frame.to_world(place);
                let zones = self.zones.iter().map(|zone| zone.at(place));
                to_cloth * (wind.air.wind + field.deviation(&wind, place) + zones.sum::<Vec3>())
            });
        }
    }

    /// Largest acceleration (m/s²) that they may give a cloth whose lightest part has this areal density (kg/m²), at this
    /// largest `speed` (m/s). Within one tick of `seconds`, wind does not accelerate it beyond the wind's speed.
    pub fn acceleration(&self, areal_density: f32, speed: f32, seconds: f32) -> f32 {
        let pressure = self.known.pressure;
        let others = pressure.map_or(0.0, |of| of.acceleration(areal_density, seconds));
        let Some(EffectiveWind { air, deviation, .. }) = self.known.wind else {
            return others;
        };
        let zones = self.zones.iter().map(PlacedZone::fastest);
        let fastest = air.wind.length() + 2.0 * deviation + zones.sum::<f32>();
        let relative = fastest + speed;
        let force = 0.5 * air.density * (air.drag + air.lift) * relative * relative;
        let most = relative / seconds.max(f32::MIN_POSITIVE);
        others + (force / areal_density).min(most)
    }
}
