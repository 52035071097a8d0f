//! A quick test of a whole cloth: whether it is too flat to touch itself.

use bevy::math::{Vec2, Vec3A};
use multiversion::multiversion;

use super::bounds::{Bounds, Tangents};
use crate::cloth::{Block, ClothParticles, LANES, Lanes, Layout, View, X, Y, Z};

/// Minimum and maximum of eight lanes, of x, y and z.
type Extremes = [[Lanes; 3]; 2];

const NONE: Extremes = [[[f32::INFINITY; LANES]; 3], [[f32::NEG_INFINITY; LANES]; 3]];

/// Masks of the lanes of a grid's row that hold particles, and of those with right neighbours: 0 there, NaN elsewhere,
/// which is never an extreme.
#[derive(Debug, Default)]
pub(super) struct Masks {
    is_there: Vec<Lanes>,
    has_right: Vec<Lanes>,
}

impl Masks {
    pub fn new(layout: Layout) -> Self {
        let mask = |columns: u32| {
            let lane = |block, lane| match layout.column(block, lane) {
                Some(column) if column < columns => 0.0,
                _ => f32::NAN,
            };
            let lanes = |block| std::array::from_fn(|l| lane(block, l));
            (0..layout.strip as usize).map(lanes).collect()
        };
        Self {
            is_there: mask(layout.columns),
            has_right: mask(layout.columns.saturating_sub(1)),
        }
    }
}

/// Bounds of the tangents of all rows and columns of a grid, at the particles' current positions.
pub(super) fn tangents_of_all(
    particles: &ClothParticles,
    masks: &Masks,
    spacing: Vec2,
) -> Tangents {
    let (mut across, mut down) = (NONE, NONE);
    extremes(particles.blocks(), masks, &mut across, &mut down);
    let per_metre = spacing.recip();
    let bounds = |of: Extremes, scale: f32| {
        let [min, max] = of;
        let fold = |lanes: &Lanes, start: f32, pick: fn(f32, f32) -> f32| {
            lanes.iter().copied().fold(start, pick)
        };
        let corner = |of: [Lanes; 3], start, pick| {
            Vec3A::from(of.map(|lanes| fold(&lanes, start, pick))) * scale
        };
        Bounds {
            min: corner(min, f32::INFINITY, f32::min),
            max: corner(max, f32::NEG_INFINITY, f32::max),
        }
    };
    Tangents::between(bounds(across, per_metre.x), bounds(down, per_metre.y))
}

#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
fn extremes(blocks: &[Block], masks: &Masks, across: &mut Extremes, down: &mut Extremes) {
    let mut above: Option<&[Block]> = None;
    for row in blocks.chunks_exact(masks.is_there.len()) {
        for (index, (block, mask)) in row.iter().zip(&masks.has_right).enumerate() {
            let right = match row.get(index + 1) {
                Some(next) => next.view(),
                None => row[0].shifted(),
            };
            note(block.view(), right, mask, across);
        }
        if let Some(above) = above {
            for ((upper, lower), mask) in above.iter().zip(row).zip(&masks.is_there) {
                note(upper.view(), lower.view(), mask, down);
            }
        }
        above = Some(row);
    }
}

/// Adds the differences of eight pairs of particles.
#[inline(always)]
fn note(from: &View, to: &View, mask: &Lanes, [min, max]: &mut Extremes) {
    for (axis, (min, max)) in [X, Y, Z].into_iter().zip(min.iter_mut().zip(max)) {
        for l in 0..LANES {
            let difference = to[axis + l] - from[axis + l] + mask[l];
            min[l] = if difference < min[l] {
                difference
            } else {
                min[l]
            };
            max[l] = if difference > max[l] {
                difference
            } else {
                max[l]
            };
        }
    }
}
