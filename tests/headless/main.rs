//! Drives a headless app: `MinimalPlugins`, fixed ticks, no renderer.

mod attach;
mod drawing;
mod envelope;
mod faults;
mod frame;
mod gizmos;
mod lifetime;
mod log;
mod mesh;
mod meshes;
mod motion;
mod near;
mod rapier;
mod reflection;
mod rest;
mod scene_files;
mod schedule;
mod scratch;
mod search;
mod shapes;
mod spin;
mod startup;
mod substepping;
mod support;
mod touch;
mod uneven;
