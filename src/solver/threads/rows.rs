//! Threads within rows: sixteen rows at a time, their lanes turned so that each row is a lane.

use bevy::math::{Mat4, Vec4};

use super::{
    down::Pull,
    link::{Family, equation, from_left},
};
use crate::cloth::{Block, DX, DY, DZ, LANES, Lanes, W};

/// Rows that are solved at once.
pub(crate) const GROUP: usize = 16;

/// One number of each row.
type Rows = [f32; GROUP];

/// The systems of a group of rows.
#[derive(Debug, Default, Clone)]
pub(crate) struct RowSystems {
    /// Row by row, block by block.
    ways: Vec<[Lanes; 3]>,
    pulls: Vec<Pull>,
    /// Column by column: diagonal, then one over the pivot.
    diagonal: Vec<Rows>,
    /// What couples a spring with the one before it.
    off: Vec<Rows>,
    /// Right side, then the multiplier.
    right: Vec<Rows>,
}

impl RowSystems {
    pub fn new(strip: usize) -> Self {
        let columns = strip * LANES;
        Self {
            ways: vec![[[0.0; LANES]; 3]; strip * GROUP],
            pulls: vec![[[0.0; LANES]; 3]; strip * GROUP],
            diagonal: vec![[1.0; GROUP]; columns],
            off: vec![[0.0; GROUP]; columns + 1],
            right: vec![[0.0; GROUP]; columns],
        }
    }
}

/// Transposes eight by eight numbers.
#[inline(always)]
fn turned(rows: [Lanes; LANES]) -> [Lanes; LANES] {
    let quarter = |row: usize, lane: usize| {
        let of = |at: usize| Vec4::from_slice(&rows[row + at][lane..lane + 4]);
        Mat4::from_cols(of(0), of(1), of(2), of(3))
            .transpose()
            .to_cols_array_2d()
    };
    let quarters = [
        [quarter(0, 0), quarter(4, 0)],
        [quarter(0, 4), quarter(4, 4)],
    ];
    std::array::from_fn(|lane| {
        let [low, high] = &quarters[lane / 4];
        let ([a, b, c, d], [e, f, g, h]) = (low[lane % 4], high[lane % 4]);
        [a, b, c, d, e, f, g, h]
    })
}

/// Solves the rows in `blocks`, up to [`GROUP`] of them, of `strip` blocks each; their families by row.
#[inline(always)]
pub(crate) fn solve_rows(
    blocks: &mut [Block],
    systems: &mut RowSystems,
    border: &Family,
    inner: &Family,
    is_border: [bool; 2],
    springs: usize,
) {
    let strip = border.hold.len();
    let count = blocks.len() / strip;
    let family = |row: usize| {
        if (row == 0 && is_border[0]) || (row + 1 == count && is_border[1]) {
            border
        } else {
            inner
        }
    };
    for j in 0..strip {
        for half in 0..GROUP / LANES {
            let mut diagonal = [[1.0; LANES]; LANES];
            let mut off = [[0.0; LANES]; LANES];
            let mut right = [[0.0; LANES]; LANES];
            for r in 0..LANES {
                let row = half * LANES + r;
                if row >= count {
                    break;
                }
                let own = &blocks[row * strip..(row + 1) * strip];
                let a = own[j].view();
                let b = if j + 1 < strip {
                    own[j + 1].view()
                } else {
                    own[0].shifted()
                };
                let spring = equation(a, b, family(row), j);
                systems.ways[row * strip + j] = spring.way;
                diagonal[r] = spring.diagonal;
                right[r] = spring.right;
                if j > 0 {
                    let before = &systems.ways[row * strip + j - 1];
                    for l in 0..LANES {
                        off[r][l] = -a[W + l]
                            * (before[0][l] * spring.way[0][l]
                                + before[1][l] * spring.way[1][l]
                                + before[2][l] * spring.way[2][l]);
                    }
                }
            }
            let (diagonal, off, right) = (turned(diagonal), turned(off), turned(right));
            for lane in 0..LANES {
                let column = lane * strip + j;
                let rows = half * LANES..(half + 1) * LANES;
                systems.diagonal[column][rows.clone()].copy_from_slice(&diagonal[lane]);
                systems.off[column][rows.clone()].copy_from_slice(&off[lane]);
                systems.right[column][rows].copy_from_slice(&right[lane]);
            }
        }
    }
    // What a strip's first spring shares with the last one of the strip before.
    for row in 0..count {
        let own = &systems.ways[row * strip..(row + 1) * strip];
        let a = blocks[row * strip].view();
        let before = [0, 1, 2].map(|axis| from_left(&own[strip - 1][axis]));
        for l in 1..LANES {
            let along = before[0][l] * own[0][0][l]
                + before[1][l] * own[0][1][l]
                + before[2][l] * own[0][2][l];
            systems.off[l * strip][row] = -a[W + l] * along;
        }
    }
    solve(
        &mut systems.diagonal,
        &systems.off,
        &mut systems.right,
        springs,
    );
    systems.right[springs..].fill([0.0; GROUP]);
    for j in 0..strip {
        for half in 0..count.div_ceil(LANES) {
            let rows = half * LANES..(half + 1) * LANES;
            let multipliers = turned(std::array::from_fn(|lane| {
                *systems.right[lane * strip + j][rows.clone()]
                    .first_chunk()
                    .expect("eight rows")
            }));
            for r in 0..LANES.min(count - half * LANES) {
                let at = (half * LANES + r) * strip + j;
                let (way, pull) = (&systems.ways[at], &mut systems.pulls[at]);
                for axis in 0..3 {
                    for l in 0..LANES {
                        pull[axis][l] = way[axis][l] * multipliers[r][l];
                    }
                }
            }
        }
    }
    for (row, pulls) in blocks
        .chunks_exact_mut(strip)
        .zip(systems.pulls.chunks_exact(strip))
    {
        let mut before = [0, 1, 2].map(|axis| from_left(&pulls[strip - 1][axis]));
        for (block, pull) in row.iter_mut().zip(pulls) {
            let view = block.view_mut();
            for (axis, from) in [DX, DY, DZ].into_iter().enumerate() {
                for l in 0..LANES {
                    view[from + l] += view[W + l] * (before[axis][l] - pull[axis][l]);
                }
            }
            before = *pull;
        }
    }
}

/// Solves tridiagonal systems from both ends at once, so that two eliminations run side by side. Of `springs` unknowns.
#[inline(always)]
fn solve(diagonal: &mut [Rows], off: &[Rows], right: &mut [Rows], springs: usize) {
    let middle = springs / 2;
    let (mut left_pivot, mut left) = ([0.0; GROUP], [0.0; GROUP]);
    let (mut right_pivot, mut last) = ([0.0; GROUP], [0.0; GROUP]);
    let after = springs - 1 - middle;
    for k in 0..middle.max(after) {
        if k < middle {
            step(
                &mut diagonal[k],
                &off[k],
                &mut right[k],
                &mut left_pivot,
                &mut left,
            );
        }
        if k < after {
            let at = springs - 1 - k;
            step(
                &mut diagonal[at],
                &off[at + 1],
                &mut right[at],
                &mut right_pivot,
                &mut last,
            );
        }
    }
    // The one in the middle has a neighbour on each side.
    let (before, behind) = (&off[middle], &off[middle + 1]);
    let mut value = [0.0; GROUP];
    for r in 0..GROUP {
        let beside =
            before[r] * (before[r] * left_pivot[r]) + behind[r] * (behind[r] * right_pivot[r]);
        let known = before[r] * left[r] + behind[r] * last[r];
        value[r] = (right[middle][r] - known) / (diagonal[middle][r] - beside);
    }
    right[middle] = value;
    let (mut left, mut last) = (value, value);
    for k in 1..=middle.max(after) {
        if k <= middle {
            let at = middle - k;
            back(&diagonal[at], &off[at + 1], &mut right[at], &mut left);
        }
        if k <= after {
            let at = middle + k;
            back(&diagonal[at], &off[at], &mut right[at], &mut last);
        }
    }
}

#[inline(always)]
fn step(diagonal: &mut Rows, off: &Rows, right: &mut Rows, pivot: &mut Rows, before: &mut Rows) {
    for r in 0..GROUP {
        let own = 1.0 / (diagonal[r] - off[r] * (off[r] * pivot[r]));
        let value = (right[r] - off[r] * before[r]) * own;
        (diagonal[r], right[r]) = (own, value);
        (pivot[r], before[r]) = (own, value);
    }
}

#[inline(always)]
fn back(pivot: &Rows, off: &Rows, right: &mut Rows, neighbour: &mut Rows) {
    for r in 0..GROUP {
        let value = right[r] - pivot[r] * (off[r] * neighbour[r]);
        (right[r], neighbour[r]) = (value, value);
    }
}
