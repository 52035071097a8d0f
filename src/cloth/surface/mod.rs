//! The surface that a cloth is: what does not change while it moves, whatever it was made from.
//!
//! A grid is one way to make one, a triangle mesh another. Solver, hierarchy, contact and drawing see a surface; only what
//! makes one, and pins that name rows and columns, ask whether it is a grid.

#[cfg(feature = "mesh")]
mod asset;
mod binding;
mod bound;
mod calibration;
mod faces;
mod flat;
mod from_grid;
mod from_mesh;
mod graph;
mod grid;
mod normals;
mod orientation;
mod paths;
mod springs;
#[cfg(test)]
mod tests;
mod threads;
mod triangles;
mod weld;

use std::{fmt, sync::OnceLock};

use bevy::math::{Vec2, Vec3};

use super::{ClothGrid, SpringKind};

pub use binding::SurfaceBinding;
pub use from_mesh::MAX_MESH_PARTICLES;
pub use triangles::{TriangleMesh, VertexAttribute};

#[cfg(feature = "mesh")]
pub(crate) use asset::skin_of_asset;
pub(crate) use faces::Faces;
pub(crate) use flat::Flat;
pub(crate) use graph::Graph;
pub(crate) use paths::ShortestPaths;
pub(crate) use springs::Link;
pub(crate) use threads::Threads;
pub(crate) use triangles::JointWeights;

/// A cloth's surface at rest: its particles, the triangles between them, their areas, what is next to what. In the cloth's
/// own frame, in metres, with the transform's scale multiplied in.
///
/// It never changes, so that cloths made alike share one.
#[derive(Clone)]
pub struct Surface {
    rest: Vec<Vec3>,
    areas: Vec<f32>,
    /// One for all of a flat surface, else one for each particle.
    normals: Vec<Vec3>,
    /// The particle of each vertex that it was made from; `None` where each vertex is its own.
    particle_of_vertex: Option<Vec<u32>>,
    attributes: Vec<VertexAttribute>,
    /// The springs of a mesh; a grid's follow from its rows and columns.
    links: Vec<Link>,
    /// Of a mesh, which particles are at an edge that does not have two faces.
    is_border: Vec<bool>,
    scale: Vec3,
    spacing: Spacing,
    extent: Extent,
    grid: Option<ClothGrid>,
    // Made when they are asked for: a cloth that touches nothing needs none of them.
    uvs: OnceLock<Vec<Vec2>>,
    faces: OnceLock<Faces>,
    graph: OnceLock<Graph>,
    threads: OnceLock<Threads>,
    flat: OnceLock<Option<Flat>>,
}

/// Lengths of stretch springs at rest (m).
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Spacing {
    /// Of the shortest.
    pub shortest: f32,
    /// Of the one in the middle; on a grid, the smaller of its two.
    pub typical: f32,
    /// Of the longest.
    pub longest: f32,
}

/// How large a surface is.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Extent {
    /// From one end to the other at rest (m).
    pub diagonal: f32,
    /// All of it (m²).
    pub area: f32,
    /// Particles side by side where it is narrow.
    pub particles_across: usize,
    /// From a particle to the farthest corner of the faces that it stands for, along stretch springs at most (m).
    pub face_reach: f32,
    /// Of the springs between neighbours the longest, shear springs too (m).
    pub longest_spring: f32,
    /// Faces that meet in one particle, at most.
    pub max_faces: usize,
    /// How many pieces there are that no edge joins.
    pub pieces: usize,
}

impl Surface {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.rest.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Where each particle is at rest (m).
    pub fn rest_positions(&self) -> &[Vec3] {
        &self.rest
    }

    /// The part of the surface that a particle stands for (m²).
    pub fn area_of(&self, particle: usize) -> f32 {
        self.areas[particle]
    }

    /// The part of the surface that each particle stands for (m²).
    pub(crate) fn areas(&self) -> &[f32] {
        &self.areas
    }

    /// Area of all of it (m²).
    pub fn area(&self) -> f32 {
        self.extent.area
    }

    /// The side that the surface faces at a particle at rest, of length 1.
    pub fn normal_of(&self, particle: usize) -> Vec3 {
        let index = if self.normals.len() == 1 { 0 } else { particle };
        self.normals[index]
    }

    /// Triangles, as particle indices, counter-clockwise seen from where the surface faces.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.faces().all()
    }

    /// How many vertices it was made from.
    pub fn vertices(&self) -> usize {
        self.particle_of_vertex
            .as_ref()
            .map_or(self.len(), Vec::len)
    }

    /// The particle of a vertex that the surface was made from. None of a vertex that is no part of a triangle with an
    /// area.
    pub fn particle_of_vertex(&self, vertex: usize) -> Option<usize> {
        let particle = match &self.particle_of_vertex {
            None => vertex,
            Some(particles) => *particles.get(vertex)? as usize,
        };
        (particle < self.len()).then_some(particle)
    }

    /// Lengths of its stretch springs at rest.
    pub fn spacing(&self) -> Spacing {
        self.spacing
    }

    /// From one end to the other at rest (m).
    pub fn diagonal(&self) -> f32 {
        self.extent.diagonal
    }

    /// The rows and columns of a surface that was made from a grid.
    pub fn as_grid(&self) -> Option<&ClothGrid> {
        self.grid.as_ref()
    }

    /// Whether it encloses a volume: a mesh of which each edge has two faces.
    pub fn is_closed(&self) -> bool {
        !self.is_border.is_empty() && !self.is_border.contains(&true)
    }

    /// Particles side by side where it is narrow.
    pub(crate) fn particles_across(&self) -> usize {
        self.extent.particles_across
    }

    /// Particles side by side where it is long: of a mesh, as many as a square of its diagonal would have.
    pub fn particles_along(&self) -> usize {
        match &self.grid {
            Some(grid) => grid.columns().max(grid.rows()) as usize,
            None => {
                let side = self.diagonal() * std::f32::consts::FRAC_1_SQRT_2;
                (side / self.spacing().typical) as usize + 1
            }
        }
    }

    /// From a particle to the farthest corner of the faces that it stands for, along stretch springs at most (m).
    pub(crate) fn face_reach(&self) -> f32 {
        self.extent.face_reach
    }

    /// Of the springs between neighbours the longest, shear springs too (m).
    pub(crate) fn longest_spring(&self) -> f32 {
        self.extent.longest_spring
    }

    /// Faces that meet in one particle, at most.
    pub(crate) fn max_faces(&self) -> usize {
        self.extent.max_faces
    }

    /// The transform's scale that is in it.
    pub(crate) fn scale(&self) -> Vec3 {
        self.scale
    }

    /// What its vertices carry besides their places.
    pub(crate) fn attributes(&self) -> &[VertexAttribute] {
        &self.attributes
    }

    /// The springs of a mesh; none of a grid.
    pub(crate) fn links(&self) -> &[Link] {
        &self.links
    }

    /// Texture coordinates of each particle; empty where there are none.
    pub fn uvs(&self) -> &[Vec2] {
        self.uvs.get_or_init(|| {
            let grid = self.grid.as_ref();
            grid.map_or_else(Vec::new, grid::uvs)
        })
    }

    /// Its faces, by the particles that stand for them.
    pub(crate) fn faces(&self) -> &Faces {
        self.faces.get_or_init(|| {
            let grid = self.grid.as_ref();
            grid.map_or_else(Faces::default, grid::faces)
        })
    }

    /// What is next to what.
    pub(crate) fn graph(&self) -> &Graph {
        self.graph.get_or_init(|| match &self.grid {
            Some(grid) => grid::graph(grid),
            None => {
                let edges = self.links.iter();
                let edges = edges.filter(|link| link.kind == SpringKind::Structural);
                Graph::new(self.len(), edges.map(|link| (link.ends, link.rest_length)))
            }
        })
    }

    /// The threads of a mesh, along its structural links, which are numbered from the first of them.
    pub(crate) fn threads(&self) -> &Threads {
        self.threads.get_or_init(|| {
            let links = self.links.iter();
            let links = links.filter(|link| link.kind == SpringKind::Structural);
            let edges: Vec<[u32; 2]> = links.map(|link| link.ends).collect();
            Threads::trace(&edges, &self.rest, |particle| {
                self.normal_of(particle as usize)
            })
        })
    }

    /// Its plane, if it is flat and convex: then the shortest path between two particles is a straight line.
    pub(crate) fn flat(&self) -> Option<&Flat> {
        let flat = self.flat.get_or_init(|| match &self.grid {
            Some(grid) => Some(grid::flat(grid)),
            None if self.extent.pieces > 1 => None,
            None => Flat::find(
                &self.rest,
                self.faces().all(),
                &self.is_border,
                self.extent.area,
            ),
        });
        flat.as_ref()
    }
}

impl Default for Surface {
    /// Of no particles.
    fn default() -> Self {
        Self {
            rest: Vec::new(),
            areas: Vec::new(),
            normals: vec![Vec3::Y],
            particle_of_vertex: None,
            attributes: Vec::new(),
            links: Vec::new(),
            is_border: Vec::new(),
            scale: Vec3::ONE,
            spacing: Spacing::default(),
            extent: Extent::default(),
            grid: None,
            uvs: OnceLock::new(),
            faces: OnceLock::new(),
            graph: OnceLock::new(),
            threads: OnceLock::new(),
            flat: OnceLock::new(),
        }
    }
}

impl fmt::Debug for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Surface")
            .field("particles", &self.len())
            .field("grid", &self.grid)
            .finish_non_exhaustive()
    }
}

/// How the particles of a surface are named in messages: its rows and columns, or how many there are.
impl fmt::Display for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.grid {
            Some(grid) => write!(f, "{} columns × {} rows", grid.columns(), grid.rows()),
            None => write!(
                f,
                "{} particles of {} vertices",
                self.len(),
                self.vertices()
            ),
        }
    }
}
