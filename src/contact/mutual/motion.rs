//! What all cloths together say of a search: how thin they are, how they move, and how flat they are.

use bevy::math::Vec3;

use super::participant::Participant;

/// The smallest thickness of any (m).
pub(super) fn thinnest(cloths: &[Participant]) -> f32 {
    let each = cloths.iter().map(|cloth| cloth.settings.thickness);
    each.fold(f32::INFINITY, f32::min)
}

/// By how much any two particles come nearer to each other in a sub-step as long as the last, at most (m).
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

/// By how much any two points of a cloth that is alone may come nearer to each other until it touches itself (m), as far as its
/// tangents say so; none if they don't.
pub(super) fn room_in_flat(cloths: &[Participant]) -> Option<f32> {
    let [cloth] = cloths else {
        return None;
    };
    let tangents = cloth.sheet.tangents_of_all(cloth.particles)?;
    Some(tangents.unfolded() * cloth.sheet.closest() - cloth.settings.thickness)
}
