//! Shared by the examples: options, the window with its keys, the headless run, light and floor, fabric.

pub mod headless;
pub mod pixels;
pub mod preparing;
pub mod stage;
pub mod start;
pub mod view;
pub mod window;
pub mod woven;
