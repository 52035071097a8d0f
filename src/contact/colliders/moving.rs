//! Colliders in motion.

use bevy::math::{Isometry3d, Quat, Vec3, bounding::BoundingSphere};

use super::{mass::BodyMass, nearest::Nearest, shape::ColliderShape};
use crate::{
    hierarchy::{Core, Probe},
    solver::SubStep,
};

/// A collider during a tick, in the cloth's frame. It moves along a straight line and turns uniformly.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingCollider {
    /// Its shape.
    pub shape: ColliderShape,
    /// Its pose at the beginning of the tick (m).
    pub from: Isometry3d,
    /// Position of its origin at the end of the tick (m).
    pub to: Vec3,
    /// Its rotation in the tick: axis × angle (rad).
    pub turn: Vec3,
    /// Its mass, if cloth can push it; `None` if nothing can move it.
    pub body: Option<BodyMass>,
}

/// Largest displacement of a point within an extent (m) by a turn (rad): 0 without one, even if the extent is infinite.
pub(crate) fn swing(turn: f32, extent: f32) -> f32 {
    if turn > 0.0 { turn * extent } else { 0.0 }
}

/// The collider with an ID.
pub(crate) fn moving_of(
    colliders: &[(usize, MovingCollider)],
    id: usize,
) -> Option<&MovingCollider> {
    let known = colliders.iter().find(|(known, _)| *known == id);
    known.map(|(_, moving)| moving)
}

impl MovingCollider {
    /// A ball that moves from one centre to another (m) without rotation.
    pub fn ball(radius: f32, from: Vec3, to: Vec3) -> Self {
        let pose = Isometry3d::from_translation(from);
        Self {
            to,
            ..Self::still(ColliderShape::Ball { radius }, pose)
        }
    }

    /// A static collider.
    pub fn still(shape: ColliderShape, pose: Isometry3d) -> Self {
        Self {
            shape,
            from: pose,
            to: pose.translation.into(),
            turn: Vec3::ZERO,
            body: None,
        }
    }

    /// Its pose at a fraction of the tick, from 0 to 1.
    pub fn pose_at(&self, fraction: f32) -> Isometry3d {
        let place = self.start().lerp(self.to, fraction);
        let rotation = if self.turn == Vec3::ZERO {
            self.from.rotation
        } else {
            Quat::from_scaled_axis(self.turn * fraction) * self.from.rotation
        };
        Isometry3d::new(place, rotation)
    }

    /// Whether it is a body that has come to rest.
    pub(crate) fn is_settled(&self) -> bool {
        self.body.is_some_and(|body| body.is_settled)
    }

    fn start(&self) -> Vec3 {
        self.from.translation.into()
    }

    /// Displacement of its origin in the tick (m).
    pub fn travel(&self) -> f32 {
        self.start().distance(self.to)
    }

    /// Largest displacement of its surface in the tick by translation, rotation and deformation (m): cloth that sticks to it is
    /// dragged that far. For a rotating half-space, only points within `within` of its origin count (m).
    pub fn max_surface_travel(&self, within: f32) -> f32 {
        let extent = self.shape.extent().min(within);
        self.travel() + swing(self.turn.length(), extent) + self.shape.deformation()
    }

    /// Largest displacement of any point of its core by rotation alone in the tick (m): 0 for a ball.
    pub(crate) fn swing(&self) -> f32 {
        swing(self.turn.length(), self.shape.core_extent())
    }

    /// Carries a point (m) and a normal along with its motion between two fractions of the tick. A ball does not turn
    /// normals: it is the same from all sides.
    pub(crate) fn carry(&self, [from, to]: [f32; 2], point: Vec3, normal: Vec3) -> (Vec3, Vec3) {
        let (before, after) = (self.pose_at(from), self.pose_at(to));
        let rotation = match self.shape {
            ColliderShape::Ball { .. } => Quat::IDENTITY,
            _ => after.rotation * before.rotation.inverse(),
        };
        let mut offset = point - Vec3::from(before.translation);
        if let ColliderShape::Deforming(mesh) = &self.shape {
            let displacement = mesh.displacement_at(from, before.rotation.inverse() * offset);
            offset += before.rotation * displacement * (to - from);
        }
        let carried = Vec3::from(after.translation) + rotation * offset;
        (carried, rotation * normal)
    }

    /// A probe of the collider along its whole path, inflated by `margin` (m), for a search among particles of a radius
    /// (m) that are all inside `cloth`. For a ball it is the exact path, a capsule.
    ///
    /// For other shapes it is the shape halfway, inflated by the largest distance of any of its points from there: half
    /// of the translation, and half of the rotation's arc.
    pub fn probe(&self, margin: f32, particle_radius: f32, cloth: &BoundingSphere) -> Probe {
        let (core, radius) = match self.shape {
            ColliderShape::Ball { radius } if self.start() == self.to => {
                (Core::Point(self.to), radius)
            }
            ColliderShape::Ball { radius } => (Core::Segment([self.start(), self.to]), radius),
            _ => {
                let pose = self.pose_at(0.5);
                let (core, radius) = self.shape.core(pose);
                // Particles may leave the sphere by the margin. The core of a mesh that deforms is around all of that.
                let travel = self.max_surface_travel(self.farthest_distance(cloth) + margin);
                (core, radius + (travel - self.shape.deformation()) / 2.0)
            }
        };
        Probe {
            core,
            radius: radius + margin,
            particle_radius,
        }
    }

    /// Largest distance of the cloth's far end from the origin (m).
    pub fn farthest_distance(&self, cloth: &BoundingSphere) -> f32 {
        let distance = |place: Vec3| place.distance(cloth.center.into());
        distance(self.start()).max(distance(self.to)) + cloth.radius()
    }

    /// Its motion in a sub-step.
    pub(crate) fn in_substep(&self, substep: SubStep) -> ColliderSubstep<'_> {
        let (count, pose) = (substep.count as f32, self.pose_at(substep.end()));
        ColliderSubstep {
            collider: self,
            substep,
            pose,
            origin: pose.translation.into(),
            slide: (self.to - self.start()) / count,
            turn: self.turn / count,
            swing: self.swing() / count,
            deformation: self.shape.deformation() / count,
        }
    }

    /// The surface nearest to a point at a fraction of the tick.
    #[inline]
    pub(crate) fn nearest(&self, part: f32, point: Vec3) -> Nearest {
        let pose = self.pose_at(part);
        match &self.shape {
            ColliderShape::Deforming(mesh) => {
                let nearest = mesh.nearest(part, pose.inverse() * point);
                nearest.turned(pose.rotation)
            }
            shape => shape.nearest(pose, point),
        }
    }
}

/// A collider's motion in a sub-step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColliderSubstep<'a> {
    pub collider: &'a MovingCollider,
    pub substep: SubStep,
    /// Its pose at the end, and its origin then (m).
    pub pose: Isometry3d,
    pub origin: Vec3,
    /// Its displacement (m) and rotation (rad).
    pub slide: Vec3,
    pub turn: Vec3,
    /// Largest displacement of any point of its core by rotation alone, and of its surface by deformation (m).
    pub swing: f32,
    pub deformation: f32,
}

impl ColliderSubstep<'_> {
    /// Displacement of its surface at a point (m).
    pub fn surface_motion(&self, point: Vec3) -> Vec3 {
        let rigid = self.slide + self.turn.cross(point - self.origin);
        match &self.collider.shape {
            ColliderShape::Deforming(mesh) => {
                let local = self.pose.inverse() * point;
                let displacement = mesh.displacement_at(self.substep.end(), local);
                rigid + self.pose.rotation * displacement / self.substep.count as f32
            }
            _ => rigid,
        }
    }

    /// The surface nearest to a point at the end.
    #[inline]
    pub fn nearest(&self, point: Vec3) -> Nearest {
        match &self.collider.shape {
            ColliderShape::Deforming(_) => self.collider.nearest(self.substep.end(), point),
            shape => shape.nearest(self.pose, point),
        }
    }

    /// The largest change of its distance from something that moves by these displacements (m).
    #[inline]
    pub fn speed<const N: usize>(&self, displacements: [Vec3; N]) -> f32 {
        let each = displacements.iter();
        let squares = each.map(|displacement| (*displacement - self.slide).length_squared());
        squares.fold(0.0, f32::max).sqrt() + self.swing + self.deformation
    }

    /// Largest displacement of its surface (m).
    pub fn travel(&self) -> f32 {
        self.slide.length() + self.swing + self.deformation
    }

    /// The fraction of the tick at a fraction of the sub-step.
    pub fn passed(&self, part: f32) -> f32 {
        (self.substep.index as f32 + part) / self.substep.count as f32
    }

    /// Its pose at a fraction of the sub-step.
    pub fn pose_at(&self, part: f32) -> Isometry3d {
        self.collider.pose_at(self.passed(part))
    }

    /// Carries a point (m) and a normal along with it from a fraction of the sub-step to the end.
    pub fn carry(&self, part: f32, point: Vec3, normal: Vec3) -> (Vec3, Vec3) {
        let parts = [self.passed(part), self.substep.end()];
        self.collider.carry(parts, point, normal)
    }
}
