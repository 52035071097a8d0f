//! Which face, or segment of a rope, a ray hits first: a top-down query with the ray as its probe.

use std::cmp::Ordering;

use bevy::math::{DVec2, DVec3, Ray3d, Vec3, Vec3Swizzles, bounding::BoundingSphere};

use super::{
    bounds::NodeBounds,
    probe::{Core, Probe, ROUNDING},
    query::TopDownQuery,
    rule::BoundRule,
    tree::QuadTree,
    volume::BoundingVolume,
};
use crate::cloth::{ClothParticles, MapInline, Surface};

/// Where a ray hits a face, or a segment of a rope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RayHit {
    /// Index of the face in [`Surface::triangles`], or of the segment's first particle.
    pub face: usize,
    /// Its corners. The last two of a segment are the same.
    pub particles: [u32; 3],
    /// Barycentric weights of its corners.
    pub weights: [f32; 3],
    /// Along the ray (m).
    pub distance: f32,
}

impl RayHit {
    /// Nearer ones first.
    fn order(&self, other: &Self) -> Ordering {
        let by_distance = self.distance.total_cmp(&other.distance);
        by_distance.then(self.face.cmp(&other.face))
    }
}

/// Memory of a search for a ray, which is reused.
#[derive(Debug, Default)]
pub(crate) struct RayQuery {
    bounds: NodeBounds,
    query: TopDownQuery,
    /// The corners of a particle's faces, [seen](View) by the ray.
    corners: Vec<DVec3>,
}

impl RayQuery {
    /// The first face that `ray` hits within `max_distance` (m), from either side, in the cloth's frame. `stretch` is
    /// [`Stretch::bound`](crate::solver::Stretch) of the particles. No hit is missed: every point of a face is within
    /// reach of the particle that owns it, and no particle within reach of the ray is missed.
    pub fn cast(
        &mut self,
        surface: &Surface,
        tree: &QuadTree,
        particles: &ClothParticles,
        stretch: f32,
        ray: Ray3d,
        max_distance: f32,
    ) -> Option<RayHit> {
        let rope = surface.rope_radius();
        let reach = tree.face_reach(surface) * (1.0 + stretch) * ROUNDING + rope.unwrap_or(0.0);
        let mut around = tree.root_sphere(particles, stretch);
        if !around.radius().is_finite() {
            // Pieces that no spring joins.
            around = particles.bounding_sphere();
        }
        let around = BoundingSphere::new(around.center, around.radius() + reach);
        let ends = chord(&around, ray, max_distance)?;
        let spheres = (BoundingVolume::Sphere, BoundRule::RestShape);
        let rebuilt = (self.bounds).rebuild(spheres, tree, particles, stretch);
        rebuilt.ok()?;
        self.query.clear();
        self.query.silence();
        let probe = Probe {
            core: Core::Segment(ends.map_inline(|distance| ray.get_point(distance))),
            radius: reach,
            particle_radius: 0.0,
        };
        self.query.search(tree, &self.bounds, particles, &probe);
        let nearest = match rope {
            Some(radius) => self.nearest_segment(surface, particles, ray, radius),
            None => self.nearest_face(surface, particles, &View::of(ray)),
        };
        nearest.filter(|hit| hit.distance <= max_distance)
    }

    /// The first segment of a rope that a ray hits, of those that were found.
    fn nearest_segment(
        &self,
        surface: &Surface,
        particles: &ClothParticles,
        ray: Ray3d,
        radius: f32,
    ) -> Option<RayHit> {
        let place = |particle: u32| particles.position_at(particle as usize);
        let found = self.query.candidates().iter().copied();
        let found = found.filter(|from| (*from as usize) + 1 < surface.len());
        let hits = found.filter_map(|from| {
            let (weights, distance) = hit_segment(ray, [place(from), place(from + 1)], radius)?;
            Some(RayHit {
                face: from as usize,
                particles: [from, from + 1, from + 1],
                weights,
                distance,
            })
        });
        hits.min_by(RayHit::order)
    }

    /// The first face that a ray hits, of those of the particles that were found.
    fn nearest_face(
        &mut self,
        surface: &Surface,
        particles: &ClothParticles,
        view: &View,
    ) -> Option<RayHit> {
        let (faces, fans, blocks) = (surface.faces(), surface.fans(), particles.blocks());
        let mut nearest: Option<RayHit> = None;
        for &owner in self.query.candidates() {
            let fan = fans.of(owner);
            let places = fan.corners.iter();
            let places = places.map(|slot| view.see(blocks[slot.block].position(slot.lane)));
            self.corners.clear();
            self.corners.extend(places);
            for (&corners, face) in fan.faces.iter().zip(faces.range_of(owner)) {
                let corners = corners.map_inline(|corner| self.corners[corner as usize]);
                let Some((weights, distance)) = hit(corners) else {
                    continue;
                };
                let found = RayHit {
                    face,
                    particles: faces.all()[face],
                    weights,
                    distance,
                };
                if nearest.is_none_or(|known| found.order(&known).is_lt()) {
                    nearest = Some(found);
                }
            }
        }
        nearest
    }
}

/// A frame with a ray's origin as its zero: two axes across the ray, and the ray.
struct View {
    origin: DVec3,
    axes: [DVec3; 3],
}

impl View {
    fn of(ray: Ray3d) -> Self {
        let along = ray.direction.as_dvec3().normalize();
        let (u, v) = along.any_orthonormal_pair();
        Self {
            origin: ray.origin.as_dvec3(),
            axes: [u, v, along],
        }
    }

    /// A point in it (m).
    #[inline]
    fn see(&self, point: Vec3) -> DVec3 {
        let offset = point.as_dvec3() - self.origin;
        DVec3::from(self.axes.map_inline(|axis| axis.dot(offset)))
    }
}

/// The weights of the ends of a segment of a rope of this radius (m) where a ray passes nearest to it, if it hits it, and the distance (m).
fn hit_segment(ray: Ray3d, ends: [Vec3; 2], radius: f32) -> Option<([f32; 3], f32)> {
    let direction = ray.direction.as_dvec3();
    let [a, b] = ends.map_inline(|end| end.as_dvec3() - ray.origin.as_dvec3());
    // Seen along the ray, the segment is one in a plane, and the ray is its origin.
    let across = |at: DVec3| at.reject_from_normalized(direction);
    let (from, way) = (across(a), across(b) - across(a));
    let length = way.length_squared();
    let part = match length > 0.0 {
        true => (-from.dot(way) / length).clamp(0.0, 1.0),
        false => 0.0,
    };
    let distance = a.lerp(b, part).dot(direction);
    let is_hit = (from + way * part).length() <= f64::from(radius) && distance >= 0.0;
    is_hit.then_some(([1.0 - part as f32, part as f32, 0.0], distance as f32))
}

/// The distances between which a ray is in a sphere, up to the largest, if it is.
fn chord(around: &BoundingSphere, ray: Ray3d, max_distance: f32) -> Option<[f32; 2]> {
    let offset = Vec3::from(around.center) - ray.origin;
    let middle = offset.dot(*ray.direction);
    let off = offset.distance_squared(middle * *ray.direction);
    // More than all roundings, which are relative to the offset.
    let radius = around.radius() * ROUNDING + offset.length() * (ROUNDING - 1.0);
    let half = (radius * radius - off).sqrt();
    let (from, to) = ((middle - half).max(0.0), (middle + half).min(max_distance));
    // False for NaN.
    (half >= 0.0 && from <= to).then_some([from, to])
}

/// The weights of the corners, seen by the ray, where it hits their triangle, and the distance (m). They are the areas that it
/// spans with each edge (Woop, Benthin and Wald 2013). Two triangles get the same area, up to its sign, for the edge that they
/// share. So no ray passes between them.
#[inline]
fn hit(corners: [DVec3; 3]) -> Option<([f32; 3], f32)> {
    let [a, b, c] = corners.map_inline(Vec3Swizzles::xy);
    let [least, most] = [a.min(b).min(c), a.max(b).max(c)];
    // The areas tell of NaN.
    if !(least.cmple(DVec2::ZERO).all() && most.cmpge(DVec2::ZERO).all()) {
        return None;
    }
    let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    let is_through = areas.iter().all(|v| *v >= 0.0) || areas.iter().all(|v| *v <= 0.0);
    let sum = areas.iter().sum::<f64>();
    if !is_through || sum == 0.0 {
        return None;
    }
    let weights = areas.map_inline(|area| area / sum);
    let each = weights.iter().zip(&corners);
    let distance: f64 = each.map(|(weight, of)| weight * of.z).sum();
    let weights = weights.map_inline(|weight| weight as f32);
    (distance >= 0.0).then_some((weights, distance as f32))
}
