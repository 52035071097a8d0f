//! Level of detail: how often a cloth is moved.

use bevy::{
    ecs::{
        component::Component,
        reflect::{ReflectComponent, ReflectResource},
        resource::Resource,
    },
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::ClothError;

/// Ticks that one move of a cloth may stand for, at most: a quarter of a second of Bevy's 64 Hz.
const MOST_TICKS: u32 = 16;

/// How much of the work of a full simulation a cloth gets.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothLodLevel {
    /// It is moved in each tick.
    #[default]
    Full,
    /// It is moved in each second, third … tick, from 1 to 16, by the time of as many ticks, with as many sub-steps as one tick has
    /// otherwise: a half, a third … of the cost. It stretches more, as its sub-steps are longer, which is no
    /// [`ClothLimitExceeded`](super::ClothLimitExceeded). What is drawn lags behind by as many ticks, and moves smoothly; its
    /// [`ClothParticles`](crate::cloth::ClothParticles) are those of the last tick in which it was moved.
    Every(u32),
    /// It keeps its shape, as seen from its entity, from its first attachment's target or from the bones of its
    /// [`ClothSkin`](crate::cloth::ClothSkin) where it has one, and passes through colliders. Costs no more than a look at where that is,
    /// and the skinning of the bones' pose.
    Frozen,
    /// As `Frozen`, and neither its bones are followed nor is its mesh written: hide it, by `Visibility` or Bevy's `VisibilityRange`.
    Off,
}

impl ClothLodLevel {
    /// Of two levels the finer is less.
    pub(super) fn coarseness(self) -> u32 {
        match self {
            Self::Full => 1,
            Self::Every(ticks) => ticks.max(1),
            Self::Frozen => u32::MAX - 1,
            Self::Off => u32::MAX,
        }
    }

    /// In how many ticks it is moved once; `None` if in none.
    pub(super) fn ticks(self) -> Option<u32> {
        match self {
            Self::Full => Some(1),
            Self::Every(ticks) => Some(ticks.max(1)),
            Self::Frozen | Self::Off => None,
        }
    }
}

/// Level of detail of a cloth: by its distance to the nearest active camera, while it is hidden, or by hand. On a cloth; [`GlobalClothLod`] is for
/// all cloths that have none of their own.
///
/// *Nothing jumps* when the level changes. Positions and velocities go on as they are; a cloth that freezes loses its velocity,
/// and when it thaws it has that of what carries it: however far that has gone meanwhile, the cloth is not thrown. What is drawn passes
/// from one level to the other within an eighth of a second. Cloths of one level are moved in different ticks, by the index of
/// their entities, so that no tick has all of the work.
///
/// *What touches.* [`Every`](ClothLodLevel::Every) lowers the rate only while nothing that moves comes near: beside a
/// collider that moves or a [`ClothBody`](super::ClothBody), and for half a second after, the cloth is moved in each tick. Cloths with
/// [`ClothSelfCollision`](crate::contact::ClothSelfCollision) that are near each other are all at the finest of their
/// levels. What is frozen touches nothing, and nothing touches it: where it stands in a collider when it thaws, it is pushed out as
/// anything that is put there. A cloth that sleeps costs next to nothing at any level.
///
/// Distances are from the camera to the nearest point of a sphere around the cloth, and cameras are where the last frame had
/// them. A cloth that is hidden is [`Off`](ClothLodLevel::Off) unless [`ClothLod::hidden`] says otherwise: without a `ClothLod` it moves on,
/// unseen. Without an active camera, as on a server, or without the feature `mesh` neither counts: all is `Full`.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn castle(mut commands: Commands) {
///     commands.insert_resource(GlobalClothLod(ClothLod::by_distance([
///         (20.0, ClothLodLevel::Every(2)),
///         (60.0, ClothLodLevel::Frozen),
///     ])));
///     commands.spawn(Cloth::default());
///     // By hand; a game may change it at any time.
///     commands.spawn((Cloth::default(), ClothLod::at(ClothLodLevel::Frozen)));
/// }
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothLod {
    /// This level, whatever the distance; `None` goes by distance.
    pub level: Option<ClothLodLevel>,
    /// From which distance on (m) which level holds, ascending; `Full` before the first.
    pub distances: Vec<(f32, ClothLodLevel)>,
    /// While Bevy's visibility hides the cloth, its own or an ancestor's, its level is this one or a coarser one. `Off` unless a game says
    /// otherwise.
    pub hidden: ClothLodLevel,
    /// The part of a distance by which a cloth has to be nearer than that to leave its level again, from 0 to less than 1: so that
    /// it does not change to and fro.
    pub hysteresis: f32,
}

impl Default for ClothLod {
    /// Every second tick from 25 m on, every fourth from 50 m, frozen from 100 m; a tenth of hysteresis.
    fn default() -> Self {
        Self::by_distance([
            (25.0, ClothLodLevel::Every(2)),
            (50.0, ClothLodLevel::Every(4)),
            (100.0, ClothLodLevel::Frozen),
        ])
    }
}

impl ClothLod {
    /// From each distance on (m) its level; a tenth of hysteresis.
    pub fn by_distance(distances: impl IntoIterator<Item = (f32, ClothLodLevel)>) -> Self {
        Self {
            level: None,
            distances: distances.into_iter().collect(),
            hidden: ClothLodLevel::Off,
            hysteresis: 0.1,
        }
    }

    /// One level, hidden or not, until the game says otherwise.
    pub fn at(level: ClothLodLevel) -> Self {
        Self {
            level: Some(level),
            hidden: level,
            ..Self::by_distance([])
        }
    }

    /// # Errors
    /// The first value that is out of range.
    pub(super) fn validate(&self) -> Result<(), ClothError> {
        let is_part = |part: f32| (0.0..1.0).contains(&part);
        let expected = "from 0 to less than 1";
        ClothError::check(
            self.hysteresis,
            is_part,
            "hysteresis of `ClothLod`",
            expected,
        )?;
        let mut before = 0.0;
        for (distance, _) in &self.distances {
            let is_distance = |distance: f32| distance >= 0.0 && distance.is_finite();
            let quantity = "a distance of `ClothLod` (m)";
            ClothError::check(*distance, is_distance, quantity, "finite and 0 or more")?;
            ClothError::check(
                distance - before,
                |more| more >= 0.0,
                quantity,
                "no less than the one before",
            )?;
            before = *distance;
        }
        let levels = self.distances.iter().map(|(_, level)| *level);
        for level in levels.chain(self.level).chain([self.hidden]) {
            if let ClothLodLevel::Every(ticks) = level {
                let is_rate = |ticks: f32| (1.0..=MOST_TICKS as f32).contains(&ticks);
                ClothError::check(
                    ticks as f32,
                    is_rate,
                    "ticks of `ClothLodLevel::Every`",
                    "from 1 to 16",
                )?;
            }
        }
        Ok(())
    }

    /// How many of the distances a cloth has passed that is `distance` away (m) and had passed as many `before`.
    pub(super) fn passed(&self, distance: f32, before: usize) -> usize {
        let mut passed = before.min(self.distances.len());
        while self
            .distances
            .get(passed)
            .is_some_and(|(from, _)| distance >= *from)
        {
            passed += 1;
        }
        let back = 1.0 - self.hysteresis;
        while passed > 0 && distance < self.distances[passed - 1].0 * back {
            passed -= 1;
        }
        passed
    }
}

/// The level of detail of all cloths without a [`ClothLod`]. Not there unless a game inserts it: then they are all at
/// [`ClothLodLevel::Full`].
#[derive(Resource, Reflect, Debug, Default, Clone, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct GlobalClothLod(pub ClothLod);

#[cfg(test)]
mod tests {
    use super::*;
    use ClothLodLevel::{Every, Frozen};

    #[test]
    fn distances_are_left_a_little_nearer_than_they_are_passed() {
        let lod = ClothLod::by_distance([(10.0, Every(2)), (20.0, Frozen)]);
        for (distance, before, passed) in [
            (9.9, 0, 0),
            (10.0, 0, 1),
            (9.1, 1, 1),
            (8.9, 1, 0),
            (18.1, 2, 2),
            (17.9, 2, 1),
            (8.9, 2, 0),
            (30.0, 0, 2),
            (30.0, 7, 2),
        ] {
            assert_eq!(
                lod.passed(distance, before),
                passed,
                "{distance} m, {before}"
            );
        }
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let by = |distances: &[(f32, ClothLodLevel)]| ClothLod::by_distance(distances.to_vec());
        assert_eq!(ClothLod::default().validate(), Ok(()));
        assert_eq!(by(&[(0.0, Frozen), (0.0, Every(16))]).validate(), Ok(()));
        let bad_hysteresis = ClothLod {
            hysteresis: 1.0,
            ..ClothLod::default()
        };
        let bad_hidden = ClothLod {
            hidden: Every(0),
            ..ClothLod::default()
        };
        for bad in [
            by(&[(-1.0, Frozen)]),
            by(&[(f32::NAN, Frozen)]),
            by(&[(2.0, Frozen), (1.0, Frozen)]),
            by(&[(2.0, Every(0))]),
            ClothLod::at(Every(17)),
            bad_hidden,
            bad_hysteresis,
        ] {
            let outcome = bad.validate();
            assert!(
                matches!(outcome, Err(ClothError::Quantity { .. })),
                "{bad:?}"
            );
        }
    }
}
