//! Draws a cloth that follows a pose where its skeleton is drawn.
//!
//! The cloth and its pose are interpolated between two ticks; the skeleton is drawn where it is in this frame. Each
//! particle is moved along by the difference. So held particles are drawn exactly in the pose, in line with meshes that
//! the renderer skins.

use bevy::{
    math::Affine3A,
    prelude::{Entity, GlobalTransform, Isometry3d, Vec3},
};

use crate::plugin::{
    frame::{ClothFrame, Shift},
    prepare::Skins,
    state::{ClothScratch, ClothState, Pose, Shared},
};

/// Poses of the last tick, and the drawn skeleton.
#[derive(Debug, Default)]
pub(super) struct DrawnPose {
    /// As the last tick began and ended, in the frame of its end (m).
    from: Vec<Vec3>,
    to: Vec<Vec3>,
    frame: ClothFrame,
    drawn: Pose,
    /// The joints as they were drawn last.
    known: Vec<Affine3A>,
}

impl DrawnPose {
    /// Takes over a tick's poses. `undone` undoes the motion that carried the cloth along as the tick began.
    pub fn follow(
        &mut self,
        frame: ClothFrame,
        state: &ClothState,
        scratch: &ClothScratch,
        undone: Option<Isometry3d>,
    ) {
        self.from.clone_from(&scratch.pose.places);
        self.to.clone_from(&state.pose.places);
        self.frame = frame;
        if let Some(undone) = undone {
            let places = self.from.iter_mut();
            places.for_each(|place| *place = undone * *place);
        }
    }

    /// Shifts it with the world's origin, from one frame to another.
    pub fn shift(&mut self, shift: Shift, frames: [ClothFrame; 2]) {
        self.frame = self.frame.shifted_with(shift, frames);
    }

    /// Reads the drawn joints. Returns whether they have moved since they were last drawn.
    pub fn read(
        &mut self,
        entity: Entity,
        skins: &Skins,
        place: impl Fn(Entity) -> Option<GlobalTransform>,
    ) -> bool {
        if self.to.is_empty() {
            return false;
        }
        std::mem::swap(&mut self.known, &mut self.drawn.joints);
        let read = skins.read(entity, place, &mut self.drawn.joints);
        if read.is_err() {
            self.drawn.joints.clear();
        }
        self.drawn.joints != self.known
    }

    /// Moves particles, a fraction of the way from the last tick to this one, along with the skeleton that is drawn. Returns
    /// whether there is one.
    pub fn place(&mut self, shared: &Shared, fraction: f32, drawn: &mut [Vec3]) -> bool {
        let count = drawn.len();
        if self.drawn.joints.is_empty() || self.to.len() != count || self.from.len() != count {
            return false;
        }
        let placed =
            (self.drawn).place(&shared.surface, shared.known_skinning(), &self.frame, false);
        if placed.is_err() || self.drawn.places.len() != count {
            return false;
        }
        let poses = self.from.iter().zip(&self.to).zip(&self.drawn.places);
        for (place, ((from, to), drawn)) in drawn.iter_mut().zip(poses) {
            *place += *drawn - from.lerp(*to, fraction);
        }
        true
    }
}
