//! Whether anything simulates cloth: only a cloth that is spawned can say that nothing does.

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
    /// A plugin does it.
    Simulated,
    /// None does so far, and that was logged.
    Missed,
}

/// Logs the first cloth of an app's world without the plugin. Other worlds, as those of scene assets, run no schedules.
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
        "cloth {name} was spawned, and nothing moves it before `DrapePlugins` are added to the app"
    );
}
