//! The stretch that a pass over the chains of a grid leaves in the springs of its rows and columns.
//!
//! # The floor
//! Two springs for each particle: 3 additions for its position, and 10 operations for each of them, of elastic ones 16 and a
//! division. That is a fifteenth of a sub-step.

use super::link::SpringBand;
use crate::{
    cloth::{Block, DX, LANES, Lanes, View, X},
    solver::kernels::pentadiagonal::Vec3Lanes,
};

/// The stretch that is left: squared lengths of springs over those that they should have.
#[derive(Debug, Clone)]
pub(crate) struct Residuals {
    /// Positions of the row above (m).
    above: Vec<Vec3Lanes>,
    /// The largest in the row that was measured last.
    pub across: f32,
    /// The largest in the columns of each block, lane by lane.
    pub down: Vec<Lanes>,
}

impl Residuals {
    pub fn new(strip: usize) -> Self {
        Self {
            above: vec![[[0.0; LANES]; 3]; strip],
            across: 0.0,
            down: vec![[0.0; LANES]; strip],
        }
    }
}

/// The springs within a row, and those that lead to it from the row above.
pub(crate) struct RowSprings<'a> {
    pub kinds: [&'a SpringBand; 2],
    /// Where theirs are in each.
    pub first: [usize; 2],
    /// Their multipliers (m kg), if they are elastic.
    pub pulled: [&'a [Lanes]; 2],
}

/// The positions of eight particles in a sub-step.
#[inline(always)]
fn places(view: &View) -> Vec3Lanes {
    let mut places = [[0.0; LANES]; 3];
    for axis in 0..3 {
        for l in 0..LANES {
            places[axis][l] = view[X + axis * LANES + l] + view[DX + axis * LANES + l];
        }
    }
    places
}

/// Notes where the particles of a row are.
#[inline(always)]
pub(crate) fn note_places(row: &[Block], left: &mut Residuals) {
    for (above, block) in left.above.iter_mut().zip(row) {
        *above = places(block.view());
    }
}

/// Raises `left` to the squared lengths of eight springs over those that they should have.
#[inline(always)]
fn raise<const ELASTIC: bool>(
    [a, b]: [&Vec3Lanes; 2],
    (springs, first, block): (&SpringBand, usize, usize),
    pulled: &[Lanes],
    left: &mut Lanes,
) {
    let at = first + block;
    let scale = &springs.inverse_square[at];
    let mut most = *left;
    for l in 0..LANES {
        let (x, y, z) = (b[0][l] - a[0][l], b[1][l] - a[1][l], b[2][l] - a[2][l]);
        let p = (x * x + y * y + z * z) * scale[l];
        let found = if ELASTIC {
            // 1 and twice C + α̃ λ over the length, with Halley's step for C as in the equations.
            let pull = springs.softness[at][l] * pulled[block][l] * springs.inverse_rest;
            1.0 + 2.0 * ((p - 1.0) / (1.5 * p + 0.5) + pull)
        } else {
            p
        };
        most[l] = if found > most[l] { found } else { most[l] };
    }
    *left = most;
}

/// Measures the springs of a row, and those that lead to it from the row that was noted or measured before.
#[inline(always)]
pub(crate) fn measure_left(row: &[Block], springs: &RowSprings, left: &mut Residuals) {
    measure::<false>(row, springs, left);
}

/// The same where springs are elastic.
#[inline(always)]
pub(crate) fn measure_elastic_left(row: &[Block], springs: &RowSprings, left: &mut Residuals) {
    measure::<true>(row, springs, left);
}

#[inline(always)]
fn measure<const ELASTIC: bool>(row: &[Block], springs: &RowSprings, left: &mut Residuals) {
    let [across, down] = springs.kinds;
    let [in_row, from_above] = springs.pulled;
    let count = row.len();
    let (all_above, columns) = (&mut left.above[..count], &mut left.down[..count]);
    let [first_across, first_down] = springs.first;
    let mut most = [0.0; LANES];
    let mut before = places(row[0].view());
    let first = (down, first_down, 0);
    raise::<ELASTIC>([&all_above[0], &before], first, from_above, &mut columns[0]);
    all_above[0] = before;
    for j in 1..count {
        let own = places(row[j].view());
        let across = (across, first_across, j - 1);
        raise::<ELASTIC>([&before, &own], across, in_row, &mut most);
        let ends = [&all_above[j], &own];
        raise::<ELASTIC>(ends, (down, first_down, j), from_above, &mut columns[j]);
        (all_above[j], before) = (own, own);
    }
    let after = places(row[0].shifted());
    let across = (across, first_across, count - 1);
    raise::<ELASTIC>([&before, &after], across, in_row, &mut most);
    left.across = largest(most);
}

/// Measures, in a row and from the one above, the springs at some blocks alone.
#[inline(always)]
pub(crate) fn measure_left_at(
    row: &[Block],
    blocks: &[u32],
    springs: &RowSprings,
    left: &mut Residuals,
) {
    measure_at::<false>(row, blocks, springs, left);
}

/// The same where springs are elastic.
#[inline(always)]
pub(crate) fn measure_elastic_left_at(
    row: &[Block],
    blocks: &[u32],
    springs: &RowSprings,
    left: &mut Residuals,
) {
    measure_at::<true>(row, blocks, springs, left);
}

#[inline(always)]
fn measure_at<const ELASTIC: bool>(
    row: &[Block],
    blocks: &[u32],
    springs: &RowSprings,
    left: &mut Residuals,
) {
    let [across, down] = springs.kinds;
    let [in_row, from_above] = springs.pulled;
    let [first_across, first_down] = springs.first;
    let mut most = [0.0; LANES];
    let last = row.len() - 1;
    for &block in blocks {
        let block = block as usize;
        let own = places(row[block].view());
        let (before, first, to_first) = if block == 0 {
            (last, places(row[last].view()), places(row[0].shifted()))
        } else {
            (block - 1, places(row[block - 1].view()), own)
        };
        let ends = [&first, &to_first];
        let to_own = (across, first_across, before);
        raise::<ELASTIC>(ends, to_own, in_row, &mut most);
        let after = match row.get(block + 1) {
            Some(after) => places(after.view()),
            None => places(row[0].shifted()),
        };
        let from_own = (across, first_across, block);
        raise::<ELASTIC>([&own, &after], from_own, in_row, &mut most);
        let above = &mut left.above[block];
        let down = (down, first_down, block);
        raise::<ELASTIC>([above, &own], down, from_above, &mut left.down[block]);
        *above = own;
    }
    left.across = largest(most);
}

/// The largest of eight numbers.
#[inline(always)]
pub(crate) fn largest(mut lanes: Lanes) -> f32 {
    for half in [4, 2, 1] {
        for l in 0..half {
            let other = lanes[l + half];
            lanes[l] = if other > lanes[l] { other } else { lanes[l] };
        }
    }
    lanes[0]
}
