//! The solver against what is true: closed forms, conservation, a converged run in f64. `-- --nocapture` prints
//! the figures.

mod air;
mod awning;
mod balloon;
mod bending;
mod capstan;
mod catenary;
mod changes;
mod compliance;
mod convergence;
mod creases;
mod damping;
mod distance;
mod drape;
mod drops;
mod energy;
mod gas;
mod hung;
mod mesh;
#[path = "../shared/meshes.rs"]
mod meshes;
mod motion;
mod plate;
#[path = "../shared/scene.rs"]
#[expect(dead_code, reason = "the lab asks for a scene's grid, no test does")]
mod scene;
mod scenes;
mod singular;
mod soft;
mod strip;
mod swings;
mod woven;

/// `meshes` calls the crate by this name: the crate's own tests include that file, too.
use bevy_drape as library;
