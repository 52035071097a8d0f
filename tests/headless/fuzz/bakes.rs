//! Recordings of cloths, to which anything may happen meanwhile.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use gltf::Gltf;

use super::random::Random;
use crate::support::TICK;

/// Frames of a recording, at most.
const MOST: usize = 10;

/// A cloth that is being recorded.
#[derive(Resource)]
struct Baking {
    cloth: Entity,
    bake: ClothBake,
    /// The time of the last frame (s).
    seconds: f32,
    /// Number of ticks until it is written.
    left: usize,
}

/// Begins to record a cloth, unless one is being recorded. Times may be too large to tell frames apart, or none.
pub fn begin(world: &mut World, cloth: Entity, random: &mut Random) {
    let baking = Baking {
        cloth,
        bake: ClothBake::default(),
        seconds: random.number(),
        left: 1 + random.below(MOST),
    };
    if !world.contains_resource::<Baking>() {
        world.insert_resource(baking);
    }
}

/// Records the cloth as this tick left it, if there is one. Each recording of two frames or more is a valid file.
pub fn record(world: &mut World) {
    let Some(mut baking) = world.remove_resource::<Baking>() else {
        return;
    };
    baking.seconds += TICK;
    baking.left -= 1;
    let handle = world.get::<Mesh3d>(baking.cloth);
    let meshes = world.resource::<Assets<Mesh>>();
    if let Some(mesh) = handle.and_then(|mesh| meshes.get(&mesh.0)) {
        let before = baking.bake.frames();
        let outcome = baking.bake.record(mesh, baking.seconds);
        let frames = before + usize::from(outcome.is_ok());
        assert_eq!(baking.bake.frames(), frames, "{outcome:?}");
    }
    if baking.left > 0 {
        world.insert_resource(baking);
        return;
    }
    match baking.bake.to_glb("cloth") {
        Ok(file) => {
            let read = Gltf::from_slice(&file);
            assert!(read.is_ok(), "{:?}", read.err());
        }
        Err(error) => {
            let frames = baking.bake.frames();
            assert!(frames < 2, "{error}");
            assert_eq!(error, BakeError::Frames { frames });
        }
    }
}
