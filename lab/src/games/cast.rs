//! Parts of scenes: cloths with layers or without, things that follow a path, and where particles begin.

use bevy::prelude::*;
use bevy_drape::prelude::*;

/// Ticks a second.
pub const RATE: f32 = 60.0;

/// The settings of all cloths of a scene: with contact of cloth with cloth, or without.
pub struct Layers(pub Option<ClothSelfCollision>);

/// How a thing moves: its place at each time (s).
#[derive(Component)]
pub struct Path(pub fn(f32, usize) -> Transform, pub usize);

/// Moves what has a path to its place after so many ticks.
pub fn follow(world: &mut World, ticks: u32) {
    let seconds = ticks as f32 / RATE;
    let mut all = world.query::<(&Path, &mut Transform)>();
    for (Path(at, index), mut place) in all.iter_mut(world) {
        *place = at(seconds, *index);
    }
}

impl Layers {
    /// Spawns a cloth that stays awake.
    pub fn spawn(&self, world: &mut World, cloth: impl Bundle) -> Entity {
        let settings = ClothSettings {
            sleeps: false,
            ..default()
        };
        let mut spawned = world.spawn((settings, cloth));
        if let Some(layers) = self.0 {
            spawned.insert(layers);
        }
        spawned.id()
    }
}

/// Where each particle begins, from its place in the world as the cloth is spawned.
#[derive(Component)]
pub struct Moved(pub fn(Vec3) -> Vec3);
