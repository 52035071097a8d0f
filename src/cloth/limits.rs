//! How large a cloth may be.

/// The most particles that a grid may have: 4096 × 4096.
pub const MAX_PARTICLES: usize = 1 << 24;

/// Largest size of anything, and largest distance from the origin (m): squares of such lengths, and their products with
/// masses, stay well within `f32`.
pub(crate) const FARTHEST: f32 = 1.0e12;
