//! A plane between a particle's triangles and the edges of a shape near them.

use bevy::math::Vec3;

use super::{ColliderShape, fan_view::FanView, geometry::SharpEdge, shape_memory::Nearness};

/// Edges far from a particle are searched for again when it has moved by this many reaches of its triangles.
const FAR: f32 = 8.0;

/// A plane is searched for again when the particle has moved by this fraction of the distance at which edges touch.
const RENEWED: f32 = 0.25;

/// Where a particle was when the edges around it were searched for: all of them are beyond a distance from there, or
/// below a plane.
///
/// ```text
///   o---o---o   triangles      as long as they are above the plane by the reach of an
/// ------------- plane          edge, and within the distance, no edge touches them
///     ____/\__  shape
/// ```
#[derive(Debug, Clone, Copy)]
pub(super) struct Separation {
    /// The particle's position in the shape's frame (m); NaN before the first search.
    at: Vec3,
    /// No edge that sticks out of the plane is nearer to it (m).
    distance: f32,
    /// The plane's normal, and its height over the origin (m): −∞ if no edge is within the distance.
    normal: Vec3,
    height: f32,
}

impl Separation {
    pub const UNKNOWN: Self = Self {
        at: Vec3::NAN,
        distance: 0.0,
        normal: Vec3::Y,
        height: f32::NEG_INFINITY,
    };

    /// Displacement of everything before an edge can touch the triangles in view (m), at least. 0 or less if one may.
    pub fn room(&mut self, shape: &ColliderShape, view: &FanView, near: Nearness) -> f32 {
        let moved = view.own.distance(self.at);
        let left = self.left(moved, view, near);
        // False for NaN.
        if left > 0.0 || (self.height.is_finite() && moved < RENEWED * near.reach) {
            return left;
        }
        self.search(shape, view, near);
        self.left(0.0, view, near)
    }

    /// The room of all triangles after the particle has `moved` this far (m).
    fn left(&self, moved: f32, view: &FanView, near: Nearness) -> f32 {
        let inside = self.inside(moved, view, near);
        let above = self.above(view.corners(), view, near);
        if above < inside { above } else { inside }
    }

    /// The room of one of the triangles (m).
    pub fn room_of(&self, triangle: [Vec3; 3], view: &FanView, near: Nearness) -> f32 {
        let inside = self.inside(view.own.distance(self.at), view, near);
        let above = self.above(&triangle, view, near);
        if above < inside { above } else { inside }
    }

    /// Displacement before they come near an edge beyond the distance (m).
    fn inside(&self, moved: f32, view: &FanView, near: Nearness) -> f32 {
        (self.distance - moved - view.extent) * (1.0 - 1.0e-4) - near.reach
    }

    /// Displacement of corners before they come near an edge below the plane (m).
    fn above(&self, corners: &[Vec3], view: &FanView, near: Nearness) -> f32 {
        let heights = corners.iter().map(|&corner| self.normal.dot(corner));
        let lowest = heights.fold(f32::INFINITY, f32::min);
        let rounding = 1.0e-6 * (view.own.length() + view.extent);
        lowest - self.height - near.reach - rounding
    }

    fn search(&mut self, shape: &ColliderShape, view: &FanView, near: Nearness) {
        self.at = view.own;
        self.height = f32::NEG_INFINITY;
        let within = FAR * view.extent + 2.0 * near.reach;
        let distance = shape.edge_distance(self.at, within, near.smooth);
        let around = view.extent + near.reach + near.slack;
        self.distance = distance.min(within);
        if self.distance > around {
            return;
        }
        self.distance = around;
        self.normal = shape.normal_at(self.at);
        let bounds = [self.at - around, self.at + around];
        let (at, normal, mut height) = (self.at, self.normal, self.height);
        shape.edges_near(bounds, near.smooth, |_, edge| {
            if let Some(ends) = part_within(edge, at, around + edge.radius) {
                let [from, to] = ends.map(|end| normal.dot(end));
                height = height.max(from.max(to) + edge.radius);
            }
        });
        self.height = height;
    }
}

/// The part of an edge within a distance of a point (m).
fn part_within(edge: &SharpEdge, point: Vec3, distance: f32) -> Option<[Vec3; 2]> {
    let [begin, end] = edge.ends;
    let (along, offset) = (end - begin, point - begin);
    let square = along.length_squared();
    if square == 0.0 {
        return (offset.length() <= distance).then_some(edge.ends);
    }
    let part = offset.dot(along) / square;
    let left = distance * distance - offset.distance_squared(along * part);
    if left < 0.0 {
        return None;
    }
    let half = (left / square).sqrt();
    let [first, last] = [(part - half).max(0.0), (part + half).min(1.0)];
    (first <= last).then(|| [begin + along * first, begin + along * last])
}
