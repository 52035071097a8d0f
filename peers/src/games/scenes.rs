//! Scenes of games: a mesh that hangs, a skirt on legs that walk, a tablecloth, and a balloon.

use bevy::math::{Isometry3d, Quat, Vec3};
use bevy_drape::cloth::{Cloth, ClothMaterial, Pin, Pins};

use super::meshes::{self, Mesh};
use crate::{
    collider::{Collider, Shape},
    game_row::{BALLOON, HUNG_MESH, SKIRT, TABLECLOTH},
    told::{Garment, NUDGE, Told},
};

/// Frames of 1/60 s; of the last third all figures are taken but the time.
pub const FRAMES: u32 = 240;
pub const LAST: u32 = 80;

/// Vertices along a side of a sheet.
const SIDE: u32 = 64;

/// The plugin's default radius of a particle (m), which all solvers keep from bodies.
const MARGIN: f32 = 0.01;

/// Pressure times volume of a balloon's gas (J): some 100 Pa.
const GAS: f32 = 11.3;

/// The scenes in the header of the CSV file.
pub const SETTINGS: [(&str, &str); 7] = [
    (
        "scenes",
        "triangle meshes of ClothMaterial::COTTON (0.15 kg/m2, 0.1 mm/N, 6e-6 N m, friction 0.4, damping 0.6/s), kept 1 cm from bodies; 240 frames of 1/60 s. Hung mesh: 64 x 64 vertices, 2 m, level at first, hung by two corners. Skirt: 96 x 32 vertices, pinned at its waist, on a ball and on two capsules that walk. Tablecloth: 64 x 64 vertices, 1.6 m, let go 0.1 m above a fixed box of 1 m. Balloon: 1,692 vertices, radius 0.3 m, gas of 11.3 J in a vacuum, let go 0.1 m above a floor",
    ),
    (
        "ms_per_frame, ms_p99, ms_max",
        "CPU time of all threads: the mean over a scene, its 99th percentile and its longest frame; of all starts the smallest",
    ),
    (
        "max_stretch, rms_stretch",
        "of all edges of the mesh in all frames of the last third; NaN where it blew up",
    ),
    (
        "depth_m, triangles_depth_m",
        "the deepest vertex, and the deepest point of flat triangles, in a body in all frames of the last third, by brute force in f64; 0 on its surface and outside",
    ),
    (
        "volume",
        "relative to that at rest, the mean of the last third",
    ),
    (
        "height_error_m, volume_error",
        "of the hung mesh's mean height and of the balloon's volume, means of the last third, against bevy_drape with 200 sub-steps",
    ),
    (
        "medians",
        "of all but the times, over starts in which another vertex is 1 um aside",
    ),
];

/// A cloth and what it meets.
pub struct Game {
    pub name: &'static str,
    pub garment: Garment,
    triangles: Vec<[u32; 3]>,
    pinned: Vec<u32>,
    colliders: Vec<Collider>,
    gas: f32,
}

impl Game {
    /// All scenes.
    pub fn all() -> [Self; 4] {
        let still = |shape: Shape, at: fn(f32) -> Isometry3d| Collider {
            shape,
            at,
            moves: false,
        };
        let moving = |at: fn(f32) -> Isometry3d| Collider {
            shape: Shape::Capsule {
                radius: 0.08,
                length: 0.6,
            },
            at,
            moves: true,
        };
        let hips = still(Shape::Ball(0.15), |_| Isometry3d::from_xyz(0.0, 1.0, 0.0));
        let legs = [moving(|at| leg(at, 1.0)), moving(|at| leg(at, -1.0))];
        let table = still(Shape::Cuboid(Vec3::ONE), |_| Isometry3d::IDENTITY);
        let floor = still(Shape::Floor, |_| Isometry3d::IDENTITY);
        [
            Self::new(HUNG_MESH, meshes::sheet(SIDE, 2.0), 0.0).pinned([0, SIDE - 1]),
            Self::new(SKIRT, meshes::skirt(96, 32), 1.0)
                .pinned(0..96)
                .on([hips].into_iter().chain(legs)),
            Self::new(TABLECLOTH, meshes::sheet(SIDE, 1.6), 0.6).on([table]),
            Self {
                gas: GAS,
                ..Self::new(BALLOON, meshes::sphere(13, 0.3), 0.4).on([floor])
            },
        ]
    }

    /// A mesh that begins so high (m).
    fn new(name: &'static str, mesh: Mesh, height: f32) -> Self {
        let places = mesh.places.iter().map(|place| *place + Vec3::Y * height);
        Self {
            name,
            garment: Garment {
                cloth: Cloth::triangles(places, mesh.triangles.iter().copied()),
                pins: Pins::none(),
                material: ClothMaterial::COTTON,
            },
            triangles: mesh.triangles,
            pinned: Vec::new(),
            colliders: Vec::new(),
            gas: 0.0,
        }
    }

    fn pinned(mut self, vertices: impl IntoIterator<Item = u32>) -> Self {
        self.pinned = vertices.into_iter().collect();
        let pins = self
            .pinned
            .iter()
            .map(|vertex| Pin::Vertex(*vertex as usize));
        self.garment.pins = Pins::new(pins);
        self
    }

    fn on(mut self, colliders: impl IntoIterator<Item = Collider>) -> Self {
        self.colliders.extend(colliders);
        self
    }

    pub fn is_balloon(&self) -> bool {
        self.gas > 0.0
    }

    /// Whether there is a truth: where it ends does not depend on each touch.
    pub fn is_compared(&self) -> bool {
        self.is_balloon() || !self.has_colliders()
    }

    pub fn has_pins(&self) -> bool {
        !self.pinned.is_empty()
    }

    pub fn has_colliders(&self) -> bool {
        !self.colliders.is_empty()
    }

    /// All that a solver has to know, with one vertex aside in each `start`.
    pub fn told(&self, start: u32) -> Told {
        let mut told = Told {
            margin: MARGIN,
            gas: self.gas,
            pinned: self.pinned.clone(),
            colliders: self.colliders.clone(),
            ..Told::new(&self.garment, self.triangles.clone(), FRAMES)
        };
        let count = told.positions.len();
        told.positions[(100 + 1009 * start as usize) % count][1] += NUDGE;
        told
    }
}

/// A leg that swings from the hip, on one side or the other.
fn leg(seconds: f32, side: f32) -> Isometry3d {
    let turn = Quat::from_rotation_x(0.5 * side * (5.0 * seconds).sin());
    let hip = Vec3::new(0.09 * side, 0.95, 0.0);
    Isometry3d::new(hip + turn * Vec3::new(0.0, -0.4, 0.0), turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collider::depths;

    #[test]
    fn scenes_are_told_in_the_order_of_their_vertices() {
        for game in Game::all() {
            let told = game.told(0);
            let surface = game.garment.surface();
            let area = surface.area();
            let mass: f32 = told.masses.iter().sum();
            assert!((mass / (0.15 * area) - 1.0).abs() < 1.0e-3, "{}", game.name);
            // Each edge has a spring, and each spring is an edge.
            let mut edges: Vec<[u32; 2]> = told
                .triangles
                .iter()
                .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
                .map(|[a, b]| [a.min(b), a.max(b)])
                .collect();
            edges.sort_unstable();
            edges.dedup();
            let mut springs: Vec<[u32; 2]> = told
                .springs
                .iter()
                .map(|&[a, b]| [a.min(b), a.max(b)])
                .collect();
            springs.sort_unstable();
            assert_eq!(edges, springs, "{}", game.name);
            assert!(told.compliances.iter().all(|compliance| *compliance > 0.0));
            // Nothing begins inside of a body, but may begin within the margin.
            let depths = depths(&told.positions, &told.triangles, &told.colliders, 0.0);
            assert_eq!(depths, [0.0; 2], "{}", game.name);
        }
    }

    #[test]
    fn each_start_moves_another_vertex() {
        let [game, ..] = Game::all();
        let [one, other] = [0, 1].map(|start| game.told(start).positions);
        let moved = one.iter().zip(&other).filter(|(a, b)| a != b);
        assert_eq!(moved.count(), 2);
    }
}
