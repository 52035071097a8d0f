//! Resistance to bending: that of a plate of the material's flexural rigidity.
//!
//! Between its prediction and the sweep over the springs, each sub-step moves the particles from their predicted
//! positions p to the solution y of `(M + s K) y = M p`. This is implicit Euler for bending alone, with s = Δt² and K
//! the matrix of the bending energy. That energy is quadratic in the positions as long as the cloth does not stretch
//! (Bergou et al. 2006). So K is constant, the same for x, y and z, and stable at any rigidity and sub-step. A surface
//! that is soft enough for its sub-steps is pushed by `−s K p` instead, which is as good there and costs a fraction.
//! A torn or mapped grid is pushed as a plate whose moments differ from place to place; if it is stiffer, or creases, it bends as the mesh
//! of its faces. A mesh or such a grid that is softer still and touches nothing is pushed in every second, third or fourth sub-step, for
//! all of them: by impulses, as molecules are by their slow forces (Grubmüller et al. 1991; Tuckerman, Berne and Martyna 1992).
//!
//! Where the cloth creases, its rest curvature is a state. It is constant in a tick and pushes at p, in frames that turn with the
//! cloth; as the tick ends, it follows by the return mapping of plasticity with linear kinematic hardening (Simo and Hughes 1998).

mod chains;
mod creasing;
mod factor;
mod grid;
mod grid_creases;
mod mesh;
mod mesh_creases;
mod mesh_matrix;
mod patch;
mod plate;
mod push;
mod schedule;
#[cfg(test)]
mod tests;
mod torn_creases;
mod torn_plate;

use std::sync::Arc;

use super::kernels::Kernels;
use crate::cloth::{Block, ClothMaterial, StiffnessFactors, Surface};
pub use creasing::ClothCreasing;
use grid::GridBending;
use grid_creases::GridCreases;
use mesh::MeshBending;
use mesh_creases::MeshCreases;
use mesh_matrix::{KnownMatrix, MeshMatrix};
pub(super) use schedule::BendingSchedule;
pub(crate) use torn_creases::creases_of_torn;
use torn_plate::{TornBending, TornPlate};

/// A surface's resistance to bending.
#[derive(Debug, Clone)]
pub struct Bending {
    of: Kind,
    creasing: Option<ClothCreasing>,
    factors: Arc<StiffnessFactors>,
}

#[derive(Debug, Clone)]
enum Kind {
    Grid(Box<GridBending>),
    Torn(Box<TornBending>),
    Mesh(MeshBending),
}

impl Kind {
    /// The bending of the mesh of its faces, of all but a whole grid.
    fn mesh(&self) -> Option<&MeshBending> {
        match self {
            Self::Grid(_) => None,
            Self::Torn(torn) => Some(&torn.mesh),
            Self::Mesh(mesh) => Some(mesh),
        }
    }

    /// A bound of the largest eigenvalue of its forces by mass (1/s²): of what pushes, if it is soft.
    fn bound(&self, blocks: &[Block]) -> f32 {
        match self {
            Self::Grid(grid) => grid.bound(blocks),
            Self::Torn(torn) => torn.bound(blocks),
            Self::Mesh(mesh) => mesh.bound(blocks),
        }
    }

    fn mesh_mut(&mut self) -> Option<&mut MeshBending> {
        match self {
            Self::Grid(_) => None,
            Self::Torn(torn) => Some(&mut torn.mesh),
            Self::Mesh(mesh) => Some(mesh),
        }
    }
}

impl Bending {
    /// The resistance of a surface; `None` if its material bends freely.
    pub fn new(surface: &Surface, material: &ClothMaterial) -> Option<Self> {
        Self::with_factors(surface, material, Arc::default(), None)
    }

    /// The same of a mesh whose rigidity differs from place to place. A grid takes no factors. `known` is of the same material, for a
    /// surface that was torn in another way: a mesh copies the part that does not change.
    pub(crate) fn with_factors(
        surface: &Surface,
        material: &ClothMaterial,
        factors: Arc<StiffnessFactors>,
        known: Option<(&Self, &Surface)>,
    ) -> Option<Self> {
        let rigidities = material.bend_rigidities();
        if rigidities[0].max(rigidities[1]) <= 0.0 || surface.is_empty() {
            return None;
        }
        let of = match surface.as_grid() {
            Some(grid) => Kind::Grid(Box::new(GridBending::new(grid, rigidities))),
            None => {
                let known = known.and_then(|(known, surface)| {
                    Some(KnownMatrix {
                        matrix: &known.of.mesh()?.matrix,
                        surface,
                        factors: &known.factors,
                    })
                });
                let matrix = MeshMatrix::new(surface, material.woven_bending(), &factors, known);
                let mesh = MeshBending::new(matrix, surface);
                match TornPlate::new(surface, rigidities, &factors) {
                    Some(plate) => Kind::Torn(Box::new(TornBending::new(plate, mesh))),
                    None => Kind::Mesh(mesh),
                }
            }
        };
        Some(Self {
            of,
            creasing: None,
            factors,
        })
    }

    /// Where a mesh's matrix lies, to see which ones share it.
    #[cfg(test)]
    pub(crate) fn matrix(&self) -> Option<*const f32> {
        let mesh = self.of.mesh()?;
        Some(mesh.matrix.diagonal.as_ptr())
    }

    /// In one of how many sub-steps of `dt` (s) it needs to bend, for all of them: their weights together leave it soft. For the
    /// fastest ripple ω the time between two pushes then is at most 0.9/ω, of 2/ω that are stable. A whole grid bends in each.
    pub(super) fn stride(&self, blocks: &[Block], dt: f32) -> u32 {
        match &self.of {
            Kind::Grid(_) => 1,
            of => {
                let weights = push::LIMIT / (of.bound(blocks) * dt * dt);
                (weights as u32).clamp(1, schedule::MOST_AT_ONCE)
            }
        }
    }

    /// Takes over the masses and the weight s (s²) of the forces if they have changed: Δt² for implicit Euler.
    pub(super) fn prepare(&mut self, blocks: &[Block], weight: f32) {
        match &mut self.of {
            Kind::Grid(grid) => grid.prepare(blocks, weight),
            Kind::Torn(torn) => torn.prepare(blocks, weight),
            Kind::Mesh(mesh) => mesh.prepare(blocks, weight),
        }
    }

    /// Changes displacements by the implicit effect of the bending moments.
    pub(super) fn solve(&mut self, blocks: &mut [Block], kernels: &Kernels) {
        match &mut self.of {
            Kind::Grid(grid) => grid.solve(blocks, kernels),
            Kind::Torn(torn) => torn.solve(blocks, kernels),
            Kind::Mesh(mesh) => mesh.solve(blocks),
        }
    }

    /// The longest sub-step (s) in which it may [push](Self::push).
    pub(super) fn longest_push(&self, blocks: &[Block]) -> f32 {
        (push::LIMIT / self.of.bound(blocks)).sqrt()
    }

    /// Adds the displacements by the forces at the current positions, with this weight (s²).
    pub(super) fn push(&mut self, blocks: &mut [Block], weight: f32, kernels: &Kernels) {
        match &mut self.of {
            Kind::Grid(grid) => grid.push(blocks, weight, kernels),
            Kind::Torn(torn) => torn.push(blocks, weight, kernels),
            Kind::Mesh(mesh) => mesh.push(blocks, weight),
        }
    }

    /// Sets how `surface`, of which it is, creases; `None` for not at all. It needs the material that it was made with.
    pub fn set_creasing(
        &mut self,
        surface: &Surface,
        material: &ClothMaterial,
        creasing: Option<ClothCreasing>,
    ) {
        self.creasing = creasing;
        if let (Kind::Grid(grid), Some(of)) = (&mut self.of, surface.as_grid()) {
            let new = || Box::new(GridCreases::new(of, &grid.plate));
            grid.creases = creasing.map(|_| grid.creases.take().unwrap_or_else(new));
        } else if let Some(mesh) = self.of.mesh_mut() {
            let rigidity = material.woven_bending();
            let new = || Box::new(MeshCreases::new(surface, rigidity, &self.factors));
            mesh.creases = creasing.map(|_| mesh.creases.take().unwrap_or_else(new));
        }
    }

    /// The rest curvatures of its creases; none if it does not crease.
    pub fn creases(&self) -> &[f32] {
        let creases = match &self.of {
            Kind::Grid(grid) => grid.creases.as_ref().map(|of| of.rest()),
            of => (of.mesh()).and_then(|mesh| Some(mesh.creases.as_ref()?.rest())),
        };
        creases.unwrap_or_default()
    }

    /// Takes over rest curvatures of earlier; none if they are not of this surface.
    pub(super) fn recall_creases(&mut self, creases: &[f32]) {
        if let Kind::Grid(grid) = &mut self.of {
            grid.creases.iter_mut().for_each(|of| of.recall(creases));
        } else if let Some(mesh) = self.of.mesh_mut() {
            mesh.creases.iter_mut().for_each(|of| of.recall(creases));
        }
    }

    /// Creases it where it is bent beyond its yield curvature.
    pub(super) fn crease(&mut self, blocks: &[Block]) {
        let Some(creasing) = &self.creasing else {
            return;
        };
        if let Kind::Grid(grid) = &mut self.of {
            grid.creases
                .iter_mut()
                .for_each(|of| of.flow(creasing, blocks));
        } else if let Some(mesh) = self.of.mesh_mut() {
            mesh.creases
                .iter_mut()
                .for_each(|of| of.flow(creasing, blocks));
        }
    }
}
