//! Seams between cloths.

use std::sync::Arc;

use bevy::{
    ecs::{entity::MapEntities, reflect::ReflectMapEntities},
    prelude::{Component, Entity, Reflect, ReflectComponent, ReflectDefault},
};

use super::ClothTarget;
use crate::{
    cloth::{Allowed, Pin, QuantityError, Surface},
    solver::{Seam, SeamPull},
};

/// Sews two cloths together, or a cloth to itself: a sleeve to a bodice, a patch to a flag, a sheet to a tube. It is on an
/// entity of its own; despawn that to undo the seam.
///
/// Each side names its cloth, by entity or `Name`, and its particles, by [`Pin`]s: rows, columns, vertices, paint. Particles along a border follow
/// it, from the end with the lower vertex index; a list of single particles keeps its order. Both sides are matched by the
/// fraction of their length, from the ends that are nearer to each other as the seam begins. So their resolutions may
/// differ. Particles that enclose faces are a region, such as the middle of a flag: the other side is sewn to its nearest
/// points.
///
/// As it begins it closes whatever gap there is, over [`seconds`](Self::seconds), and no faster than 1 m/s. From then on it
/// holds both sides together, and both pull at each other as one cloth does. All fields may change at any time. Another side is
/// a new seam.
///
/// Cloths that are sewn together run in one island, with the same number of sub-steps, and wake each other. Particles that
/// are sewn together do not collide, and neither do the faces and edges at them. While one of the cloths is at fault, the seam
/// waits; while one is gone or disabled, the seam has a [`ClothFault`](crate::plugin::ClothFault).
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn setup(mut commands: Commands) {
///     let sheet = commands.spawn(Cloth::new(20, 20, 0.05)).id();
///     let below = Transform::from_xyz(0.0, -0.95, 0.0);
///     let hem = commands.spawn((Cloth::new(30, 5, 0.033), Pins::none(), below)).id();
///     commands.spawn(ClothSeam::new((sheet, Pin::Row(19)), (hem, Pin::Row(0))));
/// }
///
/// /// A zip: opens in two seconds, from its first end.
/// fn unzip(mut seams: Query<&mut ClothSeam>, time: Res<Time>) {
///     for mut seam in &mut seams {
///         seam.sewn[0] = (seam.sewn[0] + 0.5 * time.delta_secs()).min(1.0);
///     }
/// }
/// # bevy::ecs::system::assert_is_system(setup);
/// # bevy::ecs::system::assert_is_system(unzip);
/// ```
#[derive(Component, Reflect, MapEntities, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, MapEntities, Default, Debug, Clone, PartialEq)]
#[require(ClothStitches)]
pub struct ClothSeam {
    /// Its first side.
    #[entities]
    pub first: ClothSeamSide,
    /// Its second side.
    #[entities]
    pub second: ClothSeamSide,
    /// The time in which it closes from the gap at which it begins (s). It begins and ends gently.
    pub seconds: f32,
    /// The gap that it leaves under a load of 1 N on each metre of it (m²/N). 0 for a seam that does not give, which is the
    /// default.
    pub compliance: f32,
    /// The part of its length that is sewn, as fractions from the first end of the first side: `[0.0, 1.0]` for all of
    /// it, `[0.4, 1.0]` for a zip that is open at its first end.
    pub sewn: [f32; 2],
}

/// One side of a seam.
#[derive(Reflect, MapEntities, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothSeamSide {
    /// The cloth. If several cloths have the name, it is the one that has the nearest common ancestor with the seam's own
    /// entity. Among equals it is the one with the lowest generation and index. A seam that has begun keeps its cloth while that has the name.
    #[entities]
    pub cloth: ClothTarget,
    /// The particles.
    pub along: Vec<Pin>,
}

impl Default for ClothSeam {
    /// A seam of nothing: at once, without compliance, all of its length.
    fn default() -> Self {
        Self {
            first: ClothSeamSide::default(),
            second: ClothSeamSide::default(),
            seconds: 0.0,
            compliance: 0.0,
            sewn: [0.0, 1.0],
        }
    }
}

impl<C: Into<ClothTarget>> From<(C, Pin)> for ClothSeamSide {
    fn from((cloth, pin): (C, Pin)) -> Self {
        Self::new(cloth, [pin])
    }
}

impl ClothSeamSide {
    /// The particles of a cloth that any of these pins name.
    pub fn new(cloth: impl Into<ClothTarget>, along: impl IntoIterator<Item = Pin>) -> Self {
        Self {
            cloth: cloth.into(),
            along: along.into_iter().collect(),
        }
    }
}

impl ClothSeam {
    /// A seam between two sides, each a cloth and a pin, or a [`ClothSeamSide`]. It closes at once.
    pub fn new(first: impl Into<ClothSeamSide>, second: impl Into<ClothSeamSide>) -> Self {
        Self {
            first: first.into(),
            second: second.into(),
            ..Self::default()
        }
    }

    /// The same, closing in this time (s).
    #[must_use]
    pub fn closing_in(self, seconds: f32) -> Self {
        Self { seconds, ..self }
    }

    /// Its sides.
    pub(crate) fn sides(&self) -> [&ClothSeamSide; 2] {
        [&self.first, &self.second]
    }

    /// Checks its numbers.
    ///
    /// # Errors
    /// [`QuantityError`] for a value that is out of range.
    pub(crate) fn validate(&self) -> Result<(), QuantityError> {
        Allowed::SIZE.check("the time in which a seam closes (s)", [self.seconds])?;
        Allowed::SIZE.check("the compliance of a seam (m²/N)", [self.compliance])?;
        Allowed::SHARE.check("an end of the part of a seam that is sewn (1)", self.sewn)
    }

    /// Its numbers, for the solver.
    pub(crate) fn pull(&self) -> SeamPull {
        SeamPull {
            seconds: self.seconds,
            compliance: self.compliance,
            sewn: self.sewn,
        }
    }
}

/// The stitches of a seam, from tick to tick.
#[derive(Component, Reflect, Debug, Default)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct ClothStitches {
    #[reflect(ignore)]
    pub seam: Seam,
    /// The cloths that it joins, once it has begun.
    #[reflect(ignore)]
    pub cloths: Option<[Entity; 2]>,
    /// Their surfaces; `None` after a snapshot was restored.
    #[reflect(ignore)]
    pub surfaces: Option<[Arc<Surface>; 2]>,
    /// The component as of the last tick.
    #[reflect(ignore)]
    pub known: Option<ClothSeam>,
}
