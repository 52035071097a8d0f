//! The scenes: a square cloth that hangs by two corners, one of soft springs that hangs by its top row, and one that falls on
//! a ball.

use bevy::math::{Isometry3d, Vec3};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, Corner, Pin, Pins},
    solver::TickStep,
};

use crate::{
    collider::{Collider, Shape},
    row::{BALL, CORNERS, ROW},
    shared::sheet::{Sheet, threads},
    told::{FRAME, Garment, NUDGE, Told},
};

/// Particles along a side, and its length (m).
pub const SIDE: u32 = 64;
pub const WIDTH: f32 = 2.0;

/// Frames of 1/60 s, and how many of them, the last, stretch and depth are taken from.
pub const FRAMES: u32 = 180;
pub const LAST: u32 = 60;

/// The frame after which the places of particles are compared with the reference's: half a second.
pub const COMPARED: u32 = 30;

/// Coulomb's μ of cloth on the ball.
pub const FRICTION: f32 = 0.3;

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

    /// The cloth as the plugin has it.
    pub fn garment(&self) -> Garment {
        let pins = match self.hung {
            Hung::TwoCorners => Pins::new([Corner::TopLeft, Corner::TopRight].map(Pin::Corner)),
            Hung::TopRow => Pins::top_row(),
            Hung::Nowhere => Pins::none(),
        };
        Garment {
            cloth: Cloth::new(SIDE, SIDE, WIDTH / (SIDE - 1) as f32),
            pins,
            material: self.material(),
        }
    }

    /// All that a solver has to know, with the springs that it shall have.
    pub fn told(&self, start: u32) -> Told {
        let cells = || (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column)));
        let ball = |radius| Collider {
            shape: Shape::Ball(radius),
            at: |_| Isometry3d::IDENTITY,
            moves: false,
        };
        Told {
            pinned: cells()
                .zip(0..)
                .filter(|((row, column), _)| self.hung.holds(*row, *column))
                .map(|(_, index)| index)
                .collect(),
            positions: cells()
                .map(|(row, column)| self.place(row, column, start).to_array())
                .collect(),
            colliders: self.ball.map(ball).into_iter().collect(),
            ..Told::new(&self.garment(), triangles(), FRAMES)
        }
    }
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
