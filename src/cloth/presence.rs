//! Detects cloth that is spawned into an app without the plugin.

use bevy::{
    ecs::{
        lifecycle::HookContext, name::Name, resource::Resource, schedule::Schedules,
        world::DeferredWorld,
    },
    log::error,
};

/// Whether a world's cloth is simulated.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ClothPresence {
    /// The plugin simulates it.
    Simulated,
    /// Nothing simulates it so far, and that was logged.
    Missed,
}

/// Logs the first cloth of an app's world without the plugin. Other worlds, such as those of scene assets, run no
/// schedules.
pub(super) fn log_unsimulated(mut world: DeferredWorld, context: HookContext) {
    if world.contains_resource::<ClothPresence>() || !world.contains_resource::<Schedules>() {
        return;
    }
    world.commands().insert_resource(ClothPresence::Missed);
    let entity = context.entity;
    let name = match world.get::<Name>(entity) {
        Some(name) => format!("\"{name}\""),
        None => entity.to_string(),
    };
    error!(
        "cloth {name} was spawned without `DrapePlugins`: add them to the app, or nothing simulates it"
    );
}
