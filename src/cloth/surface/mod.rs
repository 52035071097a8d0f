//! The surface of a cloth at rest. It does not change while the cloth moves.
//!
//! A surface is made from a grid or from a triangle mesh. Solver, hierarchy, contact and rendering use only the
//! surface. Only the code that makes one, and pins by rows and columns, ask whether it is a grid.

#[cfg(feature = "mesh")]
mod asset;
mod bending;
mod binding;
mod bound;
mod calibration;
mod chains;
mod faces;
mod fans;
mod flat;
mod from_grid;
mod from_mesh;
mod graph;
mod grid;
mod incidence;
mod normals;
mod orientation;
mod paths;
mod springs;
#[cfg(test)]
mod tests;
mod torn;
mod triangles;
mod triangulation;
mod weld;
mod widths;
mod woven;

use std::{
    fmt,
    sync::{Arc, OnceLock},
};

use bevy::math::{Vec2, Vec3};

use super::{grid::ClothGrid, lanes::Layout, spring::SpringKind};
use incidence::Incidence;

pub use binding::SurfaceBinding;
pub use from_mesh::MAX_MESH_PARTICLES;
pub use torn::TearError;
pub use triangles::{MeshError, TriangleMesh, VertexAttribute};
use triangulation::Triangulation;
pub use woven::GrainError;

#[cfg(feature = "mesh")]
pub(crate) use asset::{indices_of_asset, positions_of_asset, skin_of_asset};
pub(crate) use chains::{Chain, Chains};
pub(crate) use faces::Faces;
pub(crate) use fans::{Fan, Fans};
pub(crate) use flat::Flat;
pub(crate) use graph::Graph;
#[cfg(feature = "mesh")]
pub(crate) use normals::add_face_normals;
pub(crate) use paths::ShortestPaths;
pub(crate) use springs::Link;
pub(crate) use torn::StencilKind;
pub(crate) use triangles::JointWeights;
#[cfg(feature = "mesh")]
pub(crate) use weld::same_places;

/// A cloth's surface at rest: its particles, the triangles between them, their areas and neighbours. It is in the
/// cloth's own frame, in metres, with the transform's scale applied.
///
/// It never changes, so that equal cloths share one.
#[derive(Clone)]
pub struct Surface {
    rest: Vec<Vec3>,
    areas: Vec<f32>,
    /// One normal for a flat surface, else one for each particle.
    normals: Vec<Vec3>,
    /// The particle of each vertex of the mesh; `None` if each vertex is its own particle.
    particle_of_vertex: Option<Vec<u32>>,
    attributes: Vec<VertexAttribute>,
    /// The springs of a mesh. Those of a grid follow from its rows and columns.
    links: Vec<Link>,
    /// Direction of the warp in each face of a mesh, of length 1; empty without a [grain](crate::cloth::ClothGrain).
    grain: Vec<Vec3>,
    /// On a mesh, marks particles at an edge that does not have two faces.
    is_border: Vec<bool>,
    scale: Vec3,
    spacing: Spacing,
    extent: Extent,
    grid: Option<ClothGrid>,
    torn: Option<Box<Torn>>,
    derived: Derived,
}

/// The whole surface of a torn one, and how its particles follow from it.
#[derive(Debug, Clone)]
struct Torn {
    whole: Arc<Surface>,
    /// The particles of each face, in the order of the whole surface's faces.
    corners: Vec<[u32; 3]>,
    /// The particle of the whole surface that each particle was.
    origin: Vec<u32>,
}

/// Computed when they are first asked for: a cloth that nothing touches or points at needs none of them.
#[derive(Default, Clone)]
struct Derived {
    uvs: OnceLock<Vec<Vec2>>,
    faces: OnceLock<Faces>,
    fans: OnceLock<Fans>,
    graph: OnceLock<Graph>,
    pieces: OnceLock<Vec<u32>>,
    chains: OnceLock<Chains>,
    flat: OnceLock<Option<Flat>>,
    face_widths: OnceLock<Vec<f32>>,
    incidence: OnceLock<Incidence>,
    along_warp: OnceLock<Vec<f32>>,
    bending: OnceLock<Triangulation>,
}

/// Rest lengths of the stretch springs (m).
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Spacing {
    /// The shortest (m).
    pub shortest: f32,
    /// The median (m); on a grid, the smaller of the two.
    pub typical: f32,
    /// The longest (m).
    pub longest: f32,
}

/// The size of a surface.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Extent {
    /// Diagonal of the bounding box at rest (m).
    pub diagonal: f32,
    /// Total area (m²).
    pub area: f32,
    /// Number of particles across its narrow side.
    pub particles_across: usize,
    /// Largest distance from a particle to a corner of its faces, along stretch springs (m).
    pub face_reach: f32,
    /// Rest length of the longest spring between neighbours, including shear springs (m).
    pub longest_spring: f32,
    /// Largest number of faces at one particle.
    pub max_faces: usize,
    /// Number of connected pieces.
    pub pieces: usize,
}

impl Surface {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.rest.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Position of each particle at rest (m).
    pub fn rest_positions(&self) -> &[Vec3] {
        &self.rest
    }

    /// A particle's share of the surface's area (m²).
    pub fn area_of(&self, particle: usize) -> f32 {
        self.areas[particle]
    }

    /// Total area (m²).
    pub fn area(&self) -> f32 {
        self.extent.area
    }

    /// The surface's normal at a particle at rest, of length 1.
    pub fn normal_of(&self, particle: usize) -> Vec3 {
        let index = if self.normals.len() == 1 { 0 } else { particle };
        self.normals[index]
    }

    /// Triangles, as particle indices, counter-clockwise seen from the front.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.faces().all()
    }

    /// Number of vertices that the surface was made from, before it was torn.
    pub fn vertices(&self) -> usize {
        let particles = self.particle_of_vertex.as_ref();
        particles.map_or(self.before_tears().len(), Vec::len)
    }

    /// The particle of a vertex that the surface was made from. `None` if no triangle with an area uses the vertex.
    pub fn particle_of_vertex(&self, vertex: usize) -> Option<usize> {
        let particle = match &self.particle_of_vertex {
            None => vertex,
            Some(particles) => *particles.get(vertex)? as usize,
        };
        (particle < self.len()).then_some(particle)
    }

    /// Rest lengths of its stretch springs.
    pub fn spacing(&self) -> Spacing {
        self.spacing
    }

    /// The diagonal of the surface at rest (m).
    pub fn diagonal(&self) -> f32 {
        self.extent.diagonal
    }

    /// The grid that the surface was made from, if any.
    pub fn as_grid(&self) -> Option<&ClothGrid> {
        self.grid.as_ref()
    }

    /// Half of the thickness of a rope (m); `None` for what has faces.
    pub fn rope_radius(&self) -> Option<f32> {
        self.grid.as_ref()?.rope_radius()
    }

    /// Whether the surface encloses a volume: it is a mesh with two faces at each edge.
    pub fn is_closed(&self) -> bool {
        !self.is_border.is_empty() && !self.is_border.contains(&true)
    }

    /// Number of connected pieces.
    pub fn pieces(&self) -> usize {
        self.extent.pieces
    }

    /// Number of particles across its narrow side.
    pub(crate) fn particles_across(&self) -> usize {
        self.extent.particles_across
    }

    /// Number of particles along its long side: of a grid, torn or not, and of a mesh as of a square with its diagonal.
    pub fn particles_along(&self) -> usize {
        match self.rest_grid() {
            Some(grid) => grid.columns().max(grid.rows()) as usize,
            None => {
                let side = self.diagonal() * std::f32::consts::FRAC_1_SQRT_2;
                (side / self.spacing().typical) as usize + 1
            }
        }
    }

    /// Largest distance from a particle to a corner of its faces, along stretch springs and, with `diagonals`, shear springs (m).
    pub(crate) fn face_reach(&self, diagonals: bool) -> f32 {
        [self.extent.face_reach, self.extent.longest_spring][usize::from(diagonals)]
    }

    /// Rest length of the longest spring between neighbours, including shear springs (m).
    pub(crate) fn longest_spring(&self) -> f32 {
        self.extent.longest_spring
    }

    /// Largest number of faces at one particle.
    pub(crate) fn max_faces(&self) -> usize {
        self.extent.max_faces
    }

    /// The transform's scale, already applied.
    pub(crate) fn scale(&self) -> Vec3 {
        self.scale
    }

    /// The vertices' attributes besides their positions.
    pub(crate) fn attributes(&self) -> &[VertexAttribute] {
        &self.attributes
    }

    /// The springs of a mesh; empty for a grid.
    pub(crate) fn links(&self) -> &[Link] {
        &self.links
    }

    /// The links along edges of a mesh.
    fn edges(&self) -> impl Iterator<Item = &Link> + Clone {
        let links = self.links.iter();
        links.filter(|link| link.kind == SpringKind::Structural)
    }

    /// Texture coordinates of each particle; empty if there are none.
    pub fn uvs(&self) -> &[Vec2] {
        let of_grid = || self.grid.as_ref().map(grid::uvs);
        (self.derived.uvs).get_or_init(|| of_grid().unwrap_or_default())
    }

    /// Its faces, by their owners.
    pub(crate) fn faces(&self) -> &Faces {
        let of_grid = || self.grid.as_ref().map(grid::faces);
        (self.derived.faces).get_or_init(|| of_grid().unwrap_or_default())
    }

    /// Where the corners of its faces are, by their owners.
    pub(crate) fn fans(&self) -> &Fans {
        let make = || Fans::new(self.faces(), self.layout());
        self.derived.fans.get_or_init(make)
    }

    /// Where its particles are in memory: rows of a grid, torn or not, or one row.
    pub(crate) fn layout(&self) -> Layout {
        match &self.grid {
            Some(grid) => Layout::new(grid.columns(), grid.rows()),
            None => match self.rest_grid() {
                Some(grid) => Layout::of_torn_grid(grid.columns(), self.len() as u32),
                None => Layout::new(self.len() as u32, 1),
            },
        }
    }

    /// Neighbours of each particle.
    pub(crate) fn graph(&self) -> &Graph {
        self.derived.graph.get_or_init(|| match &self.grid {
            Some(grid) => grid::graph(grid),
            None => {
                let edges = self.edges().map(|link| (link.ends, link.rest_length));
                Graph::new(self.len(), edges)
            }
        })
    }

    /// The chains of a mesh along its structural links. Their indices count from the first structural link.
    pub(crate) fn chains(&self) -> &Chains {
        self.derived.chains.get_or_init(|| self.chains_beyond(0))
    }

    /// The same along those links alone that have an end from this particle on.
    pub(crate) fn chains_beyond(&self, first: u32) -> Chains {
        let is_beyond = |[a, b]: [u32; 2]| a.max(b) >= first;
        let chosen = (0_u32..).zip(self.edges().map(|link| link.ends));
        let (numbers, edges): (Vec<u32>, Vec<[u32; 2]>) =
            chosen.filter(|(_, ends)| is_beyond(*ends)).unzip();
        let normal = |particle| self.normal_of(particle as usize);
        Chains::trace(&edges, &self.rest, normal).renamed(|edge| numbers[edge as usize])
    }

    /// Its plane, if it is flat and convex. The shortest path between two particles is then a straight line.
    pub(crate) fn flat(&self) -> Option<&Flat> {
        let flat = self.derived.flat.get_or_init(|| match &self.grid {
            Some(grid) => Some(grid::flat(grid)),
            None if self.extent.pieces > 1 => None,
            None => Flat::find(&self.rest, self.triangles(), &self.is_border, self.area()),
        });
        flat.as_ref()
    }
}

impl Default for Surface {
    /// A surface without particles.
    fn default() -> Self {
        Self {
            rest: Vec::new(),
            areas: Vec::new(),
            normals: vec![Vec3::Y],
            particle_of_vertex: None,
            attributes: Vec::new(),
            links: Vec::new(),
            grain: Vec::new(),
            is_border: Vec::new(),
            scale: Vec3::ONE,
            spacing: Spacing::default(),
            extent: Extent::default(),
            grid: None,
            torn: None,
            derived: Derived::default(),
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

/// Writes the size of a surface for messages: its columns and rows, or its particles and vertices.
impl fmt::Display for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.grid {
            Some(grid) if grid.rows() == 1 => write!(f, "a rope of {} particles", grid.columns()),
            Some(grid) => write!(f, "{} columns × {} rows", grid.columns(), grid.rows()),
            None => {
                let (particles, vertices) = (self.len(), self.vertices());
                write!(f, "{particles} particles of {vertices} vertices")
            }
        }
    }
}
