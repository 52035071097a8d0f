//! Errors of cloths and colliders: those of all modules, joined. Errors of upper floors are here, since none may import from those.

mod alike;
mod kinds;

use bevy::reflect::Reflect;
use thiserror::Error;

use super::{
    grid::GridError,
    particles::ParticleError,
    pins::PinError,
    quantity::QuantityError,
    skin::{PaintError, SkinError},
    surface::{GrainError, MeshError, TearError},
};

pub use kinds::{BoundsError, SelfCollisionError, ShapeError, TargetError, TransformError};

/// The reason why a cloth or a collider is not simulated, with the value at fault.
///
/// The plugin logs each error once with its entity, marks the entity with a [`ClothFault`](crate::plugin::ClothFault),
/// and continues with the other entities. Fixing the value brings the entity back.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothError {
    /// A number outside its valid range, or not finite.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
    /// A grid or a rope can't be built.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A mesh makes no cloth and no collider.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A pin holds nothing.
    #[error(transparent)]
    Pin(#[from] PinError),
    /// A paint gives no values.
    #[error(transparent)]
    Paint(#[from] PaintError),
    /// A mesh has no grain.
    #[error(transparent)]
    Grain(#[from] GrainError),
    /// A skinned mesh can't follow its joints.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// A cloth can't be torn.
    #[error(transparent)]
    Tear(#[from] TearError),
    /// The particles are not those of the cloth.
    #[error(transparent)]
    Particle(#[from] ParticleError),
    /// Cloth can't collide with a shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A cloth can't touch itself.
    #[error(transparent)]
    SelfCollision(#[from] SelfCollisionError),
    /// A bounding volume is not used.
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    /// An entity has no usable place.
    #[error(transparent)]
    Transform(#[from] TransformError),
    /// An entity can't be the target of another.
    #[error(transparent)]
    Target(#[from] TargetError),
}
