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

use super::{
    ClothFault, ClothFrame,
    frame::global_transform,
    naming::Part,
    source::{ColliderMeshes, Source},
};
use crate::{
    cloth::ClothError,
    contact::{ClothCollider, ColliderShape, MovingCollider},
};

/// A collider's way through the tick, in the world.
#[derive(Component, Debug, Default)]
pub(super) struct ColliderMotion {
    /// Its way; `None` before the first tick.
    way: Option<MovingCollider>,
    /// Where the last tick with time in it left it.
    last: Option<Isometry3d>,
    /// Middle of its way (m), and how far it is from there at most to any of the collider's points on it.
    middle: Vec3,
    reach: f32,
    /// Of a half-space that does not turn, its normal: what is far above it is not near.
    normal: Option<Vec3>,
    /// The shape and what it was built from, as a mesh of many triangles is built but once.
    built: Option<BuiltShape>,
}

/// A shape, and the collider and scale that it is of.
#[derive(Debug)]
struct BuiltShape {
    collider: ClothCollider,
    source: Option<Source>,
    scale: Vec3,
    shape: ColliderShape,
    offset: Isometry3d,
}

impl BuiltShape {
    fn is_of(&self, collider: &ClothCollider, source: Option<Source>, scale: Vec3) -> bool {
        // A scale that is read out of a rotating transform changes by rounding.
        self.collider == *collider
            && self.source == source
            && self.scale.abs_diff_eq(scale, 1.0e-5 * scale.length())
    }
}

impl ColliderMotion {
    fn follow(
        &mut self,
        collider: &ClothCollider,
        transforms: &TransformHelper,
        meshes: &ColliderMeshes,
        entity: Entity,
        time_passes: bool,
    ) -> Result<(), ClothError> {
        let transform = global_transform(transforms, entity)?;
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let known = self.built.as_ref().and_then(|built| built.source);
        let source = meshes.find(entity, collider, known)?;
        let is_built = self
            .built
            .as_ref()
            .is_some_and(|built| built.is_of(collider, source, scale));
        if !is_built {
            self.built = None;
            let made = meshes.resolve(collider, source)?;
            self.built = Some(BuiltShape {
                shape: made.scaled(scale)?,
                offset: made.offset(),
                collider: collider.clone(),
                source,
                scale,
            });
        }
        let Some(BuiltShape { shape, offset, .. }) = &self.built else {
            return Ok(());
        };
        if !(translation.is_finite() && rotation.is_finite()) {
            return Err(ClothError::Transform {
                transform: format!("{transform:?}"),
            });
        }
        let pose = Isometry3d::new(translation, rotation.normalize()) * *offset;
        let translation = Vec3::from(pose.translation);
        let from = self.last.unwrap_or(pose);
        let turned = pose.rotation * from.rotation.inverse();
        // Of the two quaternions of a rotation, the one of the shorter way round.
        let turned = if turned.w < 0.0 { -turned } else { turned };
        let way = MovingCollider {
            shape: shape.clone(),
            from,
            to: translation,
            turn: turned.to_scaled_axis(),
        };
        self.middle = translation.midpoint(from.translation.into());
        self.reach = way.travel() / 2.0 + shape.extent();
        self.normal = None;
        if *shape == ColliderShape::HalfSpace && way.turn == Vec3::ZERO {
            self.reach = way.travel() / 2.0;
            self.normal = Some(pose.rotation * Vec3::Y);
        }
        self.way = Some(way);
        // What is moved while no time passes has its way still before it.
        self.last = Some(if time_passes { pose } else { from });
        Ok(())
    }

    /// The mesh asset that its shape is made of.
    #[cfg(feature = "mesh")]
    pub fn source(&self) -> Option<Source> {
        self.built.as_ref()?.source
    }

    /// Whether the collider may come within `reach` of a point of the world (m).
    pub fn comes_near(&self, point: Vec3, reach: f32) -> bool {
        let reach = self.reach + reach;
        let offset = point - self.middle;
        let is_near = match self.normal {
            Some(normal) => normal.dot(offset) <= reach + offset.length() * 1.0e-5,
            None => offset.length_squared() <= reach * reach,
        };
        self.way.is_some() && is_near
    }

    /// The collider's way through the tick in a cloth's frame.
    pub fn seen_from(&self, frame: &ClothFrame) -> Option<MovingCollider> {
        let way = self.way.as_ref()?;
        let inverse = frame.isometry().inverse();
        Some(MovingCollider {
            shape: way.shape.clone(),
            from: inverse * way.from,
            to: inverse * way.to,
            turn: inverse.rotation * way.turn,
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
    meshes: ColliderMeshes,
    time: Res<Time>,
    mut commands: Commands,
) {
    let time_passes = time.delta_secs() > 0.0;
    for (entity, collider, mut motion, fault) in &mut colliders {
        let outcome = motion.follow(collider, &transforms, &meshes, entity, time_passes);
        if outcome.is_err() {
            *motion = ColliderMotion::default();
        }
        // What is on its way is no fault.
        let outcome = match outcome {
            Err(ClothError::MeshLoading) => Ok(()),
            outcome => outcome,
        };
        ClothFault::report(&mut commands, entity, fault, Part::Collider, outcome);
    }
}
