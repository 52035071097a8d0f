//! Springs between arbitrary particles.

use std::{cmp::Ordering, ops::Range};

use crate::cloth::{
    arrays::distinct,
    grid::ClothGrid,
    material::ClothStiffening,
    spring::{Spring, SpringKind},
    surface::Chains,
};

/// Springs between arbitrary particles, colour by colour.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct SpringList {
    pub springs: Vec<Spring>,
    pub colours: Vec<Range<usize>>,
    /// Springs that are solved together, after the sweep over the others.
    pub chains: Chains,
    /// How all of them stiffen.
    pub stiffening: Option<ClothStiffening>,
    /// Springs between the first particles are along the rows, columns and diagonals of this grid, which is torn or mapped. Only
    /// those of other particles are on `chains`.
    pub grid: Option<ClothGrid>,
}

impl SpringList {
    /// Adds springs between `particles` particles, in colours of their own. Each takes the first colour that is free at
    /// both of its ends. Returns the index of each.
    pub(super) fn add(&mut self, springs: &[Spring], particles: usize) -> Vec<u32> {
        let mut taken: Vec<u64> = vec![0; particles];
        let mut colour_of = Vec::with_capacity(springs.len());
        for (index, spring) in springs.iter().enumerate() {
            let [a, b] = spring.ends.map(|end| end as usize);
            // Beyond 63 springs at a particle, each further spring gets its own colour.
            let free = (!(taken[a] | taken[b])).trailing_zeros().min(63);
            let colour = if free < 63 {
                taken[a] |= 1 << free;
                taken[b] |= 1 << free;
                free as usize
            } else {
                63 + index
            };
            colour_of.push(colour);
        }
        let mut order: Vec<usize> = (0..springs.len()).collect();
        order.sort_by_key(|index| colour_of[*index]);
        let mut places = vec![0; springs.len()];
        for group in order.chunk_by(|a, b| colour_of[*a] == colour_of[*b]) {
            let start = self.springs.len();
            for &index in group {
                places[index] = self.springs.len() as u32;
                self.springs.push(springs[index]);
            }
            self.colours.push(start..self.springs.len());
        }
        places
    }

    /// The compliances of the springs along a grid (m/N), by the particle that each begins at; NaN where there is none.
    /// They lead to the right, down, and to the right in the row below and in the row above.
    pub fn on_grid(&self, grid: &ClothGrid) -> [Vec<f32>; 4] {
        let columns = grid.columns();
        let [mut across, mut down, mut falling, mut rising] =
            [(); 4].map(|()| vec![f32::NAN; grid.len()]);
        let is_on_grid = |spring: &&Spring| spring.ends.iter().all(|end| *end < grid.len() as u32);
        for spring in self.springs.iter().filter(is_on_grid) {
            let [a, b] = spring.ends;
            let [upper, lower] = [a.min(b), a.max(b)];
            let is_across = upper / columns == lower / columns;
            let (kind, begin) = match (upper % columns).cmp(&(lower % columns)) {
                _ if is_across => (&mut across, upper),
                Ordering::Equal => (&mut down, upper),
                Ordering::Less => (&mut falling, upper),
                Ordering::Greater => (&mut rising, lower),
            };
            kind[begin as usize] = spring.compliance;
        }
        [across, down, falling, rising]
    }

    /// The springs of the particles from this one on, whose ends are numbers in the list of particles that is returned, too.
    pub fn beyond(&self, first: u32) -> (Self, Vec<u32>) {
        let is_beyond = |spring: &Spring| spring.ends.iter().any(|end| *end >= first);
        let chosen = (0..self.springs.len()).filter(|at| is_beyond(&self.springs[*at]));
        let chosen: Vec<usize> = chosen.collect();
        let ends = chosen.iter().flat_map(|at| self.springs[*at].ends);
        let particles = distinct(ends);
        let number = |particle: u32| particles.partition_point(|other| *other < particle) as u32;
        let renamed = |at: &usize| {
            let spring = self.springs[*at];
            let ends = spring.ends.map(number);
            Spring { ends, ..spring }
        };
        let springs: Vec<Spring> = chosen.iter().map(renamed).collect();
        let mut list = Self {
            stiffening: self.stiffening,
            ..Self::default()
        };
        // As in this list, those along edges come last.
        let is_across = |spring: &Spring| spring.kind != SpringKind::Structural;
        let (across, along) = springs.split_at(springs.partition_point(is_across));
        list.add(across, particles.len());
        let places = list.add(along, particles.len());
        list.chains = self.chains.renamed(|edge| {
            let at = chosen.partition_point(|other| *other < edge as usize);
            places[at - across.len()]
        });
        for chain in list.chains.colours.iter_mut().flatten() {
            chain.first = number(chain.first);
        }
        (list, particles)
    }
}
