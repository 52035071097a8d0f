//! A collider on its way through a tick.

use bevy::math::{Isometry3d, Quat, Vec3, bounding::BoundingSphere};

use super::{BodyMass, ColliderShape, nearest::Nearest};
use crate::{
    hierarchy::{Core, Probe},
    solver::SubStep,
};

/// A collider on its way through a tick, in the cloth's frame: along a straight line, turning evenly.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingCollider {
    /// What it is.
    pub shape: ColliderShape,
    /// Where it is as the tick begins (m).
    pub from: Isometry3d,
    /// Where its origin is as the tick ends (m).
    pub to: Vec3,
    /// How far it turns in the tick: axis × angle (rad).
    pub turn: Vec3,
    /// How it gives way where cloth pushes it; `None` if nothing can move it.
    pub body: Option<BodyMass>,
}

impl MovingCollider {
    /// A ball that moves from one centre to another (m) and does not turn.
    pub fn ball(radius: f32, from: Vec3, to: Vec3) -> Self {
        Self {
            shape: ColliderShape::Ball { radius },
            from: Isometry3d::from_translation(from),
            to,
            turn: Vec3::ZERO,
            body: None,
        }
    }

    /// Something that stays where it is.
    pub fn still(shape: ColliderShape, pose: Isometry3d) -> Self {
        Self {
            shape,
            from: pose,
            to: pose.translation.into(),
            turn: Vec3::ZERO,
            body: None,
        }
    }

    /// Where it is when a fraction of the tick, from 0 to 1, has passed.
    pub fn pose_at(&self, fraction: f32) -> Isometry3d {
        let place = self.start().lerp(self.to, fraction);
        let rotation = if self.turn == Vec3::ZERO {
            self.from.rotation
        } else {
            Quat::from_scaled_axis(self.turn * fraction) * self.from.rotation
        };
        Isometry3d::new(place, rotation)
    }

    fn start(&self) -> Vec3 {
        self.from.translation.into()
    }

    /// How far its origin moves in the tick (m).
    pub fn travel(&self) -> f32 {
        self.start().distance(self.to)
    }

    /// How far its surface moves at most, by travel and turn: how far it can drag what sticks to it (m). Of a
    /// half-space that turns, no farther than `within` of its origin.
    pub fn max_surface_travel(&self, within: f32) -> f32 {
        let turn = self.turn.length();
        let swing = if turn > 0.0 {
            turn * self.shape.extent().min(within)
        } else {
            0.0
        };
        self.travel() + swing
    }

    /// How far its turn alone moves any point of its core in the tick (m): nothing in a ball.
    pub(super) fn swing(&self) -> f32 {
        let turn = self.turn.length();
        if turn > 0.0 {
            turn * self.shape.core_extent()
        } else {
            0.0
        }
    }

    /// What its motion from one part of the tick to a later one makes of a point that moves with it (m), and of a
    /// normal. A ball's normals do not turn with it: it is the same all around.
    pub(super) fn carry(&self, [from, to]: [f32; 2], point: Vec3, normal: Vec3) -> (Vec3, Vec3) {
        let (before, after) = (self.pose_at(from), self.pose_at(to));
        let rotation = match self.shape {
            ColliderShape::Ball { .. } => Quat::IDENTITY,
            _ => after.rotation * before.rotation.inverse(),
        };
        let offset = point - Vec3::from(before.translation);
        (
            Vec3::from(after.translation) + rotation * offset,
            rotation * normal,
        )
    }

    /// The collider all along its way, inflated by `margin` (m), as what a query searches for among particles of a
    /// radius (m) that are all inside of `cloth`. A ball's is its exact way, a capsule along it.
    ///
    /// Of other shapes it is the one half-way, inflated by how far any of its points ever is from there: half of the
    /// travel, and half of the turn's arc.
    pub fn probe(&self, margin: f32, particle_radius: f32, cloth: &BoundingSphere) -> Probe {
        let (core, radius) = match self.shape {
            ColliderShape::Ball { radius } if self.start() == self.to => {
                (Core::Point(self.to), radius)
            }
            ColliderShape::Ball { radius } => (Core::Segment([self.start(), self.to]), radius),
            ColliderShape::Capsule { .. }
            | ColliderShape::Cuboid { .. }
            | ColliderShape::HalfSpace
            | ColliderShape::Geometry(_) => {
                let pose = self.pose_at(0.5);
                let (core, radius) = self.shape.core(pose);
                // Particles may leave the sphere as far as the margin.
                (
                    core,
                    radius + self.max_surface_travel(self.farthest_distance(cloth) + margin) / 2.0,
                )
            }
        };
        Probe {
            core,
            radius: radius + margin,
            particle_radius,
        }
    }

    /// How far the far end of a cloth is from the origin, at most (m).
    pub fn farthest_distance(&self, cloth: &BoundingSphere) -> f32 {
        let distance = |place: Vec3| place.distance(cloth.center.into());
        distance(self.start()).max(distance(self.to)) + cloth.radius()
    }

    /// Its motion in one sub-step, seen from a point (m): that of the surface there.
    pub(super) fn surface_motion(&self, substep: SubStep, centre: Vec3, point: Vec3) -> Vec3 {
        let count = substep.count as f32;
        (self.to - self.start()) / count + (self.turn / count).cross(point - centre)
    }

    /// How a point lies to it when a part of the tick has passed.
    #[inline]
    pub(super) fn nearest(&self, part: f32, point: Vec3) -> Nearest {
        self.shape.nearest(self.pose_at(part), point)
    }
}
