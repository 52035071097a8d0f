//! A cloth's pose, and how far it may be from it.

use std::sync::Arc;

use bevy::{
    ecs::change_detection::Tick,
    math::{Affine3A, Isometry3d, Quat, Vec3},
};

use super::super::{
    ClothFrame,
    frame::{Shift, rigid},
};
use crate::cloth::{ClothError, ClothSkin, FARTHEST, Skinning, Surface};

/// Where a skeleton has the particles of a cloth, in the cloth's frame.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Pose {
    /// What takes the mesh to the world, joint by joint; none where there is no skeleton.
    pub joints: Vec<Affine3A>,
    /// Place of each particle (m).
    pub places: Vec<Vec3>,
    /// Where each faces; none where nobody asks.
    pub normals: Vec<Vec3>,
    /// That frame.
    pub frame: ClothFrame,
}

/// Numbers of a [`ClothSkin`], particle by particle.
#[derive(Debug, Clone)]
pub(crate) struct SkinLimits {
    /// When the component was last changed that they are of.
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
    /// Of a component that was last changed then.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn new(
        skin: &ClothSkin,
        changed: Tick,
        surface: &Arc<Surface>,
    ) -> Result<Self, ClothError> {
        skin.validate()?;
        let mut max_distances = skin
            .max_distance
            .values(surface, "a particle's max distance (m)")?;
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
            radius: skin
                .backstop
                .as_ref()
                .map_or(0.0, |backstop| backstop.radius),
        })
    }

    /// The particles that it holds in the pose.
    pub fn held(&self) -> impl Iterator<Item = usize> + Clone {
        let distances = self.max_distances.iter().enumerate();
        distances
            .filter(|(_, distance)| **distance == 0.0)
            .map(|(index, _)| index)
    }
}

/// A distance (m); one that is beyond all measure is none.
fn unbounded(distance: f32) -> f32 {
    if distance < FARTHEST {
        distance
    } else {
        f32::INFINITY
    }
}

impl Pose {
    /// Scale of a mesh whose first joint is where it is.
    pub fn scale(&self) -> Option<Vec3> {
        let first = self.joints.first()?;
        Some(first.to_scale_rotation_translation().0)
    }

    /// Takes over where the joints have the particles of a surface, in `frame`; without joints, where they are at rest.
    ///
    /// # Errors
    /// What is wrong with the skin of the mesh.
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
        if skinning.joints() > self.joints.len() {
            return Err(ClothError::SkinJoints {
                needed: skinning.joints(),
                joints: self.joints.len(),
            });
        }
        skinning.places(&self.joints, &mut self.places);
        if with_normals {
            skinning.normals(&self.joints, &mut self.normals);
        }
        // The frame is far from the world's origin where the joints are: their difference is taken before they are turned.
        let isometry = frame.isometry();
        let (origin, turn) = (
            Vec3::from(isometry.translation),
            isometry.rotation.inverse(),
        );
        for place in &mut self.places {
            *place = turn * (*place - origin);
        }
        for normal in &mut self.normals {
            *normal = turn * *normal;
        }
        Ok(())
    }

    /// Has been shifted with the world's origin, and what takes the mesh to its joints is `now`.
    pub fn shift(&mut self, shift: Shift, frames: [ClothFrame; 2], now: &[Affine3A]) {
        for (index, joint) in self.joints.iter_mut().enumerate() {
            *joint = shift.affine(*joint, now.get(index).copied());
        }
        let [before, after] = frames;
        self.frame = match self.frame == before {
            true => after,
            false => self.frame.shifted(shift, None),
        };
    }

    /// Becomes what `other` is, in the memory that it has.
    pub fn copy_from(&mut self, other: &Self) {
        self.joints.clone_from(&other.joints);
        self.places.clone_from(&other.places);
        self.normals.clone_from(&other.normals);
        self.frame = other.frame;
    }

    /// Sees it from another frame.
    pub fn transform(&mut self, by: Isometry3d) {
        self.places
            .iter_mut()
            .for_each(|place| *place = by * *place);
        self.normals
            .iter_mut()
            .for_each(|normal| *normal = by.rotation * *normal);
    }

    /// How far the place is that is farthest from where `other` has it, seen from another frame (m).
    pub fn farthest_from(&self, other: &Self, by: Isometry3d) -> f32 {
        let pairs = self.places.iter().zip(&other.places);
        let squares = pairs.map(|(to, from)| to.distance_squared(by * *from));
        squares.fold(0.0, f32::max).sqrt()
    }

    /// How the first joint is turned against where `other` has it, each in its own frame.
    pub fn turn_since(&self, other: &Self) -> Option<Quat> {
        let now = rigid(self.joints.first()?).rotation;
        let was = rigid(other.joints.first()?).rotation;
        let [new, old] = [self, other].map(|pose| pose.frame.isometry().rotation);
        let turn = new.inverse() * now * was.inverse() * old;
        Some(turn.normalize()).filter(|turn| turn.is_finite())
    }
}
