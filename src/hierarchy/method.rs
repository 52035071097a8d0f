//! Search methods, and the automatic choice between them.

use std::fmt;

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{rule::BoundRule, volume::BoundingVolume};
use crate::cloth::BoundsError;

/// A cloth with fewer particles is scanned. At 64 × 64, a scan of all particles, eight at a time, takes as long as the
/// search of the tree (`cargo bench --profile dev --bench hierarchy`).
pub const SEARCH_FROM: usize = 64 * 64;

/// A refit pays from one nearby collider for this many particles on: at 256 × 256, from 100 balls on.
const PARTICLES_A_COLLIDER: f32 = 600.0;

/// The method that finds the particles that a collider may touch. All methods find the same particles, except
/// that the rule [`Paper`] misses some.
///
/// [`Paper`]: BoundRule::Paper
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq, Hash)]
#[non_exhaustive]
pub enum SearchMethod {
    /// The cheapest method, by the number of particles and of colliders near.
    #[default]
    Auto,
    /// Tests every particle, eight at a time.
    Scan,
    /// Searches the tree top down, with a volume type and a rule.
    Tree(BoundingVolume, BoundRule),
}

/// Number of pairs of a volume and a rule, whether they match or not.
const PAIRS: usize = BoundingVolume::ALL.len() * BoundRule::ALL.len();

/// All methods, and how many they are: `Auto`, `Scan`, and the pairs that match.
const METHODS: ([SearchMethod; 2 + PAIRS], usize) = {
    let mut all = [SearchMethod::Auto; 2 + PAIRS];
    all[1] = SearchMethod::Scan;
    let (mut next, mut index) = (2, 0);
    while index < PAIRS {
        let (_, volume) = BoundingVolume::ALL[index % BoundingVolume::ALL.len()];
        let (_, rule) = BoundRule::ALL[index / BoundingVolume::ALL.len()];
        if rule.matches(volume) {
            all[next] = SearchMethod::Tree(volume, rule);
            next += 1;
        }
        index += 1;
    }
    (all, next)
};

impl SearchMethod {
    /// All methods, for menus.
    pub const ALL: [Self; METHODS.1] = *METHODS.0.first_chunk().expect("as many");

    /// The rule of the volumes, if the method uses any.
    pub fn rule(self) -> Option<BoundRule> {
        match self {
            Self::Tree(_, rule) => Some(rule),
            Self::Auto | Self::Scan => None,
        }
    }

    /// Checks that the method exists.
    ///
    /// # Errors
    /// [`BoundsError::Unsupported`] if the volume does not support the rule.
    pub fn validate(self) -> Result<(), BoundsError> {
        match self {
            Self::Tree(volume, rule) => rule.check(volume),
            Self::Auto | Self::Scan => Ok(()),
        }
    }

    /// Resolves [`Auto`](Self::Auto) to the cheapest method, and returns the reason, too. The choice depends on the
    /// number of particles, the number of colliders near, and the stretch ([`Stretch::bound`](crate::solver::Stretch)).
    pub fn chosen(self, particles: usize, near: usize, stretch: f32) -> (Self, SearchReason) {
        if self != Self::Auto {
            return (self, SearchReason::Asked);
        }
        // The number of nodes in a search at rest radii grows with the square of the radius.
        let looked_at = near as f32 * (1.0 + stretch) * (1.0 + stretch);
        if particles < SEARCH_FROM {
            (Self::Scan, SearchReason::FewParticles)
        } else if looked_at * PARTICLES_A_COLLIDER < particles as f32 {
            let rest_shape = Self::Tree(BoundingVolume::Sphere, BoundRule::RestShape);
            (rest_shape, SearchReason::FewColliders)
        } else {
            let refit = Self::Tree(BoundingVolume::Aabb, BoundRule::Refit);
            (refit, SearchReason::ManyColliders)
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

/// The reason for a cloth's search method.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
#[non_exhaustive]
pub enum SearchReason {
    /// No collider was near: there was no search.
    #[default]
    NothingNear,
    /// The cloth slept: nothing that touches it moved.
    Asleep,
    /// The game chose it.
    Asked,
    /// With few particles, testing all of them is cheapest.
    FewParticles,
    /// With few colliders, volumes without an update are cheapest.
    FewColliders,
    /// With many colliders or a large stretch, tight volumes are worth a refit.
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
            Err(BoundsError::Unsupported { .. })
        ));
    }
}
