//! How a triangle of the cloth lies to the edges of a shape.

use bevy::math::{Isometry3d, Vec3};

use super::{ColliderShape, geometry::SharpEdge, triangle::nearest};

/// How far beyond a triangle's sides, in barycentric weights, an edge counts as below it: neighbours leave no gap.
const BEYOND: f32 = 0.05;
/// How far through a triangle an edge counts, in lengths of the triangle's longest side.
const DEEPEST: f32 = 0.5;

/// An edge goes steeply through a triangle's plane above this sine of their angle.
const STEEP: f32 = 0.5;

/// Where an edge comes nearest to a triangle, or through it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EdgeContact {
    pub weights: [f32; 3],
    /// Of the triangle, away from the shape, of length 1.
    pub normal: Vec3,
    /// How far its point has to move (m).
    pub depth: f32,
}

/// The contact of a triangle of the shape's frame with the edge that comes nearest to it, or farthest through it.
pub(super) fn deepest_edge(
    shape: &ColliderShape,
    triangle: [Vec3; 3],
    reach: f32,
) -> Option<EdgeContact> {
    let [a, b, c] = triangle;
    let (lower, upper) = (a.min(b).min(c), a.max(b).max(c));
    let across = (b - a).cross(c - a).try_normalize()?;
    let plane = Plane::of(triangle, across)?;
    let longest = a
        .distance_squared(b)
        .max(b.distance_squared(c))
        .max(c.distance_squared(a));
    let deepest = DEEPEST * longest.sqrt();
    let mut outside = None;
    let mut found: Option<EdgeContact> = None;
    let around = Vec3::splat(reach);
    shape.edges_near([lower - around, upper + around], |edge| {
        let [from, to] = edge.ends.map(|end| plane.place(end));
        let near = reach + edge.radius;
        // Wholly on one side, and too far away.
        if from.height.abs().min(to.height.abs()) > near && from.height * to.height > 0.0 {
            return;
        }
        let outside = *outside.get_or_insert_with(|| {
            let middle = (a + b + c) / 3.0;
            shape.nearest(Isometry3d::IDENTITY, middle).normal
        });
        let ends = [from, to];
        let above = over(ends, edge, across, outside, near, deepest);
        let beside = plane.beside(ends, edge, near, deepest);
        // Through it, whichever way out is shorter.
        let contact = match (above, beside) {
            (Some(above), Some(beside)) if beside.depth < above.depth => Some(beside),
            (Some(above), _) => Some(above),
            (None, beside) => beside,
        };
        if let Some(contact) = contact
            && found.is_none_or(|found| contact.depth > found.depth)
        {
            found = Some(contact);
        }
    });
    found
}

/// The contact of an edge that comes up to a triangle, or through it, along its normal.
fn over(
    ends: [Placed; 2],
    edge: &SharpEdge,
    across: Vec3,
    outside: Vec3,
    near: f32,
    deepest: f32,
) -> Option<EdgeContact> {
    let [from, to] = clip(ends)?;
    // On which side of the triangle the shape is: by what is outside there, or by the edge where that says little.
    let facing = across.dot(outside);
    let facing = if facing.abs() > 0.3 || edge.outward == Vec3::ZERO {
        facing
    } else {
        across.dot(edge.outward)
    };
    let sign = 1.0_f32.copysign(facing);
    let normal = across * sign;
    // The far side of the shape.
    if normal.dot(edge.outward) < -0.1 {
        return None;
    }
    let [first, last] = [from.height * sign, to.height * sign];
    let height = first.max(last);
    if height > deepest || height + near <= 0.0 {
        return None;
    }
    // All along it if it lies flat, not at one end and then at the other.
    let part = match first - last {
        off if off.abs() < 0.05 * near => 0.5,
        off if off > 0.0 => 0.0,
        _ => 1.0,
    };
    Some(EdgeContact {
        weights: within(from.weights.lerp(to.weights, part)),
        normal,
        depth: height + near,
    })
}

/// A point as a triangle sees it.
#[derive(Debug, Clone, Copy)]
struct Placed {
    /// Barycentric weights of its projection.
    weights: Vec3,
    /// How far it is along the normal (m).
    height: f32,
}

/// The plane of a triangle.
struct Plane {
    origin: Vec3,
    normal: Vec3,
    /// Of the second and the third weight.
    gradients: [Vec3; 2],
}

impl Plane {
    /// `None` for a triangle without an area.
    fn of([a, b, c]: [Vec3; 3], normal: Vec3) -> Option<Self> {
        let (ab, ac) = (b - a, c - a);
        let double_area = ab.cross(ac).dot(normal);
        if double_area <= 0.0 {
            return None;
        }
        Some(Self {
            origin: a,
            normal,
            gradients: [
                ac.cross(normal) / double_area,
                normal.cross(ab) / double_area,
            ],
        })
    }

    fn place(&self, point: Vec3) -> Placed {
        let offset = point - self.origin;
        let [v, w] = self.gradients.map(|gradient| gradient.dot(offset));
        Placed {
            weights: Vec3::new(1.0 - v - w, v, w),
            height: self.normal.dot(offset),
        }
    }

    /// The contact of an edge that goes steeply through the triangle's plane with the side of the triangle that has come
    /// over it:
    ///
    /// ```text
    ///   |  edge, seen from its end: a point x in the triangle's plane
    ///   x-----o   from x inwards to the triangle's side o: so far has the triangle to go outwards
    /// ```
    fn beside(
        &self,
        [from, to]: [Placed; 2],
        edge: &SharpEdge,
        near: f32,
        deepest: f32,
    ) -> Option<EdgeContact> {
        let [begin, end] = edge.ends;
        let through = from.height - to.height;
        let is_steep = through.abs() > STEEP * begin.distance(end);
        if !is_steep || from.height * to.height > 0.0 {
            return None;
        }
        let part = from.height / through;
        let crossing = from.weights.lerp(to.weights, part);
        let in_plane = edge.outward - self.normal * self.normal.dot(edge.outward);
        let outwards = in_plane.try_normalize()?;
        // How the weights change with each metre inwards.
        let [v, w] = self.gradients.map(|gradient| -gradient.dot(outwards));
        let change = Vec3::new(-v - w, v, w);
        let (mut enters, mut leaves) = (f32::NEG_INFINITY, f32::INFINITY);
        for corner in 0..3 {
            let (weight, change) = (crossing[corner], change[corner]);
            if change < 0.0 {
                leaves = leaves.min(weight / -change);
            } else if change > 0.0 {
                enters = enters.max(-weight / change);
            } else if weight < 0.0 {
                return None;
            }
        }
        let depth = leaves + near;
        if enters > leaves || depth <= 0.0 || leaves > deepest {
            return None;
        }
        Some(EdgeContact {
            weights: within(crossing + change * leaves),
            normal: outwards,
            depth,
        })
    }
}

/// The part of a line that is above or below a triangle.
fn clip([from, to]: [Placed; 2]) -> Option<[Placed; 2]> {
    let (mut begin, mut end) = (0.0_f32, 1.0_f32);
    for corner in 0..3 {
        let (first, last) = (from.weights[corner] + BEYOND, to.weights[corner] + BEYOND);
        if first < 0.0 && last < 0.0 {
            return None;
        }
        let crossing = first / (first - last);
        if first < 0.0 {
            begin = begin.max(crossing);
        } else if last < 0.0 {
            end = end.min(crossing);
        }
    }
    let part = |part: f32| Placed {
        weights: from.weights.lerp(to.weights, part),
        height: from.height + (to.height - from.height) * part,
    };
    (begin <= end).then(|| [part(begin), part(end)])
}

/// Weights of a point of the triangle itself.
fn within(weights: Vec3) -> [f32; 3] {
    let inside = weights.max(Vec3::ZERO);
    (inside / inside.element_sum()).to_array()
}

/// How far the nearest edge is from a triangle of the shape's frame, if it is within so far (m), where from it, and its
/// nearest point.
pub(super) fn nearest_edge(
    shape: &ColliderShape,
    triangle: [Vec3; 3],
    around: f32,
) -> (f32, Vec3, Vec3) {
    let [a, b, c] = triangle;
    let around = Vec3::splat(around);
    let bounds = [a.min(b).min(c) - around, a.max(b).max(c) + around];
    let mut found = (f32::INFINITY, Vec3::ZERO, Vec3::ZERO);
    shape.edges_near(bounds, |edge: &SharpEdge| {
        let near = nearest(triangle, edge.ends);
        let distance = near.offset.length() - edge.radius;
        if distance < found.0 {
            let [from, to] = edge.ends;
            let outwards = near.offset.normalize_or_zero() * edge.radius;
            found = (
                distance,
                near.offset - outwards,
                from.lerp(to, near.along) + outwards,
            );
        }
    });
    found
}
