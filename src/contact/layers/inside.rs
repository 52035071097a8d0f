//! Cloths that begin inside each other.

use super::{MutualContact, pair::VERTEX_AND_FACE, participant::Participant};
use crate::cloth::MapInline;

/// Distance of particles that are inside of another cloth, as a fraction of the thickness.
const INSIDE: f32 = 0.5;

/// Fraction of a cloth's particles that are inside of another one if it begins there: more than those of a common seam.
const SHARE: f32 = 0.2;

/// Which cloths begin inside of which.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inside {
    /// Of all pairs the one with the largest share, by their places among the cloths.
    pub cloths: [usize; 2],
    /// The share of the first one's particles that are inside of the second.
    pub share: f32,
    /// How near they are, at most (m).
    pub distance: f32,
    /// How many other cloths begin inside of cloths.
    pub others: usize,
}

impl MutualContact {
    /// Returns which cloths begin inside each other, of those that are near each other and of which at least one is new.
    /// Looks at all listed pairs, and allocates: not for each tick.
    pub fn begin_inside(
        &self,
        cloths: &[Participant],
        is_new: impl Fn(usize) -> bool,
    ) -> Option<Inside> {
        let mean_thickness = |cloths_of: [usize; 2]| {
            let [a, b] = cloths_of.map_inline(|cloth| cloths[cloth].settings.thickness);
            (a + b) / 2.0
        };
        let mut inside = Vec::new();
        for candidate in self.near.all() {
            let [vertex, corner, ..] = candidate.particles;
            let [(own, vertex), (other, _)] =
                [vertex, corner].map_inline(|at| self.motion.cloth_of(at));
            let of = [own, other];
            let is_vertex_with_face = candidate.split as usize == VERTEX_AND_FACE;
            if is_vertex_with_face
                && own != other
                && of.iter().any(|&of| is_new(of))
                && candidate.apart < (INSIDE - 1.0) * candidate.thickness
            {
                inside.push((of, vertex));
            }
        }
        inside.sort_unstable();
        inside.dedup();
        let shares = inside.chunk_by(|a, b| a.0 == b.0).map(|of_two| {
            let cloths_of = of_two[0].0;
            let share = of_two.len() as f32 / cloths[cloths_of[0]].particles.len() as f32;
            (cloths_of, share)
        });
        let begin = || shares.clone().filter(|(_, share)| *share > SHARE);
        let most = begin().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        let (most_of, share) = most?;
        let mut all: Vec<usize> = begin().flat_map(|(cloths_of, _)| cloths_of).collect();
        all.sort_unstable();
        all.dedup();
        Some(Inside {
            cloths: most_of,
            share,
            distance: INSIDE * mean_thickness(most_of),
            others: all.len() - 2,
        })
    }
}
