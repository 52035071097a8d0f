//! Pins that follow other entities, and teleports.

use bevy::{
    ecs::{
        component::Component,
        entity::{Entity, MapEntities},
        reflect::{ReflectComponent, ReflectMapEntities},
    },
    math::{Affine3A, Isometry3d, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::helper::TransformHelper,
};

use super::{ClothFrame, frame::global_transform, prepare::PreparingItem};
use crate::{
    cloth::{ClothError, Pin},
    solver::PinMotion,
};

/// Pins of a cloth that follow other entities by their global transforms, moving smoothly over the sub-steps of a
/// tick: a flag on a pole that sways, a cape on shoulders.
///
/// Each particle keeps the offset that it has when it is attached; scaled and turned with its target. Attached
/// particles are pinned besides those of [`Pins`](crate::cloth::Pins). Move targets before
/// [`ClothSystems::Prepare`](super::ClothSystems). May change at any time: what is no longer attached is let go. A
/// predicate is known by itself: set it anew as a clone, since another one is another attachment. Before a target is
/// despawned take the attachment off, and the cloth falls; otherwise it stays where it is, with a fault.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn setup(mut commands: Commands) {
///     let pole = commands.spawn(Transform::from_xyz(0.0, 2.0, 0.0)).id();
///     commands.spawn((Cloth::default(), Pins::none(), ClothAttachments::new([(Pin::Column(0), pole)])));
/// }
/// ```
#[derive(Component, Reflect, MapEntities, Debug, Default, Clone, PartialEq)]
#[reflect(Component, MapEntities, Default, Debug, Clone, PartialEq)]
pub struct ClothAttachments(#[entities] Vec<ClothAttachment>);

/// A pin and the entity that it follows.
#[derive(Reflect, MapEntities, Debug, Clone, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct ClothAttachment {
    /// The particles.
    pub pin: Pin,
    /// What they follow.
    #[entities]
    pub target: Entity,
}

impl ClothAttachments {
    /// Each pin's particles follow its entity.
    pub fn new(attachments: impl IntoIterator<Item = (Pin, Entity)>) -> Self {
        let attach = |(pin, target)| ClothAttachment { pin, target };
        Self(attachments.into_iter().map(attach).collect())
    }

    /// What is attached to what.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &ClothAttachment> {
        self.0.iter()
    }
}

/// Insert this beside a new transform to have a cloth be there at once: it keeps its shape and its velocities, as
/// seen from its entity, or from its first attachment's target where it has one, and gets none from the jump.
/// Taken away in the next tick.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothTeleport;

/// A particle that follows an entity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attached {
    pub particle: u32,
    /// Which attachment it belongs to.
    pub attachment: usize,
    /// Where it is in the target's own frame.
    pub offset: Vec3,
}

/// Where an attachment's target is.
///
/// # Errors
/// [`ClothError::NoTarget`] for one that does not exist, has no transform, or is scaled to nothing.
fn find_target(
    attachment: &ClothAttachment,
    transforms: &TransformHelper,
) -> Result<Affine3A, ClothError> {
    let transform = global_transform(transforms, attachment.target).ok();
    let affine = transform.map(|transform| transform.affine());
    affine
        .filter(|affine| affine.inverse().is_finite())
        .ok_or_else(|| ClothError::NoTarget {
            pin: attachment.pin.clone(),
            target: attachment.target,
        })
}

impl PreparingItem<'_, '_> {
    /// Finds where the attachments' targets are, before anything is moved.
    pub(super) fn find_targets(&mut self, transforms: &TransformHelper) -> Result<(), ClothError> {
        let wanted = self
            .attachments
            .map_or(&[][..], |attachments| &attachments.0);
        self.tick.targets.clear();
        for attachment in wanted {
            attachment.pin.validate(&self.topology.grid)?;
            let target = find_target(attachment, transforms)?;
            self.tick.targets.push(target);
        }
        Ok(())
    }

    /// Has attached particles move to where their targets take them in this tick. A teleport, from the frame that the
    /// cloth had before, takes them there at once, and the others along.
    pub(super) fn follow_targets(&mut self, teleport_from: Option<ClothFrame>) {
        let wanted = self
            .attachments
            .map_or(&[][..], |attachments| &attachments.0);
        if wanted.is_empty() && self.tick.attachments.is_empty() {
            return;
        }
        if self.tick.attachments != wanted {
            self.attach(wanted);
        }
        let frame = *self.frame;
        if let Some(first) = self.tick.targets.first() {
            let pose = rigid(first);
            let was = self.tick.first_target.replace(pose);
            if let (Some(was), Some(before)) = (was, teleport_from) {
                let jump = pose * was.inverse();
                let (from, to) = (before.isometry(), frame.isometry());
                self.particles.transform(to.inverse() * jump * from);
            }
        }
        let is_carried = !self.tick.pins.is_empty();
        let tick = &mut *self.tick;
        for attached in &tick.attached {
            let target = tick.targets[attached.attachment];
            let particle = attached.particle as usize;
            let to = frame.from_world(target.transform_point3(attached.offset));
            let from = self.particles.position_at(particle);
            if teleport_from.is_some() {
                self.particles.put(particle, to);
            } else if is_carried || from != to {
                // A later motion of the same particle is the one that counts.
                tick.pins.push(PinMotion {
                    particle: attached.particle,
                    from,
                    to,
                });
            }
        }
    }

    /// Takes over other attachments. Those that stay keep their offsets; what is let go gets its mass back.
    fn attach(&mut self, wanted: &[ClothAttachment]) {
        let grid = self.topology.grid;
        let before = std::mem::take(&mut self.tick.attached);
        let known = std::mem::take(&mut self.tick.attachments);
        for (attachment, each) in wanted.iter().enumerate() {
            if let Some(old) = known.iter().position(|known| known == each) {
                let kept = before.iter().filter(|attached| attached.attachment == old);
                let kept = kept.map(|attached| Attached {
                    attachment,
                    ..*attached
                });
                self.tick.attached.extend(kept);
                continue;
            }
            let from_world = self.tick.targets[attachment].inverse();
            each.pin.for_each(&grid, |index| {
                let position = self.frame.to_world(self.particles.position_at(index));
                self.tick.attached.push(Attached {
                    particle: index as u32,
                    attachment,
                    offset: from_world.transform_point3(position),
                });
            });
        }
        if let Some((_, material, pins)) = &self.topology.woven {
            for attached in before {
                self.particles
                    .reweigh(attached.particle as usize, &grid, material, pins);
            }
        }
        for attached in &self.tick.attached {
            self.particles.pin(attached.particle as usize);
        }
        if known.first() != wanted.first() {
            self.tick.first_target = None;
        }
        self.tick.attachments = wanted.to_vec();
        self.tick.tethered = None;
        self.tick.rest.disturb();
    }
}

/// Where something is and how it is turned, its scale left out.
pub(super) fn rigid(affine: &Affine3A) -> Isometry3d {
    let (_, rotation, translation) = affine.to_scale_rotation_translation();
    Isometry3d::new(translation, rotation.normalize())
}
