//! Surfaces that are torn along edges.
//!
//! A torn surface has the faces of the whole one. A particle whose faces do not hang together any more becomes
//! several:
//!
//! ```text
//!   o───o───o          o───o───o      two torn edges make one particle in their middle two;
//!   │   │   │          │   │   │      their other ends still hold both sides together
//!   o═══o═══o    ->    o───o───o
//!   │   │   │           ╲──o──╱
//!   o───o───o          o───o───o
//! ```
//!
//! At rest [each is moved](parted) away from the torn edge by a fiftieth of a face's size. Where the cloth collides with itself,
//! it is moved by as much there: so layers know which side each is on.
//!
//! Particles keep their indices, and new ones follow in the order in which edges were torn. So whoever knows a particle by
//! its index knows it after the next tear, too. A particle's mass and area are shared out by its faces, and nothing is lost.
//!
//! Search and contact need no rule of their own. Their bounds are measured along the springs that are left: they are built
//! from the torn surface as from any mesh.

mod parted;
mod split;
mod springs;
mod stencils;

pub(crate) use stencils::StencilKind;

use std::sync::{Arc, OnceLock};

#[cfg(feature = "mesh")]
use bevy::platform::collections::HashMap;
use bevy::{
    math::{DVec3, Vec3},
    reflect::Reflect,
};
use thiserror::Error;

use super::{
    Derived, Faces, Surface, Torn,
    incidence::Incidence,
    springs::{face_area, sides},
    triangles::VertexAttribute,
};
use crate::cloth::{
    arrays::{chosen, distinct},
    grid::ClothGrid,
};

/// The reason why a cloth can't be torn.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TearError {
    /// A tear runs along no edge of the cloth.
    #[error("no edge of the cloth joins the particles {edge:?}, along which it is torn")]
    NoSuchEdge {
        /// Indices of its ends in the whole cloth.
        edge: [u32; 2],
    },
}

impl Surface {
    /// This surface, torn along edges of the whole surface, in the order in which they were torn. The smaller index of
    /// an edge's ends comes first.
    ///
    /// # Errors
    /// [`TearError::NoSuchEdge`] for the first that is no edge.
    pub(crate) fn torn(self: &Arc<Self>, edges: &[[u32; 2]]) -> Result<Self, TearError> {
        let whole = self.whole();
        let incidence = whole.incidence();
        let is_edge = |ends: &[u32; 2]| !incidence.at(*ends).is_empty();
        if let Some(edge) = edges.iter().find(|edge| !is_edge(edge)) {
            return Err(TearError::NoSuchEdge { edge: *edge });
        }
        let torn = Torn::new(&whole, edges);
        Ok(torn.surface(edges))
    }

    /// The surface before it was torn; itself, if it is not.
    pub(crate) fn whole(self: &Arc<Self>) -> Arc<Self> {
        (self.torn.as_ref()).map_or_else(|| self.clone(), |torn| torn.whole.clone())
    }

    /// Whether it is torn.
    pub fn is_torn(&self) -> bool {
        self.torn.is_some()
    }

    /// The surface before it was torn; itself, if it is not.
    pub(super) fn before_tears(&self) -> &Self {
        self.torn.as_ref().map_or(self, |torn| &torn.whole)
    }

    /// The grid that it was made from, torn or not.
    pub(crate) fn rest_grid(&self) -> Option<&ClothGrid> {
        self.before_tears().as_grid()
    }

    /// The particle of the whole surface that a particle was before anything was torn.
    pub fn origin_of(&self, particle: u32) -> u32 {
        (self.torn.as_ref()).map_or(particle, |torn| torn.origin[particle as usize])
    }

    /// The positions of the particles at rest (m) before anything was torn.
    pub(crate) fn whole_positions(&self) -> impl Iterator<Item = Vec3> + '_ {
        let before = &self.before_tears().rest;
        (0..self.len() as u32).map(|particle| before[self.origin_of(particle) as usize])
    }

    /// Whether it encloses a volume, or did so before it was torn.
    pub(crate) fn was_closed(&self) -> bool {
        self.before_tears().is_closed()
    }

    /// The connected piece of each particle, numbered from 0.
    pub(crate) fn pieces_of(&self) -> &[u32] {
        let find = || self.graph().pieces_of();
        self.derived.pieces.get_or_init(find)
    }

    /// The particles that tears made, each with the one that it was before.
    pub(crate) fn copies(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let torn = self.torn.as_ref();
        torn.into_iter().flat_map(|torn| {
            let first = torn.whole.len();
            let copies = torn.origin.iter().enumerate().skip(first);
            copies.map(|(copy, origin)| (copy as u32, *origin))
        })
    }

    /// The particles of each face, by the sorted particles that they were before anything was torn.
    #[cfg(feature = "mesh")]
    pub(crate) fn faces_by_origin(&self) -> HashMap<[u32; 3], [u32; 3]> {
        let origin = |face: [u32; 3]| {
            crate::cloth::arrays::sorted(face.map(|corner| self.origin_of(corner)))
        };
        let faces = self.triangles().iter();
        faces.map(|face| (origin(*face), *face)).collect()
    }

    /// Whether a path along edges leads from one face to another, not much longer than the way between them at rest.
    #[cfg(feature = "mesh")]
    pub(crate) fn hang_together(&self, from: [u32; 3], to: [u32; 3]) -> bool {
        let place = |particle: u32| self.rest[particle as usize];
        let farthest = 2.0 * (place(from[0]).distance(place(to[0])) + self.spacing.longest);
        let mut reached = from.to_vec();
        let mut next = 0;
        while let Some(&particle) = reached.get(next) {
            next += 1;
            if to.contains(&particle) {
                return true;
            }
            for (beside, _) in self.graph().of(particle) {
                let is_near = place(*beside).distance(place(from[0])) <= farthest;
                if is_near && !reached.contains(beside) {
                    reached.push(*beside);
                }
            }
        }
        false
    }

    /// Gives each particle that tears made the value of the one that it was before.
    pub(crate) fn share_with_copies<T: Clone>(&self, values: &mut [T]) {
        for (copy, origin) in self.copies() {
            values[copy as usize] = values[origin as usize].clone();
        }
    }

    /// For each particle, one of `other` that had one of its faces. Both are the same whole surface, torn in different
    /// ways; `None` if they are not.
    pub(crate) fn parents_in(self: &Arc<Self>, other: &Arc<Self>) -> Option<Vec<u32>> {
        let (whole, of_other) = (self.whole(), other.whole());
        // Cloths that are made alike need not share it.
        let is_alike =
            || whole.len() == of_other.len() && whole.triangles() == of_other.triangles();
        if !Arc::ptr_eq(&whole, &of_other) && !is_alike() {
            return None;
        }
        let mut parents: Vec<u32> = (0..self.len() as u32).collect();
        let corners = |of: &Self, face: usize| match &of.torn {
            Some(torn) => torn.corners[face],
            None => whole.triangles()[face],
        };
        for face in (0..whole.triangles().len()).rev() {
            for (own, others) in corners(self, face).into_iter().zip(corners(other, face)) {
                parents[own as usize] = others;
            }
        }
        Some(parents)
    }

    /// The middle of a face, or of its cell on a grid, with the particles at these places (m).
    pub(crate) fn middle_of(&self, face: [u32; 3], places: &[DVec3]) -> DVec3 {
        let place = |corner: u32| places[corner as usize];
        if self.rest_grid().is_some() {
            let origins = face.map(|corner| self.origin_of(corner));
            let diagonal = self.before_tears().diagonal_of(origins);
            let ends = face.into_iter().zip(origins);
            let ends = ends.filter(|(_, origin)| diagonal.contains(origin));
            return ends.map(|(end, _)| place(end)).sum::<DVec3>() / 2.0;
        }
        face.map(place).into_iter().sum::<DVec3>() / 3.0
    }

    /// The faces at a particle.
    pub(crate) fn faces_around(&self, particle: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        let around = self.incidence().around(particle).iter();
        around.map(|face| self.triangles()[*face as usize])
    }

    /// Calls `visit` with each edge between two faces, and the faces.
    pub(crate) fn for_each_fold(&self, mut visit: impl FnMut([u32; 2], [[u32; 3]; 2])) {
        let faces = self.triangles();
        for sides in self.incidence().sides.windows(2) {
            if sides[0].ends == sides[1].ends {
                let beside = [0, 1].map(|at| faces[sides[at].face as usize]);
                visit(sides[0].ends, beside);
            }
        }
    }

    pub(super) fn incidence(&self) -> &Incidence {
        let make = || Incidence::new(self.triangles(), self.len());
        self.derived.incidence.get_or_init(make)
    }

    /// Shares of a face's area that its corners have. Those of a grid are a quarter of each cell.
    fn shares(&self, face: [u32; 3]) -> [f32; 3] {
        if self.rest_grid().is_none() {
            return [1.0 / 3.0; 3];
        }
        let diagonal = self.diagonal_of(face);
        face.map(|at| if diagonal.contains(&at) { 0.25 } else { 0.5 })
    }

    /// The two ends of a face's longest side, a cell's diagonal, the smaller first.
    fn diagonal_of(&self, face: [u32; 3]) -> [u32; 2] {
        let square = |ends: &[u32; 2]| {
            let [a, b] = ends.map(|end| self.rest[end as usize]);
            a.distance_squared(b)
        };
        let longest = sides(face)
            .into_iter()
            .max_by(|a, b| square(a).total_cmp(&square(b)));
        longest.unwrap_or_default()
    }
}

impl Torn {
    fn surface(self, edges: &[[u32; 2]]) -> Surface {
        let whole = self.whole.clone();
        let rest = self.of_origin(&whole.rest);
        let normals = match &whole.normals[..] {
            [one] => vec![*one],
            each => self.of_origin(each),
        };
        let areas = self.areas(edges);
        let (links, is_border) = self.links();
        let mut order: Vec<u32> = (0..self.corners.len() as u32).collect();
        let first = |face: &u32| self.corners[*face as usize].into_iter().min();
        order.sort_by_key(first);
        let faces = Faces::by_first_corner(&chosen(&self.corners, &order), rest.len());
        let grain = match whole.as_grid() {
            Some(grid) => {
                let below = whole.rest[grid.columns() as usize];
                vec![(below - whole.rest[0]).normalize(); order.len()]
            }
            None if whole.grain.is_empty() => Vec::new(),
            None => chosen(&whole.grain, &order),
        };
        let of_origin = |attribute: &VertexAttribute| {
            VertexAttribute::new(attribute.name(), self.of_origin(attribute.values()))
        };
        let uvs = match whole.uvs() {
            [] => Vec::new(),
            uvs => self.of_origin(uvs),
        };
        let mut surface = Surface {
            areas,
            normals,
            particle_of_vertex: whole.particle_of_vertex.clone(),
            attributes: whole.attributes.iter().map(of_origin).collect(),
            links,
            grain,
            is_border,
            scale: whole.scale,
            spacing: whole.spacing,
            extent: whole.extent,
            grid: None,
            rest,
            torn: Some(Box::new(self)),
            derived: Derived {
                uvs: OnceLock::from(uvs),
                faces: OnceLock::from(faces),
                ..Derived::default()
            },
        };
        surface.extent.pieces = surface.graph().pieces();
        surface.rest = surface.parted(&surface.rest, |particle| surface.origin_of(particle));
        surface
    }

    /// Values of the whole surface's particles, for each of this one's.
    fn of_origin<T: Copy>(&self, whole: &[T]) -> Vec<T> {
        chosen(whole, &self.origin)
    }

    /// Areas of the particles. Those of the whole surface, but where edges are torn.
    fn areas(&self, edges: &[[u32; 2]]) -> Vec<f32> {
        let whole = &self.whole;
        let mut areas = whole.areas.clone();
        areas.resize(self.origin.len(), 0.0);
        for particle in distinct(edges.iter().flatten().copied()) {
            areas[particle as usize] = 0.0;
            for &face in whole.incidence().around(particle) {
                let corners = whole.triangles()[face as usize];
                let area = face_area(corners, &whole.rest);
                let shares = whole.shares(corners);
                for (at, share) in shares.into_iter().enumerate() {
                    if corners[at] == particle {
                        areas[self.corners[face as usize][at] as usize] += area * share;
                    }
                }
            }
        }
        areas
    }
}
