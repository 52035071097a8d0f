//! The scenes: a square cloth that hangs by two corners, one of soft springs that hangs by its top row, and one that falls on
//! a ball.

use bevy::math::Vec3;
use bevy_drape::{cloth::ClothMaterial, solver::TickStep};
use serde::Serialize;

use crate::{
    row::{BALL, CORNERS, ROW},
    shared::sheet::{GRAVITY, Sheet, threads},
};

/// Particles along a side, and its length (m).
pub const SIDE: u32 = 64;
pub const WIDTH: f32 = 2.0;

/// Frames of 1/60 s, and how many of them, the last, stretch and depth are taken from.
pub const FRAMES: u32 = 180;
pub const LAST: u32 = 60;

/// The frame after which the places of particles are compared with the reference's: half a second.
pub const COMPARED: u32 = 30;

/// Length of a frame (s).
pub const FRAME: f32 = 1.0 / 60.0;

/// Coulomb's μ of cloth on the ball.
pub const FRICTION: f32 = 0.3;

/// How far one particle is moved in each start (m): what is a draw has to differ.
const NUDGE: f32 = 1.0e-6;

/// What the reference has in place of rigid springs (m/N): the whole cloth's weight stretches one of them by 20 millionths.
pub const NEARLY_RIGID: f32 = 1.0e-7;

/// What the header of the CSV file says of the scenes.
pub const SETTINGS: [(&str, &str); 6] = [
    (
        "scenes",
        "64 x 64 particles, 2 m x 2 m, 0.15 kg/m2, from rest and level; springs along rows, columns and both diagonals, no bending, no damping; 180 frames of 1/60 s. Hung by two corners, rigid; by the top row, 1 mm/N; let go 0.1 m above a fixed ball of radius 0.5 m, rigid, friction 0.3, no margin",
    ),
    (
        "ms_per_frame",
        "CPU time of all threads, the mean over a scene, of all starts the smallest",
    ),
    (
        "max_stretch, rms_stretch",
        "of springs along rows and columns in all frames of the third second; NaN where it blew up",
    ),
    (
        "position_error_m",
        "RMS distance from the reference after 0.5 s, of solvers that were given the same springs; the reference are explicit forces in f64, with 1e-7 m/N for rigid",
    ),
    (
        "depth_m",
        "of flat triangles in the ball, the deepest point of all frames of the third second, by brute force in f64",
    ),
    (
        "medians",
        "of all but the time, over starts in which another particle is 1 um aside",
    ),
];

/// A cloth and what it meets.
#[derive(Clone, Copy)]
pub struct Scene {
    pub name: &'static str,
    /// Of all springs (m/N).
    pub compliance: f32,
    pub hung: Hung,
    /// How high it begins (m).
    pub height: f32,
    /// Radius of a ball around the origin that does not move (m).
    pub ball: Option<f32>,
}

/// Where it is pinned.
#[derive(Clone, Copy, PartialEq)]
pub enum Hung {
    TwoCorners,
    TopRow,
    Nowhere,
}

impl Hung {
    pub fn holds(self, row: u32, column: u32) -> bool {
        match self {
            Self::TwoCorners => row == 0 && (column == 0 || column == SIDE - 1),
            Self::TopRow => row == 0,
            Self::Nowhere => false,
        }
    }
}

impl Scene {
    pub const CORNERS: Self = Self {
        name: CORNERS,
        compliance: 0.0,
        hung: Hung::TwoCorners,
        height: 0.0,
        ball: None,
    };
    pub const ROW: Self = Self {
        name: ROW,
        compliance: 1.0e-3,
        hung: Hung::TopRow,
        height: 0.0,
        ball: None,
    };
    pub const BALL: Self = Self {
        name: BALL,
        compliance: 0.0,
        hung: Hung::Nowhere,
        height: 0.6,
        ball: Some(0.5),
    };

    pub const ALL: [Self; 3] = [Self::CORNERS, Self::ROW, Self::BALL];

    pub fn material(&self) -> ClothMaterial {
        ClothMaterial {
            friction: FRICTION,
            ..threads(self.compliance, self.compliance)
        }
    }

    /// Where a particle begins (m), one of them a µm aside in each `start`.
    pub fn place(&self, row: u32, column: u32, start: u32) -> Vec3 {
        let spacing = WIDTH / (SIDE - 1) as f32;
        let is_nudged = (row, column) == (7 * start % SIDE, (11 * start + 5) % SIDE);
        let aside = if is_nudged { NUDGE } else { 0.0 };
        let along = |index: u32| index as f32 * spacing - WIDTH / 2.0;
        Vec3::new(along(column), self.height + aside, along(row))
    }

    /// The cloth with springs of this compliance (m/N).
    pub fn sheet_of(&self, compliance: f32, start: u32) -> Sheet {
        let scene = Self {
            compliance,
            ..*self
        };
        let step = TickStep {
            seconds: FRAME,
            ..TickStep::default()
        };
        Sheet::new(
            (SIDE, SIDE),
            WIDTH / (SIDE - 1) as f32,
            scene.material(),
            step,
            |row, column| scene.place(row, column, start),
            |row, column| scene.hung.holds(row, column),
        )
    }

    /// All that a solver has to know, with the springs that it shall have.
    pub fn told(&self, start: u32) -> Told {
        let sheet = self.sheet_of(self.compliance, start);
        let free = self.sheet_of_free_masses();
        let springs = || sheet.springs.iter();
        Told {
            scene: self.name.into(),
            side: SIDE,
            width: WIDTH,
            frames: FRAMES,
            frame: FRAME,
            gravity: GRAVITY as f32,
            friction: FRICTION,
            ball: self.ball,
            pinned: sheet
                .particles
                .inverse_masses()
                .enumerate()
                .filter(|(_, inverse_mass)| *inverse_mass == 0.0)
                .map(|(index, _)| index as u32)
                .collect(),
            positions: sheet
                .particles
                .positions()
                .map(|place| place.to_array())
                .collect(),
            masses: free,
            springs: springs().map(|spring| spring.ends).collect(),
            compliances: springs().map(|spring| spring.compliance).collect(),
            triangles: triangles(),
        }
    }

    /// Mass of each particle (kg), as if none were pinned.
    fn sheet_of_free_masses(&self) -> Vec<f32> {
        let free = Self {
            hung: Hung::Nowhere,
            ..*self
        };
        let sheet = free.sheet_of(self.compliance, 0);
        sheet
            .particles
            .inverse_masses()
            .map(|inverse_mass| 1.0 / inverse_mass)
            .collect()
    }
}

/// A scene as plain lists: what other solvers are set up from, in Rust or Python.
#[derive(Serialize)]
pub struct Told {
    pub scene: String,
    pub side: u32,
    /// m
    pub width: f32,
    pub frames: u32,
    /// s
    pub frame: f32,
    /// m/s², along −y
    pub gravity: f32,
    pub friction: f32,
    /// Radius (m) of the ball around the origin.
    pub ball: Option<f32>,
    pub pinned: Vec<u32>,
    /// m
    pub positions: Vec<[f32; 3]>,
    /// kg
    pub masses: Vec<f32>,
    pub springs: Vec<[u32; 2]>,
    /// m/N
    pub compliances: Vec<f32>,
    pub triangles: Vec<[u32; 3]>,
}

/// Two for each square of particles, with normals up.
pub fn triangles() -> Vec<[u32; 3]> {
    let cells = (0..SIDE - 1).flat_map(|row| (0..SIDE - 1).map(move |column| row * SIDE + column));
    cells
        .flat_map(|at| {
            let [right, below] = [at + 1, at + SIDE];
            [[at, below, right], [right, below, below + 1]]
        })
        .collect()
}
