//! Makes pins follow the targets of attachments.

use super::{carry::set_motion, preparing::PrepareQueryItem};
use crate::{
    plugin::{
        authoring::Attached,
        frame::{ClothFrame, rigid},
    },
    solver::PinMotion,
};

/// Moves attached particles with their targets in this tick. A teleport moves them at once, from the
/// frame that the cloth had before, and the other particles with them.
pub(crate) fn follow_targets(cloth: &mut PrepareQueryItem, teleport_from: Option<ClothFrame>) {
    let (wanted, known) = (cloth.game.attachments(), &cloth.state.attachments);
    // A snapshot may hold attachments that the game does not have.
    if wanted.is_empty() && known.given.is_empty() && known.attached.is_empty() {
        return;
    }
    if known.given != wanted || wanted.is_empty() {
        attach(cloth);
        // Released particles are not carried along.
        let mass = |motion: &PinMotion| cloth.particles.inverse_mass(motion.particle as usize);
        (cloth.scratch.pins).retain(|motion| mass(motion) == Some(0.0));
    }
    let (particles, state, frame) = (&mut cloth.particles, &mut *cloth.state, &*cloth.frame);
    let scratch = &mut *cloth.scratch;
    let (places, motions) = (&scratch.targets, &mut scratch.pins);
    if let Some(first) = places.first() {
        let pose = rigid(first);
        let was = state.attachments.first_target.replace(pose);
        if let (Some(was), Some(before)) = (was, teleport_from) {
            let jump = pose * was.inverse();
            let (from, to) = (before.isometry(), frame.isometry());
            particles.transform(to.inverse() * jump * from);
        }
    }
    let carried = motions.len();
    for attached in &state.attachments.attached {
        let target = places[attached.attachment];
        let particle = attached.particle as usize;
        let to = frame.from_world(target.transform_point3(attached.offset));
        let from = particles.position_at(particle);
        if teleport_from.is_some() {
            particles.put(particle, to);
            continue;
        }
        let motion = PinMotion {
            particle: attached.particle,
            from,
            to,
        };
        set_motion(motions, carried, motion);
    }
}

/// Takes over changed attachments. Attachments that stay keep their offsets; released particles get their mass back.
fn attach(cloth: &mut PrepareQueryItem) {
    let (wanted, places, frame) = (
        cloth.game.attachments(),
        &cloth.scratch.targets,
        &cloth.frame,
    );
    let (particles, built, state) = (&mut *cloth.particles, &mut *cloth.built, &mut *cloth.state);
    let before = std::mem::take(&mut state.attachments.attached);
    let known = std::mem::take(&mut state.attachments.given);
    for (attachment, each) in wanted.iter().enumerate() {
        if let Some(old) = known.iter().position(|known| known == each) {
            let kept = before.iter().filter(|attached| attached.attachment == old);
            let kept = kept.map(|attached| Attached {
                attachment,
                ..*attached
            });
            state.attachments.attached.extend(kept);
            continue;
        }
        let from_world = places[attachment].inverse();
        each.pin.for_each(built.surface(), |index| {
            let position = frame.to_world(particles.position_at(index));
            state.attachments.attached.push(Attached {
                particle: index as u32,
                attachment,
                offset: from_world.transform_point3(position),
            });
        });
    }
    let released = before.iter().map(|attached| attached.particle as usize);
    built.give_masses(released, particles);
    for attached in &state.attachments.attached {
        particles.pin(attached.particle as usize);
    }
    if known.first() != wanted.first() {
        state.attachments.first_target = None;
    }
    state.attachments.given = wanted.to_vec();
    built.forget_tethers();
    state.wake();
}
