//! Pins that follow other entities, and teleports.

use bevy::{
    ecs::{component::Component, entity::Entity, reflect::ReflectComponent},
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

impl PreparingItem<'_, '_> {
    /// Has attached particles move to where their targets take them in this tick.
    pub(super) fn follow_targets(
        &mut self,
        transforms: &TransformHelper,
        teleports: bool,
    ) -> Result<(), ClothError> {
        let wanted = self
            .attachments
            .map_or(&[][..], |attachments| &attachments.0);
        if wanted.is_empty() && self.tick.attachments.is_empty() {
            return Ok(());
        }
        let target = |(pin, target): &(Pin, Entity)| {
            let transform = global_transform(transforms, *target).ok();
            let affine = transform.map(|transform| transform.affine());
            affine
                .filter(|affine| affine.inverse().is_finite())
                .ok_or_else(|| ClothError::NoTarget {
                    pin: pin.clone(),
                    target: *target,
                })
        };
        for attachment in wanted {
            target(attachment)?;
        }
        if self.tick.attachments != wanted {
            self.attach(wanted, &target)?;
        }
        if let Some(first) = wanted.first() {
            let (_, rotation, translation) = target(first)?.to_scale_rotation_translation();
            let pose = Isometry3d::new(translation, rotation.normalize());
            if let Some(was) = self.tick.first_target.replace(pose)
                && teleports
            {
                self.jump(was, pose);
            }
        }
        let frame = *self.frame;
        for index in 0..self.tick.attached.len() {
            let attached = self.tick.attached[index];
            let affine = target(&wanted[attached.attachment])?;
            let to = frame.from_world(affine.transform_point3(attached.offset));
            let from = self.particles.position_at(attached.particle as usize);
            if teleports {
                self.particles.put(attached.particle as usize, to);
            } else if from != to
                || self
                    .tick
                    .pins
                    .iter()
                    .any(|pin| pin.particle == attached.particle)
            {
                // A later motion of the same particle is the one that counts.
                self.tick.pins.push(PinMotion {
                    particle: attached.particle,
                    from,
                    to,
                });
            }
        }
        Ok(())
    }

    /// Takes over other attachments.
    fn attach(
        &mut self,
        wanted: &[(Pin, Entity)],
        target: &dyn Fn(&(Pin, Entity)) -> Result<Affine3A, ClothError>,
    ) -> Result<(), ClothError> {
        let grid = self.topology.grid;
        let pins = crate::cloth::Pins::new(wanted.iter().map(|(pin, _)| pin.clone()));
        pins.validate(&grid)?;
        // Let go of what was attached; what the game pinned stays so.
        if let Some((_, material, pins)) = &self.topology.woven
            && !self.tick.attached.is_empty()
        {
            self.particles.weigh(&grid, material, pins)?;
        }
        self.tick.attached.clear();
        for (attachment, each) in wanted.iter().enumerate() {
            let from_world = target(each)?.inverse();
            crate::cloth::Pins::new([each.0.clone()]).for_each(&grid, |index| {
                let position = self.frame.to_world(self.particles.position_at(index));
                self.tick.attached.push(Attached {
                    particle: index as u32,
                    attachment,
                    offset: from_world.transform_point3(position),
                });
            });
        }
        for attached in &self.tick.attached {
            self.particles.pin(attached.particle as usize);
        }
        self.tick.attachments = wanted.to_vec();
        self.tick.first_target = None;
        self.tick.tethered = None;
        self.tick.rest.disturb();
        Ok(())
    }

    /// Moves all particles as one body, in the world, from one pose of something to another.
    fn jump(&mut self, from: Isometry3d, to: Isometry3d) {
        let frame: ClothFrame = *self.frame;
        let jump = frame.isometry().inverse() * to * from.inverse() * frame.isometry();
        self.particles.transform(jump);
    }
}
