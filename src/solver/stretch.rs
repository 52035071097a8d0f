//! The stretch of springs beyond their rest lengths.

use bevy::reflect::Reflect;

use crate::cloth::{ClothParticles, MapInline, SpringKind, Springs};

/// Stretch of a cloth: length / rest length − 1 of its most stretched spring, at least 0.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Stretch {
    /// Largest stretch of the structural springs: the visible stretch.
    pub structural: f32,
    /// Largest stretch of structural and shear springs: no path along them is longer than its rest length times 1 +
    /// this.
    pub bound: f32,
    /// The stretch of the material at the largest tension of its structural springs, including damping along them. A
    /// stretch beyond it is what the sub-steps left unsolved. It is known where chains were solved; it equals
    /// `structural` where springs act by explicit forces, and is 0 otherwise.
    pub material: f32,
    /// Number of sub-steps in a tick as long as the last that resolves ripples across the chains. It is that of a taut
    /// membrane in a frame, at the tension in half of the cloth's width, or at the median particle of a mesh. 0 where no chain gives.
    pub ripple_substeps: f32,
    /// Number of sub-steps in a tick as long as the last that holds the bodies on the cloth, by their weight on the
    /// chains that carry them. On a mesh they also hold the places that are denser than others. 0 if there is neither.
    pub load_substeps: f32,
    /// Number of sub-steps in a tick as long as the last that holds the chains together where something that moves forces
    /// them over a collider's edges. 0 if nothing does.
    pub contact_substeps: f32,
}

impl Stretch {
    /// Measures every structural and shear spring one by one. [`Solver::measure`](crate::solver::Solver::measure) does the same
    /// for many at once.
    pub fn measure(springs: &Springs, particles: &ClothParticles) -> Self {
        let (mut structural, mut bound) = (1.0_f32, 1.0_f32);
        springs.for_each(|_, spring| {
            let [a, b] = spring
                .ends
                .map_inline(|end| particles.position_at(end as usize));
            let ratio = a.distance_squared(b) / (spring.rest_length * spring.rest_length);
            match spring.kind {
                SpringKind::Structural => structural = structural.max(ratio),
                SpringKind::Shear => bound = bound.max(ratio),
                SpringKind::Bend => {}
            }
        });
        Self::of_ratios(structural.sqrt(), bound.max(structural).sqrt())
    }

    /// From the largest length over rest length of structural springs, and of structural and shear springs.
    pub(super) fn of_ratios(structural: f32, bound: f32) -> Self {
        Self {
            structural: structural.max(1.0) - 1.0,
            bound: bound.max(1.0) - 1.0,
            material: 0.0,
            ripple_substeps: 0.0,
            load_substeps: 0.0,
            contact_substeps: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::{Cloth, ClothMaterial, Surface};
    use bevy::math::Vec3;

    #[test]
    fn finds_the_longest_spring_of_each_kind() {
        let grid = Cloth::new(4, 4, 1.0).grid(Vec3::ONE).expect("a valid grid");
        let springs = Springs::of_grid(&grid, &ClothMaterial::COTTON);
        let surface = Surface::of_grid(&grid);
        let mut particles =
            ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("a valid material");
        assert_eq!(Stretch::measure(&springs, &particles), Stretch::default());

        // The corner pulled out along the diagonal: both its structural springs become √(2² + 1²) long, its
        // shear spring 2√2.
        particles
            .set_position((0, 0), Vec3::new(-1.0, 1.0, 0.0))
            .expect("it exists");
        let stretch = Stretch::measure(&springs, &particles);
        assert!((stretch.structural - (5.0_f32.sqrt() - 1.0)).abs() < 1e-6);
        assert!((stretch.bound - 5.0_f32.sqrt() + 1.0).abs() < 1e-6);

        particles
            .set_position((0, 0), Vec3::new(-0.1, 0.1, 0.0))
            .expect("it exists");
        let stretch = Stretch::measure(&springs, &particles);
        assert!((stretch.structural - (1.22_f32.sqrt() - 1.0)).abs() < 1e-6);
        assert!((stretch.bound - 1.22_f32.sqrt() + 1.0).abs() < 1e-6);

        // Shear alone: a parallelogram with sides at rest has one longer diagonal.
        for (row, column) in grid.cells() {
            let x = column as f32 + 0.6 * row as f32;
            let sheared = Vec3::new(x, -0.8 * row as f32, 0.0);
            particles
                .set_position((row, column), sheared)
                .expect("it exists");
        }
        let stretch = Stretch::measure(&springs, &particles);
        assert!(stretch.structural < 1e-6);
        assert!((stretch.bound - (3.2_f32.sqrt() / 2.0_f32.sqrt() - 1.0)).abs() < 1e-6);
    }
}
