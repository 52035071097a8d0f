//! How colliders move from tick to tick.

use bevy::{
    math::Affine3A,
    prelude::{Component, Entity, Isometry3d, Quat, Vec3, Vec3A},
};

use super::{
    built::BuiltShape,
    skinned::SkinnedMotion,
    stay::Stay,
    tree::{Bounds, ROUNDING},
};
use crate::{
    cloth::{ClothError, FARTHEST},
    contact::{BodyChange, BodyMass, ClothCollider, ColliderShape, MovingCollider},
    plugin::{
        authoring::{Carried, ClothBody},
        frame::{ClothFrame, Places, Shift, unusable},
        prepare::source::ColliderMeshes,
    },
};

/// A collider's path through the tick, in the world.
#[derive(Component, Debug, Default)]
pub(crate) struct ColliderMotion {
    /// Its path; `None` before the first tick.
    moving: Option<MovingCollider>,
    /// Place of its entity, or of its skinned mesh, after the last tick in which time passed. The frame of the shape may be another.
    last: Option<Isometry3d>,
    /// The same, a tick earlier.
    before: Option<Isometry3d>,
    /// Its joints, if it is a skinned mesh. Then the frame is not that of the entity.
    skinned: SkinnedMotion,
    /// How long it has been where it is, if it is a body.
    stay: Stay,
    /// Middle of its path (m), and the largest distance from there to any of the collider's points on it.
    middle: Vec3,
    reach: f32,
    /// Normal of a half-space that does not rotate: cloth far above it is not near.
    normal: Option<Vec3>,
    /// Its bounds along the whole path.
    pub(super) bounds: Bounds,
    /// How many cloths pushed it in the last tick, if it is a body.
    cloths: u32,
    /// Its shape.
    built: Option<BuiltShape>,
}

/// The inputs of a collider's next path, besides its place then.
#[derive(Debug, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ColliderMemory {
    last: Option<Isometry3d>,
    joints: Vec<Affine3A>,
    cloths: u32,
    stay: Stay,
}

impl ColliderMotion {
    /// Reads the current place of its entity, or of its joints, and its shape.
    ///
    /// # Errors
    /// The error of the collider, or of its transform.
    fn place(
        &mut self,
        collider: &ClothCollider,
        places: &Places,
        meshes: &mut ColliderMeshes,
        entity: Entity,
    ) -> Result<Isometry3d, ClothError> {
        let was_skinned = self.is_skinned();
        let built = self.built.take();
        if let Some(pose) = (self.skinned).follow(collider, places, meshes, entity)? {
            // Its frame is another than that of a rigid one, or of other joints.
            if built.is_some() && !was_skinned || pose.begins {
                self.last = None;
            }
            let place = pose.place;
            self.built = Some(BuiltShape::skinned(collider, pose)?);
            return Ok(place);
        }
        if was_skinned {
            self.last = None;
        }
        let transform = places.of(entity)?;
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        self.built = Some(BuiltShape::rigid(built, collider, meshes, entity, scale)?);
        let is_far = translation.abs().max_element() > FARTHEST;
        if is_far || !(translation.is_finite() && rotation.is_finite()) {
            return Err(unusable(transform.affine()));
        }
        Ok(Isometry3d::new(translation, rotation.normalize()))
    }

    /// Reads the current place of its entity, and the path from there.
    ///
    /// # Errors
    /// The error of the collider, or of its transform.
    pub fn follow(
        &mut self,
        collider: &ClothCollider,
        body: Option<&ClothBody>,
        places: &Places,
        meshes: &mut ColliderMeshes,
        entity: Entity,
        time_passes: bool,
    ) -> Result<(), ClothError> {
        let place = self.place(collider, places, meshes, entity)?;
        let is_skinned = self.is_skinned();
        let Some(BuiltShape { shape, offset, .. }) = &self.built else {
            return Ok(());
        };
        let last = self.last.unwrap_or(place);
        let (from, pose) = (last * *offset, place * *offset);
        let translation = Vec3::from(pose.translation);
        let moving = MovingCollider {
            shape: shape.clone(),
            from,
            to: translation,
            turn: turn(from.rotation, pose.rotation),
            // Cloth does not move joints.
            body: match body.filter(|_| !is_skinned) {
                Some(body) => {
                    // As the tick begins, and seen from where the shape's origin is, which need not be the entity's.
                    let mass = body.mass_at(last.rotation)?.part_of(self.cloths);
                    let origin = last.rotation * Vec3::from(offset.translation);
                    Some(BodyMass {
                        centre: mass.centre - origin,
                        is_settled: self.stay.is_long() && self.cloths() == 1,
                        ..mass
                    })
                }
                None => None,
            },
        };
        self.middle = translation.midpoint(from.translation.into());
        self.reach = moving.travel() / 2.0 + shape.extent();
        self.normal = None;
        if *shape == ColliderShape::HalfSpace && moving.turn == Vec3::ZERO {
            self.reach = moving.travel() / 2.0;
            self.normal = Some(pose.rotation * Vec3::Y);
        }
        self.bounds = self.bounds(&moving);
        self.moving = Some(moving);
        // If it is moved while no time passes, the motion counts in the next tick with time.
        self.last = Some(if time_passes { place } else { last });
        self.before = Some(last);
        if time_passes {
            self.skinned.pass();
        }
        Ok(())
    }

    /// Its bounds along the whole path: two boxes if it does not rotate, else its bounding ball.
    fn bounds(&self, moving: &MovingCollider) -> Bounds {
        if self.normal.is_some() || self.reach.is_infinite() {
            return Bounds::Unbounded;
        }
        if moving.turn != Vec3::ZERO {
            return Bounds::around([self.middle; 2], self.reach);
        }
        let [from, to] = [0.0, 1.0].map(|part| {
            let (core, radius) = moving.shape.core(moving.pose_at(part));
            Bounds::of_core(&core, radius)
        });
        from.union(to)
    }

    /// Whether the next tick has another path, even if nothing moves the collider.
    pub fn is_moving(&self) -> bool {
        self.moving
            .as_ref()
            .is_some_and(|moving| moving.max_surface_travel(f32::INFINITY) > 0.0)
    }

    /// Whether cloth pushes it.
    pub fn is_body(&self) -> bool {
        self.moving
            .as_ref()
            .is_some_and(|moving| moving.body.is_some())
    }

    /// Number of cloths that are expected to push it: each has a part of its mass.
    pub fn cloths(&self) -> u32 {
        self.cloths.max(1)
    }

    /// Sets the number of cloths that pushed it in the tick.
    pub fn set_cloths(&mut self, cloths: u32) {
        self.cloths = cloths;
    }

    /// Applies a change of its motion by cloth: its next path begins where it is now. Returns the translation (m) and
    /// rotation of its entity.
    pub fn pushed(&mut self, change: &BodyChange, body: &ClothBody) -> (Vec3, Quat) {
        let (Some(last), Some(built)) = (&mut self.last, &self.built) else {
            return (Vec3::ZERO, Quat::IDENTITY);
        };
        let turned = Quat::from_scaled_axis(change.rotation);
        // How far the end of an arm goes as it is turned.
        let swing = |arm: Vec3| turned * arm - arm;
        let centre = last.rotation * body.centre_of_mass;
        let origin = last.rotation * Vec3::from(built.offset.translation);
        // From the shape's origin to the centre of mass, which may be locked, and on to the entity's origin.
        let gone = body.free_translation(change.translation + swing(centre - origin));
        let gone = gone - swing(centre);
        last.translation += Vec3A::from(gone);
        last.rotation = (turned * last.rotation).normalize();
        (gone, turned)
    }

    /// Puts it back to where it was before the tick, if it has moved. Returns the displacement of its centre of mass (m) and the rotation
    /// by that (rad), and the place of its entity.
    pub fn put_back(&mut self) -> Option<([Vec3; 2], Isometry3d)> {
        let (moving, before) = (self.moving.as_ref()?, self.before?);
        let start = Vec3::from(moving.from.translation);
        let rounding = 4.0 * f32::EPSILON * (start.length() + moving.shape.extent());
        if moving.max_surface_travel(f32::INFINITY) <= rounding {
            return None;
        }
        let centre = moving.body?.centre;
        let swing = Quat::from_scaled_axis(moving.turn) * centre - centre;
        let gone = moving.to - start + swing;
        self.last = Some(before);
        Some(([-gone, -moving.turn], before))
    }

    /// Notes where it is after a tick of this length (s).
    pub fn note_stay(&mut self, seconds: f32) {
        if let (Some(last), Some(built)) = (self.last, &self.built) {
            let (place, extent) = (last * built.offset, built.shape.extent());
            self.stay.note(place, extent, seconds);
        }
    }

    /// Takes it as one that has just moved.
    pub fn unsettle(&mut self) {
        self.stay = Stay::default();
    }

    /// Writes the inputs of its next path to a snapshot.
    pub fn remember(&self, memory: &mut ColliderMemory) {
        (memory.last, memory.cloths, memory.stay) = (self.last, self.cloths, self.stay);
        memory.joints.clone_from(&self.skinned.last);
    }

    /// Restores the inputs of its next path, from a snapshot.
    pub fn recall(&mut self, memory: &ColliderMemory) {
        (self.last, self.cloths, self.stay) = (memory.last, memory.cloths, memory.stay);
        self.skinned.last.clone_from(&memory.joints);
    }

    /// Whether it follows joints.
    fn is_skinned(&self) -> bool {
        self.built.as_ref().is_some_and(BuiltShape::is_skinned)
    }

    /// Shifts it with the world's origin; its entity is at `now`, and its joints are there, if it has any.
    pub fn shift(&mut self, shift: Shift, now: Option<Isometry3d>, joints: &mut [Affine3A]) {
        let now = match self.is_skinned() {
            true => self.skinned.shift(shift, joints),
            false => now,
        };
        self.last = self.last.map(|last| shift.rigid(last, now));
        self.stay = self.stay.shifted(shift);
    }

    /// Forgets its motion: wherever it is read next, its path begins there.
    pub fn stop(&mut self) {
        self.unsettle();
        self.last = None;
        self.skinned.stop();
    }

    /// Whether the collider may come within `reach` of a point of the world (m).
    pub fn comes_near(&self, point: Vec3, reach: f32) -> bool {
        let offset = point - self.middle;
        if let Some(normal) = self.normal {
            return normal.dot(offset) <= self.reach + reach + offset.length() * ROUNDING;
        }
        let is_in_ball = offset.length_squared() <= (self.reach + reach) * (self.reach + reach);
        let is_at_box = match self.bounds {
            Bounds::Absent => false,
            Bounds::Unbounded => true,
            Bounds::Box([low, high]) => {
                let offset = point - point.max(low).min(high);
                offset.length_squared() <= reach * reach
            }
        };
        is_at_box && is_in_ball
    }

    /// The collider's path through the tick in a cloth's frame.
    pub fn seen_from(
        &self,
        frame: &ClothFrame,
        carried: Option<&Carried>,
    ) -> Option<MovingCollider> {
        let moving = self.moving.as_ref()?;
        let inverse = frame.isometry().inverse();
        Some(MovingCollider {
            shape: moving.shape.clone(),
            from: inverse * moving.from,
            to: inverse * moving.to,
            turn: inverse.rotation * moving.turn,
            body: moving.body.map(|body| body.turned(inverse.rotation)),
        })
        .map(|seen| match carried {
            Some(carried) => carried_along(seen, carried.seen_from(frame, moving.from)),
            None => seen,
        })
    }
}

/// A path that begins elsewhere: to a cloth that is carried along, a collider moves the opposite way.
fn carried_along(moving: MovingCollider, from: Isometry3d) -> MovingCollider {
    let end = Quat::from_scaled_axis(moving.turn) * moving.from.rotation;
    MovingCollider {
        from,
        turn: turn(from.rotation, end),
        ..moving
    }
}

/// The rotation vector (rad) from one rotation to another.
fn turn(from: Quat, to: Quat) -> Vec3 {
    let turned = to * from.inverse();
    // Of the two quaternions of a rotation, the one of the shorter way round.
    let turned = if turned.w < 0.0 { -turned } else { turned };
    turned.to_scaled_axis()
}

#[cfg(test)]
mod tests;
