//! Drives a headless app: `MinimalPlugins`, fixed ticks, no renderer.

mod faults;
mod mesh;
mod motion;
mod rapier;
mod schedule;
mod support;
mod touch;
