//! The patches of a grid, row by row, and the windows of 2 × 2 patches over them.

use std::ops::Range;

use crate::cloth::MapInline;

/// Number of rows and of columns of particles that a patch of a grid owns.
pub(super) const OWNED: u32 = 2;

/// The windows of a grid; none for a mesh.
#[derive(Debug, Default)]
pub(super) struct Windows {
    /// Number of rows and columns of particles, and of patches.
    particles: [u32; 2],
    size: [u32; 2],
    /// The patches row by row, and the row and column of each patch.
    patches: Vec<u32>,
    places: Vec<[u32; 2]>,
}

impl Windows {
    /// The windows of a grid with these columns and rows, without patches.
    pub fn new(particles: [u32; 2]) -> Self {
        let size = particles.map_inline(|of| of.div_ceil(OWNED));
        Self {
            particles,
            size,
            patches: vec![0; (size[0] * size[1]) as usize],
            places: Vec::new(),
        }
    }

    /// Number of rows and columns of patches.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Puts the next patch at a row and column. Returns the particles that it owns.
    pub fn put(&mut self, place: [u32; 2]) -> impl Iterator<Item = u32> + use<> {
        let [row, column] = place;
        self.patches[(row * self.size[1] + column) as usize] = self.places.len() as u32;
        self.places.push(place);
        let [rows, columns] = self.particles;
        let range = |at: u32, end: u32| OWNED * at..(OWNED * (at + 1)).min(end);
        let owned = range(column, columns);
        range(row, rows)
            .flat_map(move |row| owned.clone().map(move |column| row * columns + column))
    }

    /// Number of rows and columns of windows. A single row of patches is in one row of windows.
    fn counts(&self) -> [u32; 2] {
        self.size
            .map_inline(|of| of.saturating_sub(1).max(1).min(of))
    }

    /// Number of windows.
    pub fn count(&self) -> usize {
        let [rows, columns] = self.counts();
        (rows * columns) as usize
    }

    /// The rows and columns of patches in a window.
    fn range_of(&self, window: usize) -> [Range<u32>; 2] {
        let columns = self.counts()[1];
        let at = [window as u32 / columns, window as u32 % columns];
        [0, 1].map_inline(|axis| at[axis]..(at[axis] + 2).min(self.size[axis]))
    }

    /// The patches in a window, row by row.
    pub fn patches_in(&self, window: usize) -> impl Iterator<Item = u32> {
        let [rows, columns] = self.range_of(window);
        let places = rows.flat_map(move |row| columns.clone().map(move |column| [row, column]));
        places.map(|[row, column]| self.patches[(row * self.size[1] + column) as usize])
    }

    /// The rows and columns of particles of all features in a window.
    #[inline]
    pub fn particles_in(&self, window: usize) -> [Range<usize>; 2] {
        let of = self.range_of(window);
        [0, 1].map_inline(|axis| {
            let last = (OWNED * of[axis].end).min(self.particles[axis] - 1);
            (OWNED * of[axis].start) as usize..last as usize + 1
        })
    }

    /// The windows in which two patches are.
    #[inline]
    pub fn with(&self, of: [u32; 2]) -> impl Iterator<Item = usize> {
        let place = |patch: u32| self.places.get(patch as usize).copied();
        let [a, b] = of.map_inline(|patch| place(patch).unwrap_or_default());
        let counts = self.counts();
        let [rows, columns] = [0, 1].map_inline(|axis| {
            let first = a[axis].max(b[axis]).saturating_sub(1);
            first..(a[axis].min(b[axis]) + 1).min(counts[axis])
        });
        rows.flat_map(move |row| columns.clone().map(move |column| (row, column)))
            .map(move |(row, column)| (row * counts[1] + column) as usize)
    }

    /// Whether some window has both patches.
    #[inline]
    pub fn are_neighbours(&self, of: [u32; 2]) -> bool {
        self.with(of).next().is_some()
    }

    /// Which neighbour the second patch is of the first, which is before it or the same: 1 to 5.
    #[inline]
    pub fn neighbour(&self, of: [u32; 2]) -> u32 {
        let [a, b] = of.map_inline(|patch| self.places[patch as usize]);
        3 * (b[0] - a[0]) + b[1] + 1 - a[1]
    }
}
