//! Rules for bounding volumes.

use bevy::reflect::{Reflect, std_traits::ReflectDefault};

use super::volume::BoundingVolume;
use crate::cloth::BoundsError;

/// The rule that defines the bounding volumes of a tree's nodes.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
pub enum BoundRule {
    /// The paper's Figure 4, around the mean of the patch's four corners. The root's radius is (longest side + 1)/2
    /// spacings, and each level below has half of its parent's. *Misses contacts*: the radius is less than half of a
    /// square patch's diagonal. Supports spheres, and boxes with that half side; for grids.
    Paper,
    /// The smallest volume around the children's, computed bottom up each tick: tight and complete, but reads every
    /// particle. Supports every volume.
    Refit,
    /// Around the patch's middle particle. The radius is the largest distance at rest, along the springs, to a particle
    /// of the patch, times 1 + the current largest stretch. Needs no update of nodes, and misses nothing
    /// ([proof](super#nothing-is-missed)). Supports spheres, and the boxes around them.
    #[default]
    RestShape,
}

impl BoundRule {
    /// The rules with their names, for menus.
    pub const ALL: [(&str, Self); 3] = [
        ("rest shape", Self::RestShape),
        ("refit", Self::Refit),
        ("paper", Self::Paper),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        let is_it = |(_, each): &&(&str, Self)| *each == self;
        Self::ALL.iter().find(is_it).map_or("", |(name, _)| name)
    }

    /// Whether a volume supports the rule. All volumes support `Refit`; spheres and AABBs support all rules.
    pub const fn matches(self, volume: BoundingVolume) -> bool {
        matches!(self, Self::Refit) || volume.takes_all_rules()
    }

    /// # Errors
    /// [`BoundsError::Unsupported`] if the volume does not support the rule.
    pub(super) fn check(self, volume: BoundingVolume) -> Result<(), BoundsError> {
        if self.matches(volume) {
            return Ok(());
        }
        Err(BoundsError::Unsupported {
            volume: volume.name(),
            rule: self.name(),
        })
    }
}
