//! A row of `peers_games.csv`: the package `peers` writes it, the lab draws it.

use serde::{Deserialize, Serialize};

/// Names of the scenes.
pub const HUNG_MESH: &str = "hung mesh";
pub const SKIRT: &str = "skirt";
pub const TABLECLOTH: &str = "tablecloth";
pub const BALLOON: &str = "balloon";

/// Names of the solvers, in the order in which they are shown.
pub const GAME_SOLVERS: [&str; 3] = ["bevy_drape", "Jolt", "rapier-cloth"];

/// A solver with a setting, in a scene.
#[derive(Serialize, Deserialize)]
pub struct GameRow {
    pub scene: String,
    pub solver: String,
    /// Its setting: numbers of its steps and iterations, and, behind a comma, another way to use it.
    pub setting: String,
    /// CPU time of a frame: the mean, the 99th percentile and the longest; of all starts the smallest.
    pub ms_per_frame: f64,
    pub ms_p99: f64,
    pub ms_max: f64,
    /// Of edges in the last third, as parts of their length; medians over starts, as all that follows. NaN where it blew up.
    pub max_stretch: f64,
    pub rms_stretch: f64,
    /// How deep vertices, and flat triangles, are in bodies at most in the last third (m).
    pub depth_m: Option<f64>,
    pub triangles_depth_m: Option<f64>,
    /// Relative to the volume at rest.
    pub volume: Option<f64>,
    /// Off the same cloth by the plugin with many sub-steps: of the mean height (m), and of the volume as a part of that at rest.
    pub height_error_m: Option<f64>,
    pub volume_error: Option<f64>,
}
