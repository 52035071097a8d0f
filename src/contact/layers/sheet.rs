//! The search structure of a surface, for contact with itself and with others.

use std::{ops::Range, sync::Arc};

use bevy::{
    math::{Vec2, Vec3A},
    platform::collections::HashSet,
};

use super::tangents::Tangents;
use crate::{
    cloth::{ClothGrid, Surface},
    hierarchy::QuadTree,
};

/// Largest number of rows and columns whose tangents are compared.
const LARGEST: usize = 9;

/// Largest number of rows or columns that a patch owns: with those of its faces, two in a row have [`LARGEST`].
const LONGEST: u32 = 4;

/// Largest number of particles that a patch owns.
const OWNED: u32 = 8;

/// A surface in patches of a few faces, and a tree over them, for contact of cloth with cloth. It depends only on the
/// rest shape, is built once, and is shared.
#[derive(Debug, Default)]
pub(crate) struct Sheet {
    surface: Arc<Surface>,
    patches: Vec<Patch>,
    /// The particles of all patches' features; those that a patch owns come first.
    particles: Vec<u32>,
    /// Faces and edges of faces, by the places of their corners among the particles of their patch.
    faces: Vec<[u16; 3]>,
    edges: Vec<[u16; 2]>,
    nodes: Vec<Node>,
    closest: f32,
}

/// The features that a few neighbouring particles own. Every vertex, edge and face belongs to one patch.
#[derive(Debug, Clone)]
struct Patch {
    owned: u32,
    particles: Range<u32>,
    faces: Range<u32>,
    edges: Range<u32>,
    /// For a grid, its first row and column, and the last of its features.
    rectangle: [[u32; 2]; 2],
}

/// A node of the tree over patches: its children, or its patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    children: [u32; 4],
    child_count: u32,
    pub patch: u32,
}

impl Node {
    pub fn children(&self) -> &[u32] {
        &self.children[..self.child_count as usize]
    }
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
        let closest = surface.as_grid().map_or(0.0, |grid| {
            let [across, down] = grid.spacing().to_array();
            across * down / across.hypot(down)
        });
        let mut sheet = Self {
            surface: surface.clone(),
            closest,
            ..Self::default()
        };
        if tree.is_empty() {
            return sheet;
        }
        let mut leaves = vec![0; tree.len()];
        for index in (0..tree.len()).rev() {
            let children = tree.node(index as u32);
            let below = children
                .children()
                .iter()
                .map(|&child| leaves[child as usize]);
            leaves[index] = below.sum::<u32>().max(1);
        }
        let mut seen = HashSet::new();
        sheet.add(tree, 0, &leaves, &mut seen);
        sheet
    }

    /// Adds a node of the tree and all below it. Returns its index.
    fn add(
        &mut self,
        tree: &QuadTree,
        of: u32,
        leaves: &[u32],
        seen: &mut HashSet<[u32; 2]>,
    ) -> u32 {
        let index = self.nodes.len();
        let mut node = Node {
            children: [0; 4],
            child_count: 0,
            patch: self.patches.len() as u32,
        };
        self.nodes.push(node);
        let mut owned = Vec::new();
        if leaves[of as usize] <= OWNED {
            collect(tree, of, &mut owned);
        }
        if !owned.is_empty() && !self.is_long(&owned) {
            self.add_patch(&owned, seen);
        } else {
            for &child in tree.node(of).children() {
                node.children[node.child_count as usize] = self.add(tree, child, leaves, seen);
                node.child_count += 1;
            }
            self.nodes[index] = node;
        }
        index as u32
    }

    fn add_patch(&mut self, owned: &[u32], seen: &mut HashSet<[u32; 2]>) {
        let from = [self.particles.len(), self.faces.len(), self.edges.len()];
        self.particles.extend(owned);
        for &particle in owned {
            for &face in self.surface.faces().of(particle) {
                let face = face.map(|corner| {
                    let known = &self.particles[from[0]..];
                    let place = known.iter().position(|&known| known == corner);
                    place.unwrap_or_else(|| {
                        self.particles.push(corner);
                        self.particles.len() - 1 - from[0]
                    }) as u16
                });
                self.faces.push(face);
                let [a, b, c] = face;
                for edge in [[a, b], [b, c], [c, a]] {
                    let [from, to] = edge.map(|end| self.particles[from[0] + usize::from(end)]);
                    if seen.insert([from.min(to), from.max(to)]) {
                        self.edges.push(edge);
                    }
                }
            }
        }
        let range = |from: usize, to: usize| from as u32..to as u32;
        let rectangle = self.rectangle(&self.particles[from[0]..]);
        self.patches.push(Patch {
            owned: owned.len() as u32,
            particles: range(from[0], self.particles.len()),
            faces: range(from[1], self.faces.len()),
            edges: range(from[2], self.edges.len()),
            rectangle,
        });
    }

    /// The first row and column of these particles of a grid, and the last.
    fn rectangle(&self, particles: &[u32]) -> [[u32; 2]; 2] {
        let columns = self.surface.as_grid().map_or(1, ClothGrid::columns);
        let cells = particles
            .iter()
            .map(|particle| [particle / columns, particle % columns]);
        cells.fold([[u32::MAX; 2], [0; 2]], |[low, high], at| {
            [0, 1].map(|end| {
                [0, 1].map(|axis| match end {
                    0 => low[axis].min(at[axis]),
                    _ => high[axis].max(at[axis]),
                })
            })
        })
    }

    /// Whether a patch of a grid would be so long that the tangents of it and its neighbour are not compared.
    fn is_long(&self, owned: &[u32]) -> bool {
        let [low, high] = self.rectangle(owned);
        let is_long = |axis: usize| high[axis] - low[axis] >= LONGEST;
        self.surface.as_grid().is_some() && (is_long(0) || is_long(1))
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

    /// The nodes of the tree over its patches, each before its children.
    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    pub(super) fn patch_count(&self) -> usize {
        self.patches.len()
    }

    /// A lower bound of the distance between two patches of a grid (m), from its tangents at these positions; `None` for
    /// a mesh, and for patches that are far from each other at rest.
    pub(super) fn unfolded(&self, of: [u32; 2], places: &[Vec3A]) -> Option<f32> {
        let grid = self.surface.as_grid()?;
        let [a, b] = of.map(|patch| self.patches[patch as usize].rectangle);
        let last = [0, 1].map(|axis| a[1][axis].max(b[1][axis]) as usize);
        // Two rows and columns, at least, have tangents.
        let first = |axis: usize| a[0][axis].min(b[0][axis]) as usize;
        let low = [0, 1].map(|axis| first(axis).min(last[axis].saturating_sub(1)));
        let size = [0, 1].map(|axis| last[axis] - low[axis] + 1);
        if size.iter().any(|&size| size > LARGEST) {
            return None;
        }
        let gap = |axis: usize| {
            a[0][axis]
                .max(b[0][axis])
                .saturating_sub(a[1][axis].min(b[1][axis]))
        };
        let spacing = grid.spacing();
        let apart = spacing * Vec2::new(gap(1) as f32, gap(0) as f32);
        let columns = grid.columns() as usize;
        let rows = (0..size[0]).map(|row| {
            let first = (low[0] + row) * columns + low[1];
            &places[first..first + size[1]]
        });
        let tangents = Tangents::of(rows, spacing);
        Some(tangents.unfolded() * apart.length().max(self.closest))
    }

    /// The particles of a patch's features.
    pub(super) fn particles_of(&self, patch: u32) -> &[u32] {
        let Range { start, end } = self.patches[patch as usize].particles;
        &self.particles[start as usize..end as usize]
    }

    /// The place of a patch's first particle among those of all patches.
    pub(super) fn first_of(&self, patch: u32) -> u32 {
        self.patches[patch as usize].particles.start
    }

    /// The number of a patch's particles that it owns: the first ones.
    pub(super) fn owned_of(&self, patch: u32) -> u16 {
        self.patches[patch as usize].owned as u16
    }

    /// The faces of a patch, by the places of their corners among its particles.
    pub(super) fn faces_of(&self, patch: u32) -> &[[u16; 3]] {
        let Range { start, end } = self.patches[patch as usize].faces;
        &self.faces[start as usize..end as usize]
    }

    /// The edges of a patch, by the places of their ends among its particles.
    pub(super) fn edges_of(&self, patch: u32) -> &[[u16; 2]] {
        let Range { start, end } = self.patches[patch as usize].edges;
        &self.edges[start as usize..end as usize]
    }
}

/// Collects the particles below a node.
fn collect(tree: &QuadTree, of: u32, particles: &mut Vec<u32>) {
    let node = tree.node(of);
    if node.is_leaf() {
        particles.push(node.middle);
    }
    for &child in node.children() {
        collect(tree, child, particles);
    }
}
