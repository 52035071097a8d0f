//! A scene as plain lists: what all solvers are set up from, in Rust or Python.

use bevy::math::Vec3;
use bevy_drape::cloth::{Cloth, ClothMaterial, ClothParticles, Pins, Springs, Surface};
use serde::Serialize;

use crate::{collider::Collider, shared::sheet::GRAVITY};

/// Length of a frame (s).
pub const FRAME: f32 = 1.0 / 60.0;

/// How far one particle is moved in each start (m): what is a draw has to differ.
pub const NUDGE: f32 = 1.0e-6;

/// A cloth as the plugin takes it.
pub struct Garment {
    pub cloth: Cloth,
    pub pins: Pins,
    pub material: ClothMaterial,
}

impl Garment {
    /// Its surface.
    ///
    /// # Panics
    /// If there is no such cloth.
    pub fn surface(&self) -> Surface {
        self.cloth.surface(Vec3::ONE).expect("a valid cloth")
    }
}

/// A scene with its cloth, in the order of the cloth's vertices.
#[derive(Serialize)]
pub struct Told {
    pub frames: u32,
    /// s
    pub frame: f32,
    /// m/s², along −y
    pub gravity: f32,
    pub friction: f32,
    /// The part of its velocity that a particle loses in a second, while it is small (1/s).
    #[serde(skip)]
    pub damping: f32,
    /// The distance (m) at which the cloth lies on a collider.
    #[serde(skip)]
    pub margin: f32,
    /// A gas has this much pressure times volume (J); 0 for none. Nothing is outside.
    #[serde(skip)]
    pub gas: f32,
    pub pinned: Vec<u32>,
    /// m
    pub positions: Vec<[f32; 3]>,
    /// kg, as if none were pinned
    pub masses: Vec<f32>,
    pub springs: Vec<[u32; 2]>,
    /// m/N
    pub compliances: Vec<f32>,
    /// With normals to one side.
    pub triangles: Vec<[u32; 3]>,
    #[serde(skip)]
    pub hinges: Vec<Hinge>,
    #[serde(skip)]
    pub colliders: Vec<Collider>,
}

/// A hinge that resists bending between two triangles.
#[derive(Debug, Clone, Copy)]
pub struct Hinge {
    /// The edge that they share, and the corners opposite to it.
    pub vertices: [u32; 4],
    /// By how much the torque grows with the angle (N·m).
    pub stiffness: f32,
}

impl Told {
    /// The springs, masses and bending that the plugin gives to a cloth, at rest where its vertices are, free, with nothing around
    /// it. `triangles` are those of the vertices.
    ///
    /// # Panics
    /// If there is no such cloth.
    pub fn new(garment: &Garment, triangles: Vec<[u32; 3]>, frames: u32) -> Self {
        let (surface, material) = (garment.surface(), garment.material);
        let particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
        let of_vertex = order(&surface);
        let mut of_particle = vec![0; of_vertex.len()];
        for (vertex, &particle) in of_vertex.iter().enumerate() {
            of_particle[particle] = vertex as u32;
        }
        let masses: Vec<f32> = particles.inverse_masses().map(|mass| 1.0 / mass).collect();
        let springs = Springs::of_surface(&surface, &material).to_vec();
        let positions: Vec<[f32; 3]> = of_vertex
            .iter()
            .map(|&particle| surface.rest_positions()[particle].to_array())
            .collect();
        let hinges = hinges(&positions, &triangles, material.bend_rigidity);
        Self {
            frames,
            frame: FRAME,
            gravity: GRAVITY as f32,
            friction: material.friction,
            damping: -(1.0 - material.damping).ln() * 60.0,
            margin: 0.0,
            gas: 0.0,
            pinned: Vec::new(),
            positions,
            masses: of_vertex.iter().map(|&particle| masses[particle]).collect(),
            springs: springs
                .iter()
                .map(|spring| spring.ends.map(|end| of_particle[end as usize]))
                .collect(),
            compliances: springs.iter().map(|spring| spring.compliance).collect(),
            triangles,
            hinges,
            colliders: Vec::new(),
        }
    }

    /// Whether no spring gives.
    pub fn is_rigid(&self) -> bool {
        self.compliances.iter().all(|compliance| *compliance == 0.0)
    }
}

/// The particle of each vertex.
pub fn order(surface: &Surface) -> Vec<usize> {
    let particle = |vertex| surface.particle_of_vertex(vertex).unwrap_or(vertex);
    (0..surface.len()).map(particle).collect()
}

/// A hinge at each edge between two triangles, whose torque is that of a plate of this rigidity (N·m) bent along an edge of a square
/// that two triangles share: D l² ⁄ (A + B), with the edge's length l and the triangles' areas A and B.
fn hinges(positions: &[[f32; 3]], triangles: &[[u32; 3]], rigidity: f32) -> Vec<Hinge> {
    if rigidity == 0.0 {
        return Vec::new();
    }
    let place = |vertex: u32| Vec3::from_array(positions[vertex as usize]);
    let area =
        |[a, b, c]: [u32; 3]| 0.5 * (place(b) - place(a)).cross(place(c) - place(a)).length();
    let mut sides: Vec<([u32; 2], u32, f32)> = triangles
        .iter()
        .flat_map(|&[a, b, c]| {
            let area = area([a, b, c]);
            [(a, b, c), (b, c, a), (c, a, b)].map(|(a, b, c)| ([a.min(b), a.max(b)], c, area))
        })
        .collect();
    sides.sort_by_key(|(ends, corner, _)| (*ends, *corner));
    let pairs = sides.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    pairs
        .map(|pair| {
            let [(ends, c, one), (_, d, other)] = [pair[0], pair[1]];
            let length = place(ends[0]).distance(place(ends[1]));
            Hinge {
                vertices: [ends[0], ends[1], c, d],
                stiffness: rigidity * length * length / (one + other),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fold_has_the_energy_of_a_plate() {
        // A strip of squares, bent around its cross edges to a curvature of 1/m: each edge turns by its spacing.
        let (squares, side, rigidity) = (10_u32, 0.1_f32, 6.0e-6);
        let positions: Vec<[f32; 3]> = (0..=squares)
            .flat_map(|column| [0.0, side].map(|z| [column as f32 * side, 0.0, z]))
            .collect();
        let triangles: Vec<[u32; 3]> = (0..squares)
            .flat_map(|column| {
                let a = 2 * column;
                [[a, a + 1, a + 2], [a + 2, a + 1, a + 3]]
            })
            .collect();
        let hinges = hinges(&positions, &triangles, rigidity);
        assert_eq!(hinges.len() as u32, 2 * squares - 1);
        let crosses = hinges.iter().filter(|hinge| {
            hinge.vertices[1] == hinge.vertices[0] + 1 && hinge.vertices[0] % 2 == 0
        });
        let energy: f32 = crosses
            .map(|hinge| 0.5 * hinge.stiffness * side * side)
            .sum();
        // Nothing folds at the ends.
        let area = (squares - 1) as f32 * side * side;
        assert!((energy / (0.5 * rigidity * area) - 1.0).abs() < 1.0e-4);
    }
}
