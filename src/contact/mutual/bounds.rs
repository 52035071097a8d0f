//! Bounds of places, and of the directions in which a surface runs.

use bevy::math::{Vec2, Vec3A};

/// A box along the axes (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    pub min: Vec3A,
    pub max: Vec3A,
}

impl Bounds {
    /// Around nothing.
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

    /// From one box to the other (m), 0 if they meet.
    pub fn distance(&self, other: &Self) -> f32 {
        let gap = (self.min - other.max).max(other.min - self.max);
        gap.max(Vec3A::ZERO).length()
    }
}

/// Between which vectors the rows and the columns of a patch of a grid run, for each metre at rest.
///
/// # The proof that a patch does not touch itself
/// A patch of rows × columns is convex at rest, so the straight line between two of its points u and v stays in it. Along it the
/// surface runs by its tangents F = (∂x/∂across, ∂x/∂down), which are all within ε of their middle F₀:
///
/// ```text
///   x(u) − x(v) = ∫ F (u − v) dt
///   |x(u) − x(v) − F₀(u − v)| ≤ ε |u − v|
///   |x(u) − x(v)| ≥ (σ − ε) |u − v|          σ: smallest singular value of F₀
/// ```
///
/// So no two points come nearer to each other than [σ − ε](Self::unfolded) times what they are apart at rest. Unlike a cone of
/// normals, which says nothing of a patch whose outline crosses itself, this loses nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tangents {
    across: Bounds,
    down: Bounds,
}

impl Tangents {
    /// Of nothing.
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

    /// Of a cell: of the two rows' edges and of the two columns'.
    pub fn of_cell([a, b, c, d]: [Vec3A; 4], per_metre: Vec2) -> Self {
        Self {
            across: Bounds::at((b - a) * per_metre.x).with((d - c) * per_metre.x),
            down: Bounds::at((c - a) * per_metre.y).with((d - b) * per_metre.y),
        }
    }

    /// Between bounds of both, for each metre at rest.
    pub fn between(across: Bounds, down: Bounds) -> Self {
        Self { across, down }
    }

    /// σ − ε: a lower bound of the distance of any two points over that at rest; 0 or less where they may meet.
    pub fn unfolded(&self) -> f32 {
        // Of nothing, too.
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

/// More than what rounding adds.
const ROUNDING: f32 = 1.0e-5;
