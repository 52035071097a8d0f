//! The tree of a grid: rows and columns halved on each level, without stored nodes.

use std::ops::Range;

use bevy::math::Vec2;

use super::node::Outline;
use crate::cloth::{ClothGrid, Layout};

/// A range of rows or columns on one level.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Part {
    /// The first, and one past the last.
    pub span: Range<u32>,
    /// End of the part if all lanes of the cloth's blocks were columns.
    pub full_end: u32,
    /// The middle one: never nearer to the end than to the start.
    pub middle: u32,
    /// Distance from the middle to the end.
    pub half: u32,
    /// 1 if `half` is less than the largest of the level, else 0.
    pub is_short: u8,
    /// Its two halves on the next level; empty on the last.
    pub children: Range<u32>,
    /// For rows, the middle's first block; for columns, the middle's block in its row.
    pub block: u32,
    /// For columns, the middle's lane.
    pub lane: u32,
    /// For columns, the index of the part in its strip, if a strip holds several.
    pub in_strip: u32,
}

/// The rows and columns of one level. A node is one part of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    pub rows: Vec<Part>,
    pub columns: Vec<Part>,
    /// Index of its first node.
    pub first: u32,
    /// Largest distance along the springs at rest from the middle of a node to a corner (m), indexed by whether its
    /// rows and columns are short.
    pub rest_radius: [[f32; 2]; 2],
    /// Number of parts in a strip of columns, which eight lanes process together; 0 if a part has several strips.
    pub parts_in_strip: u32,
}

impl Level {
    pub fn index(&self, row: u32, column: u32) -> u32 {
        self.first + row * self.columns.len() as u32 + column
    }

    /// The rest radius of a node (m), rounded up.
    #[inline(always)]
    pub fn rest_radius(&self, rows: &Part, columns: &Part) -> f32 {
        self.rest_radius[usize::from(rows.is_short & 1)][usize::from(columns.is_short & 1)]
    }
}

/// A tree over a grid of any size.
#[derive(Debug, Clone, PartialEq)]
pub struct GridTree {
    pub levels: Vec<Level>,
    pub outline: Outline,
    /// Distances between neighbours (m).
    pub spacing: Vec2,
}

impl GridTree {
    pub fn new(grid: &ClothGrid, diagonals: bool) -> Self {
        let layout = Layout::new(grid.columns(), grid.rows());
        let strip = layout.strip;
        let strips = layout.columns.div_ceil(strip);
        let rows = halved(layout.rows, layout.rows, 1);
        let full = match strips {
            ..=1 => layout.columns,
            _ => strips * strip,
        };
        let columns = halved(full, layout.columns, strip);
        let depth = rows.len().max(columns.len());
        let mut levels: Vec<Level> = Vec::with_capacity(depth);
        for level in 0..depth {
            let first = levels.last().map_or(0, |above| {
                above.first + (above.rows.len() * above.columns.len()) as u32
            });
            let at = |halved: &[Vec<Part>]| {
                let last = halved.len() - 1;
                let mut parts = halved[level.min(last)].clone();
                for (index, part) in parts.iter_mut().enumerate() {
                    let index = index as u32;
                    if level + 1 == depth {
                        part.children = 0..0;
                    } else if level >= last {
                        part.children = index..index + 1;
                    }
                }
                parts
            };
            let (mut rows, mut columns) = (at(&rows), at(&columns));
            for part in &mut rows {
                part.block = part.middle * strip;
            }
            let width = columns[0].full_end;
            let in_strip = columns.iter().take_while(|part| part.span.start < strip);
            let count = in_strip.count() as u32;
            let parts_in_strip = if width > strip { 0 } else { count };
            for (index, part) in columns.iter_mut().enumerate() {
                (part.block, part.lane) = (part.middle % strip, part.middle / strip);
                part.in_strip = (index as u32).checked_rem(parts_in_strip).unwrap_or(0);
            }
            let [down, across] = [&mut rows, &mut columns].map(|parts| shorten(parts));
            let rest_radius = down.map(|down| {
                across.map(|across| rest_distance(grid.spacing(), across, down, diagonals))
            });
            levels.push(Level {
                rows,
                columns,
                first,
                rest_radius,
                parts_in_strip,
            });
        }
        let nodes = |level: &Level| level.first..level.index(level.rows.len() as u32, 0);
        Self {
            outline: Outline {
                layout,
                levels: levels.iter().map(nodes).collect(),
                diagonals,
                tops: vec![0],
            },
            levels,
            spacing: grid.spacing(),
        }
    }

    /// The parts of a node of `level`, after their places.
    pub fn parts(&self, level: usize, node: u32) -> ([u32; 2], &Part, &Part) {
        let Level { rows, columns, .. } = &self.levels[level];
        let (index, width) = (node - self.levels[level].first, columns.len() as u32);
        let [row, column] = [index / width, index % width];
        (
            [row, column],
            &rows[row as usize],
            &columns[column as usize],
        )
    }
}

/// Halves `full` rows or columns level by level; only the first `count` exist. Units are separated before they are
/// halved, and all units are halved alike, so that eight lanes hold eight nodes of one level.
fn halved(full: u32, count: u32, unit: u32) -> Vec<Vec<Part>> {
    let part = |full: Range<u32>| {
        let span = full.start..full.end.min(count);
        let middle = span.start + (span.end - span.start - 1) / 2;
        Part {
            half: span.end - 1 - middle,
            span,
            full_end: full.end,
            middle,
            ..Part::default()
        }
    };
    let mut levels = vec![vec![part(0..full)]];
    loop {
        let above = levels.last_mut().expect("at least one level");
        // The first is the largest.
        let largest = above[0].full_end;
        if largest == 1 {
            return levels;
        }
        let unit = if largest > unit { unit } else { 1 };
        let mut below = Vec::new();
        for parent in above.iter_mut() {
            let first = below.len() as u32;
            let (start, end) = (parent.span.start, parent.full_end);
            let half = start + (end - start).div_ceil(unit).div_ceil(2) * unit;
            let halves = [start..half.min(end), half.min(end)..end];
            let exists = |half: &Range<u32>| half.start < count && !half.is_empty();
            below.extend(halves.into_iter().filter(exists).map(part));
            parent.children = first..below.len() as u32;
        }
        levels.push(below);
    }
}

/// Marks the short parts, and returns the half lengths of the others and of these.
fn shorten(parts: &mut [Part]) -> [u32; 2] {
    let longest = parts.iter().map(|part| part.half).max().unwrap_or(0);
    for part in parts {
        part.is_short = u8::from(part.half < longest);
    }
    [longest, longest.saturating_sub(1)]
}

/// Length of the shortest path along the springs at rest between two particles, some columns and rows apart (m).
fn rest_distance(spacing: Vec2, across: u32, down: u32, diagonals: bool) -> f32 {
    let diagonal = if diagonals { across.min(down) } else { 0 };
    let (across, down) = (across - diagonal, down - diagonal);
    diagonal as f32 * spacing.length() + across as f32 * spacing.x + down as f32 * spacing.y
}
