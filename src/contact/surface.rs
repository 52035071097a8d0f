//! The narrow phase by triangles, for what is so small that it would slip between particles.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    MovingCollider,
    detection::Candidate,
    particle::Found,
    response::{Contact, first_touch},
    triangle::{NearestPoints, area_within, at, nearest},
};
use crate::{
    cloth::{ClothParticles, Layout, Slot},
    hierarchy::{Core, Probe},
    solver::SubStep,
};

/// From so many spacings of radius on, a collider is tested against particles, below against triangles.
///
/// A ball of radius R that rests between four particles of a square of spacing s dips R − √(R² − s²/2) into it: 6.5 %
/// of R at 2 s, 2.9 % at 3 s, and falls through below 0.71 s. Where this ratio is from: `cargo bench --profile dev
/// --bench contact -- triangles`.
pub const PARTICLES_FROM: f32 = 2.5;

/// What a cloth's colliders are tested against. A component of the cloth.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, Clone, PartialEq, Hash)]
pub enum NarrowPhase {
    /// Triangles for balls and capsules of a radius below [`PARTICLES_FROM`] spacings, else particles.
    #[default]
    Auto,
    /// Particles: exact while the collider is large against the spacing.
    Particles,
    /// Triangles, for balls and capsules; boxes and planes are tested against particles all the same.
    Triangles,
}

impl NarrowPhase {
    /// The choices with their names, for menus.
    pub const ALL: [(&str, Self); 3] = [
        ("auto", Self::Auto),
        ("particles", Self::Particles),
        ("triangles", Self::Triangles),
    ];

    /// What a collider of `radius` (m) is tested against, on a cloth of a spacing (m).
    pub fn chosen(self, radius: Option<f32>, spacing: f32) -> Self {
        match (self, radius) {
            (Self::Triangles, Some(_)) => Self::Triangles,
            (Self::Auto, Some(radius)) if radius < PARTICLES_FROM * spacing => Self::Triangles,
            _ => Self::Particles,
        }
    }
}

/// A triangle's particles at the end of a sub-step.
struct Corners {
    slots: [Slot; 3],
    positions: [Vec3; 3],
    displacements: [Vec3; 3],
    inverse_masses: [f32; 3],
}

impl Corners {
    fn of(particles: &ClothParticles, slots: [Slot; 3]) -> Self {
        let block = |slot: Slot| &particles.blocks()[slot.block];
        Self {
            slots,
            positions: slots.map(|slot| block(slot).position(slot.lane)),
            displacements: slots.map(|slot| block(slot).displacement(slot.lane)),
            inverse_masses: slots.map(|slot| block(slot).inverse_mass(slot.lane)),
        }
    }

    /// When a part of the sub-step has passed.
    fn when(&self, part: f32) -> [Vec3; 3] {
        [0, 1, 2].map(|corner| self.positions[corner] - self.displacements[corner] * (1.0 - part))
    }
}

/// The two triangles of the cell whose first particle this is, if it begins one.
fn triangles_of(layout: Layout, particle: u32) -> Option<[[Slot; 3]; 2]> {
    let (row, column) = (particle / layout.columns, particle % layout.columns);
    if row + 1 >= layout.rows || column + 1 >= layout.columns {
        return None;
    }
    let [a, b] = [column, column + 1].map(|column| layout.slot(row, column));
    let [c, d] = [column, column + 1].map(|column| layout.slot(row + 1, column));
    Some([[a, c, b], [b, c, d]])
}

/// Pushes the triangles out of `collider` that it touches or passed through in this sub-step, each by moving its
/// corners as much as they have a part in the nearest point, and mass allows.
pub(super) fn push_triangles(
    particles: &mut ClothParticles,
    candidates: &mut [Candidate],
    collider: &MovingCollider,
    particle_radius: f32,
    friction: f32,
    substep: SubStep,
) -> Found {
    let reach = collider.shape.radius().unwrap_or(0.0) + particle_radius;
    let layout = particles.layout();
    let mut found = Found::default();
    for candidate in candidates {
        for slots in triangles_of(layout, candidate.particle)
            .into_iter()
            .flatten()
        {
            let corners = Corners::of(particles, slots);
            let Some((touch, depth)) = touch(&corners, collider, reach, substep) else {
                continue;
            };
            candidate.depth = candidate.depth.max(depth.min(reach));
            if depth <= 0.0 {
                continue;
            }
            let Touching {
                weights,
                normal,
                centre,
            } = touch;
            let mobility: f32 = (0..3)
                .map(|corner| weights[corner] * weights[corner] * corners.inverse_masses[corner])
                .sum();
            if mobility == 0.0 {
                continue;
            }
            let point = at(corners.positions, weights);
            let origin = Vec3::from(collider.pose(substep.end()).translation);
            let surface = collider.surface_motion(
                substep,
                origin,
                point + normal * (depth - particle_radius),
            );
            let relative = at(corners.displacements, weights) - surface;
            let push = Contact {
                normal,
                depth,
                relative,
            }
            .push(friction);
            for corner in 0..3 {
                let share = weights[corner] * corners.inverse_masses[corner] / mobility;
                let Slot { block, lane } = corners.slots[corner];
                let block = &mut particles.blocks_mut()[block];
                if share > 0.0 {
                    block.set_position(lane, corners.positions[corner] + push.position * share);
                    block.set_displacement(
                        lane,
                        corners.displacements[corner] + push.displacement * share,
                    );
                    found.farthest_push = found.farthest_push.max(push.position.length() * share);
                }
            }
            let depth = depth.min(reach);
            found.deepest = found.deepest.max(depth);
            let (area, volume) = cap(corners.positions, centre, reach);
            found.area += area;
            found.volume += volume;
        }
    }
    found
}

/// Whether a probe meets a triangle of those cells, as the particles lie now. Of a box or a half-space, it does where
/// it meets the particles themselves.
pub fn meets_triangles(particles: &ClothParticles, cells: &[u32], probe: &Probe) -> bool {
    let segment = match probe.core {
        Core::Point(centre) => [centre; 2],
        Core::Segment(ends) => ends,
        Core::Cuboid { .. } | Core::HalfSpace { .. } => return !cells.is_empty(),
    };
    let reach = probe.reach() as f32;
    let triangles = cells
        .iter()
        .filter_map(|&cell| triangles_of(particles.layout(), cell));
    triangles.flatten().any(|slots| {
        let corners = Corners::of(particles, slots);
        nearest(corners.positions, segment).offset.length_squared() < reach * reach
    })
}

/// Where a triangle touches.
struct Touching {
    weights: [f32; 3],
    normal: Vec3,
    /// The core's point (m).
    centre: Vec3,
}

/// How a triangle lies to the collider at the end of the sub-step, or where it was hit in it; and how far its nearest
/// point has to go along the normal (m), negative if it is outside.
fn touch(
    corners: &Corners,
    collider: &MovingCollider,
    reach: f32,
    substep: SubStep,
) -> Option<(Touching, f32)> {
    let count = substep.count as f32;
    let begin = substep.index as f32 / count;
    let segment = |part: f32| match collider.shape.core(collider.pose(begin + part / count)).0 {
        Core::Point(centre) => [centre; 2],
        Core::Segment(ends) => ends,
        Core::Cuboid { .. } | Core::HalfSpace { .. } => [Vec3::NAN; 2],
    };
    let touching = |nearest: NearestPoints, [start, end]: [Vec3; 2], triangle: [Vec3; 3]| {
        let (normal, distance) = match nearest.offset.length() {
            0.0 => (face_normal(triangle, start.midpoint(end)), 0.0),
            distance => (nearest.offset / distance, distance),
        };
        let centre = start.lerp(end, nearest.along);
        (
            Touching {
                weights: nearest.weights,
                normal,
                centre,
            },
            distance,
        )
    };
    let slide = (collider.to - Vec3::from(collider.from.translation)) / count;
    let swing = (collider.drag(f32::INFINITY) - collider.travel()) / count;
    let speeds = corners
        .displacements
        .map(|displacement| (displacement - slide).length());
    let speed = speeds[0].max(speeds[1]).max(speeds[2]) + swing;
    let at_end = segment(1.0);
    let nearest_at_end = nearest(corners.positions, at_end);
    // Most candidates are too far away to have been met.
    let distance = nearest_at_end.offset.length();
    if !(distance - speed <= reach) {
        return None;
    }
    // What came less far than to half of the radius is still on the side that it came from.
    if speed > reach / 2.0 && speed.is_finite() {
        let distance = |part: f32| nearest(corners.when(part), segment(part)).offset.length();
        let tolerance = 1.0e-3 * reach;
        if distance(0.0) >= reach - tolerance
            && let Some(part) = first_touch(speed, reach + tolerance, |part| distance(part) - 0.0)
        {
            let (triangle, core) = (corners.when(part), segment(part));
            let (touch, _) = touching(nearest(triangle, core), core, triangle);
            let origin = Vec3::from(collider.pose(begin).translation);
            let surface = collider.surface_motion(substep, origin, at(triangle, touch.weights));
            let moved = at(corners.displacements, touch.weights);
            let depth = (1.0 - part) * touch.normal.dot(surface - moved);
            if depth > 0.0 {
                return Some((touch, depth));
            }
        }
    }
    let (touch, distance) = touching(nearest_at_end, at_end, corners.positions);
    Some((touch, reach - distance))
}

/// Of a triangle that goes through the core's point: across it, away from the core's middle.
fn face_normal([a, b, c]: [Vec3; 3], middle: Vec3) -> Vec3 {
    let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
    if normal.dot(a - middle) < 0.0 {
        -normal
    } else {
        normal
    }
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
