//! A wind that depends on the position, known at some positions and interpolated between them.

use bevy::math::Vec3;

use crate::{
    cloth::{ClothParticles, LANES, Layout},
    solver::kernels::{Vec3Lanes, between},
};

/// Intervals along a row and along a column of a grid, and along the longest side of a mesh.
const ALONG_ROW: usize = LANES;
const ALONG_COLUMN: usize = 8;
const ALONG_SIDE: usize = 4;

/// The wind at some places of a cloth, in its frame (m/s).
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct LocalWind {
    /// On a grid, 9 places a row and 9 rows; on a mesh, those of a lattice around it.
    knots: Vec<Vec3>,
    lattice: Lattice,
}

/// Places around a mesh.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Lattice {
    low: Vec3,
    /// Cells along each axis, and how many of them a metre has.
    cells: [usize; 3],
    per_metre: Vec3,
}

impl LocalWind {
    /// Asks for the wind where a cloth is now.
    pub fn sample(
        &mut self,
        particles: &ClothParticles,
        is_grid: bool,
        at: impl FnMut(Vec3) -> Vec3,
    ) {
        self.knots.clear();
        if is_grid {
            let places = knot_places(particles);
            self.knots.extend(places.map(at));
        } else {
            self.lattice = Lattice::around(particles);
            // As many as there may be: a mesh that moves asks for others in each tick.
            self.knots.reserve((ALONG_SIDE + 1).pow(3));
            self.knots.extend(self.lattice.places().map(at));
        }
    }

    /// Of the particles of a grid's row.
    ///
    /// The knots of a row are where its eight strips begin and end, so that of each block all lanes are as far between theirs.
    pub fn of_row(&self, row: usize, layout: Layout, winds: &mut [Vec3Lanes]) {
        let rows = layout.rows as usize;
        let border = |index: usize| index * (rows - 1) / ALONG_COLUMN;
        let index = (0..ALONG_COLUMN).find(|index| border(index + 1) > row);
        let index = index.unwrap_or(ALONG_COLUMN - 1);
        let (from, to) = (border(index), border(index + 1));
        let part = (row - from) as f32 / (to - from).max(1) as f32;
        let mut ends = [[[0.0; LANES]; 3]; 2];
        for (after, [x, y, z]) in ends.iter_mut().enumerate() {
            let lanes = x.iter_mut().zip(y).zip(z).enumerate();
            for (l, ((x, y), z)) in lanes {
                let knot = |index: usize| self.knots[index * (ALONG_ROW + 1) + l + after];
                [*x, *y, *z] = knot(index).lerp(knot(index + 1), part).to_array();
            }
        }
        let strip = winds.len() as f32;
        for (block, wind) in winds.iter_mut().enumerate() {
            let part = block as f32 / strip;
            for (axis, wind) in wind.iter_mut().enumerate() {
                *wind = between(&ends[0][axis], &ends[1][axis], part);
            }
        }
    }

    /// Of all particles of a mesh.
    pub fn of_mesh(&self, particles: &ClothParticles, winds: &mut [Vec3Lanes]) {
        for (place, slot) in particles.positions().zip(particles.layout().slots()) {
            let wind = self.lattice.interpolate(&self.knots, place).to_array();
            for axis in 0..3 {
                winds[slot.block][axis][slot.lane] = wind[axis];
            }
        }
    }
}

/// Where the knots of a grid are, row by row.
fn knot_places(particles: &ClothParticles) -> impl Iterator<Item = Vec3> + '_ {
    let layout = particles.layout();
    let (rows, last) = (layout.rows as usize, layout.columns as usize - 1);
    (0..=ALONG_COLUMN).flat_map(move |index| {
        let first = index * (rows - 1) / ALONG_COLUMN * layout.columns as usize;
        let place = move |column: usize| particles.position_at(first + column);
        (0..=ALONG_ROW).map(move |knot| {
            let column = knot * layout.strip as usize;
            if column <= last {
                return place(column);
            }
            // The strip that the row ends in goes on straight.
            let from = (column - layout.strip as usize).min(last);
            let displacement = place(last) - place(from);
            let part = layout.strip as f32 / (last - from).max(1) as f32;
            place(from) + displacement * part
        })
    })
}

impl Lattice {
    fn around(particles: &ClothParticles) -> Self {
        let low = particles.positions().fold(Vec3::MAX, Vec3::min);
        let high = particles.positions().fold(Vec3::MIN, Vec3::max);
        let size = high - low;
        let cell = size.max_element() / ALONG_SIDE as f32;
        // A cloth without a size is one cell.
        let count = |side: f32| ((side / cell).ceil() as usize).clamp(1, ALONG_SIDE);
        let cells = size.to_array().map(count);
        let along = cells.map(|count| count as f32);
        let per_metre = Vec3::select(size.cmpgt(Vec3::ZERO), Vec3::from(along) / size, Vec3::ZERO);
        Self {
            low,
            cells,
            per_metre,
        }
    }

    fn places(&self) -> impl Iterator<Item = Vec3> + use<> {
        let Self {
            low,
            cells: [x, y, z],
            per_metre,
        } = *self;
        let is_wide = per_metre.cmpgt(Vec3::ZERO);
        let cell = Vec3::select(is_wide, 1.0 / per_metre, Vec3::ZERO);
        (0..=x).flat_map(move |x| {
            (0..=y).flat_map(move |y| {
                (0..=z).map(move |z| low + Vec3::new(x as f32, y as f32, z as f32) * cell)
            })
        })
    }

    fn interpolate(&self, knots: &[Vec3], place: Vec3) -> Vec3 {
        let [_, y, z] = self.cells;
        let along = (place - self.low) * self.per_metre;
        let (mut from, mut part) = ([0; 3], [0.0; 3]);
        for axis in 0..3 {
            from[axis] = (along[axis] as usize).min(self.cells[axis] - 1);
            // What has moved out of the lattice since has the wind of its border.
            part[axis] = (along[axis] - from[axis] as f32).clamp(0.0, 1.0);
        }
        let index = (from[0] * (y + 1) + from[1]) * (z + 1) + from[2];
        let edge = |at: usize| knots[at].lerp(knots[at + 1], part[2]);
        let side = |at: usize| edge(at).lerp(edge(at + z + 1), part[1]);
        side(index).lerp(side(index + (y + 1) * (z + 1)), part[0])
    }
}
