//! How a cloth is searched, and the choice where nobody asked.

use std::fmt;

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{BoundRule, BoundingVolume};
use crate::cloth::ClothError;

/// A cloth of fewer particles is scanned rather than searched: at 64 × 64 a scan of all particles, eight at a time,
/// takes as long as the search of the tree (`cargo bench --profile dev --bench hierarchy`).
pub const SEARCH_FROM: usize = 64 * 64;

/// With a collider near for this many particles or fewer, a refit pays: at 256 × 256 from 100 balls on.
const PARTICLES_A_COLLIDER: f32 = 600.0;

/// How the particles are found that a collider may touch. Whatever is asked for, the same are found, [`Paper`]'s
/// rule excepted.
///
/// [`Paper`]: BoundRule::Paper
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq, Hash)]
#[non_exhaustive]
pub enum SearchMethod {
    /// Whatever costs least, by the number of particles and of colliders near.
    #[default]
    Auto,
    /// Every particle is tested, eight at a time.
    Scan,
    /// Top down through the tree, with volumes of a kind and by a rule.
    Tree(BoundingVolume, BoundRule),
}

impl SearchMethod {
    /// All methods, for menus.
    pub const ALL: [Self; 12] = [
        Self::Auto,
        Self::Scan,
        Self::Tree(BoundingVolume::Sphere, BoundRule::RestShape),
        Self::Tree(BoundingVolume::Aabb, BoundRule::RestShape),
        Self::Tree(BoundingVolume::Sphere, BoundRule::Refit),
        Self::Tree(BoundingVolume::Aabb, BoundRule::Refit),
        Self::Tree(BoundingVolume::Obb, BoundRule::Refit),
        Self::Tree(BoundingVolume::KDop14, BoundRule::Refit),
        Self::Tree(BoundingVolume::KDop18, BoundRule::Refit),
        Self::Tree(BoundingVolume::KDop26, BoundRule::Refit),
        Self::Tree(BoundingVolume::Sphere, BoundRule::Paper),
        Self::Tree(BoundingVolume::Aabb, BoundRule::Paper),
    ];

    /// The rule of the volumes that are searched, if any are.
    pub fn rule(self) -> Option<BoundRule> {
        match self {
            Self::Tree(_, rule) => Some(rule),
            Self::Auto | Self::Scan => None,
        }
    }

    /// Whether there is such a method.
    ///
    /// # Errors
    /// [`ClothError::NoSuchBounds`] for a volume without the rule.
    pub fn validate(self) -> Result<(), ClothError> {
        match self {
            Self::Tree(volume, rule) => rule.check(volume),
            Self::Auto | Self::Scan => Ok(()),
        }
    }

    /// What costs least for this many particles and colliders near, at a stretch
    /// ([`Stretch::bound`](crate::solver::Stretch)), if that is to be chosen; and why.
    pub fn chosen(self, particles: usize, near: usize, stretch: f32) -> (Self, SearchReason) {
        if self != Self::Auto {
            return (self, SearchReason::Asked);
        }
        // What a search at rest radii looks at grows with their square.
        let looked_at = near as f32 * (1.0 + stretch) * (1.0 + stretch);
        if particles < SEARCH_FROM {
            (Self::Scan, SearchReason::FewParticles)
        } else if looked_at * PARTICLES_A_COLLIDER < particles as f32 {
            let rest_shape = Self::Tree(BoundingVolume::Sphere, BoundRule::RestShape);
            (rest_shape, SearchReason::FewColliders)
        } else {
            (
                Self::Tree(BoundingVolume::Aabb, BoundRule::Refit),
                SearchReason::ManyColliders,
            )
        }
    }
}

impl fmt::Display for SearchMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => write!(f, "auto"),
            Self::Scan => write!(f, "scan"),
            Self::Tree(volume, rule) => write!(f, "{}, {}", volume.name(), rule.name()),
        }
    }
}

/// Why a cloth was searched as it was.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
#[non_exhaustive]
pub enum SearchReason {
    /// No collider was near: nothing was searched.
    #[default]
    NothingNear,
    /// The cloth slept on: nothing moved that touches it.
    Asleep,
    /// The game asked for it.
    Asked,
    /// There are so few particles that testing all costs least.
    FewParticles,
    /// There are so few colliders that volumes which cost nothing to keep are best.
    FewColliders,
    /// There are many colliders, or the cloth is stretched much: tight volumes are worth a refit.
    ManyColliders,
}

impl fmt::Display for SearchReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NothingNear => "no collider is near",
            Self::Asleep => "asleep",
            Self::Asked => "as asked",
            Self::FewParticles => "few particles: testing all costs least",
            Self::FewColliders => "few colliders: spheres that need no update",
            Self::ManyColliders => "many colliders: tight boxes are worth a refit",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choice_follows_particles_colliders_and_stretch() {
        let chosen =
            |particles, near, stretch| SearchMethod::Auto.chosen(particles, near, stretch).1;
        assert_eq!(chosen(63 * 63, 1, 0.0), SearchReason::FewParticles);
        assert_eq!(chosen(64 * 64, 1, 0.0), SearchReason::FewColliders);
        assert_eq!(chosen(256 * 256, 100, 0.0), SearchReason::FewColliders);
        assert_eq!(chosen(256 * 256, 110, 0.0), SearchReason::ManyColliders);
        assert_eq!(chosen(64 * 64, 1, 2.0), SearchReason::ManyColliders);
        assert_eq!(
            chosen(64 * 64, 1, f32::INFINITY),
            SearchReason::ManyColliders
        );
        let asked = SearchMethod::Tree(BoundingVolume::Obb, BoundRule::Refit);
        assert_eq!(asked.chosen(4, 1, 0.0), (asked, SearchReason::Asked));
    }

    #[test]
    fn every_method_of_the_menu_exists() {
        assert!(
            SearchMethod::ALL
                .into_iter()
                .all(|method| method.validate().is_ok())
        );
        let none = SearchMethod::Tree(BoundingVolume::Obb, BoundRule::RestShape);
        assert!(matches!(
            none.validate(),
            Err(ClothError::NoSuchBounds { .. })
        ));
    }
}
