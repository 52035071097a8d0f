//! Ropes: grids of a single row.

use bevy::{
    math::{Vec2, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    error::ClothError,
    grid::{ClothGrid, ClothPlane, mean},
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
    /// [`ClothError::Quantity`] for fewer than two particles, and for a spacing or radius that is not positive and finite, below
    /// 10⁻⁹ m, or makes the rope longer than 10¹² m. [`ClothError::GridTooLarge`] for too many particles.
    pub fn scaled(&self, scale: Vec3) -> Result<ClothGrid, ClothError> {
        let count = self.particles as f32;
        ClothError::check(count, |n| n >= 2.0, "particles of a rope", "at least 2")?;
        let is_length = |length: f32| length > 0.0 && length.is_finite();
        for (length, name) in [
            (self.spacing, "spacing of a rope (m)"),
            (self.radius, "radius of a rope (m)"),
        ] {
            ClothError::check(length, is_length, name, "positive and finite")?;
        }
        let (axes, along) = match self.plane {
            ClothPlane::Hanging => ([Vec3::NEG_Y, Vec3::NEG_X], scale.y),
            ClothPlane::Lying => ([Vec3::X, Vec3::Z], scale.x),
        };
        // The single row is a border of the grid, and borders are half a spacing wide.
        let width = 4.0 * self.radius * mean(scale);
        let spacing = Vec2::new(self.spacing * along, width);
        ClothGrid::new([self.particles, 1], spacing, axes, scale, self.centred)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::{Cloth, ClothMaterial, ClothParticles, Surface};

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

    #[test]
    fn refuses_what_is_no_rope() {
        let refused = |rope: Cloth| rope.surface(Vec3::ONE).err();
        let is_quantity = |error| matches!(error, Some(ClothError::Quantity { .. }));
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
        assert!(matches!(many, Some(ClothError::GridTooLarge { .. })));
    }
}
