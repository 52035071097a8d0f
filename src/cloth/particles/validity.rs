//! Valid ranges of a particle's numbers.

/// Largest coordinate of a particle (m): squares of distances still fit into `f32`.
const FARTHEST: f32 = 1.0e18;

/// Largest inverse mass (1/kg).
const LARGEST_INVERSE_MASS: f32 = 1.0e15;

/// Whether a particle's numbers are valid, from the squares of position and displacement (m²) and its inverse mass
/// (1/kg). False for NaN.
pub(super) fn is_valid(squares: f32, inverse_mass: f32) -> bool {
    (squares < FARTHEST * FARTHEST) & (0.0..=LARGEST_INVERSE_MASS).contains(&inverse_mass)
}
