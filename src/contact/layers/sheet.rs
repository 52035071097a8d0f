//! The search structure of a surface, for contact with itself and with others.
//!
//! # Torn cloth
//! The [guarantee](super) holds for torn cloth, too. No step of it assumes a spring. The boxes of 1 and the motion of 2 are measured on the
//! particles where they are. A feature is the convex hull of particles of its own patch, so the patch's box contains it however
//! its springs are torn. The tree over patches only orders the search: its boxes contain those of their children. The radii of the
//! [rest-shape rule](crate::hierarchy), which paths along springs bound, are not used here.
//!
//! Only 3 assumes more: that the faces of a [window](super::windows) cover their hull at rest. One that a tear crosses is never laid
//! flat, so its pairs of neighbours are compared like any others.
//!
//! A particle that came apart is several, so the sides of a cut have no common particle, and are pairs like any others.
//! At rest a cut has a width. Its sides are kept apart by at most half of that: otherwise each would push the other open. At the
//! end of a cut both sides share a particle, and count as neighbours there. After each tear, and each mend, the pairs are found
//! anew.
//!
//! # Ropes
//! A rope has edges and no faces. Two ropes, or two strands of one, are a whole thickness apart along all of their edges. Edges without
//! a common particle are at least a spacing apart along the rope, which is twice the thickness or more. So no distance at rest
//! lowers the thickness, also where a path begins with strands side by side.

use std::{ops::Range, sync::Arc};

use bevy::platform::collections::HashSet;

use super::windows::Windows;
use crate::{
    cloth::{ClothGrid, Grouped, Surface},
    hierarchy::QuadTree,
};

/// Largest number of particles that a patch of a mesh owns, and of rows and columns that one of a grid does.
const OWNED: u32 = 8;
const OWNED_ACROSS: u32 = 2;

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
    /// The patches with features of each particle.
    patches_with: Grouped<u32>,
    /// The corners of eight features each, by their places among the particles of their patch: of owned vertices, faces, and
    /// edges. The last feature fills the rest of its eight.
    groups: Vec<[u16; 8]>,
    windows: Windows,
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
}

/// A node of the tree over patches: its children, or its patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    children: [u32; 4],
    child_count: u32,
    pub patch: u32,
}

impl Node {
    #[inline]
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
        assert!(tree.is_of(surface), "the tree belongs to another surface");
        let closest = surface.as_grid().map_or(0.0, |grid| {
            let [across, down] = grid.spacing().to_array();
            match grid.rope_radius() {
                Some(_) => across,
                None => across * down / across.hypot(down),
            }
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
            let [rows, columns] = [grid.rows(), grid.columns()].map(|of| of.div_ceil(OWNED_ACROSS));
            sheet.add_of_grid(grid, [0..rows, 0..columns], &mut seen);
        } else {
            let mut leaves = vec![0; tree.len()];
            for index in (0..tree.len()).rev() {
                let node = tree.node(index as u32);
                let below = node.children().iter();
                let below = below.map(|&child| leaves[child as usize]).sum::<u32>();
                leaves[index] = below.max(1);
            }
            sheet.add_of_mesh(tree, 0, &leaves, &mut seen);
        }
        sheet.find_patches();
        sheet.windows = Windows::new(
            surface,
            sheet.patches.len(),
            |particle| sheet.patches_with.of(particle),
            |patch| {
                let particles = sheet.particles_of(patch);
                let faces = sheet.faces_of(patch).iter();
                let named = |face: &[u16; 3]| face.map(|corner| particles[usize::from(corner)]);
                let owned = usize::from(sheet.owned_of(patch));
                (faces.map(named).collect(), &particles[..owned])
            },
        );
        sheet
    }

    /// Finds the patches with features of each particle.
    fn find_patches(&mut self) {
        self.patches_with = Grouped::new(self.surface.len(), || {
            let patches = 0..self.patches.len() as u32;
            patches.flat_map(|index| {
                let particles = self.particles_of(index).iter();
                particles.map(move |particle| (*particle, index))
            })
        });
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

    /// Adds a node of a mesh's tree and all below it. Returns its index.
    fn add_of_mesh(
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
            self.add_patch(&owned, seen);
        } else {
            for &child in tree.node(of).children() {
                node.children[node.child_count as usize] =
                    self.add_of_mesh(tree, child, leaves, seen);
                node.child_count += 1;
            }
            self.nodes[index] = node;
        }
        index as u32
    }

    /// Adds a node of these rows and columns of patches of a grid, and all below it. Returns its index. The patches of the grid's own
    /// tree would be of different sizes.
    fn add_of_grid(
        &mut self,
        grid: &ClothGrid,
        of: [Range<u32>; 2],
        seen: &mut HashSet<[u32; 2]>,
    ) -> u32 {
        let (index, mut node) = self.add_node();
        let [rows, columns] = of;
        if rows.len() == 1 && columns.len() == 1 {
            let owned = |at: u32, end: u32| OWNED_ACROSS * at..(OWNED_ACROSS * (at + 1)).min(end);
            let columns = owned(columns.start, grid.columns());
            let owned = owned(rows.start, grid.rows()).flat_map(|row| {
                let particle = move |column| row * grid.columns() + column;
                columns.clone().map(particle)
            });
            self.add_patch(&owned.collect::<Vec<_>>(), seen);
            return index as u32;
        }
        for rows in halves(&rows) {
            for columns in halves(&columns) {
                let child = self.add_of_grid(grid, [rows.clone(), columns], seen);
                node.children[node.child_count as usize] = child;
                node.child_count += 1;
            }
        }
        self.nodes[index] = node;
        index as u32
    }

    fn add_patch(&mut self, owned: &[u32], seen: &mut HashSet<[u32; 2]>) {
        let from = [self.particles.len(), self.faces.len(), self.edges.len()];
        self.particles.extend(owned);
        if self.is_rope() {
            self.add_rope(owned);
        }
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
        group(&vertices, &mut self.groups);
        group(&self.faces[from[1]..], &mut self.groups);
        group(&self.edges[from[2]..], &mut self.groups);
        self.patches.push(Patch {
            owned: owned.len() as u32,
            particles: range(from[0], self.particles.len()),
            faces: range(from[1], self.faces.len()),
            edges: range(from[2], self.edges.len()),
            first_group,
        });
    }

    /// Adds the edges of a rope that begin at the particles that a patch owns: the last ones of all.
    fn add_rope(&mut self, owned: &[u32]) {
        let Some(&last) = owned.last() else { return };
        let mut count = owned.len() as u16;
        if (last as usize) + 1 < self.surface.len() {
            self.particles.push(last + 1);
            count += 1;
        }
        self.edges.extend((1..count).map(|end| [end - 1, end]));
    }

    /// The surface.
    #[inline]
    pub fn surface(&self) -> &Arc<Surface> {
        &self.surface
    }

    /// For a grid, the smallest distance at rest between two features without a common particle (m): from a corner of a
    /// cell to its diagonal. For a rope, that along it, wherever its path begins. 0 for a mesh.
    #[inline]
    pub(super) fn closest(&self) -> f32 {
        self.closest
    }

    /// Whether it has edges and no faces.
    #[inline]
    pub(super) fn is_rope(&self) -> bool {
        self.surface.rope_radius().is_some()
    }

    /// The nodes of the tree over its patches, each before its children.
    #[inline]
    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    pub(super) fn patch_count(&self) -> usize {
        self.patches.len()
    }

    /// The windows: patches that meet at a particle.
    #[inline]
    pub(super) fn windows(&self) -> &Windows {
        &self.windows
    }

    /// The particles of a patch's features.
    #[inline]
    pub(super) fn particles_of(&self, patch: u32) -> &[u32] {
        let Range { start, end } = self.patches[patch as usize].particles;
        &self.particles[start as usize..end as usize]
    }

    /// The patches with features of a particle.
    #[inline]
    pub(super) fn patches_of(&self, particle: usize) -> &[u32] {
        self.patches_with.of(particle as u32)
    }

    /// The place of a patch's first particle among those of all patches.
    #[inline]
    pub(super) fn first_of(&self, patch: u32) -> u32 {
        self.patches[patch as usize].particles.start
    }

    /// The number of a patch's particles that it owns: the first ones.
    #[inline]
    pub(super) fn owned_of(&self, patch: u32) -> u16 {
        self.patches[patch as usize].owned as u16
    }

    /// The places of a patch's groups of eight among those of all patches.
    #[inline]
    pub(super) fn group_range(&self, patch: u32) -> Range<u32> {
        let next = self.patches.get(patch as usize + 1);
        self.patches[patch as usize].first_group
            ..next.map_or(self.group_count(), |next| next.first_group)
    }

    /// Number of groups of eight of all patches.
    pub(super) fn group_count(&self) -> u32 {
        self.groups.len() as u32
    }

    /// The groups of eight of a patch: the corners of eight features each, by their places among its particles.
    #[inline]
    pub(super) fn groups_of(&self, patch: u32) -> &[[u16; 8]] {
        let Range { start, end } = self.group_range(patch);
        &self.groups[start as usize..end as usize]
    }

    /// The faces of a patch, by the places of their corners among its particles.
    #[inline]
    pub(super) fn faces_of(&self, patch: u32) -> &[[u16; 3]] {
        let Range { start, end } = self.patches[patch as usize].faces;
        &self.faces[start as usize..end as usize]
    }

    /// The edges of a patch, by the places of their ends among its particles.
    #[inline]
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

/// The two halves of a range; one if it cannot be halved.
fn halves(of: &Range<u32>) -> impl Iterator<Item = Range<u32>> + use<> {
    let middle = (of.start + of.end).div_ceil(2);
    let halves = [of.start..middle, middle..of.end];
    halves.into_iter().filter(|half| !half.is_empty())
}

/// Puts features into groups of eight, corner by corner. The last feature fills the last group.
fn group<const N: usize>(features: &[[u16; N]], groups: &mut Vec<[u16; 8]>) {
    for eight in features.chunks(8) {
        groups.extend(
            (0..N).map(|corner| std::array::from_fn(|l| eight[l.min(eight.len() - 1)][corner])),
        );
    }
}
