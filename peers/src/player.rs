//! Solvers with their settings, and how each plays a scene.

use bevy_drape::{contact::NarrowPhase, solver::Substepping};
use cpu_time::ProcessTime;
use oxijolt::LongRangeAttachment;

use crate::{
    explicit::Explicit,
    jolt::{self, Jolt},
    ours::Ours,
    outcome::{Milliseconds, Places, Play},
    python::Python,
    rapier::{self, RapierCloth},
    row::{EXPLICIT, OURS, SOLVERS},
    scene::{COMPARED, FRAMES, LAST, Scene},
    told::{Garment, Told},
};

/// A solver in the middle of a scene.
pub trait Frames {
    /// Goes on by a frame.
    ///
    /// # Errors
    /// The state that it cannot go on from.
    fn step(&mut self) -> Result<(), String>;

    /// Where all vertices are.
    fn places(&mut self) -> Places;
}

/// Plays so many frames. Only steps are timed. The places of so many last frames are told.
///
/// # Errors
/// A state that the solver cannot go on from, and its frame.
pub fn play(frames: &mut dyn Frames, count: u32, last: u32) -> Result<Play, String> {
    let mut ms = Vec::new();
    let (mut compared, mut lasts) = (Vec::new(), Vec::new());
    for frame in 1..=count {
        let clock = ProcessTime::now();
        let outcome = frames.step();
        ms.push(1.0e3 * clock.elapsed().as_secs_f64());
        outcome.map_err(|error| format!("frame {frame}: {error}"))?;
        if frame == COMPARED {
            compared = frames.places();
        }
        if frame + last > count {
            lasts.push(frames.places());
        }
    }
    Ok(Play {
        ms: Milliseconds::new(ms),
        compared,
        last: lasts,
    })
}

/// A solver with its settings.
pub struct Player {
    pub solver: &'static str,
    pub setting: String,
    pub way: Way,
}

pub enum Way {
    Ours(Substepping, NarrowPhase),
    Jolt(jolt::Setting),
    Rapier(rapier::Setting),
    Explicit(u32),
    /// By its name in the script.
    Python(&'static str),
}

impl Player {
    /// All that play a scene: those of this program, and those of the script.
    pub fn all(scene: &Scene, is_quick: bool) -> Vec<Self> {
        let mut all = Vec::new();
        let ours: &[u32] = match (scene.ball.is_some(), is_quick) {
            (_, true) => &[20],
            (true, false) => &[10, 20, 40],
            (false, false) => &[10, 20, 30, 40, 80, 160],
        };
        all.extend(ours.iter().map(|&count| Self {
            solver: OURS,
            setting: format!("{count} sub-steps"),
            way: Way::Ours(Substepping::Fixed(count), NarrowPhase::Auto),
        }));
        if scene.ball.is_some() {
            all.push(Self {
                solver: OURS,
                setting: "20 sub-steps, triangles".into(),
                way: Way::Ours(Substepping::Fixed(20), NarrowPhase::Triangles),
            });
        }
        let best = |iterations| jolt::Setting {
            iterations,
            is_generated: false,
            is_shuffled: true,
            late_pins: true,
            tethers: None,
        };
        let documented = |iterations| jolt::Setting {
            is_shuffled: false,
            late_pins: false,
            ..best(iterations)
        };
        let tethered = |iterations| jolt::Setting {
            late_pins: false,
            tethers: Some(LongRangeAttachment::EuclideanDistance),
            ..best(iterations)
        };
        let jolt = |name: &str, setting: jolt::Setting| Self {
            solver: SOLVERS[1],
            setting: format!("{} iterations{name}", setting.iterations),
            way: Way::Jolt(setting),
        };
        let counts: &[u32] = match (scene.ball.is_some(), is_quick) {
            (_, true) => &[20],
            (true, false) => &[10, 20, 40],
            (false, false) => &[20, 30, 40, 80, 100],
        };
        all.extend(counts.iter().map(|&count| jolt("", best(count))));
        all.push(jolt(", as documented", documented(20)));
        if !scene.told(0).pinned.is_empty() && scene.compliance == 0.0 {
            all.push(jolt(", tethers", tethered(20)));
        }
        if scene.compliance > 0.0 {
            all.push(Self {
                solver: EXPLICIT,
                setting: "70 steps".into(),
                way: Way::Explicit(70),
            });
        }
        all.extend(Self::of_python(scene, is_quick));
        all
    }

    /// Those of the script, as many steps and iterations as its table says.
    fn of_python(scene: &Scene, is_quick: bool) -> Vec<Self> {
        let mut all: Vec<(&str, &str, &str)> = Vec::new();
        let [_, _, pypbd, mujoco, vbd, xpbd, style3d, _] = SOLVERS;
        if scene.ball.is_none() {
            all.extend(
                [
                    "20 sub-steps",
                    "30 sub-steps",
                    "40 sub-steps",
                    "80 sub-steps",
                ]
                .map(|setting| (pypbd, "pypbd", setting)),
            );
        }
        if scene.compliance == 0.0 {
            all.extend(
                ["1 step of 30 MPa", "1 step of 300 MPa"]
                    .map(|setting| (mujoco, "mujoco", setting)),
            );
            all.push((style3d, "style3d", "2 steps of 10 × 10"));
        }
        all.push((vbd, "vbd", "20 steps of 2"));
        all.push((xpbd, "xpbd", "80 steps of 1"));
        if is_quick {
            all.dedup_by_key(|each| each.1);
        }
        let player = |(solver, name, setting): (&'static str, _, &str)| Self {
            solver,
            setting: setting.into(),
            way: Way::Python(name),
        };
        all.into_iter().map(player).collect()
    }

    /// Whether it has the scene's springs, and not a material like them.
    pub fn has_same_springs(&self, scene: &Scene) -> bool {
        match self.way {
            Way::Ours(..) | Way::Jolt(_) | Way::Rapier(_) | Way::Explicit(_) => true,
            // Of rigid threads VBD makes triangles.
            Way::Python("vbd") => scene.compliance > 0.0,
            Way::Python(name) => name == "pypbd" || name == "xpbd",
        }
    }

    pub fn is_python(&self) -> bool {
        matches!(self.way, Way::Python(_))
    }

    /// Plays a scene from one of its starts.
    ///
    /// # Errors
    /// What went wrong in the script.
    pub fn play(&self, scene: &Scene, python: Option<&Python>, start: u32) -> Result<Play, String> {
        let mut frames = match &self.way {
            Way::Python(name) => {
                let python = python.ok_or("no interpreter was given by --python")?;
                return python.play(scene, name, &self.setting, start);
            }
            Way::Explicit(steps) => Box::new(Explicit::new(scene, *steps, start)),
            way => way.begin(&scene.garment(), &scene.told(start))?,
        };
        play(&mut *frames, FRAMES, LAST)
    }
}

impl Way {
    /// A solver of this program that begins a scene of any mesh.
    ///
    /// # Errors
    /// The input that it refuses.
    pub fn begin(&self, garment: &Garment, told: &Told) -> Result<Box<dyn Frames>, String> {
        Ok(match self {
            Self::Ours(substepping, narrow_phase) => {
                Box::new(Ours::new(garment, told, *substepping, *narrow_phase))
            }
            Self::Jolt(setting) => Box::new(Jolt::new(told, *setting)?),
            Self::Rapier(setting) => Box::new(RapierCloth::new(told, *setting)?),
            Self::Explicit(_) | Self::Python(_) => {
                return Err("it only knows the sheets".into());
            }
        })
    }
}
