//! A row of `peers.csv`: the package `peers` writes it, the lab draws it.

use serde::{Deserialize, Serialize};

/// Names of the scenes.
pub const CORNERS: &str = "two corners, rigid";
pub const ROW: &str = "top row, 1 mm/N";
pub const BALL: &str = "on a ball, rigid";

/// Names of the solvers, in the order in which they are shown.
pub const SOLVERS: [&str; 8] = [
    OURS,
    "Jolt",
    "pypbd",
    "MuJoCo flex",
    "Newton VBD",
    "Newton XPBD",
    "Newton Style3D",
    EXPLICIT,
];
pub const OURS: &str = "bevy_drape";
pub const EXPLICIT: &str = "explicit forces, f64";

/// A solver with a setting, in a scene.
#[derive(Serialize, Deserialize)]
pub struct Row {
    pub scene: String,
    pub solver: String,
    /// What was chosen of it; the first number is that of its steps or iterations.
    pub setting: String,
    /// CPU time of a frame in the mean; of all starts the smallest.
    pub ms_per_frame: f64,
    /// Of springs along rows and columns in the last second, as parts of their length; medians over starts, as all that follows.
    /// NaN where it blew up.
    pub max_stretch: f64,
    pub rms_stretch: f64,
    /// RMS distance from the reference after half a second (m), where it was given the same springs.
    pub position_error_m: Option<f64>,
    /// By how much the reference may be wrong (m).
    pub reference_error_m: Option<f64>,
    /// How deep triangles are in the ball at most in the last second (m).
    pub depth_m: Option<f64>,
}
