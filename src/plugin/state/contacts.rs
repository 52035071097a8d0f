//! Contacts of cloths with colliders, and the messages about them.

use bevy::{
    ecs::{entity::MapEntities, reflect::ReflectMapEntities},
    prelude::{Component, Entity, Message, Quat, Reflect, ReflectComponent, ReflectDefault, Vec3},
};

use crate::contact::{ContactPoint, Detection, MovingCollider, NarrowPhase};

/// A collider that a cloth touches.
#[derive(Reflect, MapEntities, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothContact {
    /// The collider's entity.
    #[entities]
    pub collider: Entity,
    /// Number of particles that it pushed in the last tick.
    pub particles: usize,
    /// Penetration of the deepest of them (m), before it was pushed out.
    pub deepest_penetration: f32,
    /// Area of the cloth inside the collider at the end of a sub-step (m²), the largest of the tick.
    pub area: f32,
    /// ∫ depth dA over that area (m³), the largest of the tick. For a shallow contact it is the volume that the cloth
    /// cuts off from the collider.
    pub volume: f32,
    /// Impulse that the cloth gave to the collider in the last tick, in the world (N·s): the sum of its pushes, as far
    /// as they carry momentum. Divided by the length of the tick (s), it is the mean force (N).
    pub impulse: Vec3,
    /// Angular impulse of these pushes about the origin of the collider's shape, in the world (N·m·s). It is the
    /// entity's origin, except for shapes with an offset from their entity.
    pub angular_impulse: Vec3,
    /// Whether the collider was tested against particles or triangles: `Triangles` if against any.
    pub narrow_phase: NarrowPhase,
    /// Whether the cloth began inside of it, and is let out on one side or left alone:
    /// [`ClothLimit::Embedded`](crate::solver::ClothLimit::Embedded).
    pub is_embedded: bool,
    /// The range of its points.
    points: [usize; 2],
}

/// The colliders that a cloth touched in the last tick in which it moved. They stay while the cloth sleeps, and while
/// no time passes.
#[derive(Component, Reflect, MapEntities, Debug, Default, Clone)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, MapEntities, Default, Debug, Clone)]
#[component(clone_behavior = Ignore)]
pub struct ClothContacts {
    #[entities]
    pub(crate) now: Vec<ClothContact>,
    points: Vec<ContactPoint>,
    /// Those of the tick before, while they are renewed.
    #[cfg_attr(feature = "serialize", serde(skip))]
    #[entities]
    #[reflect(ignore)]
    before: Vec<ClothContact>,
    #[cfg_attr(feature = "serialize", serde(skip))]
    #[reflect(ignore)]
    points_before: Vec<ContactPoint>,
    /// Those reported, each with the largest number of particles and the deepest penetration since the touch began.
    #[entities]
    pub(crate) reported: Vec<ClothContact>,
}

impl ClothContacts {
    /// All colliders touched.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &ClothContact> {
        self.now.iter()
    }

    /// The contact with one collider, if it touches.
    pub fn with(&self, collider: Entity) -> Option<&ClothContact> {
        self.now.iter().find(|contact| contact.collider == collider)
    }

    /// Whether these contacts, read from a file, can belong to a cloth with that number of particles.
    pub(crate) fn is_valid_for(&self, particles: usize) -> bool {
        (self.points.iter()).all(|point| (point.particle as usize) < particles)
    }

    /// The particles near a touching collider, each with its signed depth.
    pub fn points(&self, contact: &ClothContact) -> &[ContactPoint] {
        let [first, end] = contact.points;
        self.points.get(first..end).unwrap_or_default()
    }

    /// Forgets all contacts: a cloth that is frozen touches nothing.
    pub(crate) fn clear(&mut self) {
        self.now.clear();
        self.points.clear();
    }

    /// Takes the contacts of a new tick, found in a frame that is turned by `rotation`; those of no particle are none. Particles that
    /// sleep keep theirs, and a collider that only such particles touch has all numbers of its last contact.
    pub(crate) fn renew(
        &mut self,
        near: &[(Entity, MovingCollider)],
        detection: &Detection,
        rotation: Quat,
        sleeps: impl Fn(u32) -> bool,
    ) {
        std::mem::swap(&mut self.now, &mut self.before);
        std::mem::swap(&mut self.points, &mut self.points_before);
        self.now.clear();
        self.points.clear();
        for touch in detection.touches() {
            let first = self.points.len();
            let points = detection.points(touch).map(|point| ContactPoint {
                depth: point.depth.min(f32::MAX),
                ..point
            });
            (self.points).extend(points.filter(|point| !sleeps(point.particle)));
            let collider = near[touch.id].0;
            let mut before = self.before.iter();
            let before = before.find(|before| before.collider == collider);
            let known = before.and_then(|before| {
                let [first, end] = before.points;
                self.points_before.get(first..end)
            });
            let known = known.unwrap_or_default();
            let sleeping = known.iter().filter(|point| sleeps(point.particle));
            self.points.extend(sleeping.copied());
            if let Some(before) = before.filter(|_| self.points[first..].len() == known.len())
                && known.iter().all(|point| sleeps(point.particle))
            {
                // Nothing else touches it.
                let points = [first, self.points.len()];
                self.now.push(ClothContact { points, ..*before });
                continue;
            }
            let depths = self.points[first..].iter().map(|point| point.depth);
            let particles = depths.clone().filter(|depth| *depth > 0.0).count();
            let deepest = depths.fold(touch.deepest, f32::max);
            if particles == 0 {
                self.points.truncate(first);
                continue;
            }
            self.now.push(ClothContact {
                collider,
                particles,
                // Beyond what a float can hold: the largest.
                deepest_penetration: deepest.min(f32::MAX),
                area: touch.area.min(f32::MAX),
                volume: touch.volume.min(f32::MAX),
                impulse: finite(rotation * touch.impulse),
                angular_impulse: finite(rotation * touch.angular_impulse),
                narrow_phase: touch.narrow_phase,
                is_embedded: detection.is_embedded(touch.id),
                points: [first, self.points.len()],
            });
        }
        self.before.clear();
        self.points_before.clear();
    }
}

/// Zero in place of an impulse that a float can't hold, from particles that are lost.
fn finite(value: Vec3) -> Vec3 {
    if value.is_finite() { value } else { Vec3::ZERO }
}

/// Sent when a cloth and a collider begin to touch.
#[derive(Message, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[non_exhaustive]
pub struct ClothTouchStarted {
    /// The cloth's entity.
    pub cloth: Entity,
    /// The collider's entity.
    pub collider: Entity,
    /// Number of particles that touched in this tick.
    pub particles: usize,
    /// Deepest penetration in this tick (m).
    pub deepest_penetration: f32,
}

/// Sent when a cloth and a collider no longer touch, or when one of them is gone: the entities may no longer exist.
#[derive(Message, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[non_exhaustive]
pub struct ClothTouchStopped {
    /// The cloth's entity.
    pub cloth: Entity,
    /// The collider's entity.
    pub collider: Entity,
    /// Largest number of particles that touched in one tick, from the start of the contact to its end.
    pub particles: usize,
    /// Deepest penetration from the start of the contact to its end (m).
    pub deepest_penetration: f32,
}

impl ClothContact {
    /// The message that the touch has ended.
    pub(crate) fn stopped(&self, cloth: Entity) -> ClothTouchStopped {
        ClothTouchStopped {
            cloth,
            collider: self.collider,
            particles: self.particles,
            deepest_penetration: self.deepest_penetration,
        }
    }
}
