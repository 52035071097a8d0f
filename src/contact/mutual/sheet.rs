//! What a surface is searched by for contact with itself and with others.

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

/// A surface with its edges and the nodes of its tree, as contact of cloth with cloth goes through them. It depends on the rest
/// shape alone, is made once, and is shared.
#[derive(Debug, Default)]
pub(crate) struct Sheet {
    surface: Arc<Surface>,
    /// Edges of faces, each stood for by one particle.
    edges: Vec<[u32; 2]>,
    /// Where each particle's begin; one more than there are particles.
    first_edge: Vec<u32>,
    nodes: Vec<Node>,
    /// Bounds of each node's faces at rest (m).
    rest: Vec<Bounds>,
    /// Of a grid, how its nodes lie on each level.
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
    /// Of a surface with its tree.
    ///
    /// # Panics
    /// If the tree is another surface's.
    pub fn new(surface: &Arc<Surface>, tree: &QuadTree) -> Self {
        assert!(
            tree.validate(surface.len()).is_ok(),
            "the surface's own tree"
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

    /// On a grid, the smallest distance at rest between two features that have no particle in common (m): from a corner of a cell
    /// to its diagonal. 0 of a mesh.
    pub(super) fn closest(&self) -> f32 {
        self.closest
    }

    pub(super) fn node(&self, node: u32) -> &Node {
        &self.nodes[node as usize]
    }

    /// Faces that a particle stands for.
    pub(super) fn faces_of(&self, particle: u32) -> &[[u32; 3]] {
        self.surface.faces().of(particle)
    }

    /// Edges that a particle stands for.
    pub(super) fn edges_of(&self, particle: u32) -> &[[u32; 2]] {
        let particle = particle as usize;
        &self.edges[self.first_edge[particle] as usize..self.first_edge[particle + 1] as usize]
    }

    /// Lower bound of the distance at rest between the faces of two nodes (m).
    pub(super) fn rest_distance(&self, a: u32, b: u32) -> f32 {
        self.rest[a as usize].distance(&self.rest[b as usize])
    }

    /// On a grid, the nodes of the smallest rectangle of nodes around two of one level, if they are near each other.
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

    /// Bounds of each node's faces, where the particles are at `positions` (m).
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

    /// Tangents of each node of a grid, where the particles are at `positions` (m); none of a mesh.
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
                // The last of a row or column begins no cell.
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

    /// Between which vectors all rows and columns run; `None` of a mesh.
    pub(super) fn tangents_of_all(&self, particles: &ClothParticles) -> Option<Tangents> {
        let grid = self.surface.as_grid()?;
        Some(tangents_of_all(particles, &self.masks, grid.spacing()))
    }
}

/// Nodes whose rows and columns are farther from each other are not looked at together.
const MAX_APART: u32 = 2;
