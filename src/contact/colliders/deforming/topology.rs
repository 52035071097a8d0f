//! The faces of a mesh, their neighbours, and a tree over them.

use std::ops::Range;

#[cfg(feature = "mesh")]
use bevy::math::Vec3;

use crate::cloth::Grouped;
#[cfg(feature = "mesh")]
use crate::contact::colliders::geometry::{MeshEdges, volume};

/// There is no face beside this side.
pub(super) const NONE: u32 = u32::MAX;

/// Faces of a leaf of the tree.
#[cfg(feature = "mesh")]
const LEAF: usize = 4;

/// The faces of a mesh, wherever its vertices are.
#[derive(Debug, Default)]
pub(crate) struct Topology {
    /// The vertices of each face, in the order of the tree.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The face beside each side: from the first corner to the second, from there to the third, and back.
    pub(super) beside: Vec<[u32; 3]>,
    /// The nodes of the tree, each before those below it.
    pub(super) nodes: Vec<Node>,
    /// The faces of each vertex.
    pub(super) around: Grouped<u32>,
}

/// A node of the tree. Its first child follows it.
#[derive(Debug, Default)]
pub(super) struct Node {
    /// The faces of a leaf; none of any other node.
    pub faces: Range<u32>,
    /// Its second child.
    pub second: u32,
}

#[cfg(feature = "mesh")]
impl Topology {
    /// Triangles between vertices (m), which say only what is near what, and which side is the outer one: a closed mesh that
    /// is inside out is turned. Triangles with fewer than three vertices are left out.
    pub fn new(vertices: &[Vec3], mut triangles: Vec<[u32; 3]>) -> Self {
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        let places = |triangle: &[u32; 3]| triangle.map(|corner| vertices[corner as usize]);
        let edges = MeshEdges::of(&triangles);
        if edges.are_closed() && volume(vertices, &triangles) < 0.0 {
            triangles
                .iter_mut()
                .for_each(|triangle| triangle.swap(1, 2));
        }
        let mut new = Self::default();
        let count = triangles.len();
        new.split(&mut triangles, 0..count, &|triangle| {
            places(triangle).into_iter().sum()
        });
        new.triangles = triangles;
        new.find_neighbours(vertices.len());
        new
    }

    /// Adds the node of a range of triangles, and those below it, and sorts them.
    fn split(
        &mut self,
        triangles: &mut [[u32; 3]],
        of: Range<usize>,
        middle: &impl Fn(&[u32; 3]) -> Vec3,
    ) {
        let own = self.nodes.len();
        self.nodes.push(Node::default());
        if of.len() <= LEAF {
            self.nodes[own].faces = of.start as u32..of.end as u32;
            return;
        }
        let all = &mut triangles[of.clone()];
        let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let middles = all.iter().map(middle);
        let [low, high] = middles.fold(empty, |[low, high], at| [low.min(at), high.max(at)]);
        let axis = (high - low).max_position();
        let half = all.len() / 2;
        all.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        let half = of.start + half;
        self.split(triangles, of.start..half, middle);
        self.nodes[own].second = self.nodes.len() as u32;
        self.split(triangles, half..of.end, middle);
    }

    fn find_neighbours(&mut self, vertices: usize) {
        self.beside = vec![[NONE; 3]; self.triangles.len()];
        for sides in MeshEdges::of(&self.triangles).edges() {
            // An edge where more than two meet is a border.
            let [a, b] = sides else {
                continue;
            };
            if a.is_forward == b.is_forward {
                continue;
            }
            for (own, other) in [(a, b), (b, a)] {
                let corners = self.triangles[own.face as usize];
                let is_opposite = |corner: &u32| !own.vertices.contains(corner);
                if let Some(opposite) = corners.iter().position(is_opposite) {
                    self.beside[own.face as usize][(opposite + 1) % 3] = other.face;
                }
            }
        }
        let corners = || {
            let faces = (0..).zip(&self.triangles);
            faces.flat_map(|(face, corners)| corners.map(|corner| (corner, face)))
        };
        self.around = Grouped::new(vertices, corners);
    }
}
