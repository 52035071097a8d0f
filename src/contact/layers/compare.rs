//! Compares the features of two patches: vertices with faces, and edges with edges.

use bevy::math::{Vec3, Vec3A};

use super::{
    bounds::Bounds,
    intersections::passes,
    lanes::{Eight, Points, edge_to_edges, vertex_to_faces},
    motion::Motion,
    pair::{Nearest, TWO_EDGES, VERTEX_AND_FACE, edge_to_edge, vertex_to_face},
    participant::Participant,
    patch_pair::{Candidate, PatchPair, Place},
    sheet::Sheet,
};

/// Distance of edges, as a fraction of the thickness. Vertices and faces keep flat layers apart. Edges that cross
/// between them show where both bend, and only must not pass.
const EDGES: f32 = 0.5;

/// Largest distance that a pair of one cloth is kept apart, as a fraction of its distance at rest.
const OF_REST: f32 = 0.5;

/// Number of sub-steps of motion that a list of features lasts; at least this fraction of the thickness, at most this
/// fraction of the shortest spacing.
const AHEAD: f32 = 10.0;
const LEAST_AHEAD: f32 = 0.25;
const MOST_AHEAD: f32 = 0.5;

/// Number of sub-steps of motion for which patches have to be apart, for their features not to be compared.
const ENOUGH: f32 = 2.0;

/// Units of work for an edge and a face that may cross, in f64.
const CROSSING: usize = 3;

/// Compares two patches, and lists their near features. `culled` is scratch: its contents do not matter.
pub(super) fn compare(
    pair: &mut PatchPair,
    cloths: &[Participant],
    motion: &Motion,
    place: &Place,
    candidates: &mut Vec<Candidate>,
    culled: &mut [Vec<u32>; 2],
    work: &mut usize,
) {
    let Place {
        thickness,
        spacing,
        used,
        reserve,
    } = *place;
    let [a, b] = pair.of.map(|patch| &motion.patches[patch as usize]);
    let ahead = (AHEAD * used)
        .min(MOST_AHEAD * spacing)
        .max(LEAST_AHEAD * thickness);
    let listed = used + ahead;
    *work = work.saturating_sub(1);
    let sides = pair.of.map(|patch| Side::of(motion, cloths, patch));
    let boxes = sides[0].bounds.distance_squared(&sides[1].bounds).sqrt();
    let apart = boxes.max(separation(&sides, a.start - b.start, b.start)) - thickness;
    if apart > ENOUGH * used + reserve {
        pair.slack = apart;
        return;
    }
    let is_one_cloth = a.cloth == b.cloth;
    let longest = pair.of.map(|patch| {
        let cloth = motion.patches[patch as usize].cloth as usize;
        cloths[cloth].sheet.surface().spacing().longest
    });
    let longest = longest[0].max(longest[1]);
    let tolerance = ROUNDING * (LONGEST * listed + thickness + longest);
    let mut features = Features {
        sides: &sides,
        is_one_cloth,
        is_one_patch: pair.of[0] == pair.of[1],
        thickness,
        tolerance,
        listed: listed + tolerance,
        least: f32::INFINITY,
        candidates,
        culled,
        tests: 0,
    };
    features.compare();
    *work = work.saturating_sub(features.tests / 2);
    // Edges have a smaller thickness. But all that are not listed are apart by more than `listed`.
    let apart = features.least.sqrt() - thickness - tolerance;
    pair.slack = apart.max(listed).min(LONGEST * listed);
}

/// Distance of two patches along a line (m), less than 0 if they overlap there. Places are taken from `origin`, which is
/// near: so the error does not grow with the distance from the frame's.
fn separation(sides: &[Side; 2], along: Vec3A, origin: Vec3A) -> f32 {
    let along = along.normalize_or_zero();
    let [front, back] = sides.each_ref().map(|side| {
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
    work: &mut usize,
) -> bool {
    let sides = pair.of.map(|patch| Side::of(motion, cloths, patch));
    if !sides[0].bounds.overlaps(&sides[1].bounds) {
        return false;
    }
    let [a, b] = pair.of.map(|patch| motion.patches[patch as usize].cloth);
    let directions = 1 + usize::from(pair.of[0] != pair.of[1]);
    [[0, 1], [1, 0]][..directions].iter().any(|of| {
        let [own, other] = of.map(|side| &sides[side]);
        let edges = own.sheet.edges_of(own.patch);
        let faces = other.sheet.faces_of(other.patch);
        *work = work.saturating_sub(CROSSING * edges.len() * faces.len());
        edges.iter().any(|edge| {
            let bounds = own.bounds(*edge);
            let ends = edge.map(|end| own.particle(end));
            let places = edge.map(|end| own.place(end).as_dvec3());
            bounds.overlaps(&other.bounds)
                && faces.iter().any(|face| {
                    let corners = face.map(|corner| other.particle(corner));
                    let is_joined = a == b && ends.iter().any(|end| corners.contains(end));
                    !is_joined
                        && other.bounds(*face).overlaps(&bounds)
                        && passes(places, face.map(|corner| other.place(corner).as_dvec3()))
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
    patch: u32,
    first_particle: u32,
    /// Its particles, and the positions of its cloth's at the beginning of the sub-step (m).
    particles: &'a [u32],
    places: &'a [Vec3A],
    bounds: Bounds,
}

impl<'a> Side<'a> {
    fn of(motion: &'a Motion, cloths: &'a [Participant], patch: u32) -> Self {
        let state = &motion.patches[patch as usize];
        let [first_particle, first_patch, _] = motion.firsts[state.cloth as usize];
        let sheet = &**cloths[state.cloth as usize].sheet;
        let patch = patch - first_patch;
        Self {
            sheet,
            patch,
            first_particle,
            particles: sheet.particles_of(patch),
            places: &motion.start[first_particle as usize..],
            bounds: state.bounds_at_start(),
        }
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

    fn bounds<const N: usize>(&self, feature: [u16; N]) -> Bounds {
        let add = |bounds: Bounds, local: &u16| bounds.with(self.place(*local));
        feature.iter().fold(Bounds::EMPTY, add)
    }

    /// The points of up to eight features; the last one fills the rest.
    fn points<const N: usize>(&self, features: &[[u16; N]], of: &[u32]) -> [Points; N] {
        let mut points = [[[0.0; 8]; 3]; N];
        for l in 0..8 {
            let feature = features[of[l.min(of.len() - 1)] as usize];
            for (point, local) in points.iter_mut().zip(feature) {
                let place = self.place(local);
                (point[0][l], point[1][l], point[2][l]) = (place.x, place.y, place.z);
            }
        }
        points
    }
}

/// The features of two patches in a comparison.
struct Features<'a> {
    sides: &'a [Side<'a>; 2],
    is_one_cloth: bool,
    is_one_patch: bool,
    thickness: f32,
    /// Error of the distances (m).
    tolerance: f32,
    /// How far apart features are that are listed (m).
    listed: f32,
    /// The least squared distance of others (m²).
    least: f32,
    candidates: &'a mut Vec<Candidate>,
    /// The features of each side that are near the other patch's box.
    culled: &'a mut [Vec<u32>; 2],
    /// Number of boxes of features, and of pairs of features, that were compared.
    tests: usize,
}

impl Features<'_> {
    fn compare(&mut self) {
        self.vertices_with_faces([0, 1]);
        if !self.is_one_patch {
            self.vertices_with_faces([1, 0]);
        }
        self.edges_with_edges();
    }

    /// Culls the features of a side, from their bounds: keeps those that are near enough to the other patch to be listed.
    fn cull(&mut self, side: usize, features: impl Iterator<Item = Bounds>) {
        let far = self.listed + self.thickness;
        let other = &self.sides[1 - side].bounds;
        let near = &mut self.culled[side];
        near.clear();
        for (index, bounds) in features.enumerate() {
            let square = bounds.distance_squared(other);
            self.tests += 1;
            if square > far * far {
                self.least = self.least.min(square);
            } else {
                near.push(index as u32);
            }
        }
    }

    /// Takes the squared distances of a feature from eight others (m²): calls `list` with those of the first `count` that
    /// are to be listed, and their distances, at least (m). The rest repeats the last one.
    fn sort(
        &mut self,
        squares: Eight,
        count: usize,
        thickness: f32,
        mut list: impl FnMut(&mut Self, usize, f32),
    ) {
        let far = (self.listed + thickness).powi(2);
        let mut are_far = true;
        for square in squares {
            let is_far = square > far;
            let least = if is_far { square } else { f32::INFINITY };
            self.least = if least < self.least {
                least
            } else {
                self.least
            };
            are_far &= is_far;
        }
        if are_far {
            return;
        }
        for (l, &square) in squares.iter().enumerate().take(count) {
            // Not `square <= far`: NaN is listed.
            if square > far {
                continue;
            }
            list(self, l, square.sqrt() - self.tolerance);
        }
    }

    fn vertices_with_faces(&mut self, [own_side, other_side]: [usize; 2]) {
        let sides = self.sides;
        let [own, other] = [&sides[own_side], &sides[other_side]];
        let vertices = 0..own.sheet.owned_of(own.patch);
        self.cull(own_side, vertices.map(|local| own.bounds([local])));
        if self.culled[own_side].is_empty() {
            return;
        }
        let faces = other.sheet.faces_of(other.patch);
        self.cull(other_side, faces.iter().map(|face| other.bounds(*face)));
        let near = std::mem::take(self.culled);
        self.tests += near[0].len() * near[1].len();
        for indices in near[other_side].chunks(8) {
            let points = other.points(faces, indices);
            for &index in &near[own_side] {
                let vertex = own.particles[index as usize];
                let place = own.places[vertex as usize];
                let squares = vertex_to_faces(place, &points);
                self.sort(
                    squares,
                    indices.len(),
                    self.thickness,
                    |features, l, distance| {
                        let face = faces[indices[l] as usize];
                        let corners = face.map(|corner| other.particle(corner));
                        if features.is_one_cloth && corners.contains(&vertex) {
                            return;
                        }
                        let thickness = features.allowed(features.thickness, |rest| {
                            let at_rest = |particle: u32| rest[particle as usize];
                            vertex_to_face(at_rest(vertex), corners.map(at_rest))
                        });
                        let [a, b, c] = corners.map(|corner| other.first_particle + corner);
                        let particles = [own.first_particle + vertex, a, b, c];
                        features.list(particles, VERTEX_AND_FACE, thickness, distance);
                    },
                );
            }
        }
        *self.culled = near;
    }

    fn edges_with_edges(&mut self) {
        let [own, other] = self.sides;
        let edges = [own, other].map(|side| side.sheet.edges_of(side.patch));
        self.cull(0, edges[0].iter().map(|edge| own.bounds(*edge)));
        if self.culled[0].is_empty() {
            return;
        }
        self.cull(1, edges[1].iter().map(|edge| other.bounds(*edge)));
        let near = std::mem::take(self.culled);
        self.tests += near[0].len() * near[1].len();
        let wanted = EDGES * self.thickness;
        for indices in near[1].chunks(8) {
            let points = other.points(edges[1], indices);
            for &index in &near[0] {
                let first = edges[0][index as usize];
                let squares = edge_to_edges(first.map(|end| own.place(end)), &points);
                self.sort(squares, indices.len(), wanted, |features, l, distance| {
                    let ends = first.map(|end| own.particle(end));
                    let second = edges[1][indices[l] as usize];
                    let others = second.map(|end| other.particle(end));
                    let is_known = features.is_one_patch && indices[l] <= index;
                    let is_joined =
                        features.is_one_cloth && ends.iter().any(|end| others.contains(end));
                    if is_known || is_joined {
                        return;
                    }
                    let thickness = features.allowed(wanted, |rest| {
                        let at_rest = |edge: [u32; 2]| edge.map(|end| rest[end as usize]);
                        edge_to_edge(at_rest(ends), at_rest(others))
                    });
                    let [p, q] = ends.map(|end| own.first_particle + end);
                    let [r, s] = others.map(|end| other.first_particle + end);
                    features.list([p, q, r, s], TWO_EDGES, thickness, distance);
                });
            }
        }
        *self.culled = near;
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

    fn list(&mut self, particles: [u32; 4], split: usize, thickness: f32, distance: f32) {
        self.candidates.push(Candidate {
            particles,
            split: split as u32,
            thickness,
            nearest: Nearest::default(),
            apart: distance - thickness,
        });
    }
}
