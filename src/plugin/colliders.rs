//! How colliders move from tick to tick.

use bevy::{
    ecs::{
        component::Component,
        entity::Entity,
        system::{Commands, Query, Res},
    },
    math::{Isometry3d, Vec3},
    time::Time,
    transform::helper::TransformHelper,
};

use super::{ClothFault, ClothFrame, fault::Part, frame::global_transform};
use crate::{
    cloth::ClothError,
    contact::{ClothCollider, MovingBall},
};

/// A collider's way through the tick, in the world.
#[derive(Component, Debug, Default)]
pub(super) struct ColliderMotion {
    /// From where to where; `None` before the first tick.
    way: Option<(Isometry3d, Isometry3d)>,
    /// Where the last tick with time in it left it.
    last: Option<Isometry3d>,
    radius: f32,
}

impl ColliderMotion {
    fn follow(
        &mut self,
        collider: &ClothCollider,
        transforms: &TransformHelper,
        entity: Entity,
        time_passes: bool,
    ) -> Result<(), ClothError> {
        let transform = global_transform(transforms, entity)?;
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let radius = collider.scaled_radius(scale)?;
        if !(translation.is_finite() && rotation.is_finite()) {
            return Err(ClothError::Transform {
                transform: format!("{transform:?}"),
            });
        }
        let pose = Isometry3d::new(translation, rotation.normalize());
        let from = self.last.unwrap_or(pose);
        self.way = Some((from, pose));
        // What is moved while no time passes has its way still before it.
        self.last = Some(if time_passes { pose } else { from });
        self.radius = radius;
        Ok(())
    }

    /// The collider's way through the tick in a cloth's frame.
    pub fn seen_from(&self, frame: &ClothFrame) -> Option<MovingBall> {
        let (from, to) = self.way?;
        let inverse = frame.isometry().inverse();
        let turned = to.rotation * from.rotation.inverse();
        // Of the two quaternions of a rotation, the one of the shorter way round.
        let turned = if turned.w < 0.0 { -turned } else { turned };
        Some(MovingBall {
            from: inverse * Vec3::from(from.translation),
            to: inverse * Vec3::from(to.translation),
            turn: inverse.rotation * turned.to_scaled_axis(),
            radius: self.radius,
        })
    }
}

/// Reads every collider's transform.
pub(super) fn prepare_colliders(
    mut colliders: Query<(
        Entity,
        &ClothCollider,
        &mut ColliderMotion,
        Option<&ClothFault>,
    )>,
    transforms: TransformHelper,
    time: Res<Time>,
    mut commands: Commands,
) {
    let time_passes = time.delta_secs() > 0.0;
    for (entity, collider, mut motion, fault) in &mut colliders {
        let outcome = motion.follow(collider, &transforms, entity, time_passes);
        if outcome.is_err() {
            *motion = ColliderMotion::default();
        }
        ClothFault::report(&mut commands, entity, fault, Part::Collider, outcome);
    }
}
