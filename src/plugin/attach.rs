//! Pins that follow other entities, and teleports.

use bevy::{
    ecs::{component::Component, entity::Entity, reflect::ReflectComponent},
    math::{Affine3A, Isometry3d, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::helper::TransformHelper,
};

use super::{ClothFrame, frame::global_transform, prepare::PreparingItem};
use crate::{
    cloth::{ClothError, Pin, Pins},
    solver::PinMotion,
};

/// Pins of a cloth that follow other entities by their global transforms, moving smoothly over the sub-steps of a
/// tick: a flag on a pole that sways, a cape on shoulders.
///
/// Each particle keeps the offset that it has when it is attached; scaled and turned with its target. Attached
/// particles are pinned besides those of [`Pins`](crate::cloth::Pins). Move targets before
/// [`ClothSystems::Prepare`](super::ClothSystems). May change at any time: what is no longer attached is let go.
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
#[derive(Component, Reflect, Debug, Default, Clone, PartialEq)]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothAttachments(Vec<(Pin, Entity)>);

impl ClothAttachments {
    /// Each pin's particles follow its entity.
    pub fn new(attachments: impl IntoIterator<Item = (Pin, Entity)>) -> Self {
        Self(attachments.into_iter().collect())
    }

    /// What is attached to what.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &(Pin, Entity)> {
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
    attachment: usize,
    /// Where it is in the target's own frame.
    offset: Vec3,
}

/// Where an attachment's target is.
///
/// # Errors
/// [`ClothError::NoTarget`] for one that does not exist, has no transform, or is scaled to nothing.
fn target(
    (pin, target): &(Pin, Entity),
    transforms: &TransformHelper,
) -> Result<Affine3A, ClothError> {
    let transform = global_transform(transforms, *target).ok();
    let affine = transform.map(|transform| transform.affine());
    affine
        .filter(|affine| affine.inverse().is_finite())
        .ok_or_else(|| ClothError::NoTarget {
            pin: pin.clone(),
            target: *target,
        })
}

impl PreparingItem<'_, '_> {
    /// Whether the attachments can be followed: asked before anything is moved.
    pub(super) fn check_targets(&self, transforms: &TransformHelper) -> Result<(), ClothError> {
        let wanted = self
            .attachments
            .map_or(&[][..], |attachments| &attachments.0);
        for attachment in wanted {
            target(attachment, transforms)?;
        }
        Pins::new(wanted.iter().map(|(pin, _)| pin.clone())).validate(&self.topology.grid)
    }

    /// Has attached particles move to where their targets take them in this tick. A teleport, from the frame that the
    /// cloth had before, takes them there at once, and the others along.
    pub(super) fn follow_targets(
        &mut self,
        transforms: &TransformHelper,
        teleport_from: Option<ClothFrame>,
    ) -> Result<(), ClothError> {
        let wanted = self
            .attachments
            .map_or(&[][..], |attachments| &attachments.0);
        if wanted.is_empty() && self.tick.attachments.is_empty() {
            return Ok(());
        }
        if self.tick.attachments != wanted {
            self.attach(wanted, transforms)?;
        }
        let frame = *self.frame;
        if let Some(first) = wanted.first() {
            let (_, rotation, translation) =
                target(first, transforms)?.to_scale_rotation_translation();
            let pose = Isometry3d::new(translation, rotation.normalize());
            let was = self.tick.first_target.replace(pose);
            if let (Some(was), Some(before)) = (was, teleport_from) {
                let jump = pose * was.inverse();
                let (from, to) = (before.isometry(), frame.isometry());
                self.particles.transform(to.inverse() * jump * from);
            }
        }
        let is_carried = !self.tick.pins.is_empty();
        for (index, attachment) in wanted.iter().enumerate() {
            let affine = target(attachment, transforms)?;
            let tick = &mut *self.tick;
            for attached in tick.attached.iter().filter(|each| each.attachment == index) {
                let particle = attached.particle as usize;
                let to = frame.from_world(affine.transform_point3(attached.offset));
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
        Ok(())
    }

    /// Takes over other attachments. Those that stay keep their offsets; what is let go gets its mass back.
    fn attach(
        &mut self,
        wanted: &[(Pin, Entity)],
        transforms: &TransformHelper,
    ) -> Result<(), ClothError> {
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
            let from_world = target(each, transforms)?.inverse();
            Pins::new([each.0.clone()]).for_each(&grid, |index| {
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
        Ok(())
    }
}
