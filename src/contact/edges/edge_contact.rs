//! Tests of a cloth triangle against the edges of a shape.

use bevy::math::{Isometry3d, Vec3};

use crate::cloth::MapInline;
use crate::contact::colliders::{ColliderShape, SharpEdge, nearest};

/// An edge counts as below a triangle up to this far beyond its sides, in barycentric weights, so that neighbours leave
/// no gap.
pub(crate) const BEYOND: f32 = 0.05;
/// Largest depth of an edge through a triangle, in lengths of the triangle's longest side.
pub(crate) const DEEPEST: f32 = 0.5;

/// Above this sine of the angle between them, an edge is steep to a triangle's plane.
pub(crate) const STEEP: f32 = 0.5;
/// Above this cosine, the outward direction says on which side of a triangle the shape lies.
const CLEAR: f32 = 0.3;
/// Above this sine, a triangle whose normal points into the shape at an edge is on the shape's far side.
pub(crate) const FAR_SIDE: f32 = 0.1;

/// The point where an edge comes nearest to a triangle, or passes through it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EdgeContact {
    pub weights: [f32; 3],
    /// Normal of the triangle, away from the shape, of length 1.
    pub normal: Vec3,
    /// Distance that its point has to move (m).
    pub depth: f32,
    /// Whether the triangle lies below the shape: the normal that its corners give points into it. `None` where the edge is beside it.
    pub is_below: Option<bool>,
}

/// A triangle in the shape's frame, tested against edges one by one.
pub(crate) struct EdgeTest<'a> {
    pub shape: &'a ColliderShape,
    bounds: [Vec3; 2],
    pub plane: Plane,
    pub reach: f32,
    /// The longest side (m).
    pub longest: f32,
    pub middle: Vec3,
    /// Whether the triangle lies below the shape, if that is known.
    pub is_below: Option<bool>,
    /// The contacts with the nearest edge, or with the deepest one through it, if the triangle lies above the shape, and if it lies
    /// below.
    found: [Option<EdgeContact>; 2],
}

impl<'a> EdgeTest<'a> {
    /// `None` for a triangle without an area.
    #[inline]
    pub fn new(shape: &'a ColliderShape, triangle: [Vec3; 3], reach: f32) -> Option<Self> {
        let [a, b, c] = triangle;
        let plane = Plane::of(triangle)?;
        let longest = a
            .distance_squared(b)
            .max(b.distance_squared(c))
            .max(c.distance_squared(a));
        Some(Self {
            shape,
            bounds: bounds_of(triangle, reach),
            plane,
            reach,
            longest: longest.sqrt(),
            middle: (a + b + c) / 3.0,
            is_below: None,
            found: [None; 2],
        })
    }

    /// Tests it against an edge.
    #[inline]
    pub fn see(&mut self, edge: &SharpEdge) {
        let [begin, end] = edge.ends;
        let [from, to] = [self.plane.place(begin), self.plane.place(end)];
        let near = self.reach * edge.part + edge.radius;
        let is_on_one_side = from.height * to.height > 0.0;
        // Entirely on one side, and too far away.
        if is_on_one_side && from.height.abs().min(to.height.abs()) > near {
            return;
        }
        // Beside it.
        let beyond = from.weights.max(to.weights).min_element() + BEYOND < 0.0;
        if is_on_one_side && beyond || self.is_beyond(edge) {
            return;
        }
        let over = match clip([from, to]) {
            Some(ends) if !beyond => self.over(ends, edge, near),
            _ => [None; 2],
        };
        let deepest = DEEPEST * self.longest;
        let beside = self.plane.beside([from, to], edge, near, deepest);
        for (found, over) in self.found.iter_mut().zip(over) {
            // Through it: the shorter way out counts.
            let contact = match (over, beside) {
                (Some(over), Some(beside)) if beside.depth < over.depth => Some(beside),
                (Some(over), _) => Some(over),
                (None, beside) => beside,
            };
            if let Some(contact) = contact
                && found.is_none_or(|found| contact.depth > found.depth)
            {
                *found = Some(contact);
            }
        }
    }

    /// The contact on the side of the shape on which the triangle lies. Unless that is known, the outward direction at the triangle's
    /// middle says it. Where that is unclear, the shorter way out does.
    #[inline]
    pub fn contact(&self) -> Option<EdgeContact> {
        let [above, below] = self.found;
        let is_over =
            |contact: &Option<EdgeContact>| contact.is_some_and(|of| of.is_below.is_some());
        if !is_over(&above) && !is_over(&below) {
            return below;
        }
        let is_below = self.is_below.unwrap_or_else(|| self.lies_below());
        self.found[usize::from(is_below)]
    }

    fn lies_below(&self) -> bool {
        let nearest = self.shape.nearest(Isometry3d::IDENTITY, self.middle);
        let facing = self.plane.normal.dot(nearest.normal);
        let depth = |side: usize| {
            let over = self.found[side].filter(|contact| contact.is_below.is_some());
            over.map_or(f32::INFINITY, |contact| contact.depth)
        };
        if facing.abs() > CLEAR || depth(0) == depth(1) {
            facing.is_sign_negative()
        } else {
            depth(1) < depth(0)
        }
    }

    /// Whether the bounding boxes of an edge and of the triangle's reach are disjoint. A box has so few edges that all
    /// are tested, including edges that have passed all through the triangle.
    #[inline]
    fn is_beyond(&self, edge: &SharpEdge) -> bool {
        let [lower, upper] = edge.corners();
        let is_beyond = lower.cmpgt(self.bounds[1]).any() || upper.cmplt(self.bounds[0]).any();
        is_beyond && matches!(self.shape, ColliderShape::Geometry(_))
    }

    /// The contacts of an edge that touches the triangle, or passes through it, along the triangle's normal: if the triangle lies above
    /// the shape, and if it lies below.
    #[inline]
    fn over(
        &self,
        [from, to]: [Placed; 2],
        edge: &SharpEdge,
        near: f32,
    ) -> [Option<EdgeContact>; 2] {
        let deepest = DEEPEST * self.longest;
        let normal = self.plane.normal;
        let contact = |sign: f32| {
            let height = (from.height * sign).max(to.height * sign);
            // The shape's far side has no contact, nor does an edge too far away.
            let is_far_side = normal.dot(edge.outward) * sign < -FAR_SIDE;
            let touches = !is_far_side && height <= deepest && height + near > 0.0;
            touches.then(|| over([from, to], normal * sign, sign, near))
        };
        [contact(1.0), contact(-1.0)]
    }
}

/// The bounding box of a triangle, enlarged by a distance (m).
pub(crate) fn bounds_of([a, b, c]: [Vec3; 3], around: f32) -> [Vec3; 2] {
    let around = Vec3::splat(around);
    [a.min(b).min(c) - around, a.max(b).max(c) + around]
}

/// The contact of the part of an edge that touches a triangle, or passes through it, on the side of a sign.
#[inline]
fn over([from, to]: [Placed; 2], normal: Vec3, sign: f32, near: f32) -> EdgeContact {
    let [first, last] = [from.height * sign, to.height * sign];
    // The middle of it if it lies flat, so that the contact does not jump from end to end.
    let part = match first - last {
        off if off.abs() < 0.05 * near => 0.5,
        off if off > 0.0 => 0.0,
        _ => 1.0,
    };
    EdgeContact {
        weights: within(from.weights.lerp(to.weights, part)),
        normal,
        depth: first.max(last) + near,
        is_below: Some(sign < 0.0),
    }
}

/// A point relative to a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed {
    /// Barycentric weights of its projection.
    pub weights: Vec3,
    /// Height along the normal (m).
    pub height: f32,
}

impl Placed {
    #[inline]
    pub fn lerp(self, other: Self, part: f32) -> Self {
        Self {
            weights: self.weights.lerp(other.weights, part),
            height: self.height + (other.height - self.height) * part,
        }
    }
}

/// The plane of a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    origin: Vec3,
    pub normal: Vec3,
    /// Gradients of the second and the third weight.
    pub gradients: [Vec3; 2],
}

impl Plane {
    /// `None` for a triangle without an area.
    #[inline]
    fn of([a, b, c]: [Vec3; 3]) -> Option<Self> {
        let (ab, ac) = (b - a, c - a);
        let across = ab.cross(ac);
        let normal = across.try_normalize()?;
        let double_area = across.dot(normal);
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

    #[inline]
    pub fn place(&self, point: Vec3) -> Placed {
        let offset = point - self.origin;
        let [v, w] = self.gradients;
        let [v, w] = [v.dot(offset), w.dot(offset)];
        Placed {
            weights: Vec3::new(1.0 - v - w, v, w),
            height: self.normal.dot(offset),
        }
    }

    /// The contact of an edge that is steep to the triangle's plane, with the side of the triangle that has passed over
    /// it:
    ///
    /// ```text
    ///   |  edge, seen from its end: a point x in the triangle's plane
    ///   x-----o   from x inwards to the triangle's side o: the triangle moves outwards by this much
    /// ```
    #[inline]
    fn beside(
        &self,
        [from, to]: [Placed; 2],
        edge: &SharpEdge,
        near: f32,
        deepest: f32,
    ) -> Option<EdgeContact> {
        let through = from.height - to.height;
        if !is_steep([from, to], edge) || from.height * to.height > 0.0 {
            return None;
        }
        let part = from.height / through;
        let crossing = from.weights.lerp(to.weights, part);
        let in_plane = edge.outward - self.normal * self.normal.dot(edge.outward);
        let outwards = in_plane.try_normalize()?;
        // Change of the weights per metre inwards.
        let [v, w] = self.gradients.map_inline(|of| -of.dot(outwards));
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
            is_below: None,
        })
    }
}

/// Whether an edge goes steeply through a triangle's plane.
#[inline]
fn is_steep([from, to]: [Placed; 2], edge: &SharpEdge) -> bool {
    let [begin, end] = edge.ends;
    (from.height - to.height).abs() > STEEP * begin.distance(end)
}

/// The part of a line that is above or below a triangle.
#[inline]
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
    (begin <= end).then(|| [from.lerp(to, begin), from.lerp(to, end)])
}

/// Weights of a point of the triangle itself.
#[inline]
fn within(weights: Vec3) -> [f32; 3] {
    let inside = weights.max(Vec3::ZERO);
    (inside / inside.element_sum()).to_array()
}

/// The edge nearest to a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NearEdge {
    /// Distance of the triangle (m): larger than it is by what the edge touches at less than the reach.
    pub distance: f32,
    /// Whether the triangle is nearer than half of the distance at which the edge touches.
    pub is_close: bool,
    /// From the edge's nearest point (m), and that point.
    pub offset: Vec3,
    pub centre: Vec3,
}

impl NearEdge {
    /// The edge of a shape that a triangle in its frame comes to first, if one is within a distance (m). Edges touch
    /// within `reach` (m). Those of a surface with a radius of at least `smooth` (m) are none.
    pub fn of(
        shape: &ColliderShape,
        triangle: [Vec3; 3],
        around: f32,
        [reach, smooth]: [f32; 2],
    ) -> Self {
        let mut found = Self {
            distance: f32::INFINITY,
            is_close: false,
            offset: Vec3::ZERO,
            centre: Vec3::ZERO,
        };
        let within = bounds_of(triangle, around);
        shape.edges_near(within, smooth, |_, edge| {
            let near = nearest(triangle, edge.ends);
            let apart = near.offset.length() - edge.radius;
            let touch = reach * edge.part;
            let distance = apart + (reach - touch);
            if distance < found.distance {
                let [from, to] = edge.ends;
                let outwards = near.offset.normalize_or_zero() * edge.radius;
                found = Self {
                    distance,
                    is_close: apart < touch / 2.0,
                    offset: near.offset - outwards,
                    centre: from.lerp(to, near.along) + outwards,
                };
            }
        });
        found
    }
}
