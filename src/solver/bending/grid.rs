//! The bending of a grid: pushed by its forces where it is soft, solved where it is stiff.

use super::{
    chains::ChainBending,
    creasing::ClothCreasing,
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
    plate: Plate,
    push: Push,
    /// From when it first may be needed.
    chains: Option<ChainBending>,
    creases: Option<Box<GridCreases>>,
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
        match &mut self.creases {
            Some(_) => self.solve_creased(blocks, kernels),
            None => self.solve_flat(blocks, kernels),
        }
    }

    fn solve_flat(&mut self, blocks: &mut [Block], kernels: &Kernels) {
        match &mut self.chains {
            Some(chains) if !self.is_soft => chains.solve(blocks, kernels, |_, _| {}),
            _ => self.push.apply(blocks, 1.0, self.weight, kernels),
        }
    }

    fn solve_creased(&mut self, blocks: &mut [Block], kernels: &Kernels) {
        let Some(creases) = &mut self.creases else {
            return;
        };
        creases.aim(blocks, 1.0);
        match &mut self.chains {
            Some(chains) if !self.is_soft => {
                let weight = self.weight;
                chains.solve(blocks, kernels, |family, blocks| {
                    creases.push(Some(family), weight, blocks);
                });
            }
            _ => {
                self.push.apply(blocks, 1.0, self.weight, kernels);
                creases.push(None, self.weight, blocks);
            }
        }
    }

    /// The longest sub-step in which it is soft enough to be pushed (s).
    pub fn longest_push(&self, blocks: &[Block]) -> f32 {
        (LIMIT / self.push.bound(blocks, 1.0)).sqrt()
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

    /// Has it crease from now on, or not any more.
    pub fn set_creasing(&mut self, grid: &ClothGrid, creasing: Option<ClothCreasing>) {
        match (creasing, &mut self.creases) {
            (Some(creasing), Some(known)) => known.set(creasing),
            (Some(creasing), none) => {
                let new = GridCreases::new(grid, &self.plate, creasing);
                *none = Some(Box::new(new));
            }
            (None, known) => *known = None,
        }
    }

    pub fn creases(&self) -> Option<&GridCreases> {
        self.creases.as_deref()
    }

    pub fn creases_mut(&mut self) -> Option<&mut GridCreases> {
        self.creases.as_deref_mut()
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
