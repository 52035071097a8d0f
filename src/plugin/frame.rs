//! The frame that a cloth is simulated in.

use bevy::{
    ecs::{entity_disabling::Disabled, system::SystemParam},
    math::Affine3A,
    prelude::{
        Allow, ChildOf, Component, Entity, GlobalTransform, Isometry3d, Name, Query, Reflect,
        ReflectComponent, ReflectDefault, Transform, Vec3, Vec3A,
    },
};

use super::naming::quoted;
use crate::cloth::{ClothError, TransformError};

/// The error of a global transform that can't be used.
pub(crate) fn unusable(transform: impl Into<Affine3A>) -> ClothError {
    let affine: Affine3A = transform.into();
    let [x, y, z] = [0, 1, 2].map(|axis| affine.matrix3.col(axis));
    ClothError::Transform(TransformError::Unusable {
        transform: format!("at {}, axes {x}, {y} and {z}", affine.translation),
    })
}

/// Global transforms as of now, including those below a disabled entity, since disabling an entity does not disable its
/// children.
#[derive(SystemParam)]
pub(crate) struct Places<'w, 's> {
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
    transforms: Query<'w, 's, &'static Transform, Allow<Disabled>>,
    names: Query<'w, 's, &'static Name, Allow<Disabled>>,
}

impl Places<'_, '_> {
    /// An entity's global transform.
    ///
    /// # Errors
    /// [`TransformError::Missing`] if it or an ancestor has none.
    pub fn of(&self, entity: Entity) -> Result<GlobalTransform, TransformError> {
        let mut place = GlobalTransform::from(self.own(entity, "")?);
        for (index, above) in self.parents.iter_ancestors(entity).enumerate() {
            let kinship = if index == 0 {
                "the parent "
            } else {
                "the ancestor "
            };
            place = self.own(above, kinship)? * place;
        }
        Ok(place)
    }

    fn own(&self, entity: Entity, kinship: &str) -> Result<Transform, TransformError> {
        let transform = self.transforms.get(entity).copied();
        transform.map_err(|_| TransformError::Missing {
            entity,
            name: format!("{kinship}{}", quoted(entity, self.names.get(entity).ok())),
        })
    }
}

/// The frame of a cloth's particles: the global translation and rotation of its entity as of the last tick. The
/// particles already include the entity's scale, so lengths in this frame are metres.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothFrame {
    isometry: Isometry3d,
    affine: Affine3A,
}

impl ClothFrame {
    /// The frame of a global transform, and its scale.
    ///
    /// # Errors
    /// [`TransformError::Unusable`] for one that is not finite or that cannot be inverted.
    pub(crate) fn of(transform: &GlobalTransform) -> Result<(Self, Vec3), ClothError> {
        let affine = transform.affine();
        let (scale, rotation, translation) = affine.to_scale_rotation_translation();
        // Under a sheared transform it comes out longer or shorter than a rotation.
        let rotation = rotation.normalize();
        let isometry = Isometry3d::new(translation, rotation);
        let inverse = affine.inverse();
        if affine.is_finite()
            && inverse.is_finite()
            && rotation.is_finite()
            && scale.min_element() != 0.0
        {
            Ok((Self { isometry, affine }, scale))
        } else {
            Err(unusable(affine))
        }
    }

    /// The same entity's, with the particles' frame elsewhere.
    pub(crate) fn with_isometry(self, isometry: Isometry3d) -> Self {
        Self { isometry, ..self }
    }

    /// Whether it is that of a global transform, to the last bit.
    pub(crate) fn is_of(&self, transform: &GlobalTransform) -> bool {
        self.affine == transform.affine()
    }

    /// The same after a jump of the world's origin, of an entity that is at `now`.
    pub(crate) fn shifted(self, shift: Shift, now: Option<&GlobalTransform>) -> Self {
        let now = now.and_then(|now| Self::of(now).ok()).map(|(now, _)| now);
        Self {
            isometry: shift.rigid(self.isometry, now.map(|now| now.isometry)),
            affine: shift.affine(self.affine, now.map(|now| now.affine)),
        }
    }

    /// The same of a place that may be the cloth's own, which went from `before` to `after`.
    pub(crate) fn shifted_with(self, shift: Shift, [before, after]: [Self; 2]) -> Self {
        match self == before {
            true => after,
            false => self.shifted(shift, None),
        }
    }

    /// The transform from the particles' frame to the world.
    pub fn isometry(&self) -> Isometry3d {
        self.isometry
    }

    /// The entity's whole global transform, its scale included.
    #[cfg(feature = "mesh")]
    pub(crate) fn affine(&self) -> Affine3A {
        self.affine
    }

    /// Takes a particle's position (m) to the world.
    pub fn to_world(&self, position: Vec3) -> Vec3 {
        self.isometry * position
    }

    /// Takes a point of the world (m) to the particles' frame.
    pub fn from_world(&self, point: Vec3) -> Vec3 {
        self.isometry.inverse() * point
    }

    /// From the particles' frame to the entity's own, in which its mesh is given: takes the scale out.
    #[cfg(feature = "mesh")]
    pub(crate) fn to_entity(self) -> Affine3A {
        self.affine.inverse() * Affine3A::from(self.isometry)
    }
}

/// A jump of the world's origin: the offset that the game has added to all positions (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shift(pub Vec3);

impl Shift {
    /// The new place of something that was here before. If it differs from `now` by no more than rounding, it is `now`,
    /// so that whatever has only been shifted stands still.
    pub fn rigid(self, was: Isometry3d, now: Option<Isometry3d>) -> Isometry3d {
        let translation = was.translation + Vec3A::from(self.0);
        let is_there = |now: &Isometry3d| {
            now.rotation == was.rotation
                && self.is_rounded(was.translation, now.translation, translation)
        };
        now.filter(is_there)
            .unwrap_or(Isometry3d { translation, ..was })
    }

    /// The same with a scale.
    pub fn affine(self, was: Affine3A, now: Option<Affine3A>) -> Affine3A {
        let translation = was.translation + Vec3A::from(self.0);
        let is_there = |now: &Affine3A| {
            now.matrix3 == was.matrix3
                && self.is_rounded(was.translation, now.translation, translation)
        };
        now.filter(is_there)
            .unwrap_or(Affine3A { translation, ..was })
    }

    /// Largest rounding error of positions about as far from the origin as `place` (m), before or after the jump. The
    /// place of a child is computed from several sums and products, each of which rounds.
    pub fn rounding(self, place: Vec3A) -> f32 {
        let size = place.abs().max_element() + self.0.abs().max_element();
        16.0 * f32::EPSILON * size
    }

    fn is_rounded(self, was: Vec3A, now: Vec3A, shifted: Vec3A) -> bool {
        (now - shifted).abs().max_element() <= self.rounding(was)
    }
}

/// The place of `b` in the frame of `a`, to a rounding of the distance between them, wherever both are.
pub(crate) fn relative(a: Isometry3d, b: Isometry3d) -> Isometry3d {
    let turn = a.rotation.inverse();
    Isometry3d::new(
        turn * (b.translation - a.translation),
        (turn * b.rotation).normalize(),
    )
}

/// Translation and rotation of a transform, without its scale.
pub(crate) fn rigid(affine: &Affine3A) -> Isometry3d {
    let (_, rotation, translation) = affine.to_scale_rotation_translation();
    Isometry3d::new(translation, rotation.normalize())
}
