//! The stress in a cloth, from the forces of its springs.

use bevy::math::Vec3;

use super::surface::Surface;
use crate::cloth::arrays::MapInline;

/// Number of times that stresses are shared with neighbours, at most: a patch of so many rings of faces.
const RINGS: usize = 12;
/// The same at the end of a tear, where the stress is large in a small place.
const RINGS_AT_TIP: usize = 2;
/// Particles along a mesh for each ring of a patch: it is small beside the cloth.
const PARTICLES_A_RING: usize = 2;

/// The stress around each particle, times the area of its patch (N m), and that area (m²).
///
/// The force T of a spring with the length L₀ at rest, in direction d, makes a stress `½ T L₀ d dᵀ` over the areas of its ends at rest (the virial). In a mesh of
/// springs, edges side by side bear loads that differ by a half and more. Their mean over two rings of faces differs by up to an eighth, over
/// four by some 5 %. A fine mesh has more places in which a patch may bear more than the mean, so its patches have more rings. Sharing n times
/// reaches as far as √(2n/3) spacings in the root of the mean square.
/// Tensions are those that the solver applied: they balance, where stretches have errors of a sub-step.
#[derive(Debug, Default)]
pub(super) struct Stress {
    around: Vec<Patch>,
    /// The same of the smaller patch.
    at_tip: Vec<Patch>,
    before: Vec<Patch>,
}

/// `σ_xx σ_yy σ_zz`, `σ_xy σ_yz σ_zx`, and the area.
#[derive(Debug, Default, Clone, Copy)]
struct Patch(Vec3, Vec3, f32);

impl Stress {
    /// Finds the stress of springs between particles at these places (m). `tensions` calls its argument with each spring's ends, and
    /// its tension T L₀/L (N).
    pub fn find(
        &mut self,
        tensions: impl FnOnce(&mut dyn FnMut([u32; 2], f32)),
        surface: &Surface,
        places: &[Vec3],
    ) {
        let around = &mut self.around;
        around.clear();
        let areas = (0..surface.len()).map(|particle| surface.area_of(particle));
        around.extend(areas.map(|area| Patch(Vec3::ZERO, Vec3::ZERO, area)));
        tensions(&mut |ends, tension| {
            let [a, b] = ends.map_inline(|end| places[end as usize]);
            let half = 0.5 * a.distance(b) * tension;
            let direction = (b - a).normalize_or_zero();
            for end in ends {
                let Patch(straight, sheared, _) = &mut around[end as usize];
                *straight += half * direction * direction;
                *sheared += half * direction * Vec3::new(direction.y, direction.z, direction.x);
            }
        });
        let rings = (surface.particles_along() / PARTICLES_A_RING).clamp(RINGS_AT_TIP + 1, RINGS);
        for ring in 0..rings {
            if ring == RINGS_AT_TIP {
                self.at_tip.clone_from(around);
            }
            self.before.clone_from(around);
            for (particle, patch) in around.iter_mut().enumerate() {
                for (beside, _) in surface.graph().of(particle as u32) {
                    let other = self.before[*beside as usize];
                    *patch = Patch(patch.0 + other.0, patch.1 + other.1, patch.2 + other.2);
                }
            }
        }
    }

    /// The force along an edge, over the width of the cloth that bears it (N/m).
    pub fn along(&self, ends: [u32; 2], is_at_tip: bool, places: &[Vec3]) -> f32 {
        let patches = [&self.around, &self.at_tip][usize::from(is_at_tip)];
        let [from, to] = ends.map_inline(|end| places[end as usize]);
        let d = (to - from).normalize_or_zero();
        let mixed = 2.0 * d * Vec3::new(d.y, d.z, d.x);
        let of = |end: u32| {
            let Patch(straight, sheared, area) = patches[end as usize];
            ((d * d).dot(straight) + mixed.dot(sheared)) / area
        };
        (of(ends[0]) + of(ends[1])) / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::{Cloth, ClothMaterial, Springs};

    /// A regular mesh that is stretched evenly has the stress that its material says, in all of its patches but those at a border,
    /// whichever way it is turned.
    #[test]
    fn an_even_stretch_has_an_even_stress() {
        let material = ClothMaterial {
            stretch_compliance: 1.0e-3,
            shear_compliance: f32::INFINITY,
            ..ClothMaterial::COTTON
        };
        let side = 16_u32;
        // Equilateral triangles.
        let place = |index: u32| {
            let (row, column) = (index / side, index % side);
            let shift = if row % 2 == 1 { 0.5 } else { 0.0 };
            Vec3::new(column as f32 + shift, row as f32 * 0.75_f32.sqrt(), 0.0) * 0.1
        };
        let cells = (0..side * (side - 1)).filter(|index| index % side < side - 1);
        let faces = cells.flat_map(|a| {
            let (b, c, d) = (a + 1, a + side, a + side + 1);
            match (a / side) % 2 {
                0 => [[a, b, c], [b, d, c]],
                _ => [[a, b, d], [a, d, c]],
            }
        });
        let cloth = Cloth::triangles((0..side * side).map(place), faces);
        let surface = cloth.surface(Vec3::ONE).expect("a valid mesh");
        let springs = Springs::of_surface(&surface, &material);
        let turn = bevy::math::Quat::from_rotation_x(0.7) * bevy::math::Quat::from_rotation_z(1.1);
        for stretch in [Vec3::X, Vec3::X + Vec3::Y].map(|of| 0.01 * of) {
            let moved: Vec<Vec3> = surface
                .rest_positions()
                .iter()
                .map(|at| turn * (*at * (Vec3::ONE + stretch)))
                .collect();
            let mut stress = Stress::default();
            let tensions = |visit: &mut dyn FnMut([u32; 2], f32)| {
                springs.for_each(|_, spring| {
                    let [a, b] = spring.ends.map(|end| moved[end as usize]);
                    let longer = a.distance(b) - spring.rest_length;
                    visit(spring.ends, longer / spring.compliance);
                });
            };
            stress.find(tensions, &surface, &moved);
            // Springs of all directions have a Poisson's ratio of a third: E h ⁄ (1 − ν²) (ε₁ + ν ε₂), with E h = 1 ⁄ compliance.
            let truth = (stretch.x + stretch.y / 3.0) / (8.0 / 9.0) / material.stretch_compliance;
            let middle = Vec3::new(0.8, 0.65, 0.0);
            let rest = surface.rest_positions();
            let near = (0..surface.len() as u32).min_by(|a, b| {
                let far = |of: u32| rest[of as usize].distance(middle);
                far(*a).total_cmp(&far(*b))
            });
            let near = near.expect("particles");
            let beside = surface.graph().of(near).iter().map(|(beside, _)| *beside);
            let mut checked = 0;
            for beside in beside {
                let d = (rest[beside as usize] - rest[near as usize]).normalize();
                if d.x.abs() > 0.999 {
                    for is_at_tip in [false, true] {
                        let found = stress.along([near, beside], is_at_tip, &moved);
                        checked += 1;
                        // Lengths, areas and directions are each off by a part of the stretch, 0.01.
                        assert!(
                            (found / truth - 1.0).abs() < 0.04,
                            "{found} N/m, {truth} N/m"
                        );
                    }
                }
            }
            assert_eq!(checked, 4);
        }
    }
}
