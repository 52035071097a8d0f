//! Threads that lead from row to row, in bands side by side that are solved at the same time.
//!
//! A diagonal is a block farther in each row, or one less far; at the last block it goes on in the first, a lane beside. So a band
//! is a range of blocks that moves along from row to row, in two pieces where it is at the border. Its links are in the order of
//! its threads. Each thread's numbers are those that it would have in one band, to the last bit.

use std::{ops::Range, slice};

use super::{
    direction::Direction,
    down::Pull,
    link::{Family, Link, from_left},
};
use crate::{
    cloth::{Block, Lanes},
    solver::{bands::take, kernel::Kernels},
};

/// Some of the threads of one direction.
pub(super) struct Beside<'a> {
    direction: Direction,
    strip: usize,
    /// Where its first threads are in the first row.
    from: usize,
    /// Blocks in a row.
    width: usize,
    /// Up to the last block of the strip, and from its first on.
    rows: Vec<[&'a mut [Block]; 2]>,
    links: &'a mut [Link],
    next: &'a mut [Pull],
    pulls: &'a mut [Pull],
}

impl<'a> Beside<'a> {
    /// Splits all threads of a direction.
    pub fn split(
        direction: Direction,
        (strip, bands): (usize, usize),
        blocks: &'a mut [Block],
        mut links: &'a mut [Link],
        [next, pulls]: &'a mut [Vec<Pull>; 2],
    ) -> Vec<Self> {
        let rows = blocks.len() / strip;
        let (mut next, mut pulls) = (&mut next[..], &mut pulls[..]);
        let border = |band| strip * band / bands;
        let band = |band| {
            let width = border(band + 1) - border(band);
            Self {
                direction,
                strip,
                from: border(band),
                width,
                rows: Vec::with_capacity(rows),
                links: take(&mut links, width * rows),
                next: take(&mut next, width),
                pulls: take(&mut pulls, width),
            }
        };
        let mut all: Vec<Self> = (0..bands).map(band).collect();
        for (row, blocks) in blocks.chunks_exact_mut(strip).enumerate() {
            let (mut low, mut high) = blocks.split_at_mut(direction.shift(row, strip));
            for band in &mut all {
                let up_to_last = band.width.min(high.len());
                let pieces = [
                    take(&mut high, up_to_last),
                    take(&mut low, band.width - up_to_last),
                ];
                band.rows.push(pieces);
            }
        }
        all
    }

    /// Solves them. Raises `given` to the squares of what the springs of columns give at their tension (m²).
    pub fn solve(&mut self, family: &Family, kernels: &Kernels, mut given: Option<&mut Lanes>) {
        let springs = self.rows.len() - 1;
        // The links before the first row's are none: so are those of the last row, where no spring begins.
        (kernels.clear)(&mut self.links[springs * self.width..], self.next);
        for row in 0..springs {
            self.forward(row, family, kernels);
        }
        for row in (0..springs).rev() {
            self.backward(row, kernels);
            if let Some(given) = &mut given {
                let softness = &family.softness[self.from..];
                (kernels.measure_given)(self.pulls, softness, given);
            }
            std::mem::swap(&mut self.next, &mut self.pulls);
        }
        let [first, _] = &mut self.rows[0];
        let wraps = usize::from(self.direction == Direction::Left && self.from == 0);
        let (wrapped, first) = first.split_at_mut(wraps);
        if wraps > 0 {
            (kernels.left_heads)(wrapped, &self.next[..wraps]);
        }
        (kernels.column_heads)(first, &self.next[wraps..]);
    }

    /// Its blocks of each row, with the number of the first.
    pub fn pieces(&mut self) -> impl Iterator<Item = (usize, &mut [Block])> {
        let (direction, strip, from) = (self.direction, self.strip, self.from);
        self.rows
            .iter_mut()
            .enumerate()
            .flat_map(move |(row, pieces)| {
                let first = (from + direction.shift(row, strip)) % strip;
                let [high, low] = pieces;
                let firsts = [row * strip + first, row * strip];
                firsts.into_iter().zip([&mut **high, &mut **low])
            })
    }

    /// The block of a row in which its thread is.
    fn block(&self, row: usize, thread: usize) -> usize {
        (self.from + self.direction.shift(row, self.strip) + thread) % self.strip
    }

    fn forward(&mut self, row: usize, family: &Family, kernels: &Kernels) {
        let (width, strip, direction) = (self.width, self.strip, self.direction);
        let last = strip - 1;
        let mut at = 0;
        while at < width {
            let block = self.block(row, at);
            // As far as both ends are side by side.
            let count = match direction {
                Direction::Down => width,
                Direction::Right if block > 0 && block < last => last - block,
                Direction::Right => 1,
                Direction::Left if block == 0 => 1,
                Direction::Left => strip - block,
            };
            let these = at..(at + count).min(width);
            at = these.end;
            let upper = piece(&self.rows[row], these.clone());
            let lower = piece(&self.rows[row + 1], these.clone());
            let (before, own) = self.links.split_at_mut(row * width);
            let (own, after) = own.split_at_mut(width);
            let before = match row {
                0 => &after[after.len() - width..],
                _ => &before[(row - 1) * width..],
            };
            let (before, links) = (&before[these.clone()], &mut own[these]);
            let forward = kernels.column_forward;
            match direction {
                Direction::Right if block == last => {
                    let shifted = lower[0].to_shifted();
                    let lower = slice::from_ref(&shifted);
                    forward(upper, lower, before, links, family, last);
                }
                Direction::Right if block == 0 => {
                    let wrapped = before[0].moved_right();
                    let before = slice::from_ref(&wrapped);
                    forward(upper, lower, before, links, family, 0);
                }
                Direction::Left if block == 0 => {
                    let shifted = upper[0].to_shifted();
                    let wrapped = before[0].moved_left();
                    let (upper, before) = (slice::from_ref(&shifted), slice::from_ref(&wrapped));
                    forward(upper, lower, before, links, family, last);
                }
                Direction::Left => forward(upper, lower, before, links, family, block - 1),
                Direction::Down | Direction::Right => {
                    forward(upper, lower, before, links, family, block);
                }
            }
        }
    }

    fn backward(&mut self, row: usize, kernels: &Kernels) {
        let (width, direction) = (self.width, self.direction);
        let mut at = 0;
        while at < width {
            let block = self.block(row + 1, at);
            let wraps = block == 0 && direction != Direction::Down;
            let count = if wraps { 1 } else { self.strip - block };
            let these = at..(at + count).min(width);
            at = these.end;
            let links = &self.links[row * width..][these.clone()];
            let (next, pulls) = (&self.next[these.clone()], &mut self.pulls[these.clone()]);
            let lower = piece_mut(&mut self.rows[row + 1], these);
            match direction {
                Direction::Right if wraps => (kernels.right_backward)(lower, links, next, pulls),
                Direction::Left if wraps => {
                    let wrapped = [0, 1, 2].map(|axis| from_left(&next[0][axis]));
                    (kernels.column_backward)(lower, links, slice::from_ref(&wrapped), pulls);
                }
                _ => (kernels.column_backward)(lower, links, next, pulls),
            }
        }
    }
}

impl Direction {
    /// How far a thread is to the right of where it was in the first row, in blocks.
    fn shift(self, row: usize, strip: usize) -> usize {
        match self {
            Self::Down => 0,
            Self::Right => row % strip,
            Self::Left => (strip - row % strip) % strip,
        }
    }
}

/// Blocks side by side, which are in one of both pieces.
fn piece<'a>([high, low]: &'a [&mut [Block]; 2], these: Range<usize>) -> &'a [Block] {
    match these.start.checked_sub(high.len()) {
        Some(start) => &low[start..these.end - high.len()],
        None => &high[these],
    }
}

fn piece_mut<'a>([high, low]: &'a mut [&mut [Block]; 2], these: Range<usize>) -> &'a mut [Block] {
    match these.start.checked_sub(high.len()) {
        Some(start) => &mut low[start..these.end - high.len()],
        None => &mut high[these],
    }
}
