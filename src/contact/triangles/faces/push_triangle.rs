//! Pushes one triangle.

use bevy::math::Vec3;

use super::{ResumePoint, TrianglePush};
use crate::{
    cloth::{ClothParticles, MapInline, Slot},
    contact::{
        colliders::{at, cap},
        friction::Contact,
        triangles::corners::{CoreMotion, Corners, Touching},
    },
};

impl TrianglePush<'_> {
    /// Pushes one triangle of a particle of a contact block.
    pub(super) fn push_one(
        &mut self,
        particles: &mut ClothParticles,
        motion: &CoreMotion,
        (contact, lane): (usize, usize),
        slots: [Slot; 3],
        resume: &mut ResumePoint,
    ) {
        let reach = motion.reach;
        let corners = Corners::of(particles, slots);
        let Some(touch) = motion.touch(&corners) else {
            return;
        };
        let depth = touch.depth.min(reach);
        let own = &mut self.contacts[contact].depth[lane];
        *own = own.max(depth);
        if touch.depth <= 0.0 {
            return;
        }
        let pushed = if touch.is_swept {
            self.push_corners(particles, &corners, &touch, motion)
        } else {
            self.push_point(particles, &corners, &touch, motion)
        };
        if pushed == 0.0 {
            return;
        }
        resume.is_swept |= touch.is_swept;
        self.passed = self.passed.max(pushed);
        self.found.deepest = self.found.deepest.max(depth);
        if self.is_measured && resume.pass == 0 {
            let (area, volume) = cap(corners.positions, touch.centre, reach);
            self.found.area += area;
            self.found.volume += volume;
        }
    }

    /// Pushes a triangle's nearest point out. Moves its corners by their weights in it and their inverse masses.
    /// Returns the largest displacement (m).
    fn push_point(
        &mut self,
        particles: &mut ClothParticles,
        corners: &Corners,
        touch: &Touching,
        motion: &CoreMotion,
    ) -> f32 {
        let (weights, normal, depth) = (touch.weights, touch.normal, touch.depth);
        let Some(shares) = corners.shares(weights) else {
            return 0.0;
        };
        let point = [corners.positions, corners.displacements].map_inline(|of| at(of, weights));
        let radius = motion.lanes.particle_radius;
        let contact = Contact::of(&motion.of, point, (normal, depth), radius);
        let [momentum, far] = contact.stopped_and_out(&motion.lanes.push_out);
        let mut farthest = 0.0_f32;
        for (corner, share) in shares.into_iter().enumerate() {
            if share > 0.0 {
                let push = [normal * (far * share), normal * (momentum * share)];
                farthest = farthest.max(self.move_corner(particles, corners, corner, push, motion));
            }
        }
        farthest
    }

    /// Pushes each corner of a triangle that was hit on its way in front of the surface's plane there, so that all of
    /// it stays on its side. Its point alone is not enough: a corner with a tiny weight would stay behind, and the
    /// triangle would turn out of a fast collider's way. Returns the largest displacement (m).
    fn push_corners(
        &mut self,
        particles: &mut ClothParticles,
        corners: &Corners,
        touch: &Touching,
        motion: &CoreMotion,
    ) -> f32 {
        let normal = touch.normal;
        let mut farthest = 0.0_f32;
        for corner in 0..3 {
            let position = corners.positions[corner];
            let depth = motion.reach - normal.dot(position - touch.centre);
            if depth <= 0.0 || corners.inverse_masses[corner] == 0.0 {
                continue;
            }
            let point = [position, corners.displacements[corner]];
            let radius = motion.lanes.particle_radius;
            let contact = Contact::of(&motion.of, point, (normal, depth), radius);
            let [momentum, _] = contact.stopped_and_out(&motion.lanes.push_out);
            // All of it at once: the collider would pass a triangle left behind.
            let push = [normal * depth, normal * momentum];
            farthest = farthest.max(self.move_corner(particles, corners, corner, push, motion));
        }
        farthest
    }

    /// Moves a corner by a fraction of its push, as displacement and as momentum (m). Returns the distance.
    fn move_corner(
        &mut self,
        particles: &mut ClothParticles,
        corners: &Corners,
        corner: usize,
        [displacement, momentum]: [Vec3; 2],
        motion: &CoreMotion,
    ) -> f32 {
        let slot = corners.slots[corner];
        let by = (&mut self.found.given, motion.of.origin);
        let distance = corners.push(corner, particles, [displacement, momentum], by);
        let block = slot.block as u32;
        let at = (self.contacts).binary_search_by_key(&block, |contact| contact.block);
        if let Ok(at) = at {
            self.budgets[at].add_one(slot.lane, momentum.to_array());
        }
        distance
    }
}
