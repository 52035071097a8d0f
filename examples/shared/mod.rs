//! Shared by the examples: options, the window with its keys, the headless run, light and floor, fabric.

pub mod headless;
pub mod measured;
pub mod pixels;
pub mod preparing;
pub mod stage;
pub mod start;
pub mod view;
pub mod window;
pub mod woven;

/// Some examples need these, some don't.
#[expect(dead_code, reason = "no example needs all of them")]
#[path = "."]
pub mod parts {
    pub mod arrows;
    pub mod depth;
    pub mod figure;
    pub mod physics;
    pub mod report;
    pub mod surfaces;
    pub mod windy;
    pub mod workshop;
}
