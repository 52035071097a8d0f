//! Drives a headless app: `MinimalPlugins`, fixed ticks, no renderer.

mod faults;
mod frame;
mod lifetime;
mod mesh;
mod motion;
mod rapier;
mod schedule;
mod support;
mod touch;
