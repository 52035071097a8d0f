//! How colliders move from tick to tick.

use bevy::{
    ecs::{
        component::Component,
        entity::Entity,
        system::{Commands, Query},
    },
    math::{Isometry3d, Vec3},
    transform::helper::TransformHelper,
};

use super::{ClothFault, ClothFrame};
use crate::{
    cloth::ClothError,
    contact::{ClothCollider, MovingBall},
};

/// Where a collider was a tick ago and where it is now, in the world.
#[derive(Component, Debug, Default)]
pub(super) struct ColliderMotion {
    /// `None` before the first tick.
    poses: Option<(Isometry3d, Isometry3d)>,
    radius: f32,
}

impl ColliderMotion {
    fn follow(&mut self, collider: &ClothCollider, transforms: &TransformHelper, entity: Entity) -> Result<(), ClothError> {
        let transform = transforms
            .compute_global_transform(entity)
            .map_err(|error| ClothError::Transform { transform: error.to_string() })?;
        // Two of a flat collider's axes still make a ball: only what is not finite is refused here.
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let radius = collider.scaled_radius(scale)?;
        if !(translation.is_finite() && rotation.is_finite()) {
            return Err(ClothError::Transform { transform: format!("{transform:?}") });
        }
        let pose = Isometry3d::new(translation, rotation);
        let last = self.poses.map_or(pose, |(_, last)| last);
        self.poses = Some((last, pose));
        self.radius = radius;
        Ok(())
    }

    /// The collider's way through the tick in a cloth's frame.
    pub fn seen_from(&self, frame: &ClothFrame) -> Option<MovingBall> {
        let (from, to) = self.poses?;
        let inverse = frame.isometry().inverse();
        let turn = (to.rotation * from.rotation.inverse()).to_scaled_axis();
        // The shorter way round.
        let turn = if turn.length() > std::f32::consts::PI {
            turn - turn.normalize() * std::f32::consts::TAU
        } else {
            turn
        };
        Some(MovingBall {
            from: inverse * Vec3::from(from.translation),
            to: inverse * Vec3::from(to.translation),
            turn: inverse.rotation * turn,
            radius: self.radius,
        })
    }
}

/// Reads every collider's transform.
pub(super) fn prepare_colliders(
    mut colliders: Query<(Entity, &ClothCollider, &mut ColliderMotion, Option<&ClothFault>)>,
    transforms: TransformHelper,
    mut commands: Commands,
) {
    for (entity, collider, mut motion, fault) in &mut colliders {
        let outcome = motion.follow(collider, &transforms, entity);
        if outcome.is_err() {
            *motion = ColliderMotion::default();
        }
        ClothFault::report(&mut commands, entity, fault, outcome);
    }
}
