//! Meshes that deform: skinned bodies.

mod skinned;
mod topology;

use std::sync::Arc;

use bevy::{math::Vec3, reflect::Reflect};
pub(crate) use skinned::SkinnedTriangles;
pub(crate) use topology::Topology;

use super::{
    geometry::towards,
    nearest::Nearest,
    triangle::{at, nearest_to_point},
};
use topology::NONE;

use crate::cloth::MapInline;

/// A mesh whose vertices move along straight lines in the tick, in its own frame. The outer side of a face is the one from
/// which its corners run counter-clockwise. Clones share the data. Two are equal if they are of the same
/// mesh, with the same positions.
#[derive(Reflect, Debug, Clone)]
#[type_path = "bevy_drape"]
#[reflect(opaque, Debug, Clone, PartialEq)]
pub struct DeformingMesh(Arc<Deformed>);

#[derive(Debug, Default, Clone)]
struct Deformed {
    topology: Arc<Topology>,
    /// Positions of the vertices at the beginning and at the end of the tick (m).
    ends: [Vec<Vec3>; 2],
    /// By the nodes of the tree.
    boxes: Vec<Boxes>,
    /// Largest displacement of a vertex in the tick (m).
    farthest_move: f32,
    /// Whether the outer side of a face is the one from which its corners run clockwise.
    is_mirrored: bool,
}

impl PartialEq for DeformingMesh {
    fn eq(&self, other: &Self) -> bool {
        let same = |own: &Deformed, other: &Deformed| {
            Arc::ptr_eq(&own.topology, &other.topology)
                && own.is_mirrored == other.is_mirrored
                && own.ends == other.ends
        };
        Arc::ptr_eq(&self.0, &other.0) || same(&self.0, &other.0)
    }
}

/// Boxes around the faces below a node.
#[derive(Debug, Clone, Copy)]
struct Boxes {
    /// As the tick begins and ends (m).
    ends: [[Vec3; 2]; 2],
    /// Around the displacements of their corners in the tick (m).
    moved: [Vec3; 2],
}

/// The point of the surface that is nearest to another.
#[derive(Debug, Clone, Copy)]
struct OnFace {
    face: u32,
    corners: [Vec3; 3],
    /// Barycentric weights of its corners.
    weights: [f32; 3],
}

impl OnFace {
    #[inline]
    fn place(&self) -> Vec3 {
        at(self.corners, self.weights)
    }
}

impl DeformingMesh {
    /// A mesh with its vertices at these positions (m) at the beginning and at the end of the tick, one for each vertex of
    /// the topology. `write` returns whether the mesh is mirrored.
    pub(crate) fn new(
        topology: &Arc<Topology>,
        write: impl FnOnce(&mut [Vec<Vec3>; 2]) -> bool,
    ) -> Self {
        let mut new = Self(Arc::new(Deformed {
            topology: topology.clone(),
            ..Deformed::default()
        }));
        new.write(write);
        new
    }

    /// Writes its vertices' positions for another tick, if no clone is left. Returns whether there was none.
    pub(crate) fn write(&mut self, write: impl FnOnce(&mut [Vec<Vec3>; 2]) -> bool) -> bool {
        let Some(deformed) = Arc::get_mut(&mut self.0) else {
            return false;
        };
        deformed.is_mirrored = write(&mut deformed.ends);
        deformed.refit();
        true
    }

    /// The minimum and maximum corners of its bounding box along its whole path (m).
    pub fn bounds(&self) -> [Vec3; 2] {
        let [from, to] = self.0.boxes.first().map(|of| of.ends).unwrap_or_default();
        union(from, to)
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.0.topology.triangles.len()
    }

    /// Largest displacement of a vertex in the tick (m).
    pub fn farthest_move(&self) -> f32 {
        self.0.farthest_move
    }

    /// The surface nearest to a point (m) at a fraction of the tick. A point is inside if it is behind the nearest
    /// face, edge or vertex, unless that is at a border. NaN for a point that is not finite.
    pub(crate) fn nearest(&self, part: f32, point: Vec3) -> Nearest {
        self.moving_nearest(part, point).0
    }

    /// The same, and the displacement of that surface in the tick (m).
    pub(crate) fn moving_nearest(&self, part: f32, point: Vec3) -> (Nearest, Vec3) {
        let deformed = &*self.0;
        let Some(on_face) = deformed.nearest_face(part, point) else {
            let distance = f32::NAN;
            let normal = Vec3::Y;
            return (Nearest { distance, normal }, Vec3::ZERO);
        };
        let surface = on_face.place();
        let out = deformed.out(part, &on_face);
        let is_inside = out.is_some_and(|out| out.dot(point - surface) < 0.0);
        let normal = deformed.normal(on_face.corners).normalize_or(Vec3::Y);
        let nearest = towards(point, surface, is_inside, normal);
        (nearest, deformed.displacement(&on_face))
    }

    /// A lower bound of the distance from the surface, at any time of the tick, of a point that moves by `displacement` in it
    /// (m), and that is here at a fraction of it.
    pub(crate) fn clearance(&self, part: f32, point: Vec3, displacement: Vec3) -> f32 {
        self.0.clearance(part, point, displacement)
    }

    /// Displacement in the tick of the surface that is nearest to a point at a fraction of the tick (m).
    pub(crate) fn displacement_at(&self, part: f32, point: Vec3) -> Vec3 {
        let found = self.0.nearest_face(part, point);
        found.map_or(Vec3::ZERO, |on_face| self.0.displacement(&on_face))
    }
}

impl Deformed {
    /// Fits the boxes to the positions.
    fn refit(&mut self) {
        let [from, to] = &self.ends;
        let ends = from.iter().zip(to);
        let moved = ends.map(|(from, to)| from.distance_squared(*to));
        self.farthest_move = moved.fold(0.0, f32::max).sqrt();
        let (triangles, nodes) = (&self.topology.triangles, &self.topology.nodes);
        self.boxes.resize(nodes.len(), Boxes::EMPTY);
        for (index, node) in nodes.iter().enumerate().rev() {
            self.boxes[index] = if node.faces.is_empty() {
                self.boxes[index + 1].with(&self.boxes[node.second as usize])
            } else {
                let faces = &triangles[node.faces.start as usize..node.faces.end as usize];
                let corners = faces.as_flattened().iter();
                corners.fold(Boxes::EMPTY, |boxes, &corner| {
                    let [from, to] = [from, to].map_inline(|end| end[corner as usize]);
                    boxes.with(&Boxes {
                        ends: [[from; 2], [to; 2]],
                        moved: [to - from; 2],
                    })
                })
            };
        }
    }

    /// The corners of a face at a fraction of the tick (m).
    fn corners(&self, face: u32, part: f32) -> [Vec3; 3] {
        let [from, to] = &self.ends;
        let corners = self.topology.triangles[face as usize];
        corners.map_inline(|corner| from[corner as usize].lerp(to[corner as usize], part))
    }

    fn nearest_face(&self, part: f32, point: Vec3) -> Option<OnFace> {
        let on_face = |face: u32| {
            let corners = self.corners(face, part);
            OnFace {
                face,
                corners,
                weights: nearest_to_point(corners, point),
            }
        };
        let near = |of: &Boxes| of.distance_squared(part, point);
        let distance = |face: u32| on_face(face).place().distance_squared(point);
        let (_, face) = self.least(near, distance)?;
        Some(on_face(face))
    }

    /// From the distances of the faces, and their displacements relative to that of the point.
    fn clearance(&self, part: f32, point: Vec3, displacement: Vec3) -> f32 {
        let [from, to] = &self.ends;
        let left = part.max(1.0 - part);
        let of_box = |of: &Boxes| {
            let [low, high] = of.moved.map_inline(|moved| (moved - displacement).abs());
            of.distance_squared(part, point).sqrt() - low.max(high).length() * left
        };
        let of_face = |face: u32| {
            let corners = self.corners(face, part);
            let distance = at(corners, nearest_to_point(corners, point)).distance(point);
            let triangle = self.topology.triangles[face as usize];
            let moved = triangle.map_inline(|corner| {
                let corner = corner as usize;
                (to[corner] - from[corner]).distance_squared(displacement)
            });
            distance - moved.into_iter().fold(0.0, f32::max).sqrt() * left
        };
        self.least(of_box, of_face).map_or(0.0, |(least, _)| least)
    }

    /// The face of the smallest `cost`, the first of several, and that. No face below a node costs less than its `bound`.
    fn least(
        &self,
        bound: impl Fn(&Boxes) -> f32,
        cost: impl Fn(u32) -> f32,
    ) -> Option<(f32, u32)> {
        let mut best: Option<(f32, u32)> = None;
        self.descend(0, &bound, &cost, &mut best);
        best
    }

    fn descend(
        &self,
        node: usize,
        bound: &impl Fn(&Boxes) -> f32,
        cost: &impl Fn(u32) -> f32,
        best: &mut Option<(f32, u32)>,
    ) {
        let of = &self.topology.nodes[node];
        for face in of.faces.clone() {
            let own = cost(face);
            let is_better =
                best.is_none_or(|(least, known)| own < least || own == least && face < known);
            if is_better && own.is_finite() {
                *best = Some((own, face));
            }
        }
        if !of.faces.is_empty() {
            return;
        }
        let mut children =
            [node + 1, of.second as usize].map_inline(|child| (bound(&self.boxes[child]), child));
        if children[1].0 < children[0].0 {
            children.swap(0, 1);
        }
        for (least, child) in children {
            if best.is_none_or(|(known, _)| least <= known) {
                self.descend(child, bound, cost, best);
            }
        }
    }

    /// Displacement of a point of the surface in the tick (m).
    fn displacement(&self, of: &OnFace) -> Vec3 {
        let [from, to] = &self.ends;
        let corners = self.topology.triangles[of.face as usize];
        let moved = corners.map_inline(|corner| to[corner as usize] - from[corner as usize]);
        at(moved, of.weights)
    }

    /// A vector that points out of the surface where a point of it is nearest to others: the normal of a face, the mean of
    /// the two of an edge, or of those around a vertex by their angles (Bærentzen and Aanæs 2005). `None` at a border.
    fn out(&self, part: f32, of: &OnFace) -> Option<Vec3> {
        let (triangles, beside) = (&self.topology.triangles, &self.topology.beside);
        let own = self.normal(of.corners).normalize_or_zero();
        let zeros = of.weights.map_inline(|weight| weight == 0.0);
        let around = |vertex: u32| {
            let faces = self.topology.around.of(vertex);
            let mut sum = Vec3::ZERO;
            for &face in faces {
                let corners = self.corners(face, part);
                let mut vertices = triangles[face as usize].iter();
                let at = vertices.position(|&corner| corner == vertex)?;
                let others = beside[face as usize];
                if others[at] == NONE || others[(at + 2) % 3] == NONE {
                    return None;
                }
                let [a, b, c] = [0, 1, 2].map_inline(|next| corners[(at + next) % 3]);
                // A face without an area has no angles.
                let angle = (b - a).angle_between(c - a);
                if angle.is_finite() {
                    sum += self.normal(corners).normalize_or_zero() * angle;
                }
            }
            Some(sum)
        };
        let vertices = triangles[of.face as usize];
        match zeros {
            [false, true, true] => around(vertices[0]),
            [true, false, true] => around(vertices[1]),
            [true, true, false] => around(vertices[2]),
            [false, false, false] | [true, true, true] => Some(own),
            // The side opposite of the corner without a weight begins at the next one.
            _ => {
                let opposite = zeros.iter().position(|is_zero| *is_zero)?;
                let other = beside[of.face as usize][(opposite + 1) % 3];
                (other != NONE)
                    .then(|| own + self.normal(self.corners(other, part)).normalize_or_zero())
            }
        }
    }

    /// The normal of a face, as long as twice its area (m²).
    fn normal(&self, [a, b, c]: [Vec3; 3]) -> Vec3 {
        let normal = (b - a).cross(c - a);
        if self.is_mirrored { -normal } else { normal }
    }
}

impl Boxes {
    const EMPTY: Self = {
        let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        Self {
            ends: [empty; 2],
            moved: empty,
        }
    };

    fn with(&self, other: &Self) -> Self {
        Self {
            ends: [0, 1].map_inline(|end| union(self.ends[end], other.ends[end])),
            moved: union(self.moved, other.moved),
        }
    }

    /// Squared distance of a point from the faces at a fraction of the tick, at least (m²): what moves along straight lines
    /// between two boxes is in the box between them.
    fn distance_squared(&self, part: f32, point: Vec3) -> f32 {
        let [from, to] = self.ends;
        let [low, high] = [0, 1].map_inline(|corner: usize| from[corner].lerp(to[corner], part));
        point.distance_squared(point.max(low).min(high))
    }
}

fn union([low, high]: [Vec3; 2], [other_low, other_high]: [Vec3; 2]) -> [Vec3; 2] {
    [low.min(other_low), high.max(other_high)]
}
