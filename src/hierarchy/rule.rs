//! Where bounding volumes are, by three rules.

use bevy::reflect::{Reflect, std_traits::ReflectDefault};

use super::BoundingVolume;
use crate::cloth::ClothError;

/// How the bounding volumes of a tree's nodes come about.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
pub enum BoundRule {
    /// The paper's Figure 4: the root's radius is (longest side + 1)/2 spacings, each level below has half of
    /// its parent's. Around the mean of the patch's four corners. *Misses contacts*: the radius is less than
    /// half of a square patch's diagonal. Of spheres, and of boxes whose half side it is; of grids.
    Paper,
    /// The smallest around the children's, computed bottom up each tick: tight, complete, at the cost of touching
    /// every particle. Of every volume.
    Refit,
    /// Around the patch's middle particle; the radius is the largest distance at rest, along the springs, to a
    /// particle of the patch, times 1 + the largest stretch present. Nothing is computed a node, and nothing
    /// is missed ([proof](super#nothing-is-missed)). Of spheres, and of the boxes around them.
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

    /// Whether there is such a rule for a volume: all can be refitted, spheres and AABBs follow the others, too.
    pub fn matches(self, volume: BoundingVolume) -> bool {
        self == Self::Refit || matches!(volume, BoundingVolume::Sphere | BoundingVolume::Aabb)
    }

    /// # Errors
    /// [`ClothError::NoSuchBounds`] if there is no such rule for the volume.
    pub(super) fn check(self, volume: BoundingVolume) -> Result<(), ClothError> {
        if self.matches(volume) {
            return Ok(());
        }
        Err(ClothError::NoSuchBounds {
            volume: volume.name(),
            rule: self.name(),
        })
    }
}
