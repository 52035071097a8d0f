//! A flag on a pole that is a collider: what its own pole costs.

use bevy::{
    app::App,
    prelude::{FixedUpdate, MinimalPlugins, Transform, TransformPlugin, Vec3},
    time::TimeUpdateStrategy,
};
use bevy_drape::prelude::*;

/// Ticks until it has swung out, and ticks that are measured then.
const SETTLING: u32 = 128;
const MEASURED: u32 = 128;

/// Radius of the pole (m).
const RADIUS: f32 = 0.02;

/// What the pole is as a collider.
#[derive(Debug, Clone, Copy)]
pub enum Pole {
    None,
    Capsule,
    Cylinder,
}

/// The median tick of a flag of 48 × 32 particles, 1.5 m wide, in a breeze: all of the cloth's systems (ms).
pub fn flag(pole: Pole) -> f64 {
    let mut app = App::new();
    let plugins = (
        MinimalPlugins,
        TransformPlugin,
        DrapePlugins::new(FixedUpdate),
    );
    app.add_plugins(plugins)
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    let target = app.world_mut().spawn(Transform::default()).id();
    let collider = match pole {
        Pole::None => None,
        Pole::Capsule => Some(ClothCollider::capsule(RADIUS, 3.0)),
        Pole::Cylinder => Some(ClothCollider::cylinder(RADIUS, 3.0)),
    };
    if let Some(collider) = collider {
        app.world_mut().entity_mut(target).insert(collider);
    }
    let attached = ClothAttachments::new([(Pin::Column(0), target)]);
    let settings = ClothSettings {
        gravity: Some(Vec3::new(6.0, -9.81, 2.0)),
        sleeps: false,
        ..Default::default()
    };
    let cloth = (
        Cloth::new(48, 32, 1.5 / 47.0),
        Pins::none(),
        attached,
        settings,
    );
    let cloth = app.world_mut().spawn(cloth).id();
    (0..SETTLING).for_each(|_| app.update());
    let mut times: Vec<f64> = (0..MEASURED)
        .map(|_| {
            app.update();
            let stats = app.world().get::<ClothStats>(cloth).expect("figures");
            stats.integrate_ms + stats.query_ms + stats.rebuild_ms
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
