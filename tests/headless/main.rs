//! Drives a headless app: `MinimalPlugins`, fixed ticks, no renderer.

mod attach;
mod envelope;
mod faults;
mod frame;
mod gizmos;
mod lifetime;
mod mesh;
mod motion;
mod near;
mod precision;
mod rapier;
mod rest;
mod schedule;
mod search;
mod shapes;
mod support;
mod touch;
