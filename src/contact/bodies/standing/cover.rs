//! The cloth between a body and the ground that it stands on.

use bevy::math::Vec3;

use crate::{
    cloth::{ClothParticles, MapInline, Surface},
    contact::{candidates::Candidate, colliders::MovingCollider},
};

/// The cloth near a body, with particles of a radius (m).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near<'a> {
    pub candidates: &'a [Candidate],
    pub surface: &'a Surface,
    pub particles: &'a ClothParticles,
    pub radius: f32,
}

/// A point of the cloth: the corners of a triangle, and their weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cover {
    pub corners: [u32; 3],
    pub weights: [f32; 3],
}

impl Near<'_> {
    /// The point of the cloth that a line from the ground up to the body passes.
    pub(super) fn cover(&self, [below, above]: [Vec3; 2], normal: Vec3) -> Option<Cover> {
        // For particles without a radius a tenth of a millimetre.
        let slack = self.radius.max(1.0e-4);
        let high = (above - below).dot(normal).max(0.0);
        let owners = self.candidates.iter();
        let mut faces = owners.flat_map(|owner| self.surface.faces().of(owner.particle));
        faces.find_map(|face| {
            let place = |corner: u32| self.particles.position_at(corner as usize) - below;
            let corners = face.map_inline(place);
            let weights = weights_along(corners, normal)?;
            let met: Vec3 = (0..3).map(|at| corners[at] * weights[at]).sum();
            let height = met.dot(normal);
            let is_between = height > -slack && height < high + slack;
            is_between.then_some(Cover {
                corners: *face,
                weights,
            })
        })
    }

    /// The particles that a body presses against the ground at a fraction of the tick.
    pub fn pressed<'a>(
        &'a self,
        [body, ground]: [&'a MovingCollider; 2],
        passed: f32,
    ) -> impl Iterator<Item = u32> + 'a {
        let each = self.candidates.iter().map(|candidate| candidate.particle);
        each.filter(move |&particle| {
            let place = self.particles.position_at(particle as usize);
            let distance = |of: &MovingCollider| of.nearest(passed, place).distance;
            distance(body) + distance(ground) < 2.5 * self.radius
        })
    }
}

/// The barycentric weights of the point at which a line through the origin meets a triangle.
fn weights_along(corners: [Vec3; 3], along: Vec3) -> Option<[f32; 3]> {
    let [a, b, c] = corners;
    let volume = |p: Vec3, q: Vec3| p.cross(q).dot(along);
    let parts = [volume(b, c), volume(c, a), volume(a, b)];
    let whole: f32 = parts.iter().sum();
    let is_met = whole != 0.0 && parts.iter().all(|part| part / whole >= 0.0);
    is_met.then(|| parts.map_inline(|part| part / whole))
}
