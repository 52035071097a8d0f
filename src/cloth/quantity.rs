//! Numbers that are out of their ranges.

use bevy::reflect::Reflect;
use thiserror::Error;

/// A number outside its valid range, or not finite.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[error("{quantity} must be {expected}, not {value}")]
#[non_exhaustive]
pub struct QuantityError {
    /// The name of the quantity, with its unit.
    #[reflect(ignore)]
    pub quantity: &'static str,
    /// The valid range.
    #[reflect(ignore)]
    pub expected: &'static str,
    /// The invalid value.
    pub value: f32,
}

impl QuantityError {
    /// `value` if it holds to `test`, else the error that names it.
    pub(crate) fn check(
        value: f32,
        test: fn(f32) -> bool,
        quantity: &'static str,
        expected: &'static str,
    ) -> Result<f32, Self> {
        if test(value) {
            Ok(value)
        } else {
            Err(Self {
                quantity,
                expected,
                value,
            })
        }
    }
}
