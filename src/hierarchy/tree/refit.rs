//! `Refit` over a grid: eight nodes at a time, bottom up, from the particles' blocks.
//!
//! Lane `l` of a block is a particle of the `l`th strip of a row's columns, and all strips are halved alike. So uniting
//! four blocks unites the particles of eight nodes. Uniting four of the results gives eight parents, until a node is as
//! wide as a strip.

use multiversion::multiversion;

use super::halving::{GridTree, Level, Part};
use crate::cloth::MapInline;
use crate::{cloth::Block, hierarchy::volume::Volume};

/// The volumes of all levels but the last, whose nodes are the particles.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RefitLevels<V: Volume> {
    /// Levels whose nodes are no wider than a strip, in groups of eight nodes.
    pub(super) lanes: Vec<Aligned<V::Lanes>>,
    /// The levels above.
    pub(super) nodes: Vec<V>,
    /// Start of each level in either.
    pub(super) first: Vec<usize>,
}

/// Aligned to a cache line, like blocks of particles: no eight numbers cross a line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub(super) struct Aligned<T>(T);

impl<V: Volume> RefitLevels<V> {
    /// Updates all volumes.
    pub fn refit(&mut self, tree: &GridTree, blocks: &[Block]) {
        self.make_room(tree);
        let inner = &tree.levels[..tree.levels.len() - 1];
        let is_wide = |level: &&Level| level.parts_in_strip == 0;
        let wide = inner.iter().take_while(is_wide).count();
        if let Some(level) = inner.get(wide) {
            for row in 0..level.rows.len() {
                self.refit_row(tree, blocks, wide, row);
            }
        }
        for level in (0..wide).rev() {
            self.refit_nodes(tree, level);
        }
    }

    /// The volume of a node of a level that is not the last.
    #[inline(always)]
    pub fn volume(&self, at: &Level, level: usize, row: u32, column: u32) -> V {
        let first = self.first[level];
        if at.parts_in_strip == 0 {
            return self.nodes[first + row as usize * at.columns.len() + column as usize];
        }
        let part = &at.columns[column as usize];
        let place = first + (row * at.parts_in_strip + part.in_strip) as usize;
        V::lane(&self.lanes[place].0, part.lane as usize)
    }

    fn make_room(&mut self, tree: &GridTree) {
        let (mut lanes, mut nodes) = (0, 0);
        self.first.clear();
        for level in &tree.levels[..tree.levels.len() - 1] {
            let (first, columns) = match level.parts_in_strip as usize {
                0 => (&mut nodes, level.columns.len()),
                parts => (&mut lanes, parts),
            };
            self.first.push(*first);
            *first += level.rows.len() * columns;
        }
        self.lanes.resize(lanes, Aligned(V::UNSET));
        self.nodes.resize(nodes, V::lane(&V::UNSET, 0));
    }

    /// Updates a row of nodes, and before it all rows below, which are then still in the first-level cache.
    fn refit_row(&mut self, tree: &GridTree, blocks: &[Block], level: usize, row: usize) {
        let (at, below) = (&tree.levels[level], &tree.levels[level + 1]);
        let children = &at.rows[row].children;
        let (upper, lower) = (children.start as usize, children.end as usize - 1);
        let is_above_leaves = level + 2 == tree.levels.len();
        if !is_above_leaves {
            for row in upper..=lower {
                self.refit_row(tree, blocks, level + 1, row);
            }
        }
        let (parts, width) = (at.parts_in_strip as usize, below.parts_in_strip as usize);
        let strip = tree.outline.layout.strip as usize;
        let end_of_level = self.first[level] + at.rows.len() * parts;
        let (here, rest) = self.lanes.split_at_mut(end_of_level);
        let out = &mut here[self.first[level] + row * parts..][..parts];
        if is_above_leaves {
            let of = |row: usize| &blocks[row * strip..(row + 1) * strip];
            unite_blocks::<V>(out, &at.columns, of(upper), of(lower));
        } else {
            let of = |row: usize| &rest[row * width..(row + 1) * width];
            unite_row::<V>(out, &at.columns, of(upper), of(lower));
        }
        // The last strip may end inside a part: it has fewer particles than that part of other strips.
        let is_cut = |part: &&Part| part.span.end < part.full_end;
        if let Some(part) = at.columns.last().filter(is_cut) {
            let child = |row: usize, column: u32| {
                let part = &below.columns[column as usize];
                let (place, lane) = (part.in_strip as usize, part.lane as usize);
                if is_above_leaves {
                    V::around(blocks[row * strip + place].position(lane), 0.0)
                } else {
                    V::lane(&rest[row * width + place].0, lane)
                }
            };
            let (left, right) = (part.children.start, part.children.end - 1);
            let [a, b] = [left, right].map_inline(|column| child(upper, column));
            let [c, d] = [left, right].map_inline(|column| child(lower, column));
            let out = &mut out[part.in_strip as usize].0;
            V::set_lane(out, part.lane as usize, V::unite([&a, &b, &c, &d]));
        }
    }

    fn refit_nodes(&mut self, tree: &GridTree, level: usize) {
        let (at, below) = (&tree.levels[level], &tree.levels[level + 1]);
        let mut place = self.first[level];
        for rows in &at.rows {
            for columns in &at.columns {
                let child = |row: u32, column: u32| self.volume(below, level + 1, row, column);
                let (upper, lower) = (rows.children.start, rows.children.end - 1);
                let (left, right) = (columns.children.start, columns.children.end - 1);
                let [a, b] = [left, right].map_inline(|column| child(upper, column));
                let [c, d] = [left, right].map_inline(|column| child(lower, column));
                self.nodes[place] = V::unite([&a, &b, &c, &d]);
                place += 1;
            }
        }
    }
}

/// The parents, eight in each of `out`, of two rows of blocks.
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
fn unite_blocks<V: Volume>(
    out: &mut [Aligned<V::Lanes>],
    parts: &[Part],
    upper: &[Block],
    lower: &[Block],
) {
    for (out, part) in out.iter_mut().zip(parts) {
        let (left, right) = (part.children.start as usize, part.children.end as usize - 1);
        let four = [&upper[left], &upper[right], &lower[left], &lower[right]];
        V::of_particles(four.map_inline(Block::view), &mut out.0);
    }
}

/// The parents, eight in each of `out`, of two rows of nodes.
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
fn unite_row<V: Volume>(
    out: &mut [Aligned<V::Lanes>],
    parts: &[Part],
    upper: &[Aligned<V::Lanes>],
    lower: &[Aligned<V::Lanes>],
) {
    for (out, part) in out.iter_mut().zip(parts) {
        let (left, right) = (part.children.start as usize, part.children.end as usize - 1);
        V::unite_lanes(
            [
                &upper[left].0,
                &upper[right].0,
                &lower[left].0,
                &lower[right].0,
            ],
            &mut out.0,
        );
    }
}
