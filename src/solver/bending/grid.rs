//! The bending of a grid: pushed by its forces where it is soft, solved where it is stiff.

use super::{
    chains::ChainBending,
    grid_creases::GridCreases,
    plate::Plate,
    push::{LIMIT, Push},
};
use crate::{
    cloth::{Block, ClothGrid},
    solver::kernels::Kernels,
};

/// The largest of the weights that take turns, over the smallest: where one of them needs factors, room for them is made at once.
const SPREAD: f32 = 9.0 / 4.0;

/// A grid's resistance to bending.
#[derive(Debug, Clone)]
pub(super) struct GridBending {
    pub plate: Plate,
    push: Push,
    /// From when it first may be needed.
    chains: Option<ChainBending>,
    pub creases: Option<Box<GridCreases>>,
    weight: f32,
    is_soft: bool,
}

impl GridBending {
    /// Of a plate of these flexural rigidities along rows and along columns (N·m).
    pub fn new(grid: &ClothGrid, rigidities: [f32; 2]) -> Self {
        let plate = Plate::new(grid, rigidities);
        Self {
            push: Push::new(&plate),
            plate,
            chains: None,
            creases: None,
            weight: 0.0,
            is_soft: true,
        }
    }

    pub fn prepare(&mut self, blocks: &[Block], weight: f32) {
        self.weight = weight;
        let bound = self.push.bound(blocks, weight);
        self.is_soft = bound < LIMIT;
        if bound * SPREAD < LIMIT {
            return;
        }
        let chains = self
            .chains
            .get_or_insert_with(|| ChainBending::new(&self.plate));
        if !self.is_soft {
            chains.prepare(blocks, weight);
        }
    }

    pub fn solve(&mut self, blocks: &mut [Block], kernels: &Kernels) {
        let weight = self.weight;
        if let Some(creases) = &mut self.creases {
            creases.aim(blocks, 1.0);
        }
        let push = |family, blocks: &mut [Block]| {
            if let Some(creases) = &self.creases {
                creases.push(family, weight, blocks);
            }
        };
        match &mut self.chains {
            Some(chains) if !self.is_soft => {
                chains.solve(blocks, kernels, |family, blocks| push(Some(family), blocks));
            }
            _ => {
                self.push.apply(blocks, 1.0, weight, kernels);
                push(None, blocks);
            }
        }
    }

    /// The bound of pushes with a weight of 1 s².
    pub fn bound(&self, blocks: &[Block]) -> f32 {
        self.push.bound(blocks, 1.0)
    }

    /// Adds what the forces at the positions make of displacements with this weight (s²).
    pub fn push(&mut self, blocks: &mut [Block], weight: f32, kernels: &Kernels) {
        if let Some(creases) = &mut self.creases {
            // Displacements have no part in either.
            creases.aim(blocks, 0.0);
            creases.push(None, weight, blocks);
        }
        self.push.apply(blocks, 0.0, weight, kernels);
    }

    /// Whether forces push it, as it was prepared.
    #[cfg(test)]
    pub fn is_soft(&self) -> bool {
        self.is_soft
    }

    /// Whether it has room for factors.
    #[cfg(test)]
    pub fn has_factors(&self) -> bool {
        self.chains.is_some()
    }
}
