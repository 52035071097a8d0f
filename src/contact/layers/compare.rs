//! Compares the features of two patches: vertices with faces, and edges with edges.

use std::ops::Range;

use bevy::math::{Vec3, Vec3A};

use super::{
    bounds::Bounds,
    intersections::passes,
    joined::Joined,
    lanes::{Groups, Hits, Points, near_edges, near_faces},
    motion::Motion,
    pair::{TWO_EDGES, VERTEX_AND_FACE, edge_to_edge, vertex_to_face},
    participant::Participant,
    patch_pair::{Candidate, PatchPair, Place},
    sheet::Sheet,
    work::{WORK_OF_CROSSING, WORK_OF_EIGHT, WORK_OF_GATHERING},
};
use crate::cloth::{MapInline, ThicknessFactors};

/// Distance of edges, as a fraction of the thickness. Vertices and faces keep flat layers apart. Edges that cross
/// between them show where both bend, and only must not pass. Edges of two ropes keep the whole thickness.
const EDGES: f32 = 0.5;

/// Largest distance that a pair of one cloth is kept apart, as a fraction of its distance at rest.
pub(super) const OF_REST: f32 = 0.5;

/// Number of sub-steps of motion that a list of features lasts; at least this fraction of the thickness, at most this
/// fraction of the shortest spacing.
const AHEAD: f32 = 10.0;
const LEAST_AHEAD: f32 = 0.25;
const MOST_AHEAD: f32 = 0.5;

/// Number of sub-steps of motion for which patches have to be apart, for their features not to be compared.
const ENOUGH: f32 = 2.0;

/// Compares two patches, and lists their near features.
pub(super) fn compare(
    pair: &mut PatchPair,
    cloths: &[Participant],
    motion: &Motion,
    joined: &Joined,
    place: &Place,
    candidates: &mut Vec<Candidate>,
    scratch: &mut Comparison,
    work: &mut usize,
) {
    let Place {
        thickness,
        spacing,
        used,
        reserve,
        ..
    } = *place;
    let [a, b] = pair.of.map_inline(|patch| &motion.patches[patch as usize]);
    let ahead = (AHEAD * used)
        .min(MOST_AHEAD * spacing)
        .max(LEAST_AHEAD * thickness);
    let listed = used + ahead;
    *work = work.saturating_sub(1);
    let sides = pair.of.map_inline(|patch| Side::of(motion, cloths, patch));
    let boxes = sides[0].bounds.distance_squared(&sides[1].bounds).sqrt();
    let apart = boxes.max(separation(&sides, a.start - b.start, b.start)) - thickness;
    if apart > ENOUGH * used + reserve {
        pair.slack = apart;
        return;
    }
    *work = work.saturating_sub(WORK_OF_GATHERING);
    for side in &sides {
        scratch.gather(side);
    }
    let is_one_cloth = a.cloth == b.cloth;
    let [longest, other] = [0, 1].map_inline(|side| sides[side].sheet.surface().spacing().longest);
    let longest = longest.max(other);
    let tolerance = ROUNDING * (LONGEST * listed + thickness + longest);
    scratch.hits.least = f32::INFINITY;
    scratch.hits.compared = 0;
    let mut features = Features {
        sides: &sides,
        points: &scratch.points,
        joined,
        hits: &mut scratch.hits,
        is_one_cloth,
        is_one_patch: pair.of[0] == pair.of[1],
        thickness,
        tolerance,
        listed: listed + tolerance,
        candidates,
    };
    features.vertices_with_faces([0, 1]);
    if !features.is_one_patch {
        features.vertices_with_faces([1, 0]);
    }
    features.edges_with_edges();
    *work = work.saturating_sub(WORK_OF_EIGHT * scratch.hits.compared);
    // Edges have a smaller thickness. But all that are not listed are apart by more than `listed`.
    let apart = scratch.hits.least.sqrt() - thickness - tolerance;
    pair.slack = apart.max(listed).min(LONGEST * listed);
}

/// The features of compared patches at the beginning of the sub-step, eight at a time.
#[derive(Debug, Default)]
pub(super) struct Comparison {
    points: Vec<Points>,
    is_known: Vec<bool>,
    /// The patches that are known.
    known: Vec<u32>,
    /// The positions of a patch's particles (m).
    places: Vec<Vec3A>,
    hits: Hits,
}

/// Without its contents: they do not matter to a snapshot.
impl Clone for Comparison {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Comparison {
    /// Begins with no features.
    pub fn clear(&mut self, motion: &Motion) {
        let groups = motion.firsts.last().map_or(0, |last| last[3]);
        self.points.resize(groups as usize, Points::default());
        for patch in self.known.drain(..) {
            if let Some(is_known) = self.is_known.get_mut(patch as usize) {
                *is_known = false;
            }
        }
        self.is_known.resize(motion.patches.len(), false);
    }

    fn gather(&mut self, side: &Side) {
        let is_known = &mut self.is_known[side.index as usize];
        if std::mem::replace(is_known, true) {
            return;
        }
        self.known.push(side.index);
        self.places.clear();
        self.places.extend(side.all());
        let groups = side.sheet.groups_of(side.patch);
        for (points, corners) in self.points[side.groups.clone()].iter_mut().zip(groups) {
            for l in 0..8 {
                let place = self.places[usize::from(corners[l])];
                (points[0][l], points[1][l], points[2][l]) = (place.x, place.y, place.z);
            }
        }
    }
}

/// Distance of two patches along a line (m), less than 0 if they overlap there. Places are taken from `origin`, which is
/// near: so the error does not grow with the distance from the frame's.
fn separation(sides: &[Side; 2], along: Vec3A, origin: Vec3A) -> f32 {
    let along = along.normalize_or_zero();
    let [front, back] = sides.each_ref().map_inline(|side| {
        let places = side.all();
        places.map(|place| along.dot(place - origin))
    });
    front.fold(f32::INFINITY, f32::min) - back.fold(f32::NEG_INFINITY, f32::max)
}

/// Whether an edge of one patch passes through a face of the other at the beginning of the sub-step.
pub(super) fn cross(
    pair: &PatchPair,
    cloths: &[Participant],
    motion: &Motion,
    joined: &Joined,
    work: &mut usize,
) -> bool {
    let sides = pair.of.map_inline(|patch| Side::of(motion, cloths, patch));
    if !sides[0].bounds.overlaps(&sides[1].bounds) {
        return false;
    }
    let [a, b] = pair
        .of
        .map_inline(|patch| motion.patches[patch as usize].cloth);
    let directions = 1 + usize::from(pair.of[0] != pair.of[1]);
    [[0, 1], [1, 0]][..directions].iter().any(|of| {
        let [own, other] = of.map_inline(|side| &sides[side]);
        let edges = own.sheet.edges_of(own.patch);
        let faces = other.sheet.faces_of(other.patch);
        *work = work.saturating_sub(WORK_OF_CROSSING * edges.len() * faces.len());
        edges.iter().any(|edge| {
            let bounds = own.bounds(*edge);
            let ends = edge.map_inline(|end| own.particle(end));
            let places = edge.map_inline(|end| own.place(end).as_dvec3());
            bounds.overlaps(&other.bounds)
                && faces.iter().any(|face| {
                    let corners = face.map_inline(|corner| other.particle(corner));
                    let is_joined = a == b && ends.iter().any(|end| corners.contains(end))
                        || joined.join(&own.global(ends), &other.global(corners));
                    !is_joined
                        && other.bounds(*face).overlaps(&bounds)
                        && passes(
                            places,
                            face.map_inline(|corner| other.place(corner).as_dvec3()),
                        )
                })
        })
    })
}

/// Largest slack that is looked for, as a multiple of the distance up to which features are listed.
const LONGEST: f32 = 3.0;

/// Error of distances in lanes, as a fraction of the distance and of the longest edge. Edges at an angle of 10⁻³ are taken
/// for parallel.
const ROUNDING: f32 = 1.0e-3;

/// A patch in a comparison.
struct Side<'a> {
    sheet: &'a Sheet,
    /// Its index among the patches of all cloths, and of its cloth.
    index: u32,
    patch: u32,
    first_particle: u32,
    /// The places of its features among those of all patches.
    groups: Range<usize>,
    /// Its particles, and the positions of its cloth's at the beginning of the sub-step (m).
    particles: &'a [u32],
    places: &'a [Vec3A],
    bounds: Bounds,
    /// Its largest thickness (m), and where it is thinner.
    thickness: f32,
    factors: Option<&'a ThicknessFactors>,
}

impl<'a> Side<'a> {
    fn of(motion: &'a Motion, cloths: &'a [Participant], index: u32) -> Self {
        let state = &motion.patches[index as usize];
        let [first_particle, first_patch, _, first_group] = motion.firsts[state.cloth as usize];
        let cloth = &cloths[state.cloth as usize];
        let sheet = &**cloth.sheet;
        let patch = index - first_patch;
        let groups = sheet.group_range(patch);
        Self {
            sheet,
            index,
            patch,
            first_particle,
            groups: (first_group + groups.start) as usize..(first_group + groups.end) as usize,
            particles: sheet.particles_of(patch),
            places: &motion.start[first_particle as usize..],
            bounds: state.bounds_at_start(),
            thickness: cloth.settings.thickness,
            factors: cloth.thickness,
        }
    }

    /// The thickness of a feature (m).
    fn thickness_of<const N: usize>(&self, particles: [u32; N]) -> f32 {
        let factor = self.factors.map_or(1.0, |factors| factors.mean(particles));
        self.thickness * factor
    }

    fn place(&self, local: u16) -> Vec3A {
        self.places[self.particles[usize::from(local)] as usize]
    }

    fn all(&self) -> impl Iterator<Item = Vec3A> {
        let places = self.places;
        let particles = self.particles.iter();
        particles.map(move |&particle| places[particle as usize])
    }

    fn particle(&self, local: u16) -> u32 {
        self.particles[usize::from(local)]
    }

    /// The places of its cloth's particles among those of all cloths.
    fn global<const N: usize>(&self, mut particles: [u32; N]) -> [u32; N] {
        for particle in &mut particles {
            *particle += self.first_particle;
        }
        particles
    }

    fn bounds<const N: usize>(&self, feature: [u16; N]) -> Bounds {
        let add = |bounds: Bounds, local: &u16| bounds.with(self.place(*local));
        feature.iter().fold(Bounds::EMPTY, add)
    }

    /// Its vertices, faces and edges.
    fn features<'b>(&self, points: &'b [Points]) -> (Groups<'b, 1>, Groups<'b, 3>, Groups<'b, 2>) {
        let counts = [
            usize::from(self.sheet.owned_of(self.patch)),
            self.sheet.faces_of(self.patch).len(),
            self.sheet.edges_of(self.patch).len(),
        ];
        // A patch owns no more than eight vertices.
        let (vertices, points) = points[self.groups.clone()].split_at(1);
        let (faces, edges) = points.split_at(3 * counts[1].div_ceil(8));
        (
            Groups::of(vertices, counts[0], self.bounds),
            Groups::of(faces, counts[1], self.bounds),
            Groups::of(edges, counts[2], self.bounds),
        )
    }
}

/// The features of two patches in a comparison.
struct Features<'a> {
    sides: &'a [Side<'a>; 2],
    points: &'a [Points],
    joined: &'a Joined,
    hits: &'a mut Hits,
    is_one_cloth: bool,
    is_one_patch: bool,
    thickness: f32,
    /// Error of the distances (m).
    tolerance: f32,
    /// How far apart features are that are listed (m).
    listed: f32,
    candidates: &'a mut Vec<Candidate>,
}

impl Features<'_> {
    fn vertices_with_faces(&mut self, of: [usize; 2]) {
        let [own, other] = of.map_inline(|side| &self.sides[side]);
        let (vertices, faces) = (own.features(self.points).0, other.features(self.points).1);
        self.hits.of.clear();
        let reach_squared = (self.listed + self.thickness).powi(2);
        near_faces(&vertices, &faces, reach_squared, self.hits);
        let faces = other.sheet.faces_of(other.patch);
        for hit in &self.hits.of {
            let vertex = own.particles[hit.first];
            let corners = faces[hit.second].map_inline(|corner| other.particle(corner));
            if self.is_one_cloth && corners.contains(&vertex) {
                continue;
            }
            let [a, b, c] = other.global(corners);
            let particles = [own.first_particle + vertex, a, b, c];
            if self.joined.join(&particles[..1], &particles[1..]) {
                continue;
            }
            let wanted = (own.thickness_of([vertex]) + other.thickness_of(corners)) / 2.0;
            let thickness = self.allowed(wanted, |rest| {
                let at_rest = |particle: u32| rest[particle as usize];
                vertex_to_face(at_rest(vertex), corners.map_inline(at_rest))
            });
            let distance = hit.square.sqrt() - self.tolerance;
            let near = Candidate::new(particles, VERTEX_AND_FACE, thickness, distance);
            self.candidates.push(near);
        }
    }

    fn edges_with_edges(&mut self) {
        let [own, other] = self.sides;
        let [edges, others] = [own, other].map_inline(|side| side.features(self.points).2);
        // Ropes have no faces to keep them apart.
        let are_ropes = self.sides.iter().all(|side| side.sheet.is_rope());
        let part = if are_ropes { 1.0 } else { EDGES };
        self.hits.of.clear();
        let reach_squared = (self.listed + part * self.thickness).powi(2);
        near_edges(&edges, &others, reach_squared, self.hits);
        let [edges, others] = [own, other].map_inline(|side| side.sheet.edges_of(side.patch));
        for hit in &self.hits.of {
            let ends = edges[hit.first].map_inline(|end| own.particle(end));
            let other_ends = others[hit.second].map_inline(|end| other.particle(end));
            let is_known = self.is_one_patch && hit.second <= hit.first;
            let is_joined = self.is_one_cloth && ends.iter().any(|end| other_ends.contains(end));
            if is_known || is_joined {
                continue;
            }
            let [[p, q], [r, s]] = [own.global(ends), other.global(other_ends)];
            if self.joined.join(&[p, q], &[r, s]) {
                continue;
            }
            let wanted = part * (own.thickness_of(ends) + other.thickness_of(other_ends)) / 2.0;
            let thickness = self.allowed(wanted, |rest| {
                let at_rest = |edge: [u32; 2]| edge.map_inline(|end| rest[end as usize]);
                edge_to_edge(at_rest(ends), at_rest(other_ends))
            });
            let distance = hit.square.sqrt() - self.tolerance;
            let near = Candidate::new([p, q, r, s], TWO_EDGES, thickness, distance);
            self.candidates.push(near);
        }
    }

    /// Distance at which two features touch, from their squared distance at rest if they are of one cloth.
    fn allowed(&self, thickness: f32, rest_square: impl FnOnce(&[Vec3]) -> f32) -> f32 {
        let sheet = self.sides[0].sheet;
        if self.is_one_cloth && OF_REST * sheet.closest() < thickness {
            let square = rest_square(sheet.surface().rest_positions());
            thickness.min(square.sqrt() * OF_REST)
        } else {
            thickness
        }
    }
}
