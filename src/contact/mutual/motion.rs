//! Thickness, motion and flatness of all cloths together.

use bevy::math::Vec3;

use super::participant::Participant;

/// The smallest thickness (m).
pub(super) fn thinnest(cloths: &[Participant]) -> f32 {
    let each = cloths.iter().map(|cloth| cloth.settings.thickness);
    each.fold(f32::INFINITY, f32::min)
}

/// Largest approach of any two particles in a sub-step as long as the last (m).
pub(super) fn relative_motion(cloths: &[Participant]) -> f32 {
    let each = || {
        cloths.iter().flat_map(|cloth| {
            cloth
                .particles
                .displacements()
                .map(|moved| cloth.vector(moved))
        })
    };
    let count = cloths
        .iter()
        .map(|cloth| cloth.particles.len())
        .sum::<usize>();
    let drift = each().sum::<Vec3>() / count.max(1) as f32;
    let squares = each().map(|moved| (moved - drift).length_squared());
    2.0 * squares.fold(0.0, f32::max).sqrt()
}

/// Largest approach of any two points of a single cloth before it can touch itself (m), from its tangents; `None` if
/// they give no bound.
pub(super) fn room_in_flat(cloths: &[Participant]) -> Option<f32> {
    let [cloth] = cloths else {
        return None;
    };
    let tangents = cloth.sheet.tangents_of_all(cloth.particles)?;
    Some(tangents.unfolded() * cloth.sheet.closest() - cloth.settings.thickness)
}
