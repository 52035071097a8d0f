//! A cloth that others may touch, or that is sewn to others.

use bevy::{
    ecs::query::QueryData,
    prelude::{Entity, Mat3, Vec3},
};

use crate::{
    cloth::ClothParticles,
    contact::ClothLayers,
    plugin::{
        authoring::ClothOrder,
        frame::ClothFrame,
        state::{BroadPhaseBounds, ClothBuilt, ClothScratch, ClothState},
    },
};

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Neighbour {
    pub entity: Entity,
    pub built: &'static ClothBuilt,
    pub particles: &'static ClothParticles,
    pub frame: &'static ClothFrame,
    pub bounds: &'static mut BroadPhaseBounds,
    pub state: &'static mut ClothState,
    pub scratch: &'static mut ClothScratch,
    pub layers: Option<&'static ClothLayers>,
    pub order: Option<&'static ClothOrder>,
}

impl NeighbourItem<'_, '_> {
    /// Wakes a cloth that was prepared as a sleeping one.
    pub fn wake(&mut self) {
        self.state.rest.disturb();
        self.state.resting.on.clear();
        self.bounds.has_sleeping_contacts = false;
        let scratch = &mut *self.scratch;
        scratch.near.clear();
        scratch.detection.begin(self.built.surface(), scratch.reach);
    }
}

impl NeighbourReadOnlyItem<'_, '_> {
    /// The least and the greatest corner of the box in the world that the cloth stays in within the tick (m): where its particles
    /// are, and as far around as they may get by themselves, and again as far should something drag them.
    pub fn bounds(&self) -> [Vec3; 2] {
        let ends = [Vec3::MAX, Vec3::MIN];
        let [low, high] = self
            .particles
            .positions()
            .fold(ends, |[low, high], place| [low.min(place), high.max(place)]);
        let axes = Mat3::from_quat(self.frame.isometry().rotation);
        let half = (high - low) / 2.0;
        let half =
            axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        let centre = self.frame.to_world(low.midpoint(high));
        let thickness = self.scratch.self_collision.map_or(0.0, |of| of.thickness);
        let around = 2.0 * self.scratch.reach + thickness + 1.0e-5 * centre.length();
        let half = half * (1.0 + 1.0e-5) + around;
        [centre - half, centre + half]
    }
}
