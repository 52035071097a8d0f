//! Level of detail: how often a cloth is simulated.

use bevy::prelude::{
    Component, Reflect, ReflectComponent, ReflectDefault, ReflectResource, Resource,
};

use crate::cloth::{Allowed, QuantityError};

/// Largest number of ticks that a cloth may be simulated for at once: a quarter of a second at Bevy's 64 Hz.
const MOST_TICKS: u32 = 16;

/// How often a cloth is simulated.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothLodLevel {
    /// In every tick.
    #[default]
    Full,
    /// Once in this number of ticks, from 1 to 16, for the time of all of them. It takes the sub-steps of a single
    /// tick, so 2 costs a half, and 3 a third. The cloth stretches more, because its sub-steps are longer; that is no
    /// [`ClothLimitExceeded`](crate::plugin::ClothLimitExceeded). Its mesh lags behind by this number of ticks, and moves
    /// smoothly. Its [`ClothParticles`](crate::cloth::ClothParticles) are those of the last tick in which it was
    /// simulated.
    Every(u32),
    /// Never: the cloth keeps its shape and passes through colliders. It moves rigidly with its entity or the target of
    /// its first attachment, or follows the bones of its [`ClothSkin`](crate::cloth::ClothSkin). It costs only a look
    /// at their transforms, and the skinning of the pose.
    Frozen,
    /// Like `Frozen`, but the plugin neither follows its bones nor writes its mesh. Hide such a cloth, by `Visibility`
    /// or Bevy's `VisibilityRange`.
    Off,
}

impl ClothLodLevel {
    /// Order of the levels: a finer one is less.
    pub(crate) fn coarseness(self) -> u32 {
        let stands = u32::MAX - u32::from(self != Self::Off);
        self.ticks().unwrap_or(stands)
    }

    /// The number of ticks in which it is simulated once; `None` if never.
    pub(crate) fn ticks(self) -> Option<u32> {
        match self {
            Self::Full => Some(1),
            Self::Every(ticks) => Some(ticks.max(1)),
            Self::Frozen | Self::Off => None,
        }
    }
}

/// Level of detail of a cloth: by its distance to the nearest active camera, by whether it is hidden, or by hand. Add
/// it to a cloth; [`GlobalClothLod`] applies to all cloths without one.
///
/// *Nothing jumps* when the level changes. Positions and velocities continue. A cloth that freezes loses its velocity;
/// when it thaws, it takes the velocity of whatever carries it. The cloth is not thrown, however far its carrier has
/// moved meanwhile. The mesh blends from one level to the other within an eighth of a second. Cloths at the same level
/// are simulated in different ticks, by the index of their entities, so that no tick has all of the work.
///
/// *Contact.* [`Every`](ClothLodLevel::Every) lowers the rate only while nothing that moves is near. Near a moving
/// collider or a [`ClothBody`](crate::plugin::ClothBody), and for half a second after, the cloth is simulated in every tick.
/// Cloths with [`ClothSelfCollision`](crate::contact::ClothSelfCollision) that are near each other are all simulated at
/// the finest of their levels. A frozen cloth touches nothing, and nothing touches it. If it is inside a collider when
/// it thaws, it is pushed out, like any cloth that is placed there. A sleeping cloth costs next to nothing at any
/// level.
///
/// Distances are measured from the camera, where the last frame had it, to the nearest point of a sphere around the
/// cloth. A hidden cloth is [`Off`](ClothLodLevel::Off) unless [`ClothLod::hidden`] says otherwise; without a
/// `ClothLod` it is still simulated, unseen. Without an active camera, as on a server, or without the feature `mesh`,
/// neither distance nor visibility counts: cloths are `Full` unless their level is set by hand.
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
///     // By hand; the game may change it at any time.
///     commands.spawn((Cloth::default(), ClothLod::at(ClothLodLevel::Frozen)));
/// }
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothLod {
    /// This level, whatever the distance; `None` chooses by distance.
    pub level: Option<ClothLodLevel>,
    /// Distances (m), ascending, each with the level from there on. Nearer than the first, the level is `Full`.
    pub distances: Vec<(f32, ClothLodLevel)>,
    /// The level while the cloth is hidden by Bevy's visibility, its own or an ancestor's, unless its other level is
    /// coarser. `Off` by default.
    pub hidden: ClothLodLevel,
    /// A cloth returns to a finer level only once it is nearer than the distance by this fraction of it, from 0 to less
    /// than 1. So it does not switch back and forth.
    pub hysteresis: f32,
}

impl Default for ClothLod {
    /// Every second tick from 25 m on, every fourth from 50 m, frozen from 100 m, with a hysteresis of 0.1.
    fn default() -> Self {
        Self::by_distance([
            (25.0, ClothLodLevel::Every(2)),
            (50.0, ClothLodLevel::Every(4)),
            (100.0, ClothLodLevel::Frozen),
        ])
    }
}

impl ClothLod {
    /// Chooses by distance: from each distance (m) on, its level. The hysteresis is 0.1.
    pub fn by_distance(distances: impl IntoIterator<Item = (f32, ClothLodLevel)>) -> Self {
        Self {
            level: None,
            distances: distances.into_iter().collect(),
            hidden: ClothLodLevel::Off,
            hysteresis: 0.1,
        }
    }

    /// Always this level, hidden or not, until the game changes it.
    pub fn at(level: ClothLodLevel) -> Self {
        Self {
            level: Some(level),
            hidden: level,
            ..Self::by_distance([])
        }
    }

    /// # Errors
    /// [`QuantityError`] for the first value that is out of range.
    pub(crate) fn validate(&self) -> Result<(), QuantityError> {
        let part = Allowed(|v| (0.0..1.0).contains(&v), "from 0 to less than 1");
        part.check("hysteresis of `ClothLod`", [self.hysteresis])?;
        let (quantity, mut before) = ("a distance of `ClothLod` (m)", 0.0);
        let farther = Allowed(|more| more >= 0.0, "no less than the one before");
        for (distance, _) in &self.distances {
            Allowed::SIZE.check(quantity, [*distance])?;
            farther.check(quantity, [distance - before])?;
            before = *distance;
        }
        let rate = Allowed(|v| (1.0..=MOST_TICKS as f32).contains(&v), "from 1 to 16");
        let levels = self.distances.iter().map(|(_, level)| *level);
        for level in levels.chain(self.level).chain([self.hidden]) {
            if let ClothLodLevel::Every(ticks) = level {
                rate.check("ticks of `ClothLodLevel::Every`", [ticks as f32])?;
            }
        }
        Ok(())
    }

    /// How many of the distances a cloth has passed that is `distance` away (m), if it had passed `before` of them.
    pub(crate) fn passed(&self, distance: f32, before: usize) -> usize {
        let mut passed = before.min(self.distances.len());
        let beyond = self.distances[passed..].iter();
        passed += beyond.take_while(|(from, _)| distance >= *from).count();
        let back = 1.0 - self.hysteresis;
        while passed > 0 && distance < self.distances[passed - 1].0 * back {
            passed -= 1;
        }
        passed
    }
}

/// Level of detail of all cloths without a [`ClothLod`]. The resource does not exist unless the game inserts it;
/// without it they are all at [`ClothLodLevel::Full`].
#[derive(Resource, Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
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
            assert!(outcome.is_err(), "{bad:?}");
        }
    }
}
