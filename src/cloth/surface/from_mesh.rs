//! Surfaces made from triangles: vertices at the same position become one particle.

use std::sync::OnceLock;

use bevy::{math::Vec3, platform::collections::HashSet};

use super::{
    Derived, Extent, Spacing, Surface,
    calibration::calibrate,
    faces::{Faces, first_corner},
    graph::Graph,
    normals::add_face_normals,
    orientation::orient,
    springs::{Side, face_area, has_area, links, sides, sides_of},
    triangles::{MeshError, TriangleMesh, VertexAttribute},
    weld::same_places,
};
use crate::cloth::{
    arrays::{chosen, distinct, sorted},
    quantity::Allowed,
    spring::SpringKind,
};

/// The most particles that a cloth from a mesh may have: more could not run in real time.
pub const MAX_MESH_PARTICLES: usize = 1 << 18;

/// Marks a vertex without a particle.
const NO_PARTICLE: u32 = u32::MAX;

/// A particle whose share is less than this fraction of the mean area is dropped.
const NEGLIGIBLE: f32 = 1.0e-6;

impl Surface {
    /// Makes the surface of a mesh under a transform's `scale`. Vertices no farther apart than `weld` (m, before the
    /// scale) become one particle.
    ///
    /// Triangles without an area are left out, and so are all but the first of several triangles between the same three
    /// particles. Vertices without a remaining triangle are left out, too. Several pieces form one cloth, and an edge
    /// may have any number of faces.
    ///
    /// # Errors
    /// The first error found, with the vertex or triangle at fault.
    pub fn of_mesh(mesh: &TriangleMesh, weld: f32, scale: Vec3) -> Result<Self, MeshError> {
        check(mesh, weld, scale)?;
        let places: Vec<Vec3> = mesh.positions.iter().map(|place| *place * scale).collect();
        // A shorter length could not be measured.
        let weld = weld.max(1.0e-9 / scale.abs().min_element());
        let mut welded = Welded::new(mesh, weld, &places);
        welded.check_count()?;
        welded.drop_what_has_no_area(mesh.triangles.len())?;
        welded.arrange();
        Ok(welded.surface(mesh, scale))
    }
}

fn check(mesh: &TriangleMesh, weld: f32, scale: Vec3) -> Result<(), MeshError> {
    Allowed::SIZE.check("weld distance (m)", [weld])?;
    let particles = mesh.positions.len();
    // A particle usually has a few vertices; far too many are rejected before welding.
    if particles > 8 * MAX_MESH_PARTICLES {
        return Err(MeshError::TooLarge { particles });
    }
    MeshError::check_vertices(&mesh.positions, scale)?;
    MeshError::check_triangles(&mesh.triangles, particles)
}

/// Welded vertices, on the way to a surface.
struct Welded {
    rest: Vec<Vec3>,
    /// The particle of each vertex.
    particle_of: Vec<u32>,
    faces: Vec<[u32; 3]>,
    /// The sum of the vertices' normals at each particle; empty without normals.
    normals: Vec<Vec3>,
    pieces: usize,
}

impl Welded {
    fn new(mesh: &TriangleMesh, weld: f32, places: &[Vec3]) -> Self {
        let (first, particle_of) = same_places(&mesh.positions, weld);
        let rest = chosen(places, &first);
        let mut normals = Vec::new();
        if mesh.normals.len() == mesh.positions.len() {
            normals.resize(rest.len(), Vec3::ZERO);
            for (normal, &particle) in mesh.normals.iter().zip(&particle_of) {
                normals[particle as usize] += *normal;
            }
        }
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| particle_of[corner as usize]);
        let mut faces: Vec<[u32; 3]> = mesh.triangles.iter().map(corners).collect();
        faces.retain(|[a, b, c]| a != b && b != c && c != a);
        let mut known = HashSet::<[u32; 3]>::default();
        faces.retain(|face| known.insert(sorted(*face)));
        Self {
            rest,
            particle_of,
            faces,
            normals,
            pieces: 0,
        }
    }

    /// Checks that there are no more particles than a cloth may have.
    fn check_count(&self) -> Result<(), MeshError> {
        let counts = count_faces(&self.faces, self.rest.len());
        let particles = counts.iter().filter(|count| **count > 0).count();
        if particles > MAX_MESH_PARTICLES {
            return Err(MeshError::TooLarge { particles });
        }
        Ok(())
    }

    /// Drops faces without an area, and particles without a share of the area, with their faces.
    fn drop_what_has_no_area(&mut self, triangles: usize) -> Result<(), MeshError> {
        self.faces.retain(|face| has_area(*face, &self.rest));
        loop {
            let (areas, total) = self.areas();
            let mean = total / areas.iter().filter(|area| **area > 0.0).count().max(1) as f32;
            let stands_for_some = |particle: u32| areas[particle as usize] > NEGLIGIBLE * mean;
            let before = self.faces.len();
            self.faces
                .retain(|face| face.iter().all(|corner| stands_for_some(*corner)));
            // Lengths in a cloth have to exceed rounding errors.
            if self.faces.is_empty() || mean < 1.0e-18 {
                return Err(MeshError::WithoutArea { triangles });
            }
            if self.faces.len() == before {
                return Ok(());
            }
        }
    }

    /// Each particle's share of the area, a third of each of its faces, and the total (m²).
    fn areas(&self) -> (Vec<f32>, f32) {
        let mut areas = vec![0.0; self.rest.len()];
        let mut total = 0.0_f64;
        for face in &self.faces {
            let area = face_area(*face, &self.rest);
            total += f64::from(area);
            for corner in face {
                areas[*corner as usize] += area / 3.0;
            }
        }
        (areas, total as f32)
    }

    /// Numbers the particles that are corners of a face, so that neighbours are near each other in memory.
    fn arrange(&mut self) {
        let edges = distinct(self.faces.iter().flat_map(|face| sides(*face)));
        let graph = Graph::new(self.rest.len(), edges.iter().map(|edge| (*edge, 1.0)));
        let mut order = graph.order();
        order.retain(|particle| !graph.of(*particle).is_empty());
        self.pieces = graph.pieces();
        let mut number = vec![NO_PARTICLE; self.rest.len()];
        for (index, &particle) in order.iter().enumerate() {
            number[particle as usize] = index as u32;
        }
        self.rest = chosen(&self.rest, &order);
        if !self.normals.is_empty() {
            self.normals = chosen(&self.normals, &order);
        }
        for face in &mut self.faces {
            *face = face.map(|corner| number[corner as usize]);
        }
        for particle in &mut self.particle_of {
            *particle = number[*particle as usize];
        }
    }

    fn surface(mut self, mesh: &TriangleMesh, scale: Vec3) -> Surface {
        // As in the asset, without the mirroring of the scale.
        let unscaled: Vec<Vec3> = self.rest.iter().map(|place| *place / scale).collect();
        self.faces.sort_by_key(first_corner);
        let sides = sides_of(&self.faces);
        orient(&mut self.faces, &sides, &unscaled, &self.normals);
        let (areas, area) = self.areas();
        let particles = self.rest.len();
        let faces = Faces::by_first_corner(&self.faces, particles);
        let mut normals = vec![Vec3::ZERO; particles];
        add_face_normals(faces.all(), &self.rest, &mut normals);
        for normal in &mut normals {
            *normal = normal.normalize_or(Vec3::Y);
        }
        let mut links = links(faces.all(), &sides, &self.rest);
        let is_border = borders(&sides, particles);
        calibrate(&mut links, &self.rest, &normals, &is_border, |_| 1.0);
        let edges = links
            .iter()
            .filter(|link| link.kind == SpringKind::Structural);
        let mut lengths: Vec<f32> = edges.map(|link| link.rest_length).collect();
        lengths.sort_unstable_by(f32::total_cmp);
        let spacing = Spacing {
            shortest: lengths[0],
            typical: lengths[lengths.len() / 2],
            longest: lengths[lengths.len() - 1],
        };
        let low = self.rest.iter().copied().fold(Vec3::MAX, Vec3::min);
        let high = self.rest.iter().copied().fold(Vec3::MIN, Vec3::max);
        let diagonal = low.distance(high);
        let has_uvs = mesh.uvs.len() == self.particle_of.len();
        let uvs = if has_uvs {
            merged(&mesh.uvs, &self.particle_of, particles, |first, _| first)
        } else {
            Vec::new()
        };
        let larger =
            |first: [f32; 4], other: [f32; 4]| std::array::from_fn(|at| first[at].max(other[at]));
        let is_whole = |of: &&VertexAttribute| of.values().len() == self.particle_of.len();
        let attribute = |of: &VertexAttribute| {
            let values = merged(of.values(), &self.particle_of, particles, larger);
            VertexAttribute::new(of.name(), values)
        };
        let attributes = mesh.attributes.iter().filter(is_whole);
        let attributes = attributes.map(attribute).collect();
        let most = count_faces(faces.all(), particles).into_iter().max();
        Surface {
            normals,
            rest: self.rest,
            areas,
            particle_of_vertex: Some(self.particle_of),
            attributes,
            links,
            is_border,
            scale,
            spacing,
            extent: Extent {
                diagonal,
                area,
                particles_across: (area / diagonal / spacing.typical).max(1.0) as usize,
                face_reach: spacing.longest,
                longest_spring: spacing.longest,
                max_faces: most.unwrap_or(0),
                pieces: self.pieces,
            },
            derived: Derived {
                uvs: OnceLock::from(uvs),
                faces: OnceLock::from(faces),
                ..Derived::default()
            },
            ..Surface::default()
        }
    }
}

/// Merges the vertices' values into one for each particle.
fn merged<T: Copy + Default>(
    values: &[T],
    particle_of: &[u32],
    particles: usize,
    merge: impl Fn(T, T) -> T,
) -> Vec<T> {
    let mut of_particle = vec![None; particles];
    for (value, &particle) in values.iter().zip(particle_of) {
        if let Some(known) = of_particle.get_mut(particle as usize) {
            *known = Some(known.map_or(*value, |known| merge(known, *value)));
        }
    }
    let values = of_particle.into_iter();
    values.map(Option::unwrap_or_default).collect()
}

/// Marks particles at an edge that does not have two faces.
fn borders(sides: &[Side], particles: usize) -> Vec<bool> {
    let mut is_border = vec![false; particles];
    let edges = sides.chunk_by(|a, b| a.ends == b.ends);
    for faces in edges.filter(|faces| faces.len() != 2) {
        for end in faces[0].ends {
            is_border[end as usize] = true;
        }
    }
    is_border
}

/// Number of faces at each particle.
fn count_faces(faces: &[[u32; 3]], particles: usize) -> Vec<usize> {
    let mut counts = vec![0; particles];
    for corner in faces.iter().flatten() {
        counts[*corner as usize] += 1;
    }
    counts
}
