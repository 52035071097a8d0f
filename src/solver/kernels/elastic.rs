//! The forces of a grid's springs, and the motion that they give: one pass down the rows.
//!
//! A row's forces are complete once the springs to the row below are done. Then nothing needs its old positions any
//! more, and it moves while it is in the first cache.
//!
//! # The floor
//! A spring needs one division, no root, and some 26 additions and multiplications. A core with AVX2 starts two of
//! these per cycle, each on eight lanes: 13 cycles for eight springs, 0.55 ns per spring at 3 GHz.

use super::{
    barrier::one_block_at_a_time,
    commit::commit,
    each::{four, three},
};
use crate::cloth::{
    Block, ClothGrid, Compliances, DX, DY, DZ, LANES, Lanes, Layout, MapInline, SpringList, View,
    W, X,
};

/// x, y and z of the forces on eight particles (N).
pub(crate) type Force = [Lanes; 3];

const NONE: Force = [[0.0; LANES]; 3];

/// Springs of a grid that lie alike: those of a row, which stands for all like it, or of each row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Elastic {
    /// One over the squared length at rest (1/m²).
    inverse_rest_square: f32,
    /// Stiffness (N/m) of those that begin in a row's blocks, 0 where there is none.
    stiffness: Vec<Lanes>,
    /// From the springs of a row to those of the next; 0 where one row stands for all.
    stride: usize,
}

impl Elastic {
    /// Those of this step that begin in `row`; `None` if one of them is rigid.
    fn new(
        grid: &ClothGrid,
        layout: Layout,
        compliances: &Compliances,
        step: (u32, i32),
        row: u32,
    ) -> Option<Self> {
        let is_there = step.0 < grid.rows();
        Self::of_rows(grid.step_length(step), layout, 1, |_, column| {
            is_there.then_some(())?;
            let end = column.checked_add_signed(step.1)?;
            (end < grid.columns()).then_some(())?;
            compliances.of_strip(grid, step, (row.min(grid.rows() - 1), column))
        })
    }

    /// Those of this length at rest (m), with the compliance (m/N) by the row and column that each begins in; `None` if one of
    /// them is rigid. One row stands for all, or there are `rows`.
    fn of_rows(
        rest: f32,
        layout: Layout,
        rows: usize,
        compliance: impl Fn(usize, u32) -> Option<f32>,
    ) -> Option<Self> {
        let strip = layout.strip as usize;
        let stiffness = |block: usize, lane: usize| {
            let column = layout.column(block % strip, lane)?;
            compliance(block / strip, column)
        };
        let lane = |block, lane| stiffness(block, lane).map_or(0.0, f32::recip);
        let lanes = |block| std::array::from_fn(|l| lane(block, l));
        let stiffness: Vec<Lanes> = (0..rows * strip).map(lanes).collect();
        let is_finite = stiffness.as_flattened().iter().all(|k| k.is_finite());
        is_finite.then_some(Self {
            inverse_rest_square: 1.0 / (rest * rest),
            stiffness,
            stride: if rows > 1 { strip } else { 0 },
        })
    }

    /// The values of stiffness (N/m) along a row, whose number of blocks is `strip`.
    #[inline(always)]
    pub fn of_row(&self, row: usize, strip: usize) -> &[Lanes] {
        &self.stiffness[row * self.stride..][..strip]
    }
}

/// All springs of a grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ElasticGrid {
    pub(crate) layout: Layout,
    /// Within a row: one on a border, one that is not.
    pub(crate) across: [Elastic; 2],
    pub(crate) down: Elastic,
    /// To the right in the row below, and in the row above; of no stiffness if there are none.
    pub(crate) falling: Elastic,
    pub(crate) rising: Elastic,
}

impl ElasticGrid {
    /// `None` if one of them is rigid.
    pub fn new(grid: &ClothGrid, compliances: &Compliances) -> Option<Self> {
        let layout = Layout::new(grid.columns(), grid.rows());
        let of = |step, row| Elastic::new(grid, layout, compliances, step, row);
        Some(Self {
            layout,
            across: [of((0, 1), 0)?, of((0, 1), 1)?],
            down: of((1, 0), 0)?,
            falling: of((1, 1), 0)?,
            rising: of((1, 1), 0)?,
        })
    }

    /// Of those springs of a list that are along the grid, between particles that lie as `layout` says; `None` if one is rigid.
    pub fn of_list(grid: &ClothGrid, layout: Layout, list: &SpringList) -> Option<Self> {
        let columns = grid.columns() as usize;
        let [across, down, falling, rising] = &list.on_grid(grid);
        let of = |step, of: &[f32], down: usize| {
            let rest = grid.step_length(step);
            Elastic::of_rows(rest, layout, layout.rows as usize, |row, column| {
                let compliance = of.get((row + down) * columns + column as usize)?;
                (!compliance.is_nan()).then_some(*compliance)
            })
        };
        let across = of((0, 1), across, 0)?;
        Some(Self {
            layout,
            across: [across.clone(), across],
            down: of((1, 0), down, 0)?,
            falling: of((1, 1), falling, 0)?,
            // Found from the row above.
            rising: of((1, 1), rising, 1)?,
        })
    }

    /// Whether each row has springs of its own.
    pub(crate) fn is_by_row(&self) -> bool {
        self.down.stride > 0
    }

    /// The shorter distance between neighbours (m).
    pub(crate) fn spacing(&self) -> f32 {
        // A rope has none below.
        if self.layout.rows == 1 {
            return self.across[0].inverse_rest_square.sqrt().recip();
        }
        let [across, down] = [&self.across[0], &self.down].map_inline(|of| of.inverse_rest_square);
        across.max(down).sqrt().recip()
    }
}

/// Weights of forces and velocities in a sub-step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kick {
    /// The part of its displacement that a particle keeps.
    pub kept: f32,
    /// c Δt² (s²).
    pub weight: f32,
    /// c a Δt² (m).
    pub pull: [f32; 3],
    /// Whether the particles move by their displacements then.
    pub moves: bool,
}

/// The part of the way from one end of a spring to the other that its force is (N/m), from its squared length over that at rest.
/// It is `k (1 − L/ℓ)`.
///
/// With δ what (ℓ/L)² is above 1, `1 − L/ℓ` is taken as `δ (4 δ + 8)/(5 δ² + 20 δ + 16)`, the Padé approximant of order [2/2] in δ:
/// no root. It is off by 4·10⁻⁶ of itself where a spring is 10 % too long, by 9·10⁻⁴ at 50 %, by 0.8 % where it is twice as long,
/// and finite where its ends coincide. It depends on the length alone, so that it is a force that keeps energy like any spring's.
#[inline(always)]
pub(crate) fn share(stiffness: f32, square: f32) -> f32 {
    let over = square - 1.0;
    stiffness * (over * (4.0 * over + 8.0)) / (over * (5.0 * over + 20.0) + 16.0)
}

/// The force on `a`, of a spring to `b`.
#[inline(always)]
fn force(a: &View, b: &View, stiffness: f32, inverse_rest_square: f32, l: usize) -> [f32; 3] {
    let [x, y, z] = three(|axis| b[X + axis * LANES + l] - a[X + axis * LANES + l]);
    let share = share(stiffness, (x * x + y * y + z * z) * inverse_rest_square);
    [share * x, share * y, share * z]
}

/// Results of the block before: the forces on the own block, and on the block below it.
type Carried = [Force; 2];

/// The particles that the springs of a block lead to.
struct Neighbours<'a> {
    right: &'a View,
    below: &'a View,
    below_right: &'a View,
}

/// The springs that begin in one block of a row, and those that come up to its right from the block below. Adds to the forces on
/// the block, writes those on the one below. Returns what acts on the blocks to the right.
#[inline(always)]
fn act(
    own: &View,
    to: &Neighbours,
    springs: [(&Lanes, f32); 4],
    carried: &Carried,
    on_own: &mut Force,
    on_below: &mut Force,
) -> Carried {
    let Neighbours {
        right,
        below,
        below_right,
    } = to;
    let [across, down, falling, rising] = springs;
    let mut carries = [NONE; 2];
    for l in 0..LANES {
        let to_right = force(own, right, across.0[l], across.1, l);
        let to_below = force(own, below, down.0[l], down.1, l);
        let falling = force(own, below_right, falling.0[l], falling.1, l);
        let rising = force(below, right, rising.0[l], rising.1, l);
        for axis in 0..3 {
            let begin = to_right[axis] + (to_below[axis] + falling[axis]);
            on_own[axis][l] += carried[0][axis][l] + begin;
            on_below[axis][l] = carried[1][axis][l] + (rising[axis] - to_below[axis]);
            carries[0][axis][l] = -to_right[axis] - rising[axis];
            carries[1][axis][l] = -falling[axis];
        }
    }
    carries
}

/// Adds forces, shifted one lane to the right.
#[inline(always)]
fn add_shifted(to: &mut Force, force: &Force) {
    for (to, [a, b, c, d, e, f, g, _]) in to.iter_mut().zip(force) {
        let moved = [0.0, *a, *b, *c, *d, *e, *f, *g];
        for l in 0..LANES {
            to[l] += moved[l];
        }
    }
}

/// The springs within a row, and from it to the row below: adds to the forces on the row, writes those on the one below.
#[inline(always)]
fn row_and_below(
    [row, lower]: [&[Block]; 2],
    springs: &ElasticGrid,
    (number, is_end): (usize, bool),
    [on_row, on_lower]: [&mut [Force]; 2],
) {
    let last = row.len() - 1;
    let lower = &lower[..=last];
    let [on_row, on_lower] = [&mut on_row[..=last], &mut on_lower[..=last]];
    let kinds = [
        &springs.across[usize::from(!is_end)],
        &springs.down,
        &springs.falling,
        &springs.rising,
    ];
    let kinds = four(|kind| {
        let of = kinds[kind];
        (of.of_row(number, last + 1), of.inverse_rest_square)
    });
    let mut carried = [NONE; 2];
    for j in 0..last {
        let to = Neighbours {
            right: row[j + 1].view(),
            below: lower[j].view(),
            below_right: lower[j + 1].view(),
        };
        let springs = four(|kind| (&kinds[kind].0[j], kinds[kind].1));
        let (own, below) = (&mut on_row[j], &mut on_lower[j]);
        carried = act(row[j].view(), &to, springs, &carried, own, below);
        one_block_at_a_time();
    }
    // The strips' last columns have their right neighbours a lane on in the first block.
    let to = Neighbours {
        right: row[0].shifted(),
        below: lower[last].view(),
        below_right: lower[0].shifted(),
    };
    let springs = four(|kind| (&kinds[kind].0[last], kinds[kind].1));
    let (own, below) = (&mut on_row[last], &mut on_lower[last]);
    let carried = act(row[last].view(), &to, springs, &carried, own, below);
    add_shifted(&mut on_row[0], &carried[0]);
    add_shifted(&mut on_lower[0], &carried[1]);
}

/// The springs within the last row.
#[inline(always)]
fn row_alone(row: &[Block], springs: &Elastic, number: usize, forces: &mut [Force]) {
    let last = row.len() - 1;
    let stiffness = springs.of_row(number, row.len());
    let mut carried = NONE;
    for j in 0..=last {
        let (a, on_a) = (row[j].view(), &mut forces[j]);
        let b = match row.get(j + 1) {
            Some(block) => block.view(),
            None => row[0].shifted(),
        };
        for l in 0..LANES {
            let force = force(a, b, stiffness[j][l], springs.inverse_rest_square, l);
            for axis in 0..3 {
                on_a[axis][l] += carried[axis][l] + force[axis];
                carried[axis][l] = -force[axis];
            }
        }
        one_block_at_a_time();
    }
    add_shifted(&mut forces[0], &carried);
}

/// Gives eight particles the displacement along one axis that forces make of theirs. Pinned ones keep it.
#[inline(always)]
fn push_along<const AT: usize>(view: &mut View, force: &Lanes, pull: f32, kick: &Kick) {
    for l in 0..LANES {
        let was = view[AT + l];
        let moved = kick.kept * was + (pull + kick.weight * view[W + l] * force[l]);
        view[AT + l] = if view[W + l] > 0.0 { moved } else { was };
    }
}

/// Gives particles the displacements that forces make of theirs.
#[inline(always)]
fn push(row: &mut [Block], forces: &[Force], kick: &Kick) {
    for (block, [x, y, z]) in row.iter_mut().zip(forces) {
        let view = block.view_mut();
        push_along::<DX>(view, x, kick.pull[0], kick);
        push_along::<DY>(view, y, kick.pull[1], kick);
        push_along::<DZ>(view, z, kick.pull[2], kick);
        one_block_at_a_time();
    }
}

/// Applies the springs' forces, and a pull on all, to the particles of some rows, and moves them. `around` are the rows
/// before and behind them, of no blocks at the ends of the grid. `first` is the number of the first row. Raises `moved` to the squares of displacements (m²).
#[inline(always)]
pub(crate) fn kick(
    blocks: &mut [Block],
    first: usize,
    [above, below]: [&[Block]; 2],
    springs: &ElasticGrid,
    kick: &Kick,
    [forces, next]: &mut [Vec<Force>; 2],
    moved: &mut Lanes,
) {
    let strip = springs.layout.strip as usize;
    let rows = blocks.len() / strip;
    forces.fill(NONE);
    if !above.is_empty() {
        let ends = [&mut next[..], &mut forces[..]];
        let before = (first - 1, false);
        row_and_below([above, &blocks[..strip]], springs, before, ends);
    }
    for row in 0..rows {
        let (own, rest) = blocks[row * strip..].split_at_mut(strip);
        let lower = rest.get(..strip).unwrap_or(below);
        if lower.is_empty() {
            row_alone(own, &springs.across[0], first + row, forces);
        } else {
            let own_number = (first + row, row == 0 && above.is_empty());
            let ends = [&mut forces[..], &mut next[..]];
            row_and_below([own, lower], springs, own_number, ends);
        }
        push(own, forces, kick);
        if kick.moves {
            commit(own, moved);
        }
        std::mem::swap(forces, next);
    }
}
