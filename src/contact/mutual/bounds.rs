//! Bounds of positions, and of the tangents of a surface.

use bevy::math::{Vec2, Vec3A};

/// An axis-aligned box (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub min: Vec3A,
    pub max: Vec3A,
}

impl Bounds {
    /// The empty box.
    pub const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
    };

    pub fn at(point: Vec3A) -> Self {
        Self {
            min: point,
            max: point,
        }
    }

    pub fn with(&self, point: Vec3A) -> Self {
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    pub fn join(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Distance between two boxes (m), 0 if they overlap.
    pub fn distance(&self, other: &Self) -> f32 {
        let gap = (self.min - other.max).max(other.min - self.max);
        gap.max(Vec3A::ZERO).length()
    }
}

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
    /// Bounds of nothing.
    pub const EMPTY: Self = Self {
        across: Bounds::EMPTY,
        down: Bounds::EMPTY,
    };

    pub fn join(&self, other: &Self) -> Self {
        Self {
            across: self.across.join(&other.across),
            down: self.down.join(&other.down),
        }
    }

    /// The tangents of a cell: those of its two rows' edges and of its two columns'.
    pub fn of_cell([a, b, c, d]: [Vec3A; 4], per_metre: Vec2) -> Self {
        Self {
            across: Bounds::at((b - a) * per_metre.x).with((d - c) * per_metre.x),
            down: Bounds::at((c - a) * per_metre.y).with((d - b) * per_metre.y),
        }
    }

    /// From bounds of both, per metre at rest.
    pub fn between(across: Bounds, down: Bounds) -> Self {
        Self { across, down }
    }

    /// σ − ε: a lower bound of the ratio of any two points' distance to that at rest; 0 or less where they may meet.
    pub fn unfolded(&self) -> f32 {
        // Also for bounds of nothing.
        if !(self.across.min.cmple(self.across.max).all()
            && self.down.min.cmple(self.down.max).all())
        {
            return 0.0;
        }
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
