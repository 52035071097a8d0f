//! Ropes: grids of a single row.

use bevy::{
    math::{Vec2, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    error::ClothError,
    grid::{ClothGrid, ClothPlane, GridError, mean},
    limits::MAX_PARTICLES,
    quantity::Allowed,
    surface::{MeshError, Surface},
};

/// The shape of a rope, before the transform's scale.
///
/// A rope is a row of particles without faces. It resists stretching and bending like a band of the material that is as wide as the rope
/// is thick, and has the mass of that band. Its particles touch colliders, at the rope's radius. It feels no wind, does not crease, and is not torn or cut.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct RopeShape {
    /// Particles along the rope, at least 2.
    pub particles: u32,
    /// Distance between neighbours (m).
    pub spacing: f32,
    /// Half of its thickness (m).
    pub radius: f32,
    /// Where it lies at rest: along −y if hanging, along +x if lying.
    pub plane: ClothPlane,
    /// Whether its middle is at the entity's origin; otherwise its first particle is.
    pub centred: bool,
}

impl Default for RopeShape {
    /// Hangs 1 m down, 2 cm thick.
    fn default() -> Self {
        Self {
            particles: 21,
            spacing: 0.05,
            radius: 0.01,
            plane: ClothPlane::Hanging,
            centred: false,
        }
    }
}

impl RopeShape {
    /// Returns the validated grid under a transform's `scale`. Its radius grows with the mean scale of the axes.
    ///
    /// # Errors
    /// [`GridError::Quantity`] for fewer than two particles, and for a spacing or radius that is not positive and finite, below
    /// 10⁻⁹ m, or makes the rope longer than 10¹² m. [`GridError::TooLarge`] for too many particles.
    pub fn scaled(&self, scale: Vec3) -> Result<ClothGrid, GridError> {
        let count = self.particles as f32;
        AT_LEAST_TWO.check("particles of a rope", [count])?;
        Allowed::POSITIVE.check("spacing of a rope (m)", [self.spacing])?;
        Allowed::POSITIVE.check("radius of a rope (m)", [self.radius])?;
        let (axes, along) = match self.plane {
            ClothPlane::Hanging => ([Vec3::NEG_Y, Vec3::NEG_X], scale.y),
            ClothPlane::Lying => ([Vec3::X, Vec3::Z], scale.x),
        };
        let spacing = Vec2::new(self.spacing * along, width(self.radius, scale));
        ClothGrid::new([self.particles, 1], spacing, axes, scale, self.centred)
    }
}

/// Of particles or points of a rope.
const AT_LEAST_TWO: Allowed = Allowed(|count| count >= 2.0, "at least 2");

/// The spacing across the single row of a rope's grid: that is a border, and borders are half a spacing wide (m).
fn width(radius: f32, scale: Vec3) -> f32 {
    4.0 * radius * mean(scale)
}

/// The shape of a rope that begins along a path, before the transform's scale.
///
/// It is a [`RopeShape`] that begins elsewhere. Its positions at rest, as [`Pin::at_rest`](crate::cloth::Pin::at_rest) sees them, are on the
/// path. Nothing holds it there: its springs are as long as the path, and its bending pulls it straight. A corner between two particles is
/// cut off.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct RopePath {
    /// Points that the path leads through, in the entity's frame (m), at least 2.
    pub points: Vec<Vec3>,
    /// Approximate distance between neighbouring particles along it (m): the path is divided into equal parts.
    pub spacing: f32,
    /// Half of its thickness (m).
    pub radius: f32,
}

impl Default for RopePath {
    /// As the default [`RopeShape`].
    fn default() -> Self {
        Self {
            points: vec![Vec3::ZERO, Vec3::NEG_Y],
            spacing: 0.05,
            radius: 0.01,
        }
    }
}

impl RopePath {
    /// The surface under a transform's `scale`.
    ///
    /// # Errors
    /// - [`MeshError::VertexNotFinite`] for the first point that, scaled, is not finite or is beyond 10¹² m.
    /// - [`QuantityError`](crate::cloth::QuantityError) for fewer than two points.
    /// - [`QuantityError`](crate::cloth::QuantityError) for a length, spacing or radius that is not positive and finite, or is too small
    ///   or large once scaled.
    /// - [`GridError::TooLarge`] for too many particles.
    pub(super) fn surface(&self, scale: Vec3) -> Result<Surface, ClothError> {
        let count = self.points.len() as f32;
        AT_LEAST_TWO.check("points of a rope's path", [count])?;
        let points: Vec<Vec3> = self.points.iter().map(|point| scale * *point).collect();
        MeshError::check_vertices(&points, Vec3::ONE)?;
        let unscaled = along(&self.points).1;
        Allowed::POSITIVE.check("spacing of a rope (m)", [self.spacing])?;
        Allowed::POSITIVE.check("radius of a rope (m)", [self.radius])?;
        Allowed::POSITIVE.check("length of a rope's path (m)", [unscaled])?;
        let parts = (unscaled / self.spacing).round();
        let parts = parts.clamp(1.0, MAX_PARTICLES as f32) as u32;
        let (reached, length) = along(&points);
        let spacing = Vec2::new(length / parts as f32, width(self.radius, scale));
        let grid = ClothGrid::new([parts + 1, 1], spacing, [Vec3::X, Vec3::Z], scale, false)?;
        let mut at = 0;
        let place = |part: u32| {
            let way = length * (part as f32 / parts as f32);
            while at + 2 < points.len() && reached[at + 1] < way {
                at += 1;
            }
            let of_side = (way - reached[at]) / (reached[at + 1] - reached[at]);
            // A side without a length is where both of its ends are.
            let inside = of_side.clamp(0.0, 1.0);
            let of_side = if of_side.is_finite() { inside } else { 1.0 };
            points[at].lerp(points[at + 1], of_side)
        };
        let places: Vec<Vec3> = (0..=parts).map(place).collect();
        let normal = |index: usize| {
            let next = places[(index + 1).min(places.len() - 1)];
            let direction = (next - places[index.saturating_sub(1)]).try_normalize();
            direction.map_or(Vec3::Y, Vec3::any_orthonormal_vector)
        };
        let normals = (0..places.len()).map(normal).collect();
        Ok(Surface::of_placed_grid(&grid, places, normals))
    }
}

/// How far along a path each of its points is, and the last of them (m).
fn along(points: &[Vec3]) -> (Vec<f32>, f32) {
    let mut length = 0.0;
    let sides = points.windows(2).map(|side| {
        length += f64::from(side[0].distance(side[1]));
        length as f32
    });
    let all: Vec<f32> = [0.0].into_iter().chain(sides).collect();
    let last = all.last().copied().unwrap_or(0.0);
    (all, last)
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;
    use crate::cloth::{Cloth, ClothMaterial, ClothParticles};

    #[test]
    fn hangs_down_or_lies_along_x() {
        let rest = |rope: &Cloth, scale, particle| {
            let surface = rope.surface(scale).expect("a valid rope");
            surface.rest_positions()[particle]
        };
        let rope = Cloth::rope(5, 0.5, 0.01);
        assert_eq!(rest(&rope, Vec3::ONE, 0), Vec3::ZERO);
        assert_eq!(
            rest(&rope, Vec3::new(3.0, 2.0, 5.0), 4),
            Vec3::new(0.0, -4.0, 0.0)
        );
        let lying = rope.lying().centred();
        assert_eq!(rest(&lying, Vec3::ONE, 0), Vec3::new(-1.0, 0.0, 0.0));
        assert_eq!(rest(&lying, Vec3::ONE, 4), Vec3::new(1.0, 0.0, 0.0));
    }

    /// It weighs as much as a band of the material, whatever its resolution.
    #[test]
    fn has_the_mass_of_a_band() {
        let material = ClothMaterial::COTTON;
        for particles in [2, 3, 20, 101] {
            let rope = Cloth::rope(particles, 2.0 / (particles - 1) as f32, 0.01);
            let surface: Surface = rope.surface(Vec3::splat(3.0)).expect("a valid rope");
            let new = ClothParticles::at_rest(&surface, &material).expect("a valid material");
            let mass: f32 = new.inverse_masses().map(f32::recip).sum();
            let band = material.areal_density * 6.0 * 0.06;
            assert!(
                (mass - band).abs() < 1.0e-5 * band,
                "{particles}: {mass}, {band}"
            );
            assert!((surface.area() - 0.36).abs() < 1.0e-5);
            assert!(surface.triangles().is_empty());
        }
    }

    /// Three quarters of a circle of 64 sides, with points twice: particles are on it, and as far apart as a chord is of an arc.
    #[test]
    fn follows_a_path() {
        let points =
            (0..=48).map(|side| Vec3::from((Vec2::from_angle(side as f32 * TAU / 64.0), 0.0)));
        let points = points.flat_map(|point| [point, point]);
        let rope = Cloth::rope_along(points, 0.1, 0.01);
        let surface = rope.surface(Vec3::new(2.0, 2.0, -2.0)).expect("a rope");
        let grid = surface.as_grid().expect("one row");
        let side = 2.0 * (TAU / 128.0).sin();
        assert_eq!(grid.columns(), (48.0 * side / 0.1).round() as u32 + 1);
        let spacing = 2.0 * 48.0 * side / (grid.columns() - 1) as f32;
        assert!((grid.spacing().x / spacing - 1.0).abs() < 1.0e-5);
        let places = surface.rest_positions();
        for place in places {
            // A side's middle is nearest to the centre.
            assert!((1.997..=2.0 + 1.0e-5).contains(&place.length()), "{place}");
        }
        for neighbours in places.windows(2) {
            // Where a path turns by 2π ⁄ 64, a chord is shorter by at most 1 − cos(π ⁄ 64).
            let distance = neighbours[0].distance(neighbours[1]) / spacing;
            assert!((0.9987..1.0 + 1.0e-5).contains(&distance), "{distance}");
        }
        assert!(places[0].distance(2.0 * Vec3::X) < 1.0e-5);
        let last = places.last().expect("an end");
        assert!(last.distance(-2.0 * Vec3::Y) < 1.0e-4, "{last}");
    }

    #[test]
    fn refuses_what_is_no_path() {
        let refused = |points: &[Vec3], spacing| {
            let rope = Cloth::rope_along(points.iter().copied(), spacing, 0.01);
            rope.surface(Vec3::ONE).expect_err("no rope")
        };
        let is_quantity = |error: ClothError| error.quantity().is_some();
        assert!(is_quantity(refused(&[], 0.1)));
        assert!(is_quantity(refused(&[Vec3::ONE], 0.1)));
        assert!(is_quantity(refused(&[Vec3::ONE; 3], 0.1)));
        assert!(is_quantity(refused(&[Vec3::ZERO, Vec3::X], f32::NAN)));
        for far in [f32::NAN, f32::INFINITY, 1.0e13, -1.0e18] {
            let error = refused(&[Vec3::ZERO, Vec3::Y * far], 0.1);
            let is_named = matches!(
                error,
                ClothError::Mesh(MeshError::VertexNotFinite { vertex: 1, .. })
            );
            assert!(is_named, "{error}");
        }
        let error = refused(&[Vec3::ZERO, Vec3::X], 1.0e-8);
        assert!(
            matches!(error, ClothError::Grid(GridError::TooLarge { .. })),
            "{error}"
        );
    }

    #[test]
    fn refuses_what_is_no_rope() {
        let refused = |rope: Cloth| rope.surface(Vec3::ONE).err();
        let is_quantity =
            |error: Option<ClothError>| error.is_some_and(|error| error.quantity().is_some());
        for particles in [0, 1] {
            assert!(is_quantity(refused(Cloth::rope(particles, 0.1, 0.01))));
        }
        for wrong in [0.0, -0.1, f32::NAN, f32::INFINITY, 1.0e-30, 1.0e30] {
            assert!(
                is_quantity(refused(Cloth::rope(8, wrong, 0.01))),
                "spacing {wrong}"
            );
            assert!(
                is_quantity(refused(Cloth::rope(8, 0.1, wrong))),
                "radius {wrong}"
            );
        }
        let many = refused(Cloth::rope(u32::MAX, 0.1, 0.01));
        assert!(matches!(
            many,
            Some(ClothError::Grid(GridError::TooLarge { .. }))
        ));
    }
}
