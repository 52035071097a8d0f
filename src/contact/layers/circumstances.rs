//! The contact settings for which pairs were found.

use bevy::math::Isometry3d;

use super::{participant::Participant, settings::ClothSelfCollision};
use crate::cloth::ThicknessFactors;

/// The inputs of a search for pairs besides the particles' positions.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Circumstances {
    of: Vec<(ClothSelfCollision, usize, bool, Option<Isometry3d>)>,
    /// The factors of the thickness of all cloths that have them, one after the other. `of` has the number of each cloth's.
    thickness: Vec<f32>,
    meets: Vec<bool>,
}

impl Circumstances {
    /// Updates the settings of these cloths. Returns whether they are unchanged.
    pub fn renew(&mut self, cloths: &[Participant], meets: impl Fn(usize, usize) -> bool) -> bool {
        let of = || {
            let each = cloths.iter();
            each.map(|cloth| {
                let factors = cloth.thickness.map_or(0, |of| of.each().len());
                (cloth.settings, factors, cloth.is_fixed, cloth.to_common)
            })
        };
        let thickness = || cloths.iter().filter_map(|cloth| cloth.thickness);
        let thickness = || thickness().flat_map(ThicknessFactors::each).copied();
        let count = cloths.len();
        let meets = || {
            (0..count)
                .flat_map(|a| (0..a).map(move |b| (a, b)))
                .map(|(a, b)| meets(a, b))
        };
        let is_same = self.of.iter().copied().eq(of())
            && self.thickness.iter().copied().eq(thickness())
            && self.meets.iter().copied().eq(meets());
        if !is_same {
            self.of.clear();
            self.of.extend(of());
            self.thickness.clear();
            self.thickness.extend(thickness());
            self.meets.clear();
            self.meets.extend(meets());
        }
        is_same
    }
}
