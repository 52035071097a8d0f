//! Frozen cloths, which keep their shape and move with their carrier, and the start of their motion when they thaw.

use bevy::prelude::{DetectChanges, DetectChangesMut, Isometry3d};

use super::{named::Targets, preparing::PrepareQueryItem};
use crate::{
    cloth::{ClothError, TargetError},
    plugin::{
        authoring::ClothAttachment,
        frame::{ClothFrame, rigid},
        state::{ClothState, Frozen},
    },
};

/// Place of the carrier of a cloth whose entity is at `frame`: its first attachment's target if it has one, else the
/// entity. `None` if that target is gone, or has no place.
fn carrier(targets: &Targets, state: &ClothState, frame: ClothFrame) -> Option<Isometry3d> {
    let Some(target) = state.attachments.targets.first() else {
        return Some(frame.isometry());
    };
    let place = targets.place(*target)?.affine();
    place.inverse().is_finite().then(|| rigid(&place))
}

/// Freezes a cloth: its frame moves with its carrier, and its particles keep their places in the frame. They lose their
/// velocities when it begins.
///
/// # Errors
/// [`Unusable`](crate::cloth::TransformError::Unusable), [`Missing`](crate::cloth::TransformError::Missing), and [`TargetError::NoTarget`] if the target of its first
/// attachment is gone or has no place.
pub(crate) fn freeze(cloth: &mut PrepareQueryItem, targets: &Targets) -> Result<(), ClothError> {
    let (particles, state) = (&mut cloth.particles, &mut *cloth.state);
    let attachments = cloth.game.attachments();
    let transform = targets.cloths.of(cloth.entity)?;
    let (now, _) = ClothFrame::of(&transform)?;
    let Some(carried_by) = carrier(targets, state, now) else {
        return match (attachments.first(), state.attachments.targets.first()) {
            (Some(ClothAttachment { pin, .. }), Some(&target))
                if state.attachments.given == attachments =>
            {
                Err(ClothError::Target(TargetError::NoTarget {
                    pin: format!("{pin:?}"),
                    target,
                }))
            }
            // Released particles fall once the cloth moves again, and particles attached to other targets go there.
            _ => Ok(()),
        };
    };
    let was = cloth.frame.isometry();
    let frozen = state.lod.frozen.unwrap_or_else(|| {
        particles.set_body_motion(Isometry3d::IDENTITY, 0.0);
        state.inputs.written = Some(particles.last_changed());
        state.carriers.clear();
        let carrier = state.attachments.first_target.unwrap_or(was);
        Frozen {
            frame: was,
            carrier,
            last: carrier,
        }
    });
    let pose = if state.attachments.targets.is_empty() {
        now.isometry()
    } else {
        carried_by * frozen.carrier.inverse() * frozen.frame
    };
    state.lod.frozen = Some(Frozen {
        last: carried_by,
        ..frozen
    });
    cloth.frame.set_if_neq(now.with_isometry(pose));
    Ok(())
}

/// Thaws a frozen cloth in a tick of `seconds`. It gets the velocity of its carrier, or none
/// if it `jumps`. Returns whether it was frozen.
pub(crate) fn thaw(
    cloth: &mut PrepareQueryItem,
    targets: &Targets,
    [before, now]: [&ClothFrame; 2],
    (seconds, jumps): (f32, bool),
) -> bool {
    let state = &mut *cloth.state;
    let Some(frozen) = state.lod.frozen.take() else {
        return false;
    };
    let was = before.isometry();
    let by = match carrier(targets, state, *now) {
        Some(now) if !jumps => was.inverse() * now * frozen.last.inverse() * was,
        _ => Isometry3d::IDENTITY,
    };
    cloth.particles.set_body_motion(by, seconds);
    // Its last place while frozen, not its place as it froze.
    if state.attachments.first_target.is_some() {
        state.attachments.first_target = Some(frozen.last);
    }
    state.wake();
    true
}
