//! Which numbers a particle may have.

/// Where a particle may be at most (m): distances between such can still be squared in `f32`.
const FARTHEST: f32 = 1.0e18;

/// What an inverse mass may be at most (1/kg).
const LARGEST_INVERSE_MASS: f32 = 1.0e15;

/// Whether a particle's numbers are valid, by the squares of position and displacement (m²) and its inverse mass (1/kg).
/// False for NaN too.
pub(super) fn is_valid(squares: f32, inverse_mass: f32) -> bool {
    (squares < FARTHEST * FARTHEST) & (0.0..=LARGEST_INVERSE_MASS).contains(&inverse_mass)
}
