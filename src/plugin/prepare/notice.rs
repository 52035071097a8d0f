//! Warnings about a cloth that was just built.

use bevy::math::Vec3;

use super::preparing::PrepareQueryItem;
use crate::{
    cloth::{ClothMaterial, Pin, Springs, Surface},
    plugin::{
        state::{Inputs, Notices},
        threads::{MIN_TO_SPLIT, threads},
    },
};

/// Looks once at a cloth that was built and has been prepared for a tick.
pub(super) fn notice_new(cloth: &mut PrepareQueryItem, inputs: &Inputs, notices: &mut Notices) {
    // While no time passes it is not known how many sub-steps there are.
    let step = cloth.scratch.step.filter(|step| step.seconds > 0.0);
    let Some(step) = step.filter(|_| cloth.built.noticed.is_due) else {
        return;
    };
    cloth.built.noticed.is_due = false;
    let surface = cloth.built.surface();
    let attached = cloth.game.attachments().iter();
    let attached = attached.map(|attachment| &attachment.pin);
    let mut pins = cloth.game.pins().iter().chain(attached);
    let vain = pins.find(|pin| pin.is_in_vain(surface));
    let vain = vain.map(|pin| in_vain(pin, surface));
    let (springs, material) = (cloth.built.springs(), &inputs.material);
    let threads = match surface.len() < MIN_TO_SPLIT {
        true => 1,
        false => threads(),
    };
    let cost = least_cost(springs, material, step.substeps, threads);
    let slow = (cost > step.seconds).then(|| {
        format!(
            "{} particles in {} sub-steps take at least {:.0} ms a tick, and a tick lasts {:.1} ms: use fewer particles or sub-steps; a \
             `ClothRenderMesh` draws a fine mesh on a coarse cloth",
            surface.len(),
            step.substeps,
            cost * 1.0e3,
            step.seconds * 1.0e3,
        )
    });
    let given = &mut cloth.built.noticed.given;
    for (given, text) in given.iter_mut().zip([vain, slow]) {
        if let Some(text) = text
            && !std::mem::replace(given, true)
        {
            notices.add(cloth.entity, text);
        }
    }
}

/// The text for a predicate that holds for no particle of a surface.
fn in_vain(pin: &Pin, surface: &Surface) -> String {
    let (name, given) = if let Pin::Where(_) = pin {
        let given = format!("(row, column) of {surface}, counted from 0");
        ("Pin::filter", given)
    } else {
        let places = surface.rest_positions().iter();
        // The sum makes 0 of −0.
        let places = places.map(|place| *place / surface.scale() + Vec3::ZERO);
        let [low, high] = places.fold([Vec3::MAX, Vec3::MIN], |[low, high], place| {
            [low.min(place), high.max(place)]
        });
        let given = format!("places at rest in the entity's frame, from {low:.2} to {high:.2} m");
        ("Pin::at_rest", given)
    };
    format!(
        "`{name}` holds for no particle, so it pins nothing. Its closure is given {given}; scene files don't hold closures"
    )
}

/// Least cost of a spring of a grid in a sub-step (s). `cargo bench --profile dev --bench solver` measures 1.5 to 2.2 ns on a thread
/// of a 2-core AMD EPYC for 64² to 512² particles; this leaves room for a faster machine.
const GRID_SPRING: f32 = 1.0e-9;

/// The same of a mesh: half of the 6 ns that `cargo bench --profile dev --bench mesh` measures.
const MESH_SPRING: f32 = 3.0e-9;

/// The bending of a mesh costs as much again as its springs.
const BENT_MESH: f32 = 2.0;

/// Least cost of the sub-steps of a tick on so many `threads` (s), without contact.
fn least_cost(springs: &Springs, material: &ClothMaterial, substeps: u32, threads: usize) -> f32 {
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
