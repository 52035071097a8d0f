//! How large a cloth may be.

/// The most particles that a grid may have: 4096 × 4096.
pub const MAX_PARTICLES: usize = 1 << 24;
