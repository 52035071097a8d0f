//! The order in which an app is put together, and what is missing from it.

use bevy::{app::TaskPoolPlugin, prelude::*, time::TimeUpdateStrategy};
use bevy_drape::prelude::*;

use crate::{
    log::{lines_with, listen},
    support::tick,
};

const UNSIMULATED: &str = "cloth \"early bird\" was spawned without `DrapePlugins`";

/// Cloths and colliders that were there before the plugin are simulated as any other, and those that come after; that
/// there was no plugin is said once a world.
#[test]
fn cloth_may_be_spawned_before_the_plugin() {
    listen();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    let floor = Transform::from_xyz(0.0, -2.0, 0.0);
    app.world_mut().spawn((ClothCollider::plane(), floor));
    let settings = ClothSettings::substeps(7);
    let name = Name::new("early bird");
    let cloth = || (Cloth::default(), Pins::none(), settings, name.clone());
    // A world that no app runs, as a scene's, is nobody's business.
    World::new().spawn(cloth());
    assert_eq!(lines_with(UNSIMULATED).len(), 0);
    let earlier = [(); 2].map(|()| app.world_mut().spawn(cloth()).id());
    assert_eq!(lines_with(UNSIMULATED).len(), 1);
    app.add_plugins(DrapePlugins::default());
    let later = app.world_mut().spawn(cloth()).id();
    app.finish();
    app.cleanup();
    app.update();
    tick(&mut app, 128);
    for cloth in earlier.into_iter().chain([later]) {
        let particles = app.world().get::<ClothParticles>(cloth).expect("a cloth");
        let lowest = particles.positions().map(|at| at.y).fold(0.0, f32::min);
        assert!((-2.0..-1.9).contains(&lowest), "{lowest}");
        assert_eq!(app.world().get::<ClothSettings>(cloth), Some(&settings));
    }
    assert_eq!(lines_with(UNSIMULATED).len(), 1);
}

/// Without a clock nothing moves, nothing panics, and that is said.
#[test]
fn without_a_clock_nothing_panics() {
    listen();
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), DrapePlugins::new(Update)));
    app.world_mut().spawn(Cloth::default());
    app.finish();
    app.cleanup();
    app.update();
    app.update();
    assert_eq!(lines_with("there is no clock").len(), 1);
}
