//! The bending of a grid that is torn or mapped: that of a plate, whose moments differ from place to place. Moments of particles that
//! tears made are in a list.

use bevy::math::Vec3;

use super::{
    mesh::MeshBending,
    plate::Plate,
    push::{LIMIT, Push, largest_bound},
};
use crate::{
    cloth::{Block, LANES, Lanes, Layout, Slot, StencilKind, StiffnessFactors, Surface},
    solver::kernels::{Kernels, Stiffness},
};

/// The forces of a torn plate.
#[derive(Debug, Clone)]
pub(super) struct TornPlate {
    push: Push,
    /// Blocks of the grid's particles.
    blocks: usize,
    moments: Vec<Moment>,
    /// Bounds of each particle's sum of K (N/m), by block.
    bounds: Vec<Lanes>,
}

/// A moment with particles that tears made.
#[derive(Debug, Clone)]
struct Moment {
    /// The parts of its particles in the second difference: 1, 1 and −2 of a chain, 1, 1, −1 and −1 of a cell.
    parts: [(Slot, f32); 4],
    /// N/m.
    stiffness: f32,
    /// N.
    value: Vec3,
}

impl TornPlate {
    /// Of these flexural rigidities along rows and along columns (N·m), times factors; `None` if the surface was no grid.
    pub fn new(
        surface: &Surface,
        rigidities: [f32; 2],
        factors: &StiffnessFactors,
    ) -> Option<Self> {
        let (grid, layout) = (surface.rest_grid()?, surface.layout());
        if layout != Layout::of_torn_grid(grid.columns(), layout.len() as u32) {
            return None;
        }
        let plate = Plate::new(grid, rigidities);
        let (of_grid, count) = (plate.layout, grid.len() as u32);
        let mut stiffness = vec![Stiffness::default(); of_grid.blocks()];
        let mut bounds = vec![[0.0; LANES]; layout.blocks()];
        let mut moments = Vec::new();
        surface.for_each_stencil(|kind, at, of| {
            let (parts, factor) = match kind {
                StencilKind::Twist => ([1.0, 1.0, -1.0, -1.0], factors.mean_bending(&of)),
                // A chain is that of a strip of half the width, on one side of it.
                _ => ([1.0, 1.0, -2.0, 0.0], factors.mean_bending(&of[2..3]) / 2.0),
            };
            let parts: [(u32, f32); 4] = std::array::from_fn(|place| (of[place], parts[place]));
            let own = plate.inside()[kind as usize] * factor;
            for (particle, part) in parts {
                let slot = layout.slot_of(particle as usize);
                bounds[slot.block][slot.lane] += 4.0 * own * part.abs();
            }
            if parts.iter().all(|(particle, _)| *particle < count) {
                let slot = of_grid.slot_of(at as usize);
                stiffness[slot.block][kind as usize][slot.lane] += own;
            } else {
                moments.push(Moment {
                    parts: parts.map(|(particle, part)| (layout.slot_of(particle as usize), part)),
                    stiffness: own,
                    value: Vec3::ZERO,
                });
            }
        });
        Some(Self {
            push: Push::of_rows(of_grid, stiffness),
            blocks: of_grid.blocks(),
            moments,
            bounds,
        })
    }

    /// A bound of the largest eigenvalue of `s M⁻¹ K` at s = 1 (1/s²).
    pub fn bound(&self, blocks: &[Block]) -> f32 {
        largest_bound(blocks, &self.bounds)
    }

    /// Adds the forces' share to displacements, with this weight (s²): of the forces where this part of the displacements leads to.
    pub fn apply(&mut self, blocks: &mut [Block], part: f32, weight: f32, kernels: &Kernels) {
        for moment in &mut self.moments {
            let at = |slot: &Slot| {
                let block = &blocks[slot.block];
                (block.position(slot.lane), block.displacement(slot.lane))
            };
            let (first, first_moved) = at(&moment.parts[0].0);
            let mut bent = Vec3::ZERO;
            for (slot, share) in &moment.parts[1..] {
                let (place, moved) = at(slot);
                // Next to each other, so that no digit is lost.
                bent += *share * ((place - first) + part * (moved - first_moved));
            }
            moment.value = moment.stiffness * bent;
        }
        (self.push).apply(&mut blocks[..self.blocks], part, weight, kernels);
        for moment in &self.moments {
            for (slot, part) in &moment.parts {
                let block = &mut blocks[slot.block];
                let pushed = -part * weight * block.inverse_mass(slot.lane) * moment.value;
                block.displace(slot.lane, pushed);
            }
        }
    }
}

/// The bending of a grid that is torn or mapped: a plate's where it is soft and does not crease, else that of the mesh of its faces.
#[derive(Debug, Clone)]
pub(super) struct TornBending {
    plate: TornPlate,
    pub mesh: MeshBending,
    /// s (s²), and whether forces push it, as it was prepared.
    weight: f32,
    is_soft: bool,
}

impl TornBending {
    pub fn new(plate: TornPlate, mesh: MeshBending) -> Self {
        Self {
            plate,
            mesh,
            weight: 0.0,
            is_soft: true,
        }
    }

    /// A bound of the largest eigenvalue of `s M⁻¹ K` at s = 1 (1/s²).
    pub fn bound(&self, blocks: &[Block]) -> f32 {
        match self.mesh.creases {
            Some(_) => self.mesh.bound(blocks),
            None => self.plate.bound(blocks),
        }
    }

    pub fn prepare(&mut self, blocks: &[Block], weight: f32) {
        self.weight = weight;
        self.is_soft = self.mesh.creases.is_none() && weight * self.plate.bound(blocks) < LIMIT;
        if !self.is_soft {
            self.mesh.prepare(blocks, weight);
        }
    }

    /// Changes displacements by the implicit effect of the bending moments, or, where it is soft, by their forces.
    pub fn solve(&mut self, blocks: &mut [Block], kernels: &Kernels) {
        if self.is_soft {
            self.plate.apply(blocks, 1.0, self.weight, kernels);
        } else {
            self.mesh.solve(blocks);
        }
    }

    /// Adds what the forces at the positions make of displacements with this weight (s²).
    pub fn push(&mut self, blocks: &mut [Block], weight: f32, kernels: &Kernels) {
        match self.mesh.creases {
            Some(_) => self.mesh.push(blocks, weight),
            None => self.plate.apply(blocks, 0.0, weight, kernels),
        }
    }
}

#[cfg(test)]
impl TornBending {
    /// Whether forces push it, as it was prepared.
    pub fn is_soft(&self) -> bool {
        self.is_soft
    }
}
