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
//! They are moved apart by a fiftieth of the way to their faces' middles, so that layers know which side each is on.
//!
//! Particles keep their indices, and new ones follow in the order in which edges were torn. So whoever knows a particle by
//! its index knows it after the next tear, too. A particle's mass and area are shared out by its faces, and nothing is lost.
//!
//! Search and contact need no rule of their own. Their bounds are measured along the springs that are left: they are built
//! from the torn surface as from any mesh.

use std::sync::{Arc, OnceLock};

use bevy::math::{DVec3, Vec3};
#[cfg(feature = "mesh")]
use bevy::platform::collections::HashMap;

use super::{
    Derived, Extent, Faces, Link, Surface,
    springs::{Side, face_area, for_each_pair, sides_of},
    triangles::VertexAttribute,
};
use crate::cloth::{error::ClothError, grid::ClothGrid, spring::SpringKind};

/// How far a cut moves its sides apart, each, as a fraction of the way to the middle of the faces beside it.
const HALF_WIDTH: f32 = 0.02;

/// What a torn surface knows of the whole one.
#[derive(Debug, Clone)]
pub(super) struct Torn {
    whole: Arc<Surface>,
    /// The particles of each face, in the order of the whole surface's faces.
    pub(super) corners: Vec<[u32; 3]>,
    /// The particle of the whole surface that each particle was.
    origin: Vec<u32>,
}

/// The sides of all faces, and the faces at each particle.
#[derive(Debug, Default, Clone)]
pub(super) struct Incidence {
    sides: Vec<Side>,
    /// First face of each particle; one more entry than particles.
    first: Vec<u32>,
    faces: Vec<u32>,
}

impl Incidence {
    fn new(faces: &[[u32; 3]], particles: usize) -> Self {
        let mut first = vec![0; particles + 1];
        for corner in faces.iter().flatten() {
            first[*corner as usize + 1] += 1;
        }
        for particle in 0..particles {
            first[particle + 1] += first[particle];
        }
        let mut next = first.clone();
        let mut around = vec![0; 3 * faces.len()];
        for (index, face) in faces.iter().enumerate() {
            for corner in face {
                let next = &mut next[*corner as usize];
                around[*next as usize] = index as u32;
                *next += 1;
            }
        }
        Self {
            sides: sides_of(faces),
            first,
            faces: around,
        }
    }

    /// The faces at a particle, ascending.
    pub fn around(&self, particle: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|at| self.first[particle as usize + at] as usize);
        &self.faces[start..end]
    }

    /// The sides of the faces at an edge, whose smaller end comes first.
    pub fn at(&self, ends: [u32; 2]) -> &[Side] {
        let start = self.sides.partition_point(|side| side.ends < ends);
        let count = self.sides[start..].partition_point(|side| side.ends == ends);
        &self.sides[start..start + count]
    }
}

impl Surface {
    /// This surface, torn along edges of the whole surface, in the order in which they were torn. The smaller index of
    /// an edge's ends comes first.
    ///
    /// # Errors
    /// [`ClothError::NoSuchEdge`] for the first that is no edge.
    pub(crate) fn torn(self: &Arc<Self>, edges: &[[u32; 2]]) -> Result<Self, ClothError> {
        let whole = self.whole();
        let incidence = whole.incidence();
        let is_edge = |ends: &[u32; 2]| !incidence.at(*ends).is_empty();
        if let Some(edge) = edges.iter().find(|edge| !is_edge(edge)) {
            return Err(ClothError::NoSuchEdge { edge: *edge });
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

    /// The grid that it was made from, torn or not.
    pub(crate) fn rest_grid(&self) -> Option<&ClothGrid> {
        let torn = self.torn.as_ref().and_then(|torn| torn.whole.as_grid());
        self.as_grid().or(torn)
    }

    /// The particle of the whole surface that a particle was before anything was torn.
    pub fn origin_of(&self, particle: u32) -> u32 {
        (self.torn.as_ref()).map_or(particle, |torn| torn.origin[particle as usize])
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
        let faces = self.triangles().iter();
        let by_origin = |face: &[u32; 3]| {
            let mut origin = face.map(|corner| self.origin_of(corner));
            origin.sort_unstable();
            (origin, *face)
        };
        faces.map(by_origin).collect()
    }

    /// The places of all particles (m), with a little room between those that have one parent: a cut has a width. So contact of
    /// cloth with cloth knows which side each is on.
    pub(crate) fn parted(&self, places: &[Vec3], parent: impl Fn(u32) -> u32) -> Vec<Vec3> {
        let mut children = vec![0_u32; self.len()];
        (0..self.len() as u32).for_each(|child| children[parent(child) as usize] += 1);
        let mut sums = vec![(Vec3::ZERO, 0.0); self.len()];
        for face in self.triangles() {
            let middle = face
                .iter()
                .map(|corner| places[*corner as usize])
                .sum::<Vec3>()
                / 3.0;
            for corner in face {
                let (sum, count) = &mut sums[*corner as usize];
                (*sum, *count) = (*sum + middle, *count + 1.0);
            }
        }
        let apart = |(child, (sum, count)): (usize, (Vec3, f32))| match children
            [parent(child as u32) as usize]
        {
            0 | 1 => places[child],
            _ => places[child].lerp(sum / count, HALF_WIDTH),
        };
        sums.into_iter().enumerate().map(apart).collect()
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
        if !Arc::ptr_eq(&whole, &of_other) && whole.triangles() != of_other.triangles() {
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

    /// The faces at a particle.
    pub(crate) fn faces_around(&self, particle: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        let around = self.incidence().around(particle).iter();
        around.map(|face| self.triangles()[*face as usize])
    }

    /// The middle of a face, or of its cell on a grid, with the particles at these places (m).
    pub(crate) fn middle_of(&self, face: [u32; 3], places: &[DVec3]) -> DVec3 {
        let place = |corner: u32| places[corner as usize];
        if self.rest_grid().is_some() {
            let [a, b] = self.diagonal_of(face);
            return (place(a) + place(b)) / 2.0;
        }
        face.map(place).into_iter().sum::<DVec3>() / 3.0
    }

    /// Calls `visit` with each edge between two faces, and the faces.
    pub(crate) fn for_each_fold(&self, mut visit: impl FnMut([u32; 2], [[u32; 3]; 2])) {
        let faces = self.triangles();
        for sides in self.incidence().sides.windows(2) {
            if sides[0].ends == sides[1].ends {
                visit(
                    sides[0].ends,
                    [0, 1].map(|at| faces[sides[at].face as usize]),
                );
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
        face.map(|corner| {
            if diagonal.contains(&corner) {
                0.25
            } else {
                0.5
            }
        })
    }

    /// The two ends of a face's longest side, a cell's diagonal, the smaller first.
    fn diagonal_of(&self, [a, b, c]: [u32; 3]) -> [u32; 2] {
        let square =
            |[a, b]: [u32; 2]| self.rest[a as usize].distance_squared(self.rest[b as usize]);
        let [one, two, three] = [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
        let longer = if square(one) > square(two) { one } else { two };
        if square(longer) > square(three) {
            longer
        } else {
            three
        }
    }
}

impl Torn {
    fn new(whole: &Arc<Surface>, edges: &[[u32; 2]]) -> Self {
        let mut torn = Self {
            whole: whole.clone(),
            corners: whole.triangles().to_vec(),
            origin: (0..whole.len() as u32).collect(),
        };
        let mut ends: Vec<(u32, usize, u32)> = Vec::with_capacity(2 * edges.len());
        for (time, [a, b]) in edges.iter().enumerate() {
            ends.extend([(*a, time, *b), (*b, time, *a)]);
        }
        ends.sort_unstable();
        let mut parts = Vec::new();
        for at in ends.chunk_by(|a, b| a.0 == b.0) {
            torn.split(at, &mut parts);
        }
        // As they came off.
        parts.sort_unstable();
        for Part { particle, face, .. } in &parts {
            let copy = torn.origin.len() as u32;
            torn.origin.push(*particle);
            let of = ends.partition_point(|(end, ..)| end < particle)..;
            let edges = ends[of].iter().take_while(|(end, ..)| end == particle);
            let others: Vec<u32> = edges.map(|(.., other)| *other).collect();
            for (own, at) in pieces(whole, *particle, &others) {
                if at == *face {
                    let corners = torn.corners[own as usize].iter_mut();
                    (corners.filter(|corner| **corner == *particle))
                        .for_each(|corner| *corner = copy);
                }
            }
        }
        torn
    }

    /// Number of particles of the whole surface.
    pub fn whole_len(&self) -> usize {
        self.whole.len()
    }

    /// Finds the parts that come off a particle with one torn edge after the other.
    fn split(&self, edges: &[(u32, usize, u32)], parts: &mut Vec<Part>) {
        let particle = edges[0].0;
        let mut known: Vec<u32> = (pieces(&self.whole, particle, &[]).into_iter())
            .map(|(_, piece)| piece)
            .collect();
        for count in 1..=edges.len() {
            let others: Vec<u32> = edges[..count].iter().map(|(.., other)| *other).collect();
            for (_, face) in pieces(&self.whole, particle, &others) {
                if !known.contains(&face) {
                    known.push(face);
                    parts.push(Part {
                        time: edges[count - 1].1,
                        particle,
                        face,
                    });
                }
            }
        }
    }

    fn surface(self, edges: &[[u32; 2]]) -> Surface {
        let whole = self.whole.clone();
        let copied = |of: &[Vec3]| -> Vec<Vec3> {
            self.origin
                .iter()
                .map(|origin| of[*origin as usize])
                .collect()
        };
        let rest = copied(&whole.rest);
        let normals = match &whole.normals[..] {
            [one] => vec![*one],
            each => copied(each),
        };
        let areas = self.areas(edges);
        let (links, is_border) = self.links();
        let mut order: Vec<u32> = (0..self.corners.len() as u32).collect();
        let first = |face: &u32| self.corners[*face as usize].into_iter().min();
        order.sort_by_key(first);
        let of_face = |face: &u32| self.corners[*face as usize];
        let faces = Faces::by_first_corner(order.iter().map(of_face).collect(), rest.len());
        let grain = match whole.as_grid() {
            Some(grid) => {
                let below = whole.rest[grid.columns() as usize];
                vec![(below - whole.rest[0]).normalize(); order.len()]
            }
            None if whole.grain.is_empty() => Vec::new(),
            None => order
                .iter()
                .map(|face| whole.grain[*face as usize])
                .collect(),
        };
        let of_origin = |attribute: &VertexAttribute| {
            let values = self
                .origin
                .iter()
                .map(|at| attribute.values()[*at as usize]);
            VertexAttribute::new(attribute.name(), values.collect())
        };
        let uvs = match whole.uvs() {
            [] => Vec::new(),
            uvs => self.origin.iter().map(|at| uvs[*at as usize]).collect(),
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
        let pieces = surface.graph().pieces_of().into_iter().max();
        surface.extent = Extent {
            pieces: pieces.map_or(0, |last| last as usize + 1),
            ..whole.extent
        };
        surface.rest = surface.parted(&surface.rest, |particle| surface.origin_of(particle));
        surface
    }

    /// Areas of the particles. Those of the whole surface, but where edges are torn.
    fn areas(&self, edges: &[[u32; 2]]) -> Vec<f32> {
        let whole = &self.whole;
        let mut areas = whole.areas.clone();
        areas.resize(self.origin.len(), 0.0);
        let mut split: Vec<u32> = edges.iter().flatten().copied().collect();
        split.sort_unstable();
        split.dedup();
        for particle in split {
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

    /// The springs, and the particles at a border. A spring along a torn edge becomes one for each side, and stands for
    /// the area on its side. Those across a torn edge are gone.
    fn links(&self) -> (Vec<Link>, Vec<bool>) {
        let whole = &self.whole;
        let faces = whole.triangles();
        let is_grid = whole.as_grid().is_some();
        let first_along = (whole.links).partition_point(|link| link.kind != SpringKind::Structural);
        let (known_across, known_along) = whole.links.split_at(first_along);
        let (mut known_across, mut known_along) = (known_across.iter(), known_along.iter());
        let (mut across, mut along) = (Vec::new(), Vec::new());
        let mut is_border = vec![false; self.origin.len()];
        let area = |side: &Side| face_area(faces[side.face as usize], &whole.rest);
        for sides in (whole.incidence().sides).chunk_by(|a, b| a.ends == b.ends) {
            let total: f32 = sides.iter().map(area).sum();
            let is_diagonal =
                is_grid && whole.diagonal_of(faces[sides[0].face as usize]) == sides[0].ends;
            let known = if is_grid { None } else { known_along.next() };
            let own: Vec<[u32; 2]> = sides.iter().map(|side| self.ends(side)).collect();
            for (index, ends) in own.iter().enumerate() {
                if own[..index].contains(ends) {
                    continue;
                }
                let alike = sides.iter().zip(&own).filter(|(_, other)| *other == ends);
                let (count, part) = alike.fold((0, 0.0), |(count, sum), (side, _)| {
                    (count + 1, sum + area(side))
                });
                if count != 2 {
                    ends.iter().for_each(|end| is_border[*end as usize] = true);
                }
                match known {
                    Some(known) => along.push(Link {
                        ends: *ends,
                        slenderness: known.slenderness * (total / part),
                        ..*known
                    }),
                    None if is_diagonal => {
                        across.push(whole.grid_link(SpringKind::Shear, *ends, self, count))
                    }
                    None => along.push(whole.grid_link(SpringKind::Structural, *ends, self, count)),
                }
            }
            for_each_pair(sides, &whole.rest, |one, other| {
                let known = if is_grid { None } else { known_across.next() };
                if self.ends(one) != self.ends(other) || is_grid && !is_diagonal {
                    return;
                }
                let [a, b] = [one, other].map(|side| self.corner(side.face, side.opposite));
                let ends = [a.min(b), a.max(b)];
                across.push(match known {
                    Some(known) => Link { ends, ..*known },
                    None => whole.grid_link(SpringKind::Shear, ends, self, 2),
                });
            });
        }
        across.append(&mut along);
        (across, is_border)
    }

    /// The particle at a corner of a face, by the particle of the whole surface.
    fn corner(&self, face: u32, particle: u32) -> u32 {
        let face = face as usize;
        let at = (self.whole.triangles()[face].iter()).position(|corner| *corner == particle);
        self.corners[face][at.unwrap_or(0)]
    }

    /// The ends of a face's side.
    fn ends(&self, side: &Side) -> [u32; 2] {
        let [a, b] = side.ends.map(|end| self.corner(side.face, end));
        [a.min(b), a.max(b)]
    }
}

impl Surface {
    /// A spring of a grid with this number of faces at its side: of a strip that is as wide as a cell for two.
    fn grid_link(&self, kind: SpringKind, ends: [u32; 2], torn: &Torn, faces: u32) -> Link {
        let [a, b] = ends.map(|end| torn.origin[end as usize]);
        let spacing = self
            .grid
            .as_ref()
            .map_or(bevy::math::Vec2::ONE, ClothGrid::spacing);
        let rest_length = self.rest[a as usize].distance(self.rest[b as usize]);
        let width = match kind {
            SpringKind::Structural if a.abs_diff(b) == 1 => spacing.y,
            SpringKind::Structural => spacing.x,
            SpringKind::Shear | SpringKind::Bend => rest_length,
        };
        Link {
            kind,
            ends,
            rest_length,
            slenderness: rest_length / width * 2.0 / faces as f32,
        }
    }
}

/// A part of a particle that came off.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Part {
    /// The edge whose tear took it off.
    time: usize,
    particle: u32,
    /// The first of its faces.
    face: u32,
}

/// The faces at a particle, each with the first face of its piece: faces hang together at edges that are not torn, which
/// lead to `others`.
fn pieces(surface: &Surface, particle: u32, others: &[u32]) -> Vec<(u32, u32)> {
    let around = surface.incidence().around(particle);
    let faces = surface.triangles();
    let mut pieces: Vec<(u32, u32)> = around.iter().map(|face| (*face, *face)).collect();
    for one in 0..around.len() {
        for two in 0..one {
            let corners = faces[around[one] as usize];
            let shares = |corner: &u32| faces[around[two] as usize].contains(corner);
            let holds = |corner: &u32| *corner != particle && !others.contains(corner);
            if corners.iter().any(|corner| holds(corner) && shares(corner)) {
                let (a, b) = (pieces[one].1, pieces[two].1);
                let joined = a.min(b);
                let of_both = pieces
                    .iter_mut()
                    .filter(|(_, piece)| *piece == a || *piece == b);
                of_both.for_each(|(_, piece)| *piece = joined);
            }
        }
    }
    pieces
}
