//! A particle's triangles in the frame of a shape.

use bevy::math::{Affine3A, Isometry3d, Vec3};

use crate::cloth::{Block, Slot};

/// A shape's motion in a sub-step, and its frame at the end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    to_local: Affine3A,
    /// Displacement of the shape, and the largest one of any of its points by rotation (m).
    slide: Vec3,
    swing: f32,
}

impl Frame {
    pub fn new(to_local: Isometry3d, slide: Vec3, swing: f32) -> Self {
        Self {
            to_local: to_local.into(),
            slide,
            swing,
        }
    }
}

/// The corners of a particle's triangles.
#[derive(Debug, Default, Clone)]
pub(super) struct FanView {
    /// Positions in the shape's frame (m), without repetition.
    corners: Vec<Vec3>,
    /// The particle itself.
    pub own: Vec3,
    /// Distance of the farthest corner (m).
    pub extent: f32,
    /// Largest displacement relative to the shape in the sub-step (m).
    pub speed: f32,
}

impl FanView {
    /// Reads the corners; the first is the particle itself.
    #[inline]
    pub fn look(&mut self, blocks: &[Block], corners: &[Slot], frame: &Frame) {
        self.corners.resize(corners.len(), Vec3::ZERO);
        let (mut speed, mut extent) = (0.0_f32, 0.0_f32);
        let mut own = None;
        for (known, &Slot { block, lane }) in self.corners.iter_mut().zip(corners) {
            let block = &blocks[block];
            *known = frame.to_local.transform_point3(block.position(lane));
            let own = *own.get_or_insert(*known);
            extent = extent.max(known.distance_squared(own));
            let moved = block.displacement(lane) - frame.slide;
            speed = speed.max(moved.length_squared());
        }
        self.own = own.unwrap_or(Vec3::NAN);
        (self.extent, self.speed) = (extent.sqrt(), speed.sqrt() + frame.swing);
    }

    /// The corners (m).
    pub fn corners(&self) -> &[Vec3] {
        &self.corners
    }

    /// A triangle of some of the corners (m).
    #[inline]
    pub fn triangle(&self, face: [u32; 3]) -> [Vec3; 3] {
        face.map(|corner| self.corners[corner as usize])
    }
}
