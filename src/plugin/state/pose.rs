//! A cloth's pose, and its largest distances from it.

use std::sync::Arc;

use bevy::{
    ecs::change_detection::Tick,
    math::Affine3A,
    prelude::{Isometry3d, Quat, Vec3},
};

use crate::{
    cloth::{ClothError, ClothSkin, FARTHEST, SkinError, Skinning, Surface},
    plugin::frame::{ClothFrame, Shift, rigid},
};

/// The skinned positions of a cloth's particles, in the cloth's frame.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Pose {
    /// Transforms of the joints, from the mesh to the world; empty without a skeleton.
    pub joints: Vec<Affine3A>,
    /// Place of each particle (m).
    pub places: Vec<Vec3>,
    /// Normal of each particle; empty if they are not needed.
    pub normals: Vec<Vec3>,
    /// That frame.
    pub frame: ClothFrame,
}

/// Numbers of a [`ClothSkin`], particle by particle.
#[derive(Debug, Clone)]
pub(crate) struct SkinLimits {
    /// When the component was last changed.
    pub changed: Tick,
    pub surface: Arc<Surface>,
    /// How far each may be from its place in the pose (m).
    pub max_distances: Vec<f32>,
    /// Whether any of them is neither 0 nor infinite.
    pub has_balls: bool,
    /// How far behind each its backstop begins (m); empty without any.
    pub backstops: Vec<f32>,
    /// Radius of the backstops (m).
    pub radius: f32,
}

impl SkinLimits {
    /// The limits of a component that was last changed then.
    ///
    /// # Errors
    /// The error of the component.
    pub fn new(
        skin: &ClothSkin,
        changed: Tick,
        surface: &Arc<Surface>,
    ) -> Result<Self, ClothError> {
        skin.validate()?;
        let quantity = "a particle's max distance (m)";
        let mut max_distances = skin.max_distance.values(surface, quantity)?;
        for distance in &mut max_distances {
            *distance = skin.blended(unbounded(*distance), surface.diagonal());
        }
        let mut backstops = match &skin.backstop {
            Some(backstop) => (backstop.distance).values(surface, "a particle's backstop (m)")?,
            None => Vec::new(),
        };
        for distance in &mut backstops {
            *distance = unbounded(*distance);
        }
        let is_ball = |distance: &f32| *distance > 0.0 && *distance < f32::INFINITY;
        Ok(Self {
            changed,
            surface: surface.clone(),
            has_balls: max_distances.iter().any(is_ball),
            max_distances,
            backstops,
            radius: skin.backstop.as_ref().map_or(0.0, |of| of.radius),
        })
    }

    /// The particles that it holds in the pose.
    pub fn held(&self) -> impl Iterator<Item = usize> + Clone {
        let distances = self.max_distances.iter().enumerate();
        let held = distances.filter(|(_, distance)| **distance == 0.0);
        held.map(|(index, _)| index)
    }
}

/// A distance (m); infinite if it is too large to matter.
fn unbounded(distance: f32) -> f32 {
    if distance < FARTHEST {
        distance
    } else {
        f32::INFINITY
    }
}

impl Pose {
    /// Scale of the mesh at its first joint.
    pub fn scale(&self) -> Option<Vec3> {
        let first = self.joints.first()?;
        Some(first.to_scale_rotation_translation().0)
    }

    /// Places the particles of a surface by the joints, in `frame`; without joints, where they are at rest.
    ///
    /// # Errors
    /// The error of the mesh's skin.
    pub fn place(
        &mut self,
        surface: &Surface,
        skinning: Option<&Skinning>,
        frame: &ClothFrame,
        with_normals: bool,
    ) -> Result<(), ClothError> {
        self.normals.clear();
        self.frame = *frame;
        let Some(skinning) = skinning.filter(|_| !self.joints.is_empty()) else {
            self.places.clear();
            self.places.extend_from_slice(surface.rest_positions());
            if with_normals {
                let normals = (0..surface.len()).map(|index| surface.normal_of(index));
                self.normals.extend(normals);
            }
            return Ok(());
        };
        let (needed, joints) = (skinning.joints(), self.joints.len());
        if needed > joints {
            return Err(SkinError::MissingJoints { needed, joints }.into());
        }
        skinning.places(&self.joints, &mut self.places);
        if with_normals {
            skinning.normals(&self.joints, &mut self.normals);
        }
        // The frame is far from the world's origin where the joints are: their difference is taken before they are turned.
        let isometry = frame.isometry();
        let origin = Vec3::from(isometry.translation);
        let turn = isometry.rotation.inverse();
        for place in &mut self.places {
            *place = turn * (*place - origin);
        }
        for normal in &mut self.normals {
            *normal = turn * *normal;
        }
        Ok(())
    }

    /// Shifts it with the world's origin; the transforms of the joints are `now`.
    pub fn shift(&mut self, shift: Shift, frames: [ClothFrame; 2], now: &[Affine3A]) {
        for (index, joint) in self.joints.iter_mut().enumerate() {
            *joint = shift.affine(*joint, now.get(index).copied());
        }
        self.frame = self.frame.shifted_with(shift, frames);
    }

    /// Takes over other particles, each in the place of one of the known ones.
    pub fn take_parts(&mut self, of: &[u32]) {
        let taken = |known: &[Vec3]| -> Vec<Vec3> {
            let each = of.iter().filter_map(|of| known.get(*of as usize));
            each.copied().collect()
        };
        self.places = taken(&self.places);
        self.normals = taken(&self.normals);
    }

    /// Copies `other` into its own memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.joints.clone_from(&other.joints);
        self.places.clone_from(&other.places);
        self.normals.clone_from(&other.normals);
        self.frame = other.frame;
    }

    /// Transforms it to another frame.
    pub fn transform(&mut self, by: Isometry3d) {
        for place in &mut self.places {
            *place = by * *place;
        }
        for normal in &mut self.normals {
            *normal = by.rotation * *normal;
        }
    }

    /// The largest distance of a place from that in `other`, seen from another frame (m).
    pub fn farthest_from(&self, other: &Self, by: Isometry3d) -> f32 {
        let pairs = self.places.iter().zip(&other.places);
        let squares = pairs.map(|(to, from)| to.distance_squared(by * *from));
        squares.fold(0.0, f32::max).sqrt()
    }

    /// Rotation of the first joint since `other`, each in its own frame.
    pub fn turn_since(&self, other: &Self) -> Option<Quat> {
        let now = rigid(self.joints.first()?).rotation;
        let was = rigid(other.joints.first()?).rotation;
        let [new, old] = [self, other].map(|pose| pose.frame.isometry().rotation);
        let turn = new.inverse() * now * was.inverse() * old;
        Some(turn.normalize()).filter(|turn| turn.is_finite())
    }
}
