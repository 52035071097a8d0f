//! Solvers that are packages of Python, run by a script in a process of its own.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde::Serialize;

use crate::{
    outcome::{Milliseconds, Places, Play},
    scene::{LAST, SIDE, Scene, WIDTH},
    told::Told,
};

/// The input of the script: a square sheet, and maybe a ball.
#[derive(Serialize)]
struct Sheet<'a> {
    scene: &'a str,
    side: u32,
    /// m
    width: f32,
    /// Radius (m) of the ball around the origin.
    ball: Option<f32>,
    #[serde(flatten)]
    told: &'a Told,
}

/// An interpreter that has the packages.
pub struct Python {
    interpreter: PathBuf,
    /// Where scenes and what came of them are written.
    folder: PathBuf,
}

impl Python {
    /// Uses `folder` for files between this program and the script.
    ///
    /// # Errors
    /// If it can't be made.
    pub fn new(interpreter: &Path, folder: PathBuf) -> Result<Self, String> {
        fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        Ok(Self {
            interpreter: interpreter.to_owned(),
            folder,
        })
    }

    /// Versions of the interpreter and of all packages that play.
    ///
    /// # Errors
    /// What the script says.
    pub fn versions(&self) -> Result<String, String> {
        self.run(&["versions"])
    }

    /// Plays a scene from one of its starts.
    ///
    /// # Errors
    /// What the script says, or which file could not be read or written.
    pub fn play(
        &self,
        scene: &Scene,
        solver: &str,
        setting: &str,
        start: u32,
    ) -> Result<Play, String> {
        let told = self.folder.join("scene.json");
        let places = self.folder.join("places.f32");
        let sheet = Sheet {
            scene: scene.name,
            side: SIDE,
            width: WIDTH,
            ball: scene.ball,
            told: &scene.told(start),
        };
        let text = serde_json::to_string(&sheet).map_err(|error| error.to_string())?;
        fs::write(&told, text).map_err(|error| format!("{}: {error}", told.display()))?;
        let [told, written] = [&told, &places].map(|path| path.to_string_lossy().into_owned());
        let said = self.run(&["play", solver, setting, &told, &written])?;
        let ms = said
            .lines()
            .last()
            .and_then(|line| line.strip_prefix("ms "))
            .and_then(|ms| ms.parse().ok())
            .ok_or_else(|| format!("{solver} does not say how long it took: {said}"))?;
        let bytes = fs::read(&places).map_err(|error| format!("{written}: {error}"))?;
        let mut frames = frames(&bytes);
        if frames.len() != 1 + LAST as usize {
            return Err(format!("{solver} wrote {} frames", frames.len()));
        }
        let last = frames.split_off(1);
        let compared = frames.pop().unwrap_or_default();
        Ok(Play {
            ms: Milliseconds::mean_only(ms),
            compared,
            last,
        })
    }

    fn run(&self, arguments: &[&str]) -> Result<String, String> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/play.py");
        let mut command = Command::new(&self.interpreter);
        command.arg(&script).args(arguments);
        // One thread each, whatever library they count by.
        for name in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"] {
            command.env(name, "1");
        }
        let output = command
            .output()
            .map_err(|error| format!("{}: {error}", self.interpreter.display()))?;
        let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
        if output.status.success() {
            return Ok(said(&output.stdout));
        }
        let error = said(&output.stderr);
        Err(error.lines().last().unwrap_or("it failed").to_owned())
    }
}

/// Floats, little end first, three a particle, frame by frame.
fn frames(bytes: &[u8]) -> Vec<Places> {
    let (floats, _) = bytes.as_chunks::<4>();
    let floats: Vec<f32> = floats
        .iter()
        .map(|bytes| f32::from_le_bytes(*bytes))
        .collect();
    let (places, _) = floats.as_chunks::<3>();
    let frames = places.chunks_exact((SIDE * SIDE) as usize);
    frames.map(<[[f32; 3]]>::to_vec).collect()
}
