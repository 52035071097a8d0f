//! A sub-step over threads in several bands: of blocks side by side where threads lead from row to row, of rows where they lead
//! within them.

use super::{
    Direction, ThreadSweep,
    beside::Beside,
    largest,
    link::Family,
    rows::{GROUP, RowSystems},
};
use crate::{
    cloth::{Block, LANES, Lanes, Layout},
    solver::{
        Stretch,
        bands::{MAX_BANDS, in_bands, take},
        kernel::{Kernels, Longest},
        sweep::{Motion, Swept},
    },
};

/// Rows that lie one below the other, and what solves them.
pub(super) struct Part<'a> {
    pub blocks: &'a mut [Block],
    pub first_row: usize,
    pub systems: &'a mut RowSystems,
    /// To be raised to the squares of what springs give at their tension (m²).
    pub given: Option<&'a mut Lanes>,
}

impl Part<'_> {
    /// Solves the threads within its rows, of a kind on the grid's borders and one that is not.
    pub fn solve(mut self, layout: Layout, families: &[Family; 2], kernels: &Kernels) {
        let strip = layout.strip as usize;
        let springs = layout.columns as usize - 1;
        let mut row = self.first_row;
        for blocks in self.blocks.chunks_mut(strip * GROUP) {
            let count = blocks.len() / strip;
            let is_border = [row == 0, row + count == layout.rows as usize];
            let systems = &mut *self.systems;
            systems.solve(blocks, families, is_border, springs, kernels);
            if let Some(given) = &mut self.given {
                systems.measure_given(families, is_border, count, kernels, given);
            }
            row += count;
        }
    }
}

/// What a band found.
#[derive(Default, Clone, Copy)]
struct Found {
    given: Lanes,
    moved: Lanes,
    longest: Longest,
}

impl ThreadSweep {
    /// A sub-step in this many bands, more than one.
    pub(super) fn substep_in_bands(
        &mut self,
        blocks: &mut [Block],
        motion: &Motion,
        bands: usize,
    ) -> Swept {
        let (kernels, measures) = (motion.kernels, motion.measures);
        if let Some(family) = &self.diagonal {
            for direction in [Direction::Right, Direction::Left] {
                let strip = self.layout.strip as usize;
                let (links, pulls) = (&mut self.links[..], &mut self.pulls);
                let all = Beside::split(direction, (strip, bands), blocks, links, pulls);
                in_bands(all, |mut band| band.solve(family, kernels, None));
            }
        }
        let across = self.across_in_bands(blocks, motion, bands) / self.across[0].rest;
        let mut found = [Found::default(); MAX_BANDS];
        let (strip, down) = (self.layout.strip as usize, &self.down);
        let (links, pulls) = (&mut self.links[..], &mut self.pulls);
        let all = Beside::split(Direction::Down, (strip, bands), blocks, links, pulls);
        in_bands(all.into_iter().zip(&mut found), |(mut band, found)| {
            band.solve(down, kernels, measures.then_some(&mut found.given));
            for (first, blocks) in band.pieces() {
                let (tethers, anchors) = (motion.tethers, motion.anchors);
                tethers.pull(anchors, blocks, first, kernels);
                (kernels.commit)(blocks, &mut found.moved);
            }
        });
        let rows = self.layout.rows as usize;
        let stretch = measures.then(|| {
            let down = merged(&found, |found| &found.given);
            let border = |band| rows * band / bands;
            let parts = (0..bands).zip(&mut found);
            let blocks = &*blocks;
            in_bands(parts, |(band, found)| {
                let rows = border(band)..border(band + 1);
                found.longest = self.measure_rows(blocks, rows, kernels);
            });
            let mut longest = Longest::default();
            for found in &found[..bands] {
                longest.merge(&found.longest);
            }
            Stretch {
                material: across.max(largest(&down) / self.down.rest),
                ..self.stretch(&longest)
            }
        });
        let moved = merged(&found, |found| &found.moved);
        Swept { moved, stretch }
    }

    /// Solves the threads within rows. Returns the most that a spring gives (m), if that is to be measured.
    fn across_in_bands(&mut self, blocks: &mut [Block], motion: &Motion, bands: usize) -> f32 {
        let strip = self.layout.strip as usize;
        let rows = self.layout.rows as usize;
        let groups = rows.div_ceil(GROUP);
        let border = |band: usize| (groups * band / bands * GROUP).min(rows);
        if self.systems.len() < bands {
            self.systems.resize(bands, RowSystems::new(strip));
        }
        let mut found = [Found::default(); MAX_BANDS];
        let mut rest = blocks;
        let each = self.systems.iter_mut().zip(&mut found).take(bands);
        let parts = each.enumerate().map(|(band, (systems, found))| Part {
            blocks: take(&mut rest, (border(band + 1) - border(band)) * strip),
            first_row: border(band),
            systems,
            given: motion.measures.then_some(&mut found.given),
        });
        let (layout, families) = (self.layout, &self.across);
        in_bands(parts, |part| part.solve(layout, families, motion.kernels));
        largest(&merged(&found, |found| &found.given))
    }
}

/// The largest number of each lane.
fn merged(all: &[Found], lanes: impl Fn(&Found) -> &Lanes) -> Lanes {
    let larger = |mut largest: Lanes, found: &Found| {
        for (largest, own) in largest.iter_mut().zip(lanes(found)) {
            *largest = largest.max(*own);
        }
        largest
    };
    all.iter().fold([0.0; LANES], larger)
}
