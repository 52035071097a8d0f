//! Drives a headless app: `MinimalPlugins`, fixed ticks, no renderer.

mod async_build;
mod attach;
mod bake;
mod cape;
mod characters;
mod clones;
mod components;
mod crammed;
mod creases;
mod damping;
mod drawing;
mod embedded;
mod envelope;
mod faults;
mod forced;
mod frame;
mod fuzz;
mod given;
mod gizmos;
mod grab;
mod heavy;
mod held;
mod hidden;
mod hints;
mod hostile;
mod layers;
mod lifetime;
mod lod;
mod log;
mod material_map;
mod mesh;
mod meshes;
mod motion;
mod near;
mod notices;
mod order;
mod origin;
mod parents;
mod picking;
mod pole;
mod push_back;
mod push_rapier;
mod rapier;
mod reflection;
mod render_mesh;
mod resolution;
mod rest;
mod resting_bodies;
mod ropes;
mod scene_files;
mod scenes;
mod schedule;
mod scratch;
mod seams;
mod search;
mod self_collision;
mod shapes;
mod snapshot;
mod soak;
mod solids;
mod spin;
mod stands;
mod startup;
mod substepping;
mod support;
mod tears;
mod touch;
mod uneven;
mod wind;
mod woven;

#[path = "../shared/meshes.rs"]
#[expect(dead_code, reason = "no regular mesh is needed here")]
mod shared_meshes;

/// `shared_meshes` calls the crate by this name.
use bevy_drape as library;
