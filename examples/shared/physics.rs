//! Rapier, which steps with the cloth, and what it moves drawn between its steps.

use bevy::prelude::*;
use bevy_rapier3d::prelude::{NoUserData, RapierPhysicsPlugin, TimestepMode};
use bevy_transform_interpolation::prelude::TransformInterpolationPlugin;

/// Rapier in the cloth's schedule, one step a fixed tick.
pub struct PhysicsPlugin;

impl Plugin for PhysicsPlugin {
    fn build(&self, app: &mut App) {
        let time = app.world().resource::<Time<Fixed>>();
        let dt = time.timestep().as_secs_f32();
        app.insert_resource(TimestepMode::Fixed { dt, substeps: 1 })
            .add_plugins((
                RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
                TransformInterpolationPlugin::default(),
            ));
    }
}
