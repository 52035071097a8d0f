//! Finds the targets of attachments, and makes pins follow them.

use bevy::{
    ecs::{change_detection::Mut, entity::Entity, system::SystemParam},
    math::Affine3A,
    transform::helper::TransformHelper,
};

use super::{carry::set_motion, named::NamedTargets};
use crate::{
    cloth::{ClothError, ClothParticles, Surface, TargetError},
    plugin::{
        authoring::{Attached, ClothAttachment},
        frame::{ClothFrame, Places, global_transform, rigid},
        state::{ClothBuilt, ClothState},
    },
    solver::PinMotion,
};

/// Transforms and names of entities.
#[derive(SystemParam)]
pub(crate) struct Targets<'w, 's> {
    pub transforms: TransformHelper<'w, 's>,
    /// Where cloths are, also below what is disabled.
    pub cloths: Places<'w, 's>,
    named: NamedTargets<'w, 's, ()>,
}

impl Targets<'_, '_> {
    /// The entity that an attachment of `cloth` names; `known` is the one that it was in the last tick.
    fn entity(
        &self,
        cloth: Entity,
        attachment: &ClothAttachment,
        known: Option<Entity>,
    ) -> Result<Entity, TargetError> {
        let exists = |entity| global_transform(&self.transforms, entity).is_some();
        let pin = || format!("{:?}", attachment.pin);
        (self.named).find(&attachment.target, cloth, known, exists, pin)
    }

    /// Finds the places of the targets of a cloth's attachments; `known` are the attachments of the last tick.
    ///
    /// # Errors
    /// [`TargetError::NoTarget`] for a target that does not exist, has no transform, or is scaled to zero;
    /// [`TargetError::NoTargetNamed`]; or the error of a pin.
    pub fn find(
        &self,
        cloth: Entity,
        attachments: &[ClothAttachment],
        known: &[ClothAttachment],
        surface: &Surface,
        entities: &mut Vec<Entity>,
        places: &mut Vec<Affine3A>,
    ) -> Result<(), ClothError> {
        places.clear();
        // Known attachments were valid.
        if attachments != known {
            attachments
                .iter()
                .try_for_each(|each| each.pin.validate(surface))?;
        }
        for (index, attachment) in attachments.iter().enumerate() {
            let target = self.entity(cloth, attachment, entities.get(index).copied())?;
            let transform = global_transform(&self.transforms, target);
            let affine = transform.map(|transform| transform.affine());
            let place = affine.filter(|affine| affine.inverse().is_finite());
            places.push(place.ok_or_else(|| TargetError::NoTarget {
                pin: format!("{:?}", attachment.pin),
                target,
            })?);
            if index < entities.len() {
                entities[index] = target;
            } else {
                entities.push(target);
            }
        }
        entities.truncate(attachments.len());
        Ok(())
    }
}

/// Moves attached particles with their targets in this tick, by `motions`. A teleport moves them at once, from the
/// frame that the cloth had before, and the other particles with them.
pub(crate) fn follow_targets(
    wanted: &[ClothAttachment],
    places: &[Affine3A],
    frame: ClothFrame,
    teleport_from: Option<ClothFrame>,
    particles: &mut Mut<ClothParticles>,
    built: &mut ClothBuilt,
    state: &mut ClothState,
    motions: &mut Vec<PinMotion>,
) {
    // A snapshot may hold attachments that the game does not have.
    let is_free = state.attachments.given.is_empty() && state.attachments.attached.is_empty();
    if wanted.is_empty() && is_free {
        return;
    }
    if state.attachments.given != wanted || wanted.is_empty() {
        attach(wanted, places, frame, particles, built, state);
        // Released particles are not carried along.
        let is_held =
            |motion: &PinMotion| particles.inverse_mass(motion.particle as usize) == Some(0.0);
        motions.retain(is_held);
    }
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
fn attach(
    wanted: &[ClothAttachment],
    places: &[Affine3A],
    frame: ClothFrame,
    particles: &mut ClothParticles,
    built: &mut ClothBuilt,
    state: &mut ClothState,
) {
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
