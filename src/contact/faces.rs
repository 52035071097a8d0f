//! The narrow phase by triangles, for what is so small that it would slip between particles.

use bevy::math::Vec3;

pub(super) use super::corners::SubstepMotion;
use super::{
    corners::{Corners, Touching},
    particle::Found,
    response::{Contact, Push},
    touch::{Candidate, Fans},
    triangle::{area_within, at},
};
use crate::cloth::ClothParticles;

/// How many times as far as a triangle's point one of its corners is pushed at most. Corners that are all free, with the
/// masses of a grid, up to four times each other's, go no more than 2.0 times as far.
const MAX_SHARE: f32 = 2.0;

/// How often all triangles are gone through at most, while any is hit on a fast way: one that was passed by may have been
/// moved into the way by another's corners.
const MAX_PASSES: u32 = 4;

/// What to go on with.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct ResumePoint {
    pass: u32,
    /// A particle, and which of the triangles that it stands for.
    at: (u32, usize),
    /// Whether one was hit on a fast way in this pass.
    is_swept: bool,
}

/// Pushes the triangles out of `collider` that it touches or passed through in this sub-step, each by moving its
/// corners as much as they have a part in the nearest point, and mass allows.
///
/// Goes on `from` a triangle. Once a particle may have been pushed farther than there is `room` (m), candidates may be
/// missing: it stops then, and says with which triangle to go on.
pub(super) fn push_triangles(
    particles: &mut ClothParticles,
    candidates: &mut [Candidate],
    fans: &Fans,
    motion: &SubstepMotion,
    from: ResumePoint,
    room: f32,
) -> (Found, Option<ResumePoint>) {
    let reach = motion.reach;
    let mut found = Found::default();
    // The farthest that one triangle has pushed in this pass (m).
    let mut passed = 0.0_f32;
    let mut resume = from;
    while resume.pass < MAX_PASSES {
        for candidate in candidates.iter_mut() {
            let faces = fans.faces(candidate.faces);
            let corners = fans.corners(candidate.corners);
            if faces.is_empty() || motion.is_beyond(particles.blocks(), candidate.slot, corners) {
                continue;
            }
            for (which, &slots) in faces.iter().enumerate() {
                if (candidate.particle, which) < resume.at {
                    continue;
                }
                let corners = Corners::of(particles, slots);
                let Some((touch, depth)) = motion.touch(&corners) else {
                    continue;
                };
                candidate.depth = candidate.depth.max(depth.min(reach));
                if depth <= 0.0 {
                    continue;
                }
                let pushed = if touch.is_swept {
                    push_corners(particles, &corners, &touch, motion)
                } else {
                    push_point(particles, &corners, &touch, depth, motion)
                };
                if pushed == 0.0 {
                    continue;
                }
                resume.is_swept |= touch.is_swept;
                passed = passed.max(pushed);
                let depth = depth.min(reach);
                found.deepest = found.deepest.max(depth);
                if resume.pass == 0 {
                    let (area, volume) = cap(corners.positions, touch.centre, reach);
                    found.area += area;
                    found.volume += volume;
                }
                if found.farthest_push + passed * fans.max_faces > room {
                    found.farthest_push += passed * fans.max_faces;
                    resume.at = (candidate.particle, which + 1);
                    return (found, Some(resume));
                }
            }
        }
        found.farthest_push += passed * fans.max_faces;
        passed = 0.0;
        if !resume.is_swept {
            break;
        }
        resume = ResumePoint {
            pass: resume.pass + 1,
            ..ResumePoint::default()
        };
    }
    (found, None)
}

/// Pushes a triangle's nearest point out, by moving its corners as much as they have a part in it, and mass allows.
/// Returns how far the farthest has moved (m).
fn push_point(
    particles: &mut ClothParticles,
    corners: &Corners,
    &Touching {
        weights, normal, ..
    }: &Touching,
    depth: f32,
    &SubstepMotion {
        collider,
        settings,
        substep,
        ..
    }: &SubstepMotion,
) -> f32 {
    let parts = [0, 1, 2].map(|corner| weights[corner] * corners.inverse_masses[corner]);
    let mobility: f32 = (0..3).map(|corner| weights[corner] * parts[corner]).sum();
    // One that hardly has a part, beside pins, can't make up for them: it would be thrown away.
    let mobility = mobility.max(parts[0].max(parts[1]).max(parts[2]) / MAX_SHARE);
    if mobility == 0.0 {
        return 0.0;
    }
    let point = at(corners.positions, weights) + normal * (depth - settings.particle_radius);
    let origin = Vec3::from(collider.pose_at(substep.end()).translation);
    let surface = collider.surface_motion(substep, origin, point);
    let push = Contact {
        normal,
        depth,
        relative: at(corners.displacements, weights) - surface,
    }
    .push(settings.friction);
    let mut farthest = 0.0_f32;
    for (corner, part) in parts.into_iter().enumerate() {
        let share = part / mobility;
        if share > 0.0 {
            let push = Push {
                position: push.position * share,
                displacement: push.displacement * share,
            };
            farthest = farthest.max(corners.push(corner, particles, push));
        }
    }
    farthest
}

/// Pushes each corner of a triangle that was hit on its way in front of the surface's plane there, which keeps all of
/// it on its side. Its point alone is not enough: a corner that has hardly a part in it would stay behind, and the
/// triangle would turn out of a fast collider's way. Returns how far the farthest has moved (m).
fn push_corners(
    particles: &mut ClothParticles,
    corners: &Corners,
    &Touching { normal, centre, .. }: &Touching,
    &SubstepMotion {
        collider,
        settings,
        substep,
        reach,
        ..
    }: &SubstepMotion,
) -> f32 {
    let origin = Vec3::from(collider.pose_at(substep.end()).translation);
    let mut farthest = 0.0_f32;
    for corner in 0..3 {
        let position = corners.positions[corner];
        let depth = reach - normal.dot(position - centre);
        if depth <= 0.0 || corners.inverse_masses[corner] == 0.0 {
            continue;
        }
        let point = position + normal * (depth - settings.particle_radius);
        let surface = collider.surface_motion(substep, origin, point);
        let push = Contact {
            normal,
            depth,
            relative: corners.displacements[corner] - surface,
        }
        .push(settings.friction);
        farthest = farthest.max(corners.push(corner, particles, push));
    }
    farthest
}

/// Area of the triangle inside of a ball (m²), and ∫ depth dA over it (m³) with the mean depth of a cap, half of its
/// height.
fn cap(corners: [Vec3; 3], centre: Vec3, radius: f32) -> (f32, f32) {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let height = normal.dot(a - centre);
    let within = radius * radius - height * height;
    if within <= 0.0 {
        return (0.0, 0.0);
    }
    let area = area_within(corners, centre + normal * height, within.sqrt());
    (area, area * (radius - height.abs()) / 2.0)
}
