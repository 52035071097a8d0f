//! Shared by examples and lab: options, the window with its keys, the headless run, light and floor, fabric; and sheets
//! without an app, with the truths that tests and lab hold them to.

#![expect(missing_docs, reason = "names say enough: nothing here is published")]

use std::path::{Path, PathBuf};

pub mod arrows;
pub mod depth;
pub mod exact;
pub mod figure;
pub mod headless;
pub mod measured;
pub mod modes;
pub mod physics;
pub mod pixels;
pub mod preparing;
pub mod report;
pub mod sheet;
pub mod smooth;
pub mod stage;
pub mod start;
pub mod surfaces;
pub mod view;
pub mod window;
pub mod windy;
pub mod workshop;
pub mod woven;

/// The top of the repository. Cargo says at run time where it is, since checkouts may share a target folder.
pub fn top() -> PathBuf {
    let package = std::env::var("CARGO_MANIFEST_DIR");
    Path::new(package.as_deref().unwrap_or(env!("CARGO_MANIFEST_DIR"))).join("..")
}
