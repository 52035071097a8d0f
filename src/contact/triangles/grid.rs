//! Pushes a grid's triangles out of a ball, eight at a time.
//!
//! A block of a grid is eight cells that lie a strip apart and share no corners. So the same triangle of each can be
//! pushed at once, and the result equals that of one push after the other.

use multiversion::multiversion;

use super::lanes::{Cells, add_area, areas, move_corner, nearest_of_each, pushes, speeds};
use crate::{
    cloth::{Block, LANES, Layout, MapInline, Slot, View, larger, smaller},
    contact::{
        candidates::ContactBlock,
        friction::FrictionBudget,
        particles::{LaneMotion, Sums},
    },
};

/// A triangle of each cell of a block.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    /// Index of the cloth's block.
    pub block: u32,
    /// Which of the two triangles.
    pub which: u32,
}

impl Place {
    /// Behind all.
    pub const END: Self = Self {
        block: u32::MAX,
        which: 0,
    };
}

/// The reason why the push stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stop {
    /// All is done.
    Done,
    /// Some triangles have to be tested one by one: the contact block and its lanes.
    Left {
        contact: usize,
        which: u32,
        lanes: [bool; LANES],
    },
    /// Candidates may be missing.
    Room,
}

/// Location of a block's corner.
#[derive(Clone, Copy)]
struct Corner {
    block: usize,
    contact: usize,
    is_shifted: bool,
}

impl Corner {
    #[inline(always)]
    fn view<'a>(&self, blocks: &'a [Block]) -> &'a View {
        if self.is_shifted {
            blocks[self.block].shifted()
        } else {
            blocks[self.block].view()
        }
    }

    #[inline(always)]
    fn view_mut<'a>(&self, blocks: &'a mut [Block]) -> &'a mut View {
        if self.is_shifted {
            blocks[self.block].shifted_mut()
        } else {
            blocks[self.block].view_mut()
        }
    }
}

/// Pushes a triangle of each cell of a block. Returns those that have to be tested one by one, and the distance of the
/// nearest from a touch (m).
#[inline(always)]
fn push_eight(
    blocks: &mut [Block],
    (contact, corners): (&mut ContactBlock, [Corner; 3]),
    budgets: &mut [FrictionBudget],
    is_cell: &[bool; LANES],
    (motion, cells): (&LaneMotion, &Cells),
    sums: &mut Sums,
) -> ([bool; LANES], f32) {
    let [a, b, c] = corners.map_inline(|corner| corner.view(blocks));
    let near = nearest_of_each(a, b, c, cells.centre);
    let half = cells.reach / 2.0;
    let mut speed = [0.0; LANES];
    // NaN is not slow.
    let is_slow = cells.fastest + cells.pushed + sums.passed * cells.max_faces <= half;
    if !is_slow {
        speed = speeds([a, b, c], motion.slide);
    }
    let mut left = [false; LANES];
    let mut is_pushed = [false; LANES];
    let mut clear = [0.0_f32; LANES];
    for l in 0..LANES {
        let distance = near.distance[l];
        let edges = near.edges[1][l] + near.edges[2][l];
        let is_wide = near.sum[l] > 4.0e-9 * edges * edges;
        let is_far = distance >= half;
        let is_met = (speed[l] > half) & motion.is_swept & (distance - speed[l] <= cells.reach);
        let is_left = is_cell[l] & (!is_wide | is_met | !is_far);
        left[l] = is_left;
        let depth = cells.reach - distance;
        let is_tested = is_cell[l] & !is_left;
        is_pushed[l] = is_tested & (depth > 0.0);
        let depth = if is_tested { depth } else { f32::NEG_INFINITY };
        contact.depth[l] = larger(depth, contact.depth[l]);
        clear[l] = if is_left { f32::NEG_INFINITY } else { -depth };
    }
    let (mut any, mut least) = (false, f32::INFINITY);
    for l in 0..LANES {
        any |= is_pushed[l];
        least = smaller(clear[l], least);
    }
    if any {
        let pushes = pushes([a, b, c], &near, &is_pushed, motion, cells, sums);
        if cells.is_measured {
            let crosses = areas(&near, &is_pushed, cells.reach, sums);
            for (lane, crosses) in crosses.into_iter().enumerate() {
                if crosses {
                    add_area([a, b, c], lane, cells, sums);
                }
            }
        }
        for (corner, share) in corners.iter().zip(&pushes.shares) {
            let momentum = move_corner(corner.view_mut(blocks), share, &pushes, motion, sums);
            if corner.is_shifted {
                budgets[corner.contact].add_shifted(&momentum);
            } else {
                budgets[corner.contact].add(&momentum);
            }
        }
    }
    (left, least)
}

/// The lanes of a block that are cells.
#[inline(always)]
fn cells_of(layout: Layout, block: u32) -> [bool; LANES] {
    let place = block % layout.strip;
    std::array::from_fn(|lane| lane as u32 * layout.strip + place + 1 < layout.columns)
}

/// The corners of both triangles of a block's cells, in the order of
/// [`ClothGrid::triangles`](crate::cloth::ClothGrid::triangles).
#[inline(always)]
fn corners_of(layout: Layout, contact: &ContactBlock, index: usize) -> [[Corner; 3]; 2] {
    let (block, strip) = (contact.block as usize, layout.strip as usize);
    let next = block + 1;
    let is_last = next.is_multiple_of(strip);
    let beside = if is_last { next - strip } else { next };
    let [right, below, below_right] = contact.around.map_inline(|contact| contact as usize);
    let corner = |block, contact, is_shifted| Corner {
        block,
        contact,
        is_shifted,
    };
    let own = corner(block, index, false);
    let right = corner(beside, right, is_last);
    let below = corner(block + strip, below, false);
    let below_right = corner(beside + strip, below_right, is_last);
    [[own, below, right], [right, below, below_right]]
}

/// The slots of a triangle of a cell.
pub(crate) fn slots_of(
    layout: Layout,
    contact: &ContactBlock,
    which: u32,
    lane: usize,
) -> [Slot; 3] {
    corners_of(layout, contact, 0)[which as usize].map_inline(|corner| Slot {
        block: corner.block,
        lane: lane + usize::from(corner.is_shifted),
    })
}

/// Pushes triangles out of a ball, from a given one on. Returns the reason for the end, and where to continue.
#[multiversion(targets("x86_64+avx+avx2"))]
pub(crate) fn push_cells(
    blocks: &mut [Block],
    contacts: &mut [ContactBlock],
    budgets: &mut [FrictionBudget],
    of: (&LaneMotion, &Cells),
    from: Place,
    sums: &mut Sums,
) -> (Stop, Place) {
    push_cells_baseline(blocks, contacts, budgets, of, from, sums)
}

#[inline(always)]
pub(crate) fn push_cells_baseline(
    blocks: &mut [Block],
    contacts: &mut [ContactBlock],
    budgets: &mut [FrictionBudget],
    (motion, cells): (&LaneMotion, &Cells),
    from: Place,
    sums: &mut Sums,
) -> (Stop, Place) {
    let first = contacts.partition_point(|contact| contact.block < from.block);
    let layout = cells.layout;
    let centre = cells.centre.iter().map(|at| at.abs()).sum::<f32>();
    for (index, contact) in contacts.iter_mut().enumerate().skip(first) {
        let block = contact.block;
        let pushed = cells.pushed + sums.passed * cells.max_faces;
        if !contact.has_cells() || motion.odometer + pushed < contact.faces_clear_until {
            continue;
        }
        let is_begun = from == Place { block, which: 1 };
        let is_cell = cells_of(layout, block);
        let corners = corners_of(layout, contact, index);
        // Blocks that were not tested are not clear.
        let mut clear = if is_begun {
            f32::NEG_INFINITY
        } else {
            f32::INFINITY
        };
        for which in u32::from(is_begun)..2 {
            let corners = corners[which as usize];
            let both = (&mut *contact, corners);
            let (left, least) = push_eight(blocks, both, budgets, &is_cell, (motion, cells), sums);
            clear = clear.min(least);
            contact.faces_clear_until = f32::NEG_INFINITY;
            let next = Place {
                block: block + which,
                which: 1 - which,
            };
            if left != [false; LANES] {
                let left = Stop::Left {
                    contact: index,
                    which,
                    lanes: left,
                };
                return (left, next);
            }
            if cells.pushed + sums.passed * cells.max_faces > cells.clearance {
                return (Stop::Room, next);
            }
        }
        // Smaller by rounding errors and by the tolerance of a touch.
        let rounding = 1.0e-5 * (centre + cells.reach + clear + motion.odometer);
        contact.faces_clear_until = motion.odometer + (clear - 2.0 * motion.tolerance - rounding);
    }
    (Stop::Done, Place::END)
}
