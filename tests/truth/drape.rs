//! The drape of a disc of cloth over a smaller disc, as textile laboratories measure it.

use bevy::math::{Vec2, Vec3};

use bevy_drape::{
    cloth::{ClothError, ClothMaterial, ClothParticles, Springs, Surface, TriangleMesh},
    solver::{Bending, Solver, TickStep},
};

/// Radius of the cloth and of the disc that holds it (m).
const CLOTH: f32 = 0.15;
const DISC: f32 = 0.09;

/// A drape test (Cusick 1965): a disc of cloth, 30 cm wide, is held flat on one of 18 cm and hangs over its edge.
#[derive(Debug, Clone, Copy)]
pub struct Drape {
    /// Spacing of the mesh (m).
    pub spacing: f32,
    /// Rotation of the mesh about the vertical (°).
    pub degrees: f32,
    /// Sub-steps in 1/60 s.
    pub substeps: u32,
    /// Time to come to rest (s).
    pub seconds: f32,
}

impl Drape {
    /// The drape coefficient: the fraction of the overhanging ring that the shadow of the draped cloth covers, from 0
    /// to 1.
    ///
    /// # Errors
    /// [`ClothError`] for a material or a spacing from which no disc can be made.
    pub fn coefficient(&self, material: &ClothMaterial) -> Result<f32, ClothError> {
        let material = &ClothMaterial {
            damping: 0.03,
            ..*material
        };
        let surface = Surface::of_mesh(&self.mesh(), 0.0, Vec3::ONE)?;
        let mut particles = ClothParticles::at_rest(&surface, material)?;
        for (index, rest) in surface.rest_positions().iter().enumerate() {
            if rest.length() < DISC + 1.0e-4 {
                particles.set_inverse_mass(index, 0.0)?;
            } else {
                // A perfectly flat disc would not fold.
                let angle = rest.z.atan2(rest.x);
                let wave = (5.0 * angle).sin() + 0.5 * (3.0 * angle + 1.0).sin();
                let height = 0.02 * wave * (rest.length() - DISC);
                particles.set_position(index, *rest + Vec3::Y * height)?;
            }
        }
        let mut solver = Solver::of_surface(&surface, &Springs::of_surface(&surface, material));
        solver.set_bending(Bending::new(&surface, material));
        let step = TickStep {
            seconds: 1.0 / 60.0,
            substeps: self.substeps,
            acceleration: Vec3::NEG_Y * 9.81,
            damping: material.damping,
            ..TickStep::default()
        };
        for _ in 0..(60.0 * self.seconds) as u32 {
            solver.advance(&mut particles, step, &[], |_, _| false);
        }
        let places: Vec<Vec2> = particles
            .positions()
            .map(|place| Vec2::new(place.x, place.z))
            .collect();
        let disc = std::f32::consts::PI * DISC * DISC;
        let cloth = surface.area();
        Ok((shadow(&places, surface.triangles()) - disc) / (cloth - disc))
    }

    /// Squares with diagonals one way and the other, the outermost particles moved onto the circles.
    fn mesh(&self) -> TriangleMesh {
        let count = (CLOTH / self.spacing).round() as i32;
        let turn = Vec2::from_angle(self.degrees.to_radians());
        let side = 2 * count + 1;
        let mut positions = Vec::new();
        for row in -count..=count {
            for column in -count..=count {
                let place = self.spacing * Vec2::new(column as f32, row as f32);
                let (length, spacing) = (place.length(), self.spacing);
                let snapped = [CLOTH, DISC]
                    .into_iter()
                    .find(|radius| (length - radius).abs() < 0.5 * spacing)
                    .unwrap_or(length);
                let place = turn.rotate(place * (snapped / length.max(1.0e-9)));
                positions.push(Vec3::new(place.x, 0.0, place.y));
            }
        }
        let mut triangles = Vec::new();
        for row in 0..side - 1 {
            for column in 0..side - 1 {
                let a = (row * side + column) as u32;
                let (b, c, d) = (a + 1, a + side as u32, a + side as u32 + 1);
                triangles.extend(if (row + column) % 2 == 0 {
                    [[a, c, b], [b, c, d]]
                } else {
                    [[a, c, d], [a, d, b]]
                });
            }
        }
        let is_inside = |corner: &u32| positions[*corner as usize].length() < CLOTH + 1.0e-5;
        triangles.retain(|corners| corners.iter().all(is_inside));
        TriangleMesh {
            positions,
            triangles,
            ..Default::default()
        }
    }
}

/// Area that triangles cover, seen from above (m²), to a quarter of a millimetre.
fn shadow(places: &[Vec2], triangles: &[[u32; 3]]) -> f32 {
    const PIXEL: f32 = 5.0e-4;
    const SIDE: i32 = 700;
    let mut is_dark = vec![false; (SIDE * SIDE) as usize];
    let pixel = |at: f32| (at / PIXEL).floor() as i32 + SIDE / 2;
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| places[corner as usize]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let twice = (b - a).perp_dot(c - a);
        for row in pixel(low.y).max(0)..=pixel(high.y).min(SIDE - 1) {
            for column in pixel(low.x).max(0)..=pixel(high.x).min(SIDE - 1) {
                let middle = |at: i32| ((at - SIDE / 2) as f32 + 0.5) * PIXEL;
                let at = Vec2::new(middle(column), middle(row));
                let is_left = |from: Vec2, to: Vec2| (to - from).perp_dot(at - from) * twice >= 0.0;
                if is_left(a, b) && is_left(b, c) && is_left(c, a) {
                    is_dark[(row * SIDE + column) as usize] = true;
                }
            }
        }
    }
    let dark = is_dark.iter().filter(|dark| **dark).count();
    dark as f32 * PIXEL * PIXEL
}
