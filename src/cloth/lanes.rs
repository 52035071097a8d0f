//! The memory layout of particles: blocks of eight lanes, so that one instruction works on eight springs.
//!
//! Each row of the grid is cut into eight strips side by side, each `strip` columns long. Lane `l` of a row's block `j`
//! is the particle in column `l × strip + j`. So the neighbours of a whole block are whole blocks:
//!
//! ```text
//! columns of a row, strip = 4:   0 1 2 3 | 4 5 6 7 | 8 9 10 11 | …
//! block 0 = columns 0 4 8 …      block 1 = columns 1 5 9 …      block 2 = …
//! ```
//!
//! The right neighbours of a row's last block are in its first block, one lane further on: a view of that block that
//! begins one number later. An infinite compliance masks the last lane of that view.

use bevy::{math::Vec3, reflect::Reflect};

/// Particles in a block.
pub(crate) const LANES: usize = 8;

/// One number for each particle of a block.
pub(crate) type Lanes = [f32; LANES];

/// Where each quantity begins in a block: position (m), inverse mass (1/kg), displacement (m).
pub(crate) const X: usize = 0;
pub(crate) const Y: usize = LANES;
pub(crate) const Z: usize = 2 * LANES;
pub(crate) const W: usize = 3 * LANES;
pub(crate) const DX: usize = 4 * LANES;
pub(crate) const DY: usize = 5 * LANES;
pub(crate) const DZ: usize = 6 * LANES;
/// Where the next one would.
const END: usize = 7 * LANES;

/// The numbers of eight particles, each quantity's together.
pub(crate) type View = [f32; END];

/// The smaller of two numbers, in one instruction; the second if one is NaN.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two numbers, likewise.
#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The larger of two numbers; NaN if one is.
#[inline(always)]
pub(crate) fn larger_or_nan(a: f32, b: f32) -> f32 {
    if b <= a || a.is_nan() { a } else { b }
}

/// Eight particles: 256 bytes, four cache lines. The last eight numbers are room for a view to be shifted.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[repr(C, align(64))]
pub(crate) struct Block(
    #[cfg_attr(feature = "serialize", serde(with = "by_lanes"))] [f32; 8 * LANES],
);

/// A block as eight times eight numbers: serde has no longer arrays than 32.
#[cfg(feature = "serialize")]
mod by_lanes {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::{LANES, Lanes};

    #[inline]
    pub fn serialize<S: Serializer>(block: &[f32; 8 * LANES], to: S) -> Result<S::Ok, S::Error> {
        let mut lanes: [Lanes; 8] = Default::default();
        lanes.as_flattened_mut().copy_from_slice(block);
        lanes.serialize(to)
    }

    #[inline]
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[f32; 8 * LANES], D::Error> {
        let lanes = <[Lanes; 8]>::deserialize(from)?;
        let mut block = [0.0; 8 * LANES];
        block.copy_from_slice(lanes.as_flattened());
        Ok(block)
    }
}

impl Block {
    /// No particles: at the origin, and nothing moves them.
    pub const EMPTY: Self = Self([0.0; 8 * LANES]);

    #[inline(always)]
    pub fn view(&self) -> &View {
        self.0.first_chunk().expect("56 of 64 numbers")
    }

    #[inline(always)]
    pub fn view_mut(&mut self) -> &mut View {
        self.0.first_chunk_mut().expect("56 of 64 numbers")
    }

    /// The view in which each lane holds its right neighbour's numbers. The last lane holds no particle.
    #[inline(always)]
    pub fn shifted(&self) -> &View {
        self.0[1..].first_chunk().expect("56 of 63 numbers")
    }

    #[inline(always)]
    pub fn shifted_mut(&mut self) -> &mut View {
        self.0[1..].first_chunk_mut().expect("56 of 63 numbers")
    }

    /// Displacements alone: x, y and z.
    #[inline(always)]
    pub fn displacements_mut(&mut self) -> &mut [f32; 3 * LANES] {
        self.0[DX..].first_chunk_mut().expect("24 of 32 numbers")
    }

    #[inline]
    pub fn position(&self, lane: usize) -> Vec3 {
        Vec3::new(self.0[X + lane], self.0[Y + lane], self.0[Z + lane])
    }

    #[inline]
    pub fn displacement(&self, lane: usize) -> Vec3 {
        Vec3::new(self.0[DX + lane], self.0[DY + lane], self.0[DZ + lane])
    }

    #[inline]
    pub fn inverse_mass(&self, lane: usize) -> f32 {
        self.0[W + lane]
    }

    #[inline]
    pub fn set_position(&mut self, lane: usize, position: Vec3) {
        [self.0[X + lane], self.0[Y + lane], self.0[Z + lane]] = position.to_array();
    }

    #[inline]
    pub fn set_displacement(&mut self, lane: usize, displacement: Vec3) {
        [self.0[DX + lane], self.0[DY + lane], self.0[DZ + lane]] = displacement.to_array();
    }

    /// Adds to a displacement (m).
    #[inline]
    pub fn displace(&mut self, lane: usize, by: Vec3) {
        self.set_displacement(lane, self.displacement(lane) + by);
    }

    #[inline]
    pub fn set_inverse_mass(&mut self, lane: usize, inverse_mass: f32) {
        self.0[W + lane] = inverse_mass;
    }
}

/// Which block and lane each particle is in: row by row, of which the last may not be full.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Layout {
    pub columns: u32,
    pub rows: u32,
    /// Columns in a strip, and so blocks in a row: even, so that springs in a row have two colours.
    pub strip: u32,
    /// Particles.
    count: u32,
    /// Whether neighbours in rows and columns are corners of cells: those of a whole grid.
    pub has_cells: bool,
}

/// Particles one after the other in a lane: those with the indices from `index` on are in the blocks from `block` on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run {
    pub lane: usize,
    pub index: usize,
    pub block: usize,
    pub count: usize,
}

/// A particle's block and lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Slot {
    pub block: usize,
    pub lane: usize,
}

impl Layout {
    #[inline]
    pub fn new(columns: u32, rows: u32) -> Self {
        let strip = columns.div_ceil(LANES as u32).next_multiple_of(2).max(2);
        Self {
            columns,
            rows,
            strip,
            count: columns.saturating_mul(rows),
            has_cells: rows > 1,
        }
    }

    /// The rows of a grid that is torn or mapped, and those of the particles that tears made behind them.
    pub fn of_torn_grid(columns: u32, count: u32) -> Self {
        Self {
            count,
            has_cells: false,
            ..Self::new(columns, count.div_ceil(columns.max(1)))
        }
    }

    /// Whether its numbers fit each other, as those of a scene file may not.
    pub fn is_valid(&self) -> bool {
        let Self { columns, rows, .. } = *self;
        columns.checked_mul(rows).is_some()
            && (columns > 0 || self.count == 0)
            && (*self == Self::new(columns, rows)
                || *self == Self::of_torn_grid(columns, self.count))
    }

    /// Number of particles.
    #[inline]
    pub fn len(&self) -> usize {
        self.count as usize
    }

    /// Number of blocks.
    #[inline]
    pub fn blocks(&self) -> usize {
        self.strip as usize * self.rows as usize
    }

    #[inline]
    pub fn slot(&self, row: u32, column: u32) -> Slot {
        Slot {
            block: row as usize * self.strip as usize + (column % self.strip) as usize,
            lane: (column / self.strip) as usize,
        }
    }

    /// The slot of a particle's index.
    #[inline]
    pub fn slot_of(&self, index: usize) -> Slot {
        let index = index as u32;
        self.slot(index / self.columns, index % self.columns)
    }

    /// The index of the particle in a block's lane, if it holds one.
    #[inline]
    pub fn index_at(&self, block: usize, lane: usize) -> Option<u32> {
        let (row, block) = (block as u32 / self.strip, block % self.strip as usize);
        let index = row * self.columns + self.column(block, lane)?;
        (index < self.count).then_some(index)
    }

    /// All particles, lane by lane of each row.
    pub fn runs(&self) -> impl Iterator<Item = Run> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let (strip, count) = (self.strip, self.count);
        let lanes = (0..rows).flat_map(|row| (0..LANES as u32).map(move |lane| (row, lane)));
        lanes.filter_map(move |(row, lane)| {
            let index = row * columns + lane * strip;
            let end = (row * columns + ((lane + 1) * strip).min(columns)).min(count);
            (index < end).then(|| Run {
                lane: lane as usize,
                index: index as usize,
                block: (row * strip) as usize,
                count: (end - index) as usize,
            })
        })
    }

    /// The column of a lane of a row's block, if a whole row has one there.
    #[inline]
    pub fn column(&self, block: usize, lane: usize) -> Option<u32> {
        let column = lane as u32 * self.strip + block as u32;
        (column < self.columns).then_some(column)
    }

    /// All slots in the order of the particles' indices.
    #[inline]
    pub fn slots(&self) -> impl ExactSizeIterator<Item = Slot> + use<> {
        let layout = *self;
        let mut next = (0, 0, 0);
        (0..self.count as usize).map(move |_| {
            let (row, lane, block) = next;
            let slot = Slot {
                block: row * layout.strip as usize + block,
                lane,
            };
            next = if layout.column(block, lane) == Some(layout.columns - 1) {
                (row + 1, 0, 0)
            } else if block + 1 == layout.strip as usize {
                (row, lane + 1, 0)
            } else {
                (row, lane, block + 1)
            };
            slot
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of whole rows, and with a last row that is not full.
    #[test]
    fn each_particle_has_a_slot_of_its_own() {
        for columns in [1, 2, 7, 8, 9, 16, 31, 32, 33, 48, 64, 65, 100] {
            let torn =
                [0, 1, columns / 2].map(|more| Layout::of_torn_grid(columns, 3 * columns + more));
            for layout in [Layout::new(columns, 3)].into_iter().chain(torn) {
                assert!(layout.is_valid());
                let mut seen = vec![[None; LANES]; layout.blocks()];
                for (index, slot) in layout.slots().enumerate() {
                    assert_eq!(slot, layout.slot_of(index), "{columns} columns");
                    let column = layout.column(slot.block % layout.strip as usize, slot.lane);
                    assert_eq!(column, Some(index as u32 % columns));
                    assert_eq!(seen[slot.block][slot.lane].replace(index as u32), None);
                }
                assert_eq!(layout.slots().len(), layout.len());
                let mut runs = vec![[None; LANES]; layout.blocks()];
                for Run {
                    lane,
                    index,
                    block,
                    count,
                } in layout.runs()
                {
                    for at in 0..count {
                        runs[block + at][lane] = Some((index + at) as u32);
                    }
                }
                assert_eq!(runs, seen);
                for (block, lanes) in seen.iter().enumerate() {
                    for (lane, index) in lanes.iter().enumerate() {
                        assert_eq!(layout.index_at(block, lane), *index);
                    }
                }
            }
        }
    }

    /// A scene file may say anything: where there is no column, there is no particle.
    #[test]
    fn particles_need_columns() {
        for count in [0, 1, 9] {
            assert_eq!(Layout::of_torn_grid(0, count).is_valid(), count == 0);
        }
        let most = Layout::new(u32::MAX, 2);
        assert!(!most.is_valid());
    }

    #[test]
    fn right_neighbours_are_in_the_next_block_or_a_lane_on_in_the_first() {
        let layout = Layout::new(37, 1);
        let mut blocks = vec![Block::EMPTY; layout.blocks()];
        for (index, slot) in layout.slots().enumerate() {
            blocks[slot.block].set_position(slot.lane, Vec3::splat(index as f32));
        }
        let last = layout.strip as usize - 1;
        for column in 0..36 {
            let slot = layout.slot(0, column);
            let right = if slot.block == last {
                blocks[0].shifted()
            } else {
                blocks[slot.block + 1].view()
            };
            assert_eq!(right[X + slot.lane], (column + 1) as f32);
            assert_eq!(right[Z + slot.lane], (column + 1) as f32);
        }
    }
}
