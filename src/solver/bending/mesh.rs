//! The bending of a mesh, from the curvature of its faces.
//!
//! Across an edge, the difference of the two faces' slopes is linear in the four positions; on a quadratic surface it
//! is linear in the curvature. Three edges give all three numbers of a face's curvature, exactly on any triangles. So
//! the energy `½ D Σ A (κ_xx² + 2 κ_xy² + κ_yy²)` of such a surface does not depend on the triangulation. The forces do, so the
//! triangles are those of [`Surface::bending_faces`]. A woven mesh has x along its warp and
//! `½ Σ A (D_warp κ_xx² + 2 √(D_warp D_weft) κ_xy² + D_weft κ_yy²)`.
//!
//! ```text
//!  ――― o ―――      a face and the three beside it: six particles;
//!   \ / \ /       κ = P H x, with the slopes' differences H x
//!    o ― o        and P the inverse of what they are of κ
//!     \ /
//!      o
//! ```
//! (a rotation-free shell as Oñate and Zárate 2000 have it; quadratic like Bergou et al. 2006, whose one number an edge depends on
//! the triangles by a factor of three). On a border, where edges have one face, the smallest curvature counts that agrees with the
//! others. A mesh that is curved at rest has rest curvatures, which turn with each face.
//!
//! `(M + s K) e = −s K p` is solved by conjugate gradients. Cloth that is soft for its spacing and sub-steps is pushed by `−s K p`
//! instead, like a grid.

use std::sync::Arc;

use bevy::math::{Vec3A, Vec4};

use super::{
    mesh_creases::MeshCreases,
    mesh_matrix::MeshMatrix,
    patch::frame,
    push::{LIMIT, largest_bound},
};
use crate::cloth::{Block, LANES, Lanes, Layout, MapInline, Surface, W};

/// The residual that is left, in parts of the first one's (by the norm of the preconditioner).
const TOLERANCE: f32 = 1.0e-4;
/// Iterations at most, and particles times iterations. A small mesh that is stiff for its spacing needs hundreds; beyond that it is
/// too soft.
const MAX_ITERATIONS: usize = 400;
const FEWEST_ITERATIONS: usize = 40;
const MAX_WORK: usize = 200_000;

/// A particle during a solve. The data that its neighbours read lies apart, close together.
#[derive(Debug, Default, Clone, Copy)]
struct Row {
    /// The solution to add to `moved`, and the residual.
    added: Vec4,
    left: Vec4,
    /// The matrix times the conjugate direction.
    image: Vec4,
    /// kg, or 0 of a pinned particle.
    mass: f32,
    /// Inverse diagonal of the matrix (1/kg), or 0.
    inverse: f32,
}

/// A mesh's bending matrix.
#[derive(Debug, Clone)]
pub(super) struct MeshBending {
    layout: Layout,
    pub matrix: Arc<MeshMatrix>,
    pub creases: Option<Box<MeshCreases>>,
    /// Sum of the absolute values of each particle's row (N/m), by block.
    bounds: Arc<[Lanes]>,
    /// s (s²).
    weight: f32,
    /// Whether forces push it, as it was prepared.
    is_soft: bool,
    rows: Vec<Row>,
    /// Places and displacements (m).
    places: Vec<[Vec4; 2]>,
    /// Conjugate directions.
    directions: Vec<Vec4>,
}

impl MeshBending {
    /// Of the matrix of a surface.
    pub fn new(matrix: MeshMatrix, surface: &Surface) -> Self {
        let layout = surface.layout();
        let mut bounds = vec![[0.0; LANES]; layout.blocks()];
        for (row, slot) in layout.slots().enumerate() {
            let beside = matrix.of(row).iter();
            let sum = beside.map(|(_, number)| number.abs()).sum::<f32>() + matrix.diagonal[row];
            bounds[slot.block][slot.lane] = sum;
        }
        Self {
            layout,
            bounds: bounds.into(),
            is_soft: true,
            creases: None,
            weight: 0.0,
            rows: vec![Row::default(); matrix.len()],
            directions: vec![Vec4::ZERO; matrix.len()],
            places: vec![[Vec4::ZERO; 2]; matrix.len()],
            matrix: Arc::new(matrix),
        }
    }

    pub fn prepare(&mut self, blocks: &[Block], weight: f32) {
        self.weight = weight;
        self.is_soft = weight * self.bound(blocks) < LIMIT;
        if self.is_soft {
            return;
        }
        let slots = self.layout.slots();
        for ((row, slot), diagonal) in self.rows.iter_mut().zip(slots).zip(&self.matrix.diagonal) {
            let inverse_mass = blocks[slot.block].view()[W + slot.lane];
            (row.mass, row.inverse) = if inverse_mass > 0.0 {
                let mass = 1.0 / inverse_mass;
                (mass, 1.0 / (mass + weight * diagonal))
            } else {
                (0.0, 0.0)
            };
        }
    }

    /// A bound of the largest eigenvalue of `s M⁻¹ K` at s = 1 (1/s²).
    pub fn bound(&self, blocks: &[Block]) -> f32 {
        largest_bound(blocks, &self.bounds)
    }

    /// Takes places and displacements.
    fn load(&mut self, blocks: &[Block]) {
        for run in self.layout.runs() {
            let places = &mut self.places[run.index..][..run.count];
            for (place, block) in places.iter_mut().zip(&blocks[run.block..]) {
                let (position, moved) = (block.position(run.lane), block.displacement(run.lane));
                *place = [position.extend(0.0), moved.extend(0.0)];
            }
        }
    }

    /// Adds what the forces at the positions make of displacements with this weight (s²).
    pub fn push(&mut self, blocks: &mut [Block], weight: f32) {
        self.load(blocks);
        for [_, moved] in &mut self.places {
            *moved = Vec4::ZERO;
        }
        self.add_forces(blocks, weight);
    }

    /// Adds what the forces make of displacements with this weight (s²).
    fn add_forces(&mut self, blocks: &mut [Block], weight: f32) {
        self.set_forces();
        for run in self.layout.runs() {
            let rows = &self.rows[run.index..][..run.count];
            for (row, block) in rows.iter().zip(&mut blocks[run.block..]) {
                let given = weight * block.inverse_mass(run.lane) * row.left;
                block.displace(run.lane, given.truncate());
            }
        }
    }

    /// Changes displacements by the implicit effect of the bending moments, or, where it is soft, by their forces.
    pub fn solve(&mut self, blocks: &mut [Block]) {
        self.load(blocks);
        if self.is_soft {
            self.add_forces(blocks, self.weight);
            return;
        }
        self.set_right_side();
        for row in &mut self.rows {
            row.added = Vec4::ZERO;
        }
        if !self.conjugate_gradients() {
            return;
        }
        self.add(blocks);
        if self.creases.as_ref().is_some_and(|of| !of.is_flat()) {
            self.aim_again();
            if self.conjugate_gradients() {
                self.add(blocks);
            }
        }
    }

    /// Adds the solution to the displacements.
    fn add(&self, blocks: &mut [Block]) {
        for (row, slot) in self.rows.iter().zip(self.layout.slots()) {
            blocks[slot.block].displace(slot.lane, row.added.truncate());
        }
    }

    /// Turns the forces of creases to where the solution leads, for what that adds to it. Forces from where it came from turn
    /// the cloth: a creased strip at rest began to turn by a degree in a second.
    fn aim_again(&mut self) {
        self.push_creases(-self.weight);
        for (row, [_, moved]) in self.rows.iter_mut().zip(&mut self.places) {
            *moved += row.added;
            row.added = Vec4::ZERO;
        }
        self.push_creases(self.weight);
        for row in self.rows.iter_mut().filter(|row| row.mass == 0.0) {
            row.left = Vec4::ZERO;
        }
    }

    /// Adds the forces of creases times this to `left`.
    fn push_creases(&mut self, weight: f32) {
        let Some(creases) = &self.creases else {
            return;
        };
        let (places, rows) = (&self.places, &mut self.rows);
        let at = |particle: u32| {
            let [place, moved] = places[particle as usize];
            (place + moved).truncate()
        };
        creases.push(at, |particle, force| {
            rows[particle as usize].left += weight * force.extend(0.0);
        });
    }

    /// `left` becomes −K p, less what the rest curvatures want.
    fn set_forces(&mut self) {
        for at in 0..self.rows.len() {
            let [place, moved] = self.places[at];
            let mut sum = Vec4::ZERO;
            for &(other, number) in self.matrix.of(at) {
                let [there, moved_there] = self.places[other as usize];
                sum += number * ((there - place) + (moved_there - moved));
            }
            self.rows[at].left = -sum;
        }
        for face in &self.matrix.rest {
            let [a, b, c, ..] = face.particles;
            let corners = [a, b, c].map_inline(|at| {
                let [place, moved] = self.places[at as usize];
                Vec3A::from_vec4(place + moved)
            });
            let Some(frame) = frame(corners) else {
                continue;
            };
            let [x, y, z] = frame.map_inline(|axis| axis.extend(0.0));
            for (&particle, &[along, beside, out]) in face.particles.iter().zip(&face.forces) {
                self.rows[particle as usize].left += x * along + y * beside + z * out;
            }
        }
        self.push_creases(1.0);
    }

    /// `left` becomes s times the forces, 0 of pinned particles.
    fn set_right_side(&mut self) {
        self.set_forces();
        for row in &mut self.rows {
            row.left = match row.mass > 0.0 {
                true => row.left * self.weight,
                false => Vec4::ZERO,
            };
        }
    }

    /// Solves for `added`, preconditioned by the diagonal. Returns whether there was anything to do.
    fn conjugate_gradients(&mut self) -> bool {
        let mut norm = 0.0;
        for (row, direction) in self.rows.iter().zip(&mut self.directions) {
            *direction = row.left * row.inverse;
            norm += direction.dot(row.left);
        }
        // Of nothing, or of next to nothing, nothing comes.
        let is_something = |norm: f32| norm > 1.0e-34;
        if !is_something(norm) {
            return norm.is_nan();
        }
        let enough = norm * TOLERANCE * TOLERANCE;
        let affordable = MAX_WORK / self.rows.len().max(1);
        let matrix = &*self.matrix;
        for _ in 0..affordable.clamp(FEWEST_ITERATIONS, MAX_ITERATIONS) {
            let mut energy = 0.0;
            for at in 0..self.rows.len() {
                let (row, own) = (&mut self.rows[at], self.directions[at]);
                let mut sum = matrix.diagonal[at] * own;
                for &(other, number) in matrix.of(at) {
                    sum += number * self.directions[other as usize];
                }
                row.image = row.mass * own + self.weight * sum;
                energy += own.dot(row.image);
            }
            let step = norm / energy;
            let before = norm;
            norm = 0.0;
            for (row, direction) in self.rows.iter_mut().zip(&self.directions) {
                row.added += step * *direction;
                // Nothing pulls at a pinned particle: its inverse is 0.
                row.left -= step * row.image;
                norm += row.inverse * row.left.dot(row.left);
            }
            if norm <= enough || !is_something(norm) {
                break;
            }
            let kept = norm / before;
            for (row, direction) in self.rows.iter().zip(&mut self.directions) {
                *direction = row.left * row.inverse + kept * *direction;
            }
        }
        true
    }
}

#[cfg(test)]
impl MeshBending {
    /// Whether forces push it, as it was prepared.
    pub fn is_soft(&self) -> bool {
        self.is_soft
    }
}
