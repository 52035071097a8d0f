//! The grain of a cloth that is made from a mesh.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::{Quat, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    error::ClothError,
    quantity::Allowed,
    skin::ClothPaint,
    surface::{GrainError, Surface, TriangleMesh},
};

/// The direction of the warp on a mesh, for a [`ClothMaterial`](crate::cloth::ClothMaterial) with a
/// [`weft`](crate::cloth::ClothMaterial::weft), or a [`ClothTearing`](crate::cloth::ClothTearing) of two strengths. Ignored by a
/// grid, whose warp runs down its columns, and by any other cloth. Without this component, the warp of such a material runs along V of
/// the mesh's texture.
///
/// ```
/// use bevy::math::Vec3;
/// use bevy_drape::prelude::*;
///
/// // Down the figure, whatever the texture.
/// let coat = ClothGrain::along(Vec3::NEG_Y);
/// // Cut on the bias, at 45° to the texture.
/// let skirt = ClothGrain::default().turned(std::f32::consts::FRAC_PI_4);
/// // Full red turns it by 90°.
/// let painted = ClothGrain::default().turned(ClothPaint::color(0, std::f32::consts::FRAC_PI_2));
/// # let _ = (coat, skirt, painted);
/// ```
#[derive(Component, Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothGrain {
    /// A direction in the entity's frame, other than zero; each face takes the direction in its plane that is nearest.
    /// A face that it is perpendicular to takes any. `None` for V of the texture, which each face must have.
    pub axis: Option<Vec3>,
    /// The angle by which it is turned on the surface (rad, zero or more), counter-clockwise seen from the front. A face
    /// takes the mean of its corners.
    pub turn: ClothPaint,
}

impl ClothGrain {
    /// Along V of the texture.
    pub(crate) const fn by_texture() -> Self {
        Self {
            axis: None,
            turn: ClothPaint::Uniform(0.0),
        }
    }

    /// Along a direction in the entity's frame.
    pub fn along(axis: Vec3) -> Self {
        Self {
            axis: Some(axis),
            ..Self::default()
        }
    }

    /// Turned on the surface by an angle (rad). A uniform one may be negative: half a turn more is the same direction.
    #[must_use]
    pub fn turned(mut self, turn: impl Into<ClothPaint>) -> Self {
        self.turn = match turn.into() {
            ClothPaint::Uniform(angle) => angle.rem_euclid(std::f32::consts::PI).into(),
            painted => painted,
        };
        self
    }

    /// Gives a surface this grain. `mesh` is the one that the surface was made from. A grid stays as it is.
    ///
    /// # Errors
    /// [`GrainError::Axis`] for an axis without a direction; [`GrainError::NeedsUvs`] where there is neither an
    /// axis nor a texture; [`GrainError::FoldedUvs`] for the first face without an area in the texture;
    /// [`QuantityError`](crate::cloth::QuantityError) and [`PaintError`](crate::cloth::PaintError) of its turn.
    pub fn apply(&self, surface: Surface, mesh: &TriangleMesh) -> Result<Surface, ClothError> {
        if surface.as_grid().is_some() {
            return Ok(surface);
        }
        let quantity = "turn of the grain (rad)";
        let turns = self.turn.values(&surface, quantity)?;
        Allowed::FINITE.check(quantity, turns.iter().copied())?;
        let grain = match self.axis {
            Some(axis) => {
                let direction = axis.try_normalize().ok_or(GrainError::Axis { axis })?;
                surface.grain_along(direction)
            }
            None => surface.grain_of_texture(mesh)?,
        };
        let turned = |(face, grain): (&[u32; 3], Vec3)| {
            let turn: f32 = face.map(|corner| turns[corner as usize]).iter().sum();
            Quat::from_axis_angle(surface.face_normal(*face), turn / 3.0) * grain
        };
        let grain = surface.triangles().iter().zip(grain).map(turned).collect();
        Ok(surface.with_grain(grain))
    }
}
