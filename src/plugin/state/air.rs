//! The air of a cloth in a tick.

use bevy::{
    ecs::entity::{Entity, EntityMapper, MapEntities},
    math::Vec3,
};

use super::wind_field::{EffectiveWind, WindField};
use crate::{
    cloth::{ClothParticles, Surface},
    plugin::{
        authoring::PlacedZone,
        frame::{ClothFrame, Shift},
    },
    solver::{Air, AirMemory, ClothPressure, FILLING, Solver},
};

/// The air in which a cloth was last moved, in the world.
#[derive(Debug, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct AirState {
    wind: Option<EffectiveWind>,
    pressure: Option<ClothPressure>,
    zones: Vec<PlacedZone>,
    /// The solver's memory of the last tick.
    pub memory: AirMemory,
}

impl MapEntities for AirState {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for zone in &mut self.zones {
            zone.entity = mapper.get_mapped(zone.entity);
        }
    }
}

impl AirState {
    /// Whether a cloth with this pressure meets the same air as before, and whether that air is steady. `ball` is a
    /// ball around the cloth: centre and radius (m).
    pub fn is_still(
        &self,
        wind: Option<&EffectiveWind>,
        pressure: Option<&ClothPressure>,
        field: &WindField,
        ball: impl FnOnce() -> (Vec3, f32),
    ) -> bool {
        if self.pressure.as_ref() != pressure {
            return false;
        }
        let Some(wind) = wind else {
            return self.wind.is_none();
        };
        let mut zones = self.zones.iter();
        let is_same = if field.zones.is_empty() {
            zones.next().is_none()
        } else {
            let (centre, radius) = ball();
            zones.eq(field.near(centre, radius))
        };
        let feels = wind.is_everywhere || !self.zones.is_empty();
        let known = feels.then_some(wind);
        is_same && self.wind.as_ref() == known && !(feels && wind.is_turbulent())
    }

    /// Takes over the air that a cloth meets in `ball`.
    pub fn renew(
        &mut self,
        wind: Option<EffectiveWind>,
        pressure: Option<ClothPressure>,
        field: &WindField,
        ball: impl FnOnce() -> (Vec3, f32),
    ) {
        self.zones.clear();
        if wind.is_some() && !field.zones.is_empty() {
            let (centre, radius) = ball();
            self.zones.extend(field.near(centre, radius));
        }
        self.wind = wind.filter(|wind| wind.is_everywhere || !self.zones.is_empty());
        self.pressure = pressure;
    }

    /// Shifts it with the world's origin; `placed` gives the current place of a zone.
    pub fn shift(&mut self, shift: Shift, placed: impl Fn(Entity) -> Option<PlacedZone>) {
        for zone in &mut self.zones {
            *zone = zone.shifted(shift, placed(zone.entity));
        }
    }

    /// Sets this air in the solver of a cloth.
    pub fn set(
        &self,
        solver: &mut Solver,
        surface: &Surface,
        particles: &ClothParticles,
        frame: &ClothFrame,
        field: &WindField,
    ) {
        let to_cloth = frame.isometry().rotation.inverse();
        // Air without density does nothing.
        let Some(wind) = self.wind.filter(|wind| wind.density > 0.0) else {
            let pressure = self.pressure;
            let nothing = Air {
                pressure,
                ..Air::NONE
            };
            solver.set_air(surface, pressure.map(|_| nothing));
            return solver.set_air_memory(self.memory);
        };
        let air = Air {
            density: wind.density,
            drag: wind.drag,
            lift: wind.lift,
            wind: to_cloth * wind.velocity,
            pressure: self.pressure,
        };
        solver.set_air(surface, Some(air));
        solver.set_air_memory(self.memory);
        if wind.is_turbulent() || !self.zones.is_empty() {
            solver.set_local_wind(particles, |place| {
                let place = frame.to_world(place);
                let zones = self.zones.iter().map(|zone| zone.at(place));
                to_cloth * (wind.velocity + field.deviation(&wind, place) + zones.sum::<Vec3>())
            });
        }
    }

    /// Largest acceleration (m/s²) that the air may give a cloth whose lightest part has this areal density (kg/m²), at this largest `speed` (m/s). Within one tick of
    /// `seconds`, wind does not accelerate it beyond the wind's speed, and gas not beyond the speed at which it fills.
    pub fn acceleration(&self, areal_density: f32, speed: f32, seconds: f32) -> f32 {
        let inside = match self.pressure {
            Some(ClothPressure::Gauge(pressure)) => pressure.abs() / areal_density,
            Some(ClothPressure::Gas { .. }) if seconds > 0.0 => FILLING / seconds,
            // Gas fills nothing in zero time.
            None | Some(ClothPressure::Gas { .. }) => 0.0,
        };
        let Some(wind) = &self.wind else {
            return inside;
        };
        let zones = self.zones.iter().map(PlacedZone::fastest);
        let fastest = wind.velocity.length() + 2.0 * wind.deviation + zones.sum::<f32>();
        let relative = fastest + speed;
        let force = 0.5 * wind.density * (wind.drag + wind.lift) * relative * relative;
        let most = relative / seconds.max(f32::MIN_POSITIVE);
        inside + (force / areal_density).min(most)
    }
}
