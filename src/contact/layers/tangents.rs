//! Bounds of the tangents of a patch of a grid: proof that it does not touch itself.

use bevy::math::{Vec2, Vec3A};

use super::bounds::Bounds;

/// Bounds of the tangents of a patch of a grid, along rows and columns, per metre at rest.
///
/// # The proof that a patch does not touch itself
/// A patch of rows × columns is convex at rest, so the straight line between two of its points u and v stays in it.
/// Along that line the surface follows its tangents F = (∂x/∂across, ∂x/∂down), which are all within ε of their middle
/// F₀:
///
/// ```text
///   x(u) − x(v) = ∫ F (u − v) dt
///   |x(u) − x(v) − F₀(u − v)| ≤ ε |u − v|
///   |x(u) − x(v)| ≥ (σ − ε) |u − v|          σ: smallest singular value of F₀
/// ```
///
/// So the distance of any two points is at least [σ − ε](Self::unfolded) times that at rest. A cone of normals says
/// nothing about a patch whose outline crosses itself; this bound covers that, too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tangents {
    across: Bounds,
    down: Bounds,
}

impl Tangents {
    /// The tangents of a rectangle of particles, from its rows, at these distances at rest.
    #[inline]
    pub fn of<'a>(rows: impl Iterator<Item = &'a [Vec3A]>, spacing: Vec2) -> Self {
        let (mut across, mut down) = (Bounds::EMPTY, Bounds::EMPTY);
        let mut above: &[Vec3A] = &[];
        for row in rows {
            for (left, right) in row.iter().zip(&row[1..]) {
                across = across.with(*right - *left);
            }
            for (upper, lower) in above.iter().zip(row) {
                down = down.with(*lower - *upper);
            }
            above = row;
        }
        let per_metre = spacing.recip();
        let scaled = |of: Bounds, by: f32| Bounds {
            min: of.min * by,
            max: of.max * by,
        };
        Self {
            across: scaled(across, per_metre.x),
            down: scaled(down, per_metre.y),
        }
    }

    /// σ − ε: a lower bound of the ratio of any two points' distance to that at rest; 0 or less where they may meet.
    #[inline]
    pub fn unfolded(&self) -> f32 {
        let middle = |of: &Bounds| (of.min + of.max) * 0.5;
        let spread = |of: &Bounds| ((of.max - of.min) * 0.5).length_squared();
        let (across, down) = (middle(&self.across), middle(&self.down));
        let off = (spread(&self.across) + spread(&self.down)).sqrt();
        // Eigenvalues of F₀ᵀF₀.
        let (a, b, mixed) = (
            across.length_squared(),
            down.length_squared(),
            across.dot(down),
        );
        let half = (a - b) * 0.5;
        let least = (a + b) * 0.5 - (half * half + mixed * mixed).sqrt();
        least.max(0.0).sqrt() * (1.0 - ROUNDING) - off * (1.0 + ROUNDING)
    }
}

/// More than the rounding errors.
const ROUNDING: f32 = 1.0e-5;
