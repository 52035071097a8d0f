//! The face of a particle: its normal, as long as its area.

use bevy::math::Vec3A;

use super::{barrier::one_block_at_a_time, each::three, pentadiagonal::Vec3Lanes};
use crate::cloth::{Block, LANES, Lanes, Layout, Run, Slot, Surface, View, X};

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
pub(crate) fn air_areas(rows: &Rows, areas: &mut [Vec3Lanes]) {
    let strip = rows.own.len();
    for (j, area) in areas.iter_mut().enumerate().take(strip) {
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
        for l in 0..LANES {
            let a = three(|axis| below[X + axis * LANES + l] - above[X + axis * LANES + l]);
            let b = three(|axis| right[axis][l] - left[axis][l]);
            area[0][l] = 0.25 * (a[1] * b[2] - a[2] * b[1]);
            area[1][l] = 0.25 * (a[2] * b[0] - a[0] * b[2]);
            area[2][l] = 0.25 * (a[0] * b[1] - a[1] * b[0]);
        }
        one_block_at_a_time();
    }
}

#[inline(always)]
fn places(view: &View) -> Vec3Lanes {
    let mut places = [[0.0; LANES]; 3];
    for (axis, places) in places.iter_mut().enumerate() {
        places.copy_from_slice(&view[X + axis * LANES..][..LANES]);
    }
    places
}

/// Without a neighbour in one lane.
#[inline(always)]
fn ending(mut right: Vec3Lanes, own: &View, lane: usize) -> Vec3Lanes {
    for (axis, right) in right.iter_mut().enumerate() {
        right[lane] = own[X + axis * LANES + lane];
    }
    right
}

/// The lanes before those of a strip's last block; the first has none.
#[inline(always)]
fn behind(last: &Vec3Lanes, own: &View) -> Vec3Lanes {
    let mut left = [[0.0; LANES]; 3];
    for (axis, (left, last)) in left.iter_mut().zip(last).enumerate() {
        left[0] = own[X + axis * LANES];
        left[1..].copy_from_slice(&last[..LANES - 1]);
    }
    left
}

/// The triangles of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Triangles {
    corners: Vec<[u32; 3]>,
    /// 1, or −1 where faces are turned inwards at rest.
    outwards: f64,
    /// Of particles, in order: places from the first one (m), and six times the areas (m²).
    places: Vec<Vec3A>,
    areas: Vec<Vec3A>,
}

/// The volume that triangles enclose.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct Enclosed {
    /// Volume (m³), positive as long as it is not turned inside out.
    pub volume: f64,
    /// 1, or −1 where faces are turned inwards.
    pub outwards: f64,
    /// Of all particles (m²): how fast the volume grows where all move outwards along their normals.
    pub area: f64,
}

impl Triangles {
    /// Those of a surface.
    pub fn new(surface: &Surface) -> Self {
        let places = surface.rest_positions();
        let origin = places.first().copied().unwrap_or_default();
        let mut triangles = Self {
            corners: surface.triangles().to_vec(),
            outwards: 1.0,
            places: places.iter().map(|at| (*at - origin).into()).collect(),
            areas: vec![Vec3A::ZERO; places.len()],
        };
        triangles.add_up();
        if triangles.enclosed().volume < 0.0 {
            triangles.outwards = -1.0;
        }
        triangles
    }

    /// The areas of all particles: a third of each of their triangles (m²). Returns what these enclose, if they enclose anything.
    pub fn areas(&mut self, blocks: &[Block], layout: Layout, areas: &mut [Vec3Lanes]) -> Enclosed {
        let Some(first) = blocks.first() else {
            return Enclosed::default();
        };
        // Near the first of them, so that little is rounded away.
        let origin = first.position(0);
        for run in layout.runs() {
            let places = &mut self.places[run.index..][..run.count];
            for (place, block) in places.iter_mut().zip(&blocks[run.block..]) {
                *place = (block.position(run.lane) - origin).into();
            }
        }
        self.add_up();
        for Run {
            lane,
            index,
            block,
            count,
        } in layout.runs()
        {
            let sums = &self.areas[index..][..count];
            for (sum, area) in sums.iter().zip(&mut areas[block..]) {
                let own = *sum / 6.0;
                [area[0][lane], area[1][lane], area[2][lane]] = own.to_array();
            }
        }
        self.enclosed()
    }

    /// Adds up the areas around each particle.
    fn add_up(&mut self) {
        self.areas.fill(Vec3A::ZERO);
        for corners in &self.corners {
            let [a, b, c] = three(|at| self.places[corners[at] as usize]);
            let double = (b - a).cross(c - a);
            for corner in corners {
                self.areas[*corner as usize] += double;
            }
        }
    }

    /// All corners of a triangle have the same product with its area: a third of it is its part of the volume.
    fn enclosed(&self) -> Enclosed {
        let (mut volume, mut area) = (0.0_f64, 0.0_f64);
        for (place, sum) in self.places.iter().zip(&self.areas) {
            volume += f64::from(place.dot(*sum));
            area += f64::from(sum.length());
        }
        Enclosed {
            volume: self.outwards * volume / 18.0,
            outwards: self.outwards,
            area: area / 6.0,
        }
    }
}

/// The lanes of one axis, from one end of a strip to the other.
pub(crate) fn between(from: &Lanes, to: &Lanes, part: f32) -> Lanes {
    let mut between = [0.0; LANES];
    for l in 0..LANES {
        between[l] = from[l] + part * (to[l] - from[l]);
    }
    between
}
