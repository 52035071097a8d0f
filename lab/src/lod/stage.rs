//! An app without a renderer, with flags in a row away from a camera.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::timed::{Clock, TimedTicks};

/// Particles of a flag, and how far apart they are (m).
const FLAG: [u32; 2] = [24, 16];
const SPACING: f32 = 0.06;

/// How far from the camera the near flags are (m), the first that are not, and how far apart these are.
const NEAR: f32 = 10.0;
const FIRST_FAR: f32 = 30.0;
const APART: f32 = 3.0;

/// Which flags there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flags {
    /// All, at the full rate.
    Full,
    /// All, by `ClothLod::default()`.
    ByDistance,
    /// The near ones alone.
    NearAlone,
}

impl Flags {
    pub const ALL: [Self; 3] = [Self::Full, Self::ByDistance, Self::NearAlone];

    pub fn name(self) -> &'static str {
        match self {
            Self::Full => "none",
            Self::ByDistance => "by distance",
            Self::NearAlone => "near alone",
        }
    }
}

/// An app, and what was measured of it.
pub struct Stage {
    app: App,
    near: u32,
    flags: Flags,
    moved: Vec<u32>,
}

impl Stage {
    /// So many flags, as many of them near.
    pub fn new(count: u32, near: u32, flags: Flags) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
            .add_plugins(TimedTicks);
        if flags == Flags::ByDistance {
            app.insert_resource(GlobalClothLod(ClothLod::default()));
        }
        let world = app.world_mut();
        world.spawn((Camera::default(), Transform::default()));
        let settings = ClothSettings {
            sleeps: false,
            ..default()
        };
        let there = if flags == Flags::NearAlone {
            near
        } else {
            count
        };
        for flag in 0..there {
            let away = match flag.checked_sub(near) {
                // Side by side.
                None => Vec3::new(
                    2.0 * (flag % 8) as f32 - 7.0,
                    2.0 * (flag / 8) as f32 - 7.0,
                    -NEAR,
                ),
                Some(far) => Vec3::NEG_Z * (FIRST_FAR + APART * far as f32),
            };
            let [columns, rows] = FLAG;
            let cloth = Cloth::new(columns, rows, SPACING);
            let pole = Pins::new([Pin::Column(0)]);
            world.spawn((cloth, pole, settings, Transform::from_translation(away)));
        }
        app.finish();
        app.cleanup();
        Self {
            app,
            near,
            flags,
            moved: Vec::new(),
        }
    }

    /// Ticks that are not measured.
    pub fn warm_up(&mut self, ticks: usize) {
        (0..ticks).for_each(|_| self.turn());
        self.app.world_mut().resource_mut::<Clock>().1.clear();
        self.moved.clear();
    }

    /// One tick.
    pub fn turn(&mut self) {
        self.app.update();
        let world = self.app.world_mut();
        let mut all = world.query::<&ClothStats>();
        let moved = all.iter(world).filter(|stats| stats.substeps > 0);
        self.moved.push(moved.count() as u32);
    }

    /// What the ticks took (ms).
    pub fn ms(&self) -> &[f64] {
        &self.app.world().resource::<Clock>().1
    }

    /// Flags that were moved in a tick, in the mean.
    pub fn moved(&self) -> f64 {
        f64::from(self.moved.iter().sum::<u32>()) / self.moved.len().max(1) as f64
    }

    /// Whether the near flags and no others are at the full rate, where that goes by distance, and else all.
    pub fn is_as_said(&mut self) -> bool {
        let world = self.app.world_mut();
        let mut all = world.query::<&ClothStats>();
        let count = all.iter(world).len();
        let at_full_rate = all
            .iter(world)
            .filter(|stats| stats.level == ClothLodLevel::Full)
            .count();
        at_full_rate
            == if self.flags == Flags::ByDistance {
                self.near as usize
            } else {
                count
            }
    }
}
