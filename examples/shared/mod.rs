//! What the examples share: options, the window with its keys, the run without one, light and floor, fabric.

pub mod headless;
pub mod pixels;
pub mod stage;
pub mod start;
pub mod view;
pub mod window;
pub mod woven;
