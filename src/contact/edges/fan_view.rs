//! A particle's triangles in the frame of a shape.

use bevy::math::{Affine3A, Vec3};

use crate::{
    cloth::{Block, MapInline, Slot},
    contact::colliders::ColliderSubstep,
};

/// The corners of a particle's triangles.
#[derive(Debug, Default, Clone)]
pub(crate) struct FanView {
    /// Positions in the shape's frame (m), without repetition.
    pub corners: Vec<Vec3>,
    /// The particle itself.
    pub own: Vec3,
    /// Distance of the farthest corner (m).
    pub extent: f32,
    /// Largest displacement relative to the shape in the sub-step (m).
    pub speed: f32,
}

impl FanView {
    /// Reads the corners in the frame of a shape in motion; the first is the particle itself.
    #[inline]
    pub fn look(
        &mut self,
        blocks: &[Block],
        corners: &[Slot],
        to_local: &Affine3A,
        motion: &ColliderSubstep,
    ) {
        self.corners.resize(corners.len(), Vec3::ZERO);
        let (mut speed, mut extent) = (0.0_f32, 0.0_f32);
        let mut own = None;
        for (known, &Slot { block, lane }) in self.corners.iter_mut().zip(corners) {
            let block = &blocks[block];
            *known = to_local.transform_point3(block.position(lane));
            let own = *own.get_or_insert(*known);
            extent = extent.max(known.distance_squared(own));
            let moved = block.displacement(lane) - motion.slide;
            speed = speed.max(moved.length_squared());
        }
        self.own = own.unwrap_or(Vec3::NAN);
        (self.extent, self.speed) = (extent.sqrt(), speed.sqrt() + motion.swing);
    }

    /// A triangle of some of the corners (m).
    #[inline]
    pub fn triangle(&self, face: [u32; 3]) -> [Vec3; 3] {
        face.map_inline(|corner| self.corners[corner as usize])
    }
}
