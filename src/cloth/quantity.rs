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

/// The values that a quantity may have, by a test and in words.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Allowed(pub fn(f32) -> bool, pub &'static str);

impl Allowed {
    pub const FINITE: Self = Self(f32::is_finite, "finite");
    pub const POSITIVE: Self = Self(|v| v > 0.0 && v.is_finite(), "positive and finite");
    /// The same, in the words for a length.
    pub const LENGTH: Self = Self(|v| v > 0.0 && v.is_finite(), "positive");
    pub const SIZE: Self = Self(|v| v >= 0.0 && v.is_finite(), "zero or more, and finite");
    pub const SHARE: Self = Self(|v| (0.0..=1.0).contains(&v), "from 0 to 1");

    /// Checks the values of a quantity.
    ///
    /// # Errors
    /// [`QuantityError`] for the first that is not allowed.
    pub fn check(
        self,
        quantity: &'static str,
        values: impl IntoIterator<Item = f32>,
    ) -> Result<(), QuantityError> {
        let Self(test, expected) = self;
        let wrong = values.into_iter().find(|value| !test(*value));
        wrong.map_or(Ok(()), |value| {
            Err(QuantityError {
                quantity,
                expected,
                value,
            })
        })
    }
}
