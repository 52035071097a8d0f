//! The triangles that a particle stands for, seen from the frame of a shape.

use bevy::math::{Isometry3d, Vec3};

use crate::cloth::{Block, Slot};

/// How a shape's frame moves in a sub-step, and where it is at its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    to_local: Isometry3d,
    /// How far the shape moves, and any of its points turns (m).
    slide: Vec3,
    swing: f32,
}

impl Frame {
    pub fn new(to_local: Isometry3d, slide: Vec3, swing: f32) -> Self {
        Self {
            to_local,
            slide,
            swing,
        }
    }
}

/// The corners of the triangles that a particle stands for.
#[derive(Debug, Default, Clone)]
pub(super) struct FanView {
    /// In the shape's frame (m), each once.
    corners: Vec<Vec3>,
    /// The particle itself.
    pub own: Vec3,
    /// How far the farthest is from it (m).
    pub extent: f32,
    /// How far any of them moved past the shape in the sub-step at most (m).
    pub speed: f32,
}

impl FanView {
    /// Looks at the corners, of which the particle is the first.
    #[inline]
    pub fn look(&mut self, blocks: &[Block], corners: &[Slot], frame: &Frame) {
        self.corners.resize(corners.len(), Vec3::ZERO);
        let (mut speed, mut extent) = (0.0_f32, 0.0_f32);
        let mut own = None;
        for (known, &Slot { block, lane }) in self.corners.iter_mut().zip(corners) {
            let block = &blocks[block];
            *known = frame.to_local * block.position(lane);
            let own = *own.get_or_insert(*known);
            extent = extent.max(known.distance_squared(own));
            let moved = block.displacement(lane) - frame.slide;
            speed = speed.max(moved.length_squared());
        }
        self.own = own.unwrap_or(Vec3::NAN);
        (self.extent, self.speed) = (extent.sqrt(), speed.sqrt() + frame.swing);
    }

    /// A triangle of some of the corners (m).
    #[inline]
    pub fn triangle(&self, [a, b, c]: [u16; 3]) -> [Vec3; 3] {
        let corner = |index: u16| self.corners[usize::from(index)];
        [corner(a), corner(b), corner(c)]
    }
}

/// Which of the corners of a fan a face has.
pub(super) fn corners_of(face: [Slot; 3], corners: &[Slot]) -> [u16; 3] {
    face.map(|slot| {
        let at = corners.iter().position(|&corner| corner == slot);
        at.unwrap_or_default() as u16
    })
}
