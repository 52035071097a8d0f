//! The face that a particle stands for: its normal, as long as its area.

use crate::{
    cloth::{Block, LANES, Lanes, Layout, Slot, Surface, View, X},
    solver::{barrier::one_block_at_a_time, pentadiagonal::Trio},
};

/// A row of a grid, and the rows above and below it, itself where there is none.
pub(crate) struct Rows<'a> {
    pub own: &'a [Block],
    pub above: &'a [Block],
    pub below: &'a [Block],
    /// Where the row's last particle is.
    pub last: Slot,
}

/// The areas of a row's particles: `(below − above) × (right − left) ⁄ 4` (m²), the particle itself where it has no neighbour. That
/// is half of the diamond of its neighbours, and on a flat grid what each particle stands for, at borders and corners too.
#[inline(always)]
pub(crate) fn air_areas(rows: &Rows, areas: &mut [Trio]) {
    let strip = rows.own.len();
    for j in 0..strip {
        let own = rows.own[j].view();
        let right = match rows.own.get(j + 1) {
            Some(block) => places(block.view()),
            None => places(rows.own[0].shifted()),
        };
        let right = if j == rows.last.block {
            ending(right, own, rows.last.lane)
        } else {
            right
        };
        let left = match j.checked_sub(1) {
            Some(before) => places(rows.own[before].view()),
            None => behind(&places(rows.own[strip - 1].view()), own),
        };
        let (above, below) = (rows.above[j].view(), rows.below[j].view());
        let area = &mut areas[j];
        for l in 0..LANES {
            let a = [0, 1, 2].map(|axis| below[X + axis * LANES + l] - above[X + axis * LANES + l]);
            let b = [0, 1, 2].map(|axis| right[axis][l] - left[axis][l]);
            area[0][l] = 0.25 * (a[1] * b[2] - a[2] * b[1]);
            area[1][l] = 0.25 * (a[2] * b[0] - a[0] * b[2]);
            area[2][l] = 0.25 * (a[0] * b[1] - a[1] * b[0]);
        }
        one_block_at_a_time();
    }
}

#[inline(always)]
fn places(view: &View) -> Trio {
    let mut places = [[0.0; LANES]; 3];
    for (axis, places) in places.iter_mut().enumerate() {
        places.copy_from_slice(&view[X + axis * LANES..][..LANES]);
    }
    places
}

/// Without a neighbour in one lane.
#[inline(always)]
fn ending(mut right: Trio, own: &View, lane: usize) -> Trio {
    for (axis, right) in right.iter_mut().enumerate() {
        right[lane] = own[X + axis * LANES + lane];
    }
    right
}

/// The lanes before those of a strip's last block; the first has none.
#[inline(always)]
fn behind(last: &Trio, own: &View) -> Trio {
    let mut left = [[0.0; LANES]; 3];
    for (axis, (left, last)) in left.iter_mut().zip(last).enumerate() {
        left[0] = own[X + axis * LANES];
        left[1..].copy_from_slice(&last[..LANES - 1]);
    }
    left
}

/// Which particles the corners of a mesh's triangles are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Triangles(Vec<[Corner; 3]>);

/// A block and a lane.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Corner {
    block: u32,
    lane: u32,
}

impl Triangles {
    /// Those of a surface.
    pub fn new(surface: &Surface) -> Self {
        let layout = Layout::of(surface);
        let corner = |particle: u32| {
            let Slot { block, lane } = layout.slot_of(particle as usize);
            Corner {
                block: block as u32,
                lane: lane as u32,
            }
        };
        let all = surface.triangles().iter();
        Self(all.map(|corners| corners.map(corner)).collect())
    }

    /// The areas of all particles: a third of each of their triangles (m²). Returns the volume that these enclose (m³), if they
    /// enclose one.
    pub fn areas(&self, blocks: &[Block], areas: &mut [Trio]) -> f32 {
        areas.fill([[0.0; LANES]; 3]);
        let Some(first) = blocks.first() else {
            return 0.0;
        };
        // Near it all, so that little is rounded away.
        let origin = first.position(0);
        let mut volume = 0.0_f64;
        for corners in &self.0 {
            let [a, b, c] =
                corners.map(|at| blocks[at.block as usize].position(at.lane as usize) - origin);
            let double = (b - a).cross(c - a);
            volume += f64::from(a.dot(double));
            let share = (double / 6.0).to_array();
            for at in corners {
                let area = &mut areas[at.block as usize];
                for axis in 0..3 {
                    area[axis][at.lane as usize] += share[axis];
                }
            }
        }
        (volume / 6.0) as f32
    }
}

/// The lanes of one axis, from one end of a strip to the other.
pub(super) fn between(from: &Lanes, to: &Lanes, part: f32) -> Lanes {
    std::array::from_fn(|l| from[l] + part * (to[l] - from[l]))
}
