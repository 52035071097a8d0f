//! The search structure of a surface, for contact with itself and with others.

use std::sync::Arc;

use bevy::{math::Vec3A, platform::collections::HashSet};

use super::{
    bounds::{Bounds, Tangents},
    flat::{Masks, tangents_of_all},
};
use crate::{
    cloth::{ClothParticles, Layout, Surface},
    hierarchy::QuadTree,
};

/// A surface with its edges and the nodes of its tree, for contact of cloth with cloth. It depends only on the rest
/// shape, is built once, and is shared.
#[derive(Debug, Default)]
pub(crate) struct Sheet {
    surface: Arc<Surface>,
    /// Edges of faces, each owned by one particle.
    edges: Vec<[u32; 2]>,
    /// First edge of each particle; one more entry than particles.
    first_edge: Vec<u32>,
    nodes: Vec<Node>,
    /// Bounds of each node's faces at rest (m).
    rest: Vec<Bounds>,
    /// For a grid, the layout of its nodes on each level.
    lattice: Vec<Lattice>,
    closest: f32,
    masks: Masks,
}

/// A node of the tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub level: u32,
    children: [u32; 4],
    child_count: u32,
    /// The particle of a leaf.
    pub particle: u32,
}

impl Node {
    pub fn children(&self) -> &[u32] {
        &self.children[..self.child_count as usize]
    }

    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }
}

/// The nodes of one level of a grid's tree, row by row.
#[derive(Debug, Clone, Copy)]
struct Lattice {
    first: u32,
    columns: u32,
}

impl Sheet {
    /// Builds it from a surface and its tree.
    ///
    /// # Panics
    /// If the tree belongs to another surface.
    pub fn new(surface: &Arc<Surface>, tree: &QuadTree) -> Self {
        assert!(
            tree.validate(surface.len()).is_ok(),
            "the tree belongs to another surface"
        );
        let mut seen = HashSet::new();
        let (mut edges, mut first_edge) = (Vec::new(), vec![0]);
        for particle in 0..surface.len() as u32 {
            for &[a, b, c] in surface.faces().of(particle) {
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    let edge = [from.min(to), from.max(to)];
                    if seen.insert(edge) {
                        edges.push(edge);
                    }
                }
            }
            first_edge.push(edges.len() as u32);
        }
        let nodes = (0..tree.len() as u32).map(|index| {
            let node = tree.node(index);
            let mut children = [0; 4];
            let child_count = node.children().len();
            children[..child_count].copy_from_slice(node.children());
            Node {
                level: node.level as u32,
                children,
                child_count: child_count as u32,
                particle: node.middle,
            }
        });
        let lattice = tree.lattice().map(|levels| {
            let levels = levels.into_iter();
            let lattice = levels.map(|(first, columns)| Lattice { first, columns });
            lattice.collect()
        });
        let closest = surface.as_grid().map_or(0.0, |grid| {
            let [across, down] = grid.spacing().to_array();
            across * down / across.hypot(down)
        });
        let mut sheet = Self {
            surface: surface.clone(),
            edges,
            first_edge,
            nodes: nodes.collect(),
            rest: Vec::new(),
            lattice: lattice.unwrap_or_default(),
            closest,
            masks: Masks::new(Layout::of(surface)),
        };
        let rest: Vec<Vec3A> = surface
            .rest_positions()
            .iter()
            .map(|&position| position.into())
            .collect();
        let mut bounds = Vec::new();
        sheet.bounds(&rest, &mut bounds);
        sheet.rest = bounds;
        sheet
    }

    /// The surface.
    pub fn surface(&self) -> &Arc<Surface> {
        &self.surface
    }

    /// For a grid, the smallest distance at rest between two features without a common particle (m): from a corner of a
    /// cell to its diagonal. 0 for a mesh.
    pub(super) fn closest(&self) -> f32 {
        self.closest
    }

    pub(super) fn node(&self, node: u32) -> &Node {
        &self.nodes[node as usize]
    }

    /// Faces that a particle owns.
    pub(super) fn faces_of(&self, particle: u32) -> &[[u32; 3]] {
        self.surface.faces().of(particle)
    }

    /// Edges that a particle owns.
    pub(super) fn edges_of(&self, particle: u32) -> &[[u32; 2]] {
        let particle = particle as usize;
        &self.edges[self.first_edge[particle] as usize..self.first_edge[particle + 1] as usize]
    }

    /// Lower bound of the distance at rest between the faces of two nodes (m).
    pub(super) fn rest_distance(&self, a: u32, b: u32) -> f32 {
        self.rest[a as usize].distance(&self.rest[b as usize])
    }

    /// For a grid, the nodes of the smallest rectangle around two nodes of one level, if they are near each other.
    pub(super) fn around(&self, a: u32, b: u32) -> Option<impl Iterator<Item = u32> + use<>> {
        let Lattice { first, columns } =
            *self.lattice.get(self.nodes[a as usize].level as usize)?;
        let [a, b] = [a, b].map(|node| ((node - first) / columns, (node - first) % columns));
        let (top, bottom) = (a.0.min(b.0), a.0.max(b.0));
        let (left, right) = (a.1.min(b.1), a.1.max(b.1));
        let is_near = bottom - top <= MAX_APART && right - left <= MAX_APART;
        let node = move |row| (left..=right).map(move |column| first + row * columns + column);
        is_near.then(|| (top..=bottom).flat_map(node))
    }

    /// Computes the bounds of each node's faces, for particles at `positions` (m).
    pub(super) fn bounds(&self, positions: &[Vec3A], bounds: &mut Vec<Bounds>) {
        bounds.clear();
        bounds.resize(self.nodes.len(), Bounds::EMPTY);
        // Children come after their parents.
        for (index, node) in self.nodes.iter().enumerate().rev() {
            bounds[index] = if node.is_leaf() {
                let corners = self.faces_of(node.particle).iter().flatten();
                let own = Bounds::at(positions[node.particle as usize]);
                corners.fold(own, |bounds, &corner| {
                    bounds.with(positions[corner as usize])
                })
            } else {
                let children = node.children().iter();
                children.fold(Bounds::EMPTY, |joined, &child| {
                    joined.join(&bounds[child as usize])
                })
            };
        }
    }

    /// Computes the tangents of each node of a grid, for particles at `positions` (m); none for a mesh.
    pub(super) fn tangents(&self, positions: &[Vec3A], tangents: &mut Vec<Tangents>) {
        tangents.clear();
        let Some(grid) = self.surface.as_grid() else {
            return;
        };
        let (columns, per_metre) = (grid.columns() as usize, grid.spacing().recip());
        tangents.resize(self.nodes.len(), Tangents::EMPTY);
        for (index, node) in self.nodes.iter().enumerate().rev() {
            tangents[index] = if node.is_leaf() {
                let at = node.particle as usize;
                // The last particle of a row or column begins no cell.
                let is_cell = at % columns + 1 < columns && at + columns < positions.len();
                if is_cell {
                    let corners = [at, at + 1, at + columns, at + columns + 1];
                    Tangents::of_cell(corners.map(|corner| positions[corner]), per_metre)
                } else {
                    Tangents::EMPTY
                }
            } else {
                let children = node.children().iter();
                children.fold(Tangents::EMPTY, |joined, &child| {
                    joined.join(&tangents[child as usize])
                })
            };
        }
    }

    /// Bounds of the tangents of all rows and columns; `None` for a mesh.
    pub(super) fn tangents_of_all(&self, particles: &ClothParticles) -> Option<Tangents> {
        let grid = self.surface.as_grid()?;
        Some(tangents_of_all(particles, &self.masks, grid.spacing()))
    }
}

/// Nodes whose rows or columns are farther apart are not combined.
const MAX_APART: u32 = 2;
