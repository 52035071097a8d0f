//! Chains that lead from row to row, all of them, or some of them in a partition beside others that are solved at the same time.
//!
//! A diagonal is a block farther in each row; at the last block it goes on in the first, a lane on. So a partition is a range of blocks
//! that moves along from row to row, in two pieces where it is at the border. Its links are in the order of its chains. Each
//! chain's numbers are those that it would have in one partition, to the last bit.

use super::{
    direction::Direction,
    link::{Before, Behind, Link},
};
use crate::{
    cloth::{Block, Lanes, Layout},
    solver::partitions::take,
};

/// Chains of one direction, beside each other.
pub(crate) struct Chains<'a> {
    pub(crate) rows: Rows<'a>,
    /// Blocks in a row.
    pub(crate) width: usize,
    /// Row by row of springs.
    pub(crate) links: &'a mut [Link],
    pub(crate) before: &'a mut [Before],
    pub(crate) behind: &'a mut [Behind],
}

/// Their rows.
pub(crate) struct Rows<'a> {
    direction: Direction,
    strip: usize,
    count: usize,
    /// The block in which the first chain is in the first row.
    from: usize,
    blocks: Blocks<'a>,
}

enum Blocks<'a> {
    /// All of the cloth.
    All(&'a mut [Block]),
    /// Of each row, in their order on the way, up to the last block of the strip, and from its first on.
    Some(Vec<[&'a mut [Block]; 2]>),
}

/// A row's blocks in the order of the chains, in two pieces.
pub(crate) struct Row<T> {
    /// The number of the first.
    pub first: usize,
    high: T,
    low: T,
}

impl Row<&[Block]> {
    #[inline(always)]
    pub fn block(&self, chain: usize) -> &Block {
        match chain.checked_sub(self.high.len()) {
            Some(chain) => &self.low[chain],
            None => &self.high[chain],
        }
    }
}

impl Row<&mut [Block]> {
    #[inline(always)]
    pub fn block(&mut self, chain: usize) -> &mut Block {
        match chain.checked_sub(self.high.len()) {
            Some(chain) => &mut self.low[chain],
            None => &mut self.high[chain],
        }
    }
}

impl Rows<'_> {
    #[inline(always)]
    pub fn strip(&self) -> usize {
        self.strip
    }

    /// The row of this number on the chains' way.
    #[inline(always)]
    pub fn at(&self, number: usize) -> Row<&[Block]> {
        let shift = self.direction.shift(number, self.strip);
        let (low, high) = match &self.blocks {
            Blocks::All(blocks) => {
                let row = self.direction.row(number, self.count);
                blocks[row * self.strip..][..self.strip].split_at(shift)
            }
            Blocks::Some(rows) => (&*rows[number][1], &*rows[number][0]),
        };
        let first = self.first(shift);
        Row { first, high, low }
    }

    #[inline(always)]
    pub fn at_mut(&mut self, number: usize) -> Row<&mut [Block]> {
        let shift = self.direction.shift(number, self.strip);
        let first = self.first(shift);
        let (low, high) = match &mut self.blocks {
            Blocks::All(blocks) => {
                let row = self.direction.row(number, self.count);
                blocks[row * self.strip..][..self.strip].split_at_mut(shift)
            }
            Blocks::Some(rows) => {
                let [high, low] = &mut rows[number];
                (&mut **low, &mut **high)
            }
        };
        Row { first, high, low }
    }

    #[inline(always)]
    fn first(&self, shift: usize) -> usize {
        let first = self.from + shift;
        if first < self.strip {
            first
        } else {
            first - self.strip
        }
    }
}

/// Memory in which chains from row to row are solved.
#[derive(Debug, Clone)]
pub(crate) struct Scratch {
    links: Vec<Link>,
    before: Vec<Before>,
    behind: Vec<Behind>,
}

impl Scratch {
    pub fn new(layout: Layout) -> Self {
        let strip = layout.strip as usize;
        Self {
            links: vec![Link::NONE; layout.blocks().saturating_sub(strip)],
            before: vec![Before::NONE; strip],
            behind: vec![Behind::NONE; strip],
        }
    }

    /// All chains of a direction.
    pub fn all<'a>(
        &'a mut self,
        direction: Direction,
        strip: usize,
        blocks: &'a mut [Block],
    ) -> Chains<'a> {
        Chains {
            rows: Rows {
                direction,
                strip,
                count: blocks.len() / strip,
                from: 0,
                blocks: Blocks::All(blocks),
            },
            width: strip,
            links: &mut self.links,
            before: &mut self.before,
            behind: &mut self.behind,
        }
    }

    /// Its memory, for other loops over the same rows.
    pub fn memory(&mut self) -> (&mut [Link], &mut [Before], &mut [Behind]) {
        (&mut self.links, &mut self.before, &mut self.behind)
    }

    /// The multipliers of all springs, after chains were solved in this many partitions: of those from each row to the next (m kg).
    pub fn multipliers(&self, strip: usize, partitions: usize, out: &mut [Lanes]) {
        let count = out.len() / strip;
        let border = |partition| strip * partition / partitions;
        let mut links = &self.links[..];
        for partition in 0..partitions {
            let blocks = border(partition)..border(partition + 1);
            for row in 0..count {
                let own = links.split_off(..blocks.len()).unwrap_or_default();
                for (out, link) in out[row * strip..][blocks.clone()].iter_mut().zip(own) {
                    *out = link.right;
                }
            }
        }
    }

    /// Splits all chains of a direction.
    pub fn split<'a>(
        &'a mut self,
        direction: Direction,
        (strip, partitions): (usize, usize),
        blocks: &'a mut [Block],
    ) -> Vec<Chains<'a>> {
        let count = blocks.len() / strip;
        let border = |partition| strip * partition / partitions;
        let width = |partition| border(partition + 1) - border(partition);
        let mut rows: Vec<_> = blocks.chunks_exact_mut(strip).collect();
        if direction == Direction::Left {
            rows.reverse();
        }
        let mut pieces: Vec<_> = (0..partitions).map(|_| Vec::with_capacity(count)).collect();
        for (number, row) in rows.into_iter().enumerate() {
            let (mut low, mut high) = row.split_at_mut(direction.shift(number, strip));
            for (partition, pieces) in pieces.iter_mut().enumerate() {
                let up_to_last = width(partition).min(high.len());
                let low = take(&mut low, width(partition) - up_to_last);
                pieces.push([take(&mut high, up_to_last), low]);
            }
        }
        let (mut links, mut before) = (&mut self.links[..], &mut self.before[..]);
        let mut behind = &mut self.behind[..];
        let chains = |(partition, pieces): (usize, Vec<_>)| Chains {
            rows: Rows {
                direction,
                strip,
                count,
                from: border(partition),
                blocks: Blocks::Some(pieces),
            },
            width: width(partition),
            links: take(&mut links, width(partition) * (count - 1)),
            before: take(&mut before, width(partition)),
            behind: take(&mut behind, width(partition)),
        };
        pieces.into_iter().enumerate().map(chains).collect()
    }
}

impl Chains<'_> {
    /// Whether they lead from one block to another.
    #[inline(always)]
    pub fn is_oblique(&self) -> bool {
        self.rows.direction != Direction::Down
    }
}
