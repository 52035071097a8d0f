//! Warnings about a cloth that was just built.

use bevy::math::Vec3;

use super::{cost::least_cost, preparing::PrepareQueryItem};
use crate::{
    cloth::{Pin, Surface},
    plugin::{
        state::{Inputs, Notice, Notices},
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
    for (notice, text) in [(Notice::PinsNothing, vain), (Notice::TooSlow, slow)] {
        if let Some(text) = text
            && cloth.built.noticed.is_first(notice)
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
