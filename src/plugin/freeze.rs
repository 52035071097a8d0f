//! Cloths that keep their shape and go with what carries them: frozen, and taking up their motion again.

use bevy::{
    ecs::{
        change_detection::{DetectChanges, DetectChangesMut, Mut},
        entity::Entity,
    },
    math::Isometry3d,
};

use super::{
    ClothAttachment, ClothFrame, ClothState,
    attach::Targets,
    frame::{global_transform, rigid},
    lod_state::Frozen,
};
use crate::cloth::{ClothError, ClothParticles};

/// Where that is what carries a cloth whose entity is at `frame`: its first attachment's target, where it has one, else the entity;
/// `None` if that target has gone.
fn carrier(targets: &Targets, state: &ClothState, frame: ClothFrame) -> Option<Isometry3d> {
    let Some(target) = state.targets.first() else {
        return Some(frame.isometry());
    };
    let place = global_transform(&targets.transforms, *target)?;
    Some(rigid(&place.affine()))
}

/// Has a cloth stand still, and its frame go with what carries it, so that its particles keep their places in that; they lose their
/// velocities as it begins to.
///
/// # Errors
/// [`ClothError::Transform`], [`ClothError::NoTransform`], and [`ClothError::NoTarget`] for a first `attachments`' target that has gone.
pub(super) fn stand(
    entity: Entity,
    attachments: &[ClothAttachment],
    targets: &Targets,
    frame: &mut Mut<ClothFrame>,
    particles: &mut Mut<ClothParticles>,
    state: &mut ClothState,
) -> Result<(), ClothError> {
    let transform = targets.cloths.of(entity)?;
    let (now, _) = ClothFrame::of(&transform)?;
    let Some(carried_by) = carrier(targets, state, now) else {
        return match (attachments.first(), state.targets.first()) {
            (Some(ClothAttachment { pin, .. }), Some(&target))
                if state.attachments == attachments =>
            {
                Err(ClothError::NoTarget {
                    pin: pin.clone(),
                    target,
                })
            }
            // What was taken off meanwhile falls once it moves again, and what was attached to others goes there.
            _ => Ok(()),
        };
    };
    let was = frame.isometry();
    let frozen = state.lod.frozen.unwrap_or_else(|| {
        particles.set_body_motion(Isometry3d::IDENTITY, 0.0);
        state.written = Some(particles.last_changed());
        state.carriers.clear();
        let carrier = state.first_target.unwrap_or(was);
        Frozen {
            frame: was,
            carrier,
            last: carrier,
        }
    });
    let pose = if state.targets.is_empty() {
        now.isometry()
    } else {
        carried_by * frozen.carrier.inverse() * frozen.frame
    };
    state.lod.frozen = Some(Frozen {
        last: carried_by,
        ..frozen
    });
    frame.set_if_neq(now.with_isometry(pose));
    Ok(())
}

/// Has a cloth that stood still, whose entity is at `now`, go on in a tick of so many `seconds`: with the velocity of what carries it, or
/// with none if it `jumps`. Returns whether it stood still.
pub(super) fn thaw(
    targets: &Targets,
    now: ClothFrame,
    (seconds, jumps): (f32, bool),
    frame: ClothFrame,
    particles: &mut Mut<ClothParticles>,
    state: &mut ClothState,
) -> bool {
    let Some(frozen) = state.lod.frozen.take() else {
        return false;
    };
    let was = frame.isometry();
    let by = match carrier(targets, state, now) {
        Some(now) if !jumps => was.inverse() * now * frozen.last.inverse() * was,
        _ => Isometry3d::IDENTITY,
    };
    particles.set_body_motion(by, seconds);
    // Where it stood, and not where it was as it froze.
    if state.first_target.is_some() {
        state.first_target = Some(frozen.last);
    }
    state.rest.disturb();
    true
}
