//! Errors of cloth that touches itself.

use bevy::reflect::Reflect;
use thiserror::Error;

/// The reason why a cloth can't touch itself.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SelfCollisionError {
    /// A cloth's thickness is more than half of its shortest spacing.
    #[error(
        "a thickness of {thickness} m needs a spacing of at least twice that, but the shortest is {shortest} m: use a smaller thickness or fewer particles"
    )]
    TooThick {
        /// The thickness (m).
        thickness: f32,
        /// The shortest spacing at rest (m).
        shortest: f32,
    },
}
