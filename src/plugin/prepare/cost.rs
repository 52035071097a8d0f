//! How long a tick takes at least.

use crate::cloth::{ClothMaterial, Springs};

/// What a spring of a grid costs in a sub-step (s), at least. `cargo bench --profile dev --bench solver` measures 1.5 to 2.2 ns on a thread
/// of a 2-core AMD EPYC for 64² to 512² particles; this leaves room for a faster machine.
const GRID_SPRING: f32 = 1.0e-9;

/// The same of a mesh: half of the 6 ns that `cargo bench --profile dev --bench mesh` measures.
const MESH_SPRING: f32 = 3.0e-9;

/// The bending of a mesh costs as much again as its springs.
const BENT_MESH: f32 = 2.0;

/// What the sub-steps of a tick cost at least (s) on so many `threads`, whatever the cloth touches.
pub(crate) fn least_cost(
    springs: &Springs,
    material: &ClothMaterial,
    substeps: u32,
    threads: usize,
) -> f32 {
    let spring = if springs.are_of_grid() {
        GRID_SPRING
    } else if material.bend_rigidity > 0.0 {
        MESH_SPRING * BENT_MESH
    } else {
        MESH_SPRING
    };
    springs.len() as f32 * substeps as f32 * spring / threads as f32
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;

    use super::*;
    use crate::{cloth::Cloth, solver::Substepping};

    /// The largest square grids whose ticks may fit Bevy's 64 Hz: 64² is far below, 300,000 particles are far beyond.
    #[test]
    fn ordinary_cloth_fits_and_a_huge_one_does_not() {
        let tick = 1.0 / 64.0;
        let cost = |side: u32| {
            let surface = Cloth::new(side, side, 0.01).surface(Vec3::ONE);
            let surface = surface.expect("a valid grid");
            let material = ClothMaterial::COTTON;
            let springs = Springs::of_surface(&surface, &material);
            let substeps = Substepping::needed(surface.particles_along(), tick);
            least_cost(&springs, &material, substeps, 1) / tick
        };
        assert!(cost(64) < 0.1, "{}", cost(64));
        assert!(cost(128) < 0.5, "{}", cost(128));
        assert!(cost(256) > 1.0, "{}", cost(256));
        assert!(cost(548) > 10.0, "{}", cost(548));
    }
}
