//! The search structure of a surface, for contact with itself and with others.

use std::{ops::Range, sync::Arc};

use bevy::{math::Vec3A, platform::collections::HashSet};

use super::tangents::Tangents;
use crate::{cloth::Surface, hierarchy::QuadTree};

/// Number of rows and of columns of a grid that a patch owns.
const OF_GRID: u32 = 2;

/// Largest number of particles that a patch of a mesh owns.
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
    /// The patches with features of each particle, and where they begin among these; and one more.
    patches_with: Vec<u32>,
    first_with: Vec<u32>,
    /// The corners of eight features each, by their places among the particles of their patch: of owned vertices, faces, and
    /// edges. The last feature fills the rest of its eight.
    groups: Vec<[u16; 8]>,
    /// For a grid, the number of rows and columns of patches, and these row by row.
    size: [u32; 2],
    blocks: Vec<u32>,
    closest: f32,
}

/// The features that a few neighbouring particles own. Every vertex, edge and face belongs to one patch.
#[derive(Debug, Clone)]
struct Patch {
    owned: u32,
    particles: Range<u32>,
    faces: Range<u32>,
    edges: Range<u32>,
    /// The first of its groups of eight features, among those of all patches.
    first_group: u32,
    /// For a grid, its row and column among patches.
    block: [u32; 2],
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
        let mut seen = HashSet::new();
        if let Some(grid) = surface.as_grid() {
            sheet.size = [grid.rows(), grid.columns()].map(|of| of.div_ceil(OF_GRID));
            sheet.blocks = vec![0; (sheet.size[0] * sheet.size[1]) as usize];
            let [rows, columns] = sheet.size;
            sheet.add_blocks([0..rows, 0..columns], &mut seen);
            sheet.find_patches();
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
        sheet.add(tree, 0, &leaves, &mut seen);
        sheet.find_patches();
        sheet
    }

    /// Finds the patches with features of each particle.
    fn find_patches(&mut self) {
        self.first_with = vec![0; self.surface.len() + 1];
        for &particle in &self.particles {
            self.first_with[particle as usize + 1] += 1;
        }
        for particle in 0..self.surface.len() {
            self.first_with[particle + 1] += self.first_with[particle];
        }
        let mut next = self.first_with.clone();
        self.patches_with = vec![0; self.particles.len()];
        for (index, patch) in (0..).zip(&self.patches) {
            for place in patch.particles.clone() {
                let next = &mut next[self.particles[place as usize] as usize];
                self.patches_with[*next as usize] = index;
                *next += 1;
            }
        }
    }

    /// Adds a node without children: of the next patch. Returns its index, too.
    fn add_node(&mut self) -> (usize, Node) {
        let node = Node {
            children: [0; 4],
            child_count: 0,
            patch: self.patches.len() as u32,
        };
        self.nodes.push(node);
        (self.nodes.len() - 1, node)
    }

    /// Adds a node of the tree and all below it. Returns its index.
    fn add(
        &mut self,
        tree: &QuadTree,
        of: u32,
        leaves: &[u32],
        seen: &mut HashSet<[u32; 2]>,
    ) -> u32 {
        let (index, mut node) = self.add_node();
        let mut owned = Vec::new();
        if leaves[of as usize] <= OWNED {
            collect(tree, of, &mut owned);
        }
        if !owned.is_empty() {
            self.add_patch(&owned, [0; 2], seen);
        } else {
            for &child in tree.node(of).children() {
                node.children[node.child_count as usize] = self.add(tree, child, leaves, seen);
                node.child_count += 1;
            }
            self.nodes[index] = node;
        }
        index as u32
    }

    /// Adds a node of these rows and columns of patches of a grid, and all below it. Returns its index.
    fn add_blocks(&mut self, of: [Range<u32>; 2], seen: &mut HashSet<[u32; 2]>) -> u32 {
        let (index, mut node) = self.add_node();
        if of.iter().all(|of| of.len() == 1) {
            let block = [of[0].start, of[1].start];
            self.blocks[(block[0] * self.size[1] + block[1]) as usize] = node.patch;
            let owned = self.owned_by(block);
            self.add_patch(&owned, block, seen);
            return index as u32;
        }
        let [rows, columns] = of.map(|Range { start, end }| {
            let middle = (start + end).div_ceil(2);
            [start..middle, middle..end]
        });
        for rows in rows {
            for columns in columns.clone().into_iter().filter(|of| !of.is_empty()) {
                if !rows.is_empty() {
                    node.children[node.child_count as usize] =
                        self.add_blocks([rows.clone(), columns], seen);
                    node.child_count += 1;
                }
            }
        }
        self.nodes[index] = node;
        index as u32
    }

    /// The particles that a patch of a grid owns.
    fn owned_by(&self, block: [u32; 2]) -> Vec<u32> {
        let grid = self.surface.as_grid();
        let [rows, columns] = grid.map_or([0; 2], |grid| [grid.rows(), grid.columns()]);
        let range = |at: u32, end: u32| OF_GRID * at..(OF_GRID * (at + 1)).min(end);
        range(block[0], rows)
            .flat_map(|row| range(block[1], columns).map(move |column| row * columns + column))
            .collect()
    }

    fn add_patch(&mut self, owned: &[u32], block: [u32; 2], seen: &mut HashSet<[u32; 2]>) {
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
        let first_group = self.groups.len() as u32;
        let vertices: Vec<[u16; 1]> = (0..owned.len() as u16).map(|vertex| [vertex]).collect();
        put(&vertices, &mut self.groups);
        put(&self.faces[from[1]..], &mut self.groups);
        put(&self.edges[from[2]..], &mut self.groups);
        self.patches.push(Patch {
            owned: owned.len() as u32,
            particles: range(from[0], self.particles.len()),
            faces: range(from[1], self.faces.len()),
            edges: range(from[2], self.edges.len()),
            first_group,
            block,
        });
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

    /// Number of rows and columns of windows of 2 × 2 patches of a grid, or fewer where there are no more.
    fn windows(&self) -> [u32; 2] {
        self.size.map(|of| of.saturating_sub(1).max(1).min(of))
    }

    /// Number of windows.
    pub(super) fn window_count(&self) -> usize {
        let [rows, columns] = self.windows();
        (rows * columns) as usize
    }

    /// The patches in a window, row by row.
    pub(super) fn patches_in(&self, window: usize) -> impl Iterator<Item = u32> {
        let [rows, columns] = self.range_of(window);
        let blocks = rows.flat_map(move |row| columns.clone().map(move |column| [row, column]));
        blocks.map(|[row, column]| self.blocks[(row * self.size[1] + column) as usize])
    }

    /// The rows and columns of patches in a window.
    fn range_of(&self, window: usize) -> [Range<u32>; 2] {
        let columns = self.windows()[1];
        let at = [window as u32 / columns, window as u32 % columns];
        [0, 1].map(|axis| at[axis]..(at[axis] + 2).min(self.size[axis]))
    }

    /// The windows in which two patches are.
    pub(super) fn windows_of(&self, of: [u32; 2]) -> impl Iterator<Item = usize> {
        let [a, b] = of.map(|patch| self.patches[patch as usize].block);
        let windows = self.windows();
        let [rows, columns] = [0, 1].map(|axis| {
            let first = a[axis].max(b[axis]).saturating_sub(1);
            first..(a[axis].min(b[axis]) + 1).min(windows[axis])
        });
        rows.flat_map(move |row| columns.clone().map(move |column| (row, column)))
            .map(move |(row, column)| (row * windows[1] + column) as usize)
    }

    /// Whether some window has both patches.
    pub(super) fn are_neighbours(&self, of: [u32; 2]) -> bool {
        self.windows_of(of).next().is_some()
    }

    /// Which neighbour the second patch is of the first, before which it does not come: 0 to 5.
    pub(super) fn neighbour(&self, of: [u32; 2]) -> u32 {
        let [a, b] = of.map(|patch| self.patches[patch as usize].block);
        3 * (b[0] - a[0]) + b[1] + 1 - a[1]
    }

    /// A lower bound of the distance between any two features without a common particle in a window (m), from its tangents at
    /// these positions.
    pub(super) fn unfolded(&self, window: usize, places: &[Vec3A]) -> f32 {
        let Some(grid) = self.surface.as_grid() else {
            return f32::NEG_INFINITY;
        };
        let size = [grid.rows(), grid.columns()];
        let blocks = self.range_of(window);
        let [rows, columns] = [0, 1].map(|axis| {
            let last = (OF_GRID * blocks[axis].end).min(size[axis] - 1);
            (OF_GRID * blocks[axis].start) as usize..last as usize + 1
        });
        let stride = size[1] as usize;
        let rows = rows.map(|row| &places[row * stride..][columns.clone()]);
        Tangents::of(rows, grid.spacing()).unfolded() * self.closest
    }

    /// The particles of a patch's features.
    pub(super) fn particles_of(&self, patch: u32) -> &[u32] {
        let Range { start, end } = self.patches[patch as usize].particles;
        &self.particles[start as usize..end as usize]
    }

    /// The patches with features of a particle.
    pub(super) fn patches_of(&self, particle: usize) -> &[u32] {
        let [start, end] = [0, 1].map(|at| self.first_with[particle + at] as usize);
        &self.patches_with[start..end]
    }

    /// The place of a patch's first particle among those of all patches.
    pub(super) fn first_of(&self, patch: u32) -> u32 {
        self.patches[patch as usize].particles.start
    }

    /// The number of a patch's particles that it owns: the first ones.
    pub(super) fn owned_of(&self, patch: u32) -> u16 {
        self.patches[patch as usize].owned as u16
    }

    /// The places of a patch's points of eight features among those of all patches: of its owned vertices, its faces, and
    /// its edges.
    pub(super) fn groups_of(&self, patch: u32) -> Range<u32> {
        let next = self.patches.get(patch as usize + 1);
        self.patches[patch as usize].first_group
            ..next.map_or(self.group_count(), |next| next.first_group)
    }

    /// Number of points of eight features of all patches.
    pub(super) fn group_count(&self) -> u32 {
        self.groups.len() as u32
    }

    /// The corners of eight features each, by their places among the particles of their patch.
    pub(super) fn groups(&self, of: Range<u32>) -> &[[u16; 8]] {
        &self.groups[of.start as usize..of.end as usize]
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

/// Puts features into groups of eight, corner by corner. The last feature fills the last group.
fn put<const N: usize>(features: &[[u16; N]], groups: &mut Vec<[u16; 8]>) {
    for eight in features.chunks(8) {
        groups.extend(
            (0..N).map(|corner| std::array::from_fn(|l| eight[l.min(eight.len() - 1)][corner])),
        );
    }
}
