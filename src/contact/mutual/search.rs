//! Searches for features of cloths that may come near each other.

use bevy::math::{Vec3, Vec3A};

use super::{
    bounds::{Bounds, Tangents},
    pair::{TWO_EDGES, VERTEX_AND_FACE, edge_to_edge, vertex_to_face},
    participant::Participant,
    sheet::Sheet,
};

/// Distance of edges, as a fraction of the thickness. Vertices and faces keep flat layers apart. Edges that cross
/// between them show where both bend, and only must not pass.
const EDGES: f32 = 0.5;

/// Largest distance that a pair of one cloth is kept apart, as a fraction of its distance at rest.
const OF_REST: f32 = 0.5;

/// Limits of a search for each particle: nodes and pairs of features tested, and pairs found. A cloth that runs into
/// itself at 5 m/s needs a ninth of that. The worst case, ten stacked sheets at 20 m/s, needs two thirds
/// (`cargo run --example lab -- self`).
const MOST_LOOKS: usize = 4_096;
const MOST_PAIRS: usize = 2_048;

/// Largest number of pairs in total: 300 MB of them. At least the second number for each particle: heaps at rest have
/// 50.
const MOST_OF_ALL: usize = 1 << 21;
const LEAST_OF_EACH: usize = 128;

/// Two features that may come near each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    /// The cloths of the first feature and of the second.
    pub cloths: [u32; 2],
    pub particles: [u32; 4],
    /// Number of the four that belong to the first feature.
    pub split: usize,
    /// Distance at which they touch (m).
    pub thickness: f32,
}

/// The search structure of one cloth.
#[derive(Debug, Default, Clone)]
struct Searched {
    places: Vec<Vec3A>,
    bounds: Vec<Bounds>,
    tangents: Vec<Tangents>,
}

/// A search through the trees of cloths for near features. Its memory is reused.
#[derive(Debug, Default, Clone)]
pub(super) struct Search {
    cloths: Vec<Searched>,
    pub found: Vec<Found>,
}

/// The results, and the remaining limits.
struct Finds<'a> {
    found: &'a mut Vec<Found>,
    looks: usize,
    pairs: usize,
    is_over: bool,
}

impl Finds<'_> {
    /// Whether the limits allow this many more tests.
    fn may_look(&mut self, at: usize) -> bool {
        self.is_over |= at > self.looks;
        self.looks = self.looks.saturating_sub(at);
        !self.is_over
    }

    fn add(&mut self, found: Found) {
        self.is_over |= self.found.len() >= self.pairs;
        if !self.is_over {
            self.found.push(found);
        }
    }
}

/// Two cloths, or one cloth twice, during a search.
struct Between<'a> {
    cloths: [usize; 2],
    sheets: [&'a Sheet; 2],
    searched: [&'a Searched; 2],
    /// Distance at which features touch (m), and the margin.
    thickness: f32,
    margin: f32,
}

impl Search {
    /// Finds all pairs of features nearer to each other than their thickness and a `margin` (m), in an order that
    /// depends only on the trees. Subtracts its tests from `work`, and returns whether that was enough.
    pub fn find(
        &mut self,
        participants: &[Participant],
        meets: impl Fn(usize, usize) -> bool,
        margin: f32,
        work: &mut usize,
    ) -> bool {
        self.found.clear();
        let each = participants.iter().map(|cloth| cloth.particles.len());
        let particles = each.sum::<usize>();
        let most = MOST_LOOKS.saturating_mul(particles).min(*work);
        let each = |pairs: usize| pairs.saturating_mul(particles);
        let pairs = each(MOST_PAIRS).min(MOST_OF_ALL.max(each(LEAST_OF_EACH)));
        let mut finds = Finds {
            found: &mut self.found,
            looks: most,
            pairs,
            is_over: false,
        };
        self.cloths
            .resize_with(participants.len(), Searched::default);
        for (searched, cloth) in self.cloths.iter_mut().zip(participants) {
            searched.places.clear();
            let places = cloth.particles.positions();
            let places = places.map(|place| Vec3A::from(cloth.point(place)));
            searched.places.extend(places);
            cloth.sheet.bounds(&searched.places, &mut searched.bounds);
            let sheet = cloth.sheet;
            sheet.tangents(&searched.places, &mut searched.tangents);
        }
        for first in 0..participants.len() {
            for second in first..participants.len() {
                let [a, b] = [&participants[first], &participants[second]];
                let are_met = if first == second {
                    a.settings.with_itself && !a.is_fixed
                } else {
                    meets(first, second) && !(a.is_fixed && b.is_fixed)
                };
                if !are_met || a.particles.is_empty() || b.particles.is_empty() {
                    continue;
                }
                let between = Between {
                    cloths: [first, second],
                    sheets: [a.sheet, b.sheet],
                    searched: [&self.cloths[first], &self.cloths[second]],
                    thickness: (a.settings.thickness + b.settings.thickness) / 2.0,
                    margin,
                };
                between.descend(0, 0, &mut finds);
            }
        }
        let is_over = finds.is_over;
        *work -= most - finds.looks;
        if is_over {
            self.found.clear();
        }
        !is_over
    }
}

impl Between<'_> {
    fn is_one_cloth(&self) -> bool {
        self.cloths[0] == self.cloths[1]
    }

    /// Tests two nodes of the same level, and their descendants.
    fn descend(&self, a: u32, b: u32, found: &mut Finds) {
        if !found.may_look(1) || self.is_far(a, b) {
            return;
        }
        let sheets = self.sheets;
        let [first, second] = [sheets[0].node(a), sheets[1].node(b)];
        match (first.is_leaf(), second.is_leaf()) {
            (true, true) => self.compare(first.particle, second.particle, found),
            (true, false) => {
                for &child in second.children() {
                    self.descend(a, child, found);
                }
            }
            (false, true) => {
                for &child in first.children() {
                    self.descend(child, b, found);
                }
            }
            (false, false) => {
                let is_same = self.is_one_cloth() && a == b;
                for (index, &child) in first.children().iter().enumerate() {
                    let from = if is_same { index } else { 0 };
                    for &other in &second.children()[from..] {
                        self.descend(child, other, found);
                    }
                }
            }
        }
    }

    /// Whether all features of two nodes are too far apart.
    fn is_far(&self, a: u32, b: u32) -> bool {
        let reach = self.thickness + self.margin;
        let [first, second] = self.searched;
        let is_same = self.is_one_cloth() && a == b;
        if !is_same && first.bounds[a as usize].distance(&second.bounds[b as usize]) > reach {
            return true;
        }
        if !self.is_one_cloth() || first.tangents.is_empty() {
            return false;
        }
        let sheet = self.sheets[0];
        sheet.around(a, b).is_some_and(|nodes| {
            let joined = nodes.fold(Tangents::EMPTY, |joined, node| {
                joined.join(&first.tangents[node as usize])
            });
            let at_rest = sheet.rest_distance(a, b).max(sheet.closest());
            joined.unfolded() * at_rest > reach
        })
    }

    /// Compares the features that two particles own.
    fn compare(&self, a: u32, b: u32, found: &mut Finds) {
        let [first, second] = self.cloths;
        let [one, other] = self.sheets;
        let faces = one.faces_of(a).len() + other.faces_of(b).len();
        let edges = one.edges_of(a).len() * other.edges_of(b).len();
        if !found.may_look(faces + edges) {
            return;
        }
        self.vertex_with_faces([first, second], [0, 1], a, b, found);
        if !(self.is_one_cloth() && a == b) {
            self.vertex_with_faces([second, first], [1, 0], b, a, found);
        }
        self.edges_with_edges(a, b, found);
    }

    fn place(&self, side: usize, particle: u32) -> Vec3 {
        self.searched[side].places[particle as usize].into()
    }

    /// Distance at which two features of one cloth touch, from their squared distance at rest.
    fn allowed(&self, thickness: f32, rest_square: impl Fn() -> f32) -> f32 {
        if self.is_one_cloth() && self.sheets[0].closest() * OF_REST < thickness {
            thickness.min(rest_square().sqrt() * OF_REST)
        } else {
            thickness
        }
    }

    fn vertex_with_faces(
        &self,
        cloths: [usize; 2],
        [own, other]: [usize; 2],
        vertex: u32,
        of: u32,
        found: &mut Finds,
    ) {
        let reach = self.thickness + self.margin;
        let place = self.place(own, vertex);
        for &[a, b, c] in self.sheets[other].faces_of(of) {
            if self.is_one_cloth() && [a, b, c].contains(&vertex) {
                continue;
            }
            let face = [a, b, c].map(|corner| self.place(other, corner));
            let low = face[0].min(face[1]).min(face[2]) - reach;
            let high = face[0].max(face[1]).max(face[2]) + reach;
            if place.cmplt(low).any() || place.cmpgt(high).any() {
                continue;
            }
            if vertex_to_face(place, face) > reach * reach {
                continue;
            }
            let rest = self.sheets[0].surface().rest_positions();
            let thickness = self.allowed(self.thickness, || {
                vertex_to_face(
                    rest[vertex as usize],
                    [a, b, c].map(|corner| rest[corner as usize]),
                )
            });
            found.add(Found {
                cloths: cloths.map(|cloth| cloth as u32),
                particles: [vertex, a, b, c],
                split: VERTEX_AND_FACE,
                thickness,
            });
        }
    }

    fn edges_with_edges(&self, a: u32, b: u32, found: &mut Finds) {
        let is_same = self.is_one_cloth() && a == b;
        let wanted = EDGES * self.thickness;
        let reach = wanted + self.margin;
        for (index, &first) in self.sheets[0].edges_of(a).iter().enumerate() {
            let own = first.map(|end| self.place(0, end));
            let low = own[0].min(own[1]) - reach;
            let high = own[0].max(own[1]) + reach;
            let from = if is_same { index + 1 } else { 0 };
            for &second in &self.sheets[1].edges_of(b)[from..] {
                if self.is_one_cloth() && first.iter().any(|end| second.contains(end)) {
                    continue;
                }
                let other = second.map(|end| self.place(1, end));
                if other[0].max(other[1]).cmplt(low).any()
                    || other[0].min(other[1]).cmpgt(high).any()
                {
                    continue;
                }
                if edge_to_edge(own, other) > reach * reach {
                    continue;
                }
                let rest = self.sheets[0].surface().rest_positions();
                let thickness = self.allowed(wanted, || {
                    let at_rest = |edge: [u32; 2]| edge.map(|end| rest[end as usize]);
                    edge_to_edge(at_rest(first), at_rest(second))
                });
                found.add(Found {
                    cloths: self.cloths.map(|cloth| cloth as u32),
                    particles: [first[0], first[1], second[0], second[1]],
                    split: TWO_EDGES,
                    thickness,
                });
            }
        }
    }
}
