//! Windows: neighbouring patches that meet at a particle.
//!
//! ```text
//!   ┌───┬───┬───┬───┐          ╲ a │ b ╱
//!   │ a │ b │   │   │           ╲__│__╱        patches that have features of one particle are in a window;
//!   ├───┼───┼───┼───┤           ╱  c  ╲        two patches of a window are neighbours
//!   │ c │ d │   │   │
//!   └───┴───┴───┴───┘
//! ```

use super::{flattened::Flattened, flattening::Flattening};
use crate::cloth::{Grouped, Surface};

/// Most patches of a window. Where more meet, as in the hub of a wheel, their boxes tell which are near.
const MOST_PATCHES: usize = 32;

/// The windows of a sheet, and which patches are neighbours in them.
#[derive(Debug, Default)]
pub(super) struct Windows {
    /// Laid flat, where that is possible.
    flattened: Vec<Option<Flattened>>,
    /// The patches of each window, in order.
    patches: Grouped<u32>,
    /// The neighbours of each patch, itself included: those that do not come before it.
    neighbours: Grouped<u32>,
    /// The windows of each pair of neighbours.
    of_pairs: Grouped<u32>,
}

impl Windows {
    /// The windows of patches of a surface. `patches_with` returns the patches with features of a particle, in order, `features_of` the
    /// faces and the vertices of a patch.
    pub fn new<'a>(
        surface: &'a Surface,
        patches: usize,
        patches_with: impl Fn(u32) -> &'a [u32],
        features_of: impl Fn(u32) -> (Vec<[u32; 3]>, &'a [u32]),
    ) -> Self {
        let mut sets: Vec<&[u32]> = (0..surface.len() as u32).map(patches_with).collect();
        sets.sort_unstable_by(|a, b| b.len().cmp(&a.len()).then(a.cmp(b)));
        sets.dedup();
        sets.retain(|set| set.len() <= MOST_PATCHES);
        // A set within another is no window of its own.
        let mut windows_of: Vec<Vec<usize>> = vec![Vec::new(); patches];
        let mut windows: Vec<&[u32]> = Vec::new();
        for set in sets {
            let Some(first) = set.first() else { continue };
            let has_all = |window: &usize| {
                let patches = windows[*window];
                set.iter().all(|patch| patches.contains(patch))
            };
            if windows_of[*first as usize].iter().any(has_all) {
                continue;
            }
            for &patch in set {
                windows_of[patch as usize].push(windows.len());
            }
            windows.push(set);
        }
        let mut pairs: Vec<[u32; 3]> = Vec::new();
        for (window, patches) in windows.iter().enumerate() {
            for (at, &a) in patches.iter().enumerate() {
                pairs.extend(patches[at..].iter().map(|&b| [a, b, window as u32]));
            }
        }
        pairs.sort_unstable();
        let mut neighbours: Vec<[u32; 2]> = pairs.iter().map(|&[a, b, _]| [a, b]).collect();
        neighbours.dedup();
        let mut flattening = Flattening::new(surface);
        let flattened = windows.iter().map(|patches| {
            let (faces, vertices): (Vec<_>, Vec<_>) =
                patches.iter().map(|&patch| features_of(patch)).unzip();
            flattening.flatten(faces.into_iter().flatten(), &vertices.concat())
        });
        let flattened = flattened.collect();
        let each = windows.iter().enumerate();
        let shared = pairs.chunk_by(|a, b| a[..2] == b[..2]).enumerate();
        Self {
            flattened,
            patches: Grouped::new(windows.len(), || {
                let each = each.clone();
                each.flat_map(|(index, patches)| patches.iter().map(move |&of| (index as u32, of)))
            }),
            of_pairs: Grouped::new(neighbours.len(), || {
                let shared = shared.clone();
                shared.flat_map(|(pair, of)| of.iter().map(move |of| (pair as u32, of[2])))
            }),
            neighbours: Grouped::new(patches, || neighbours.iter().map(|&[a, b]| (a, b))),
        }
    }

    /// Number of windows.
    pub fn count(&self) -> usize {
        self.flattened.len()
    }

    /// Number of pairs of neighbours.
    pub fn pair_count(&self) -> usize {
        self.of_pairs.len()
    }

    /// A window laid flat; `None` if it cannot be.
    #[inline]
    pub fn flattened(&self, window: usize) -> Option<&Flattened> {
        self.flattened[window].as_ref()
    }

    /// The patches in a window, in order, and the place of the first among those of all windows.
    #[inline]
    pub fn patches_in(&self, window: usize) -> (usize, &[u32]) {
        let patches = self.patches.range_of(window as u32);
        (patches.start, self.patches.of(window as u32))
    }

    /// Number of patches in all windows: one counts in each of its windows.
    pub fn member_count(&self) -> usize {
        let last = self.count().checked_sub(1);
        last.map_or(0, |last| self.patches.range_of(last as u32).end)
    }

    /// The pair of neighbours that two patches are, in order.
    #[inline]
    pub fn pair_of(&self, [a, b]: [u32; 2]) -> Option<usize> {
        if a as usize >= self.neighbours.len() {
            return None;
        }
        let at = self.neighbours.of(a).binary_search(&b).ok()?;
        Some(self.neighbours.range_of(a).start + at)
    }

    /// The windows that have both patches of a pair of neighbours.
    #[inline]
    pub fn with_pair(&self, pair: usize) -> &[u32] {
        self.of_pairs.of(pair as u32)
    }
}
