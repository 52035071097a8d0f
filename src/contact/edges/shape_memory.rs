//! Memory of particles near a shape, and of triangles near its edges, so that most need not be tested again.
//!
//! Every entry is a statement about positions: a triangle whose corners have moved less than its clearance since the test
//! touches no edge, however much time has passed. So it stays valid from tick to tick, and a lost entry is found again.

use bevy::math::Vec3;

use super::{
    clearance::EdgeClearance,
    edge_contact::{EdgeContact, EdgeTest, bounds_of},
    fan_view::FanView,
};
use crate::{
    cloth::Fan,
    contact::{colliders::ColliderShape, particles::Planes},
};

/// Number of edges remembered for a triangle; with more, none is.
const MAX_EDGES: usize = 8;

/// Below this fraction of the slack, clearance counts as none, and for this many sub-steps it is then not measured.
const HARDLY: f32 = 0.02;
const RESTS: u32 = 12;

/// No faces are remembered.
const NONE: u32 = u32::MAX;

/// Number of ticks after which unused entries are dropped.
const FORGOTTEN: u32 = 120;

/// The memory of a cloth's particles and triangles near one shape.
#[derive(Debug, Clone)]
pub(crate) struct ShapeMemory {
    /// ID and shape of the collider.
    id: usize,
    shape: ColliderShape,
    /// Distance at which triangles touch edges, up to which edges are remembered, and from which radius on there are none
    /// (m).
    near: [f32; 3],
    /// One entry for each particle, with the faces of those near an edge.
    places: Vec<KnownPlace>,
    faces: Vec<KnownFace>,
    /// Nearest planes, for each of the cloth's blocks; only of a shape whose nearest point is expensive.
    planes: Vec<Planes>,
    /// Number of ticks without use.
    age: u32,
    /// Tick counter.
    pub tick: u32,
}

/// The position of a particle when the nearest edge was searched for.
#[derive(Debug, Clone, Copy)]
struct KnownPlace {
    /// Position in the shape's frame (m); NaN before the first test.
    at: Vec3,
    /// Lower bound of the distance to the nearest edge (m).
    distance: f32,
    /// First of its faces, if they are known.
    faces: u32,
}

impl KnownPlace {
    const UNKNOWN: Self = Self {
        at: Vec3::NAN,
        distance: 0.0,
        faces: NONE,
    };
}

/// Distance at which a triangle touches edges, and up to which edges are remembered (m).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearness {
    pub reach: f32,
    pub slack: f32,
    /// Edges of a round surface with at least this radius can't come through a triangle (m).
    ///
    /// A triangle's corners are ρᵢ from an axis, and its sides are lᵢⱼ. Its point at weights w is at least √(Σ wᵢ ρᵢ² − Σ wᵢ wⱼ
    /// lᵢⱼ²) from the axis, and the last sum is at most l²/3. Particles keep the corners at R + r, with their radius r. So
    /// all of it is outside of R if 2 R r ≥ l²/3; on a cone, with the radius beside it.
    pub smooth: f32,
    /// The current tick, and the number of the sub-step in it.
    pub tick: u32,
    pub substep: u32,
}

/// On which side of a shape a triangle lay when it touched that. Cloth that is pressed against a thin shape may get through it by more
/// than its half, and then is nearer to its other side.
#[derive(Debug, Clone, Copy)]
struct Side {
    is_below: bool,
    tick: u32,
    substep: u32,
}

impl Side {
    /// The side, if that was no more than a sub-step ago.
    #[inline]
    fn lately(self, near: &Nearness) -> Option<bool> {
        let is_recent = self.tick == near.tick && near.substep <= self.substep + 1;
        is_recent.then_some(self.is_below)
    }
}

/// An edge near a triangle.
#[derive(Debug, Clone, Copy)]
struct KnownEdge {
    index: u32,
    /// Displacement of the triangle's corners before it can touch (m); 0 or less if it may touch.
    clearance: f32,
    /// Number of sub-steps in which the clearance is not measured, because there was hardly any.
    rests: u32,
}

/// The memory of a triangle near edges.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KnownFace {
    /// Positions of its corners in the shape's frame when edges were tested, and when they were listed (m); NaN before
    /// the first test.
    corners: [Vec3; 3],
    listed: [Vec3; 3],
    /// Displacement from the first before any edge can touch it (m); 0 or less if one may.
    pub clearance: f32,
    /// The edges that may touch it while its corners are within the slack of the second, unless there are too many.
    edges: [KnownEdge; MAX_EDGES],
    count: usize,
    side: Option<Side>,
}

impl KnownFace {
    const UNKNOWN: Self = Self {
        corners: [Vec3::NAN; 3],
        listed: [Vec3::NAN; 3],
        clearance: 0.0,
        edges: [KnownEdge {
            index: 0,
            clearance: 0.0,
            rests: 0,
        }; MAX_EDGES],
        count: 0,
        side: None,
    };

    /// Displacement of the corners since the test (m); NaN before the first test.
    #[inline]
    pub fn moved(&self, corners: [Vec3; 3]) -> f32 {
        farthest(corners, self.corners)
    }

    /// The contact with the nearest edge, or with the deepest one through it, of a triangle whose corners have `moved`
    /// this far (m). Updates the clearance.
    pub fn deepest(
        &mut self,
        shape: &ColliderShape,
        corners: [Vec3; 3],
        near: Nearness,
        moved: f32,
    ) -> Option<EdgeContact> {
        let Nearness { reach, slack, .. } = near;
        self.clearance = 0.0;
        let mut test = EdgeTest::new(shape, corners, reach)?;
        let strayed = farthest(corners, self.listed);
        // False for NaN.
        let is_known = strayed <= slack;
        if is_known {
            for edge in &mut self.edges {
                edge.clearance -= moved;
            }
            self.corners = corners;
        } else {
            self.list(&test, corners, near);
        }
        test.is_below = self.side.and_then(|side| side.lately(&near));
        if self.count <= MAX_EDGES {
            // Edges that are not listed are at least the slack away from the positions at the listing.
            let strayed = if is_known { strayed } else { 0.0 };
            let left = slack * (1.0 - 1.0e-3) - strayed;
            self.clearance = self.test_listed(&mut test, slack).min(left);
        } else {
            let clearance = EdgeClearance::new(&test, slack);
            let mut left = slack;
            let around = bounds_of(corners, reach + slack);
            shape.edges_near(around, near.smooth, |_, edge| {
                left = left.min(clearance.of(edge));
                test.see(edge);
            });
            self.clearance = left;
        }
        let contact = test.contact()?;
        self.side = contact.is_below.map(|is_below| Side {
            is_below,
            tick: near.tick,
            substep: near.substep,
        });
        Some(contact)
    }

    /// Tests the listed edges that may touch. Returns the displacement of the triangle's corners before any can (m).
    fn test_listed(&mut self, test: &mut EdgeTest, slack: f32) -> f32 {
        let mut measure = None;
        let mut left = slack;
        for known in &mut self.edges[..self.count] {
            if known.clearance <= 0.0
                && let Some(edge) = test.shape.edge(known.index)
            {
                test.see(&edge);
                known.clearance = 0.0;
                if known.rests > 0 {
                    known.rests -= 1;
                } else {
                    let measure = measure.get_or_insert_with(|| EdgeClearance::new(test, slack));
                    known.clearance = measure.of(&edge);
                    if known.clearance < HARDLY * slack {
                        known.rests = RESTS;
                    }
                }
            }
            left = left.min(known.clearance);
        }
        left
    }

    /// Lists the edges near it.
    fn list(&mut self, test: &EdgeTest, corners: [Vec3; 3], near: Nearness) {
        (self.corners, self.listed) = (corners, corners);
        self.count = 0;
        let clearance = EdgeClearance::new(test, near.slack);
        let around = bounds_of(corners, near.reach + near.slack);
        test.shape.edges_near(around, near.smooth, |index, edge| {
            let left = clearance.of(edge);
            if left >= near.slack * (1.0 - 1.0e-3) {
                return;
            }
            if let Some(place) = self.edges.get_mut(self.count) {
                *place = KnownEdge {
                    index,
                    clearance: left,
                    rests: 0,
                };
            }
            self.count += 1;
        });
    }
}

/// Largest displacement of three points (m); NaN where none is known.
#[inline]
fn farthest([a, b, c]: [Vec3; 3], [p, q, r]: [Vec3; 3]) -> f32 {
    let (a, b, c) = (
        a.distance_squared(p),
        b.distance_squared(q),
        c.distance_squared(r),
    );
    (if a > b { a } else { b }).max(c).sqrt()
}

impl ShapeMemory {
    /// An empty memory for a collider's shape and a number of particles.
    fn new(id: usize, shape: &ColliderShape, particles: usize) -> Self {
        Self {
            id,
            shape: shape.clone(),
            near: [0.0; 3],
            places: vec![KnownPlace::UNKNOWN; particles],
            faces: Vec::new(),
            planes: Vec::new(),
            age: 0,
            tick: 0,
        }
    }

    /// Clears everything for another shape, and keeps the memory's place.
    fn become_of(&mut self, shape: &ColliderShape) {
        self.shape.clone_from(shape);
        self.clear_edges();
        self.planes.fill(Planes::UNKNOWN);
    }

    fn clear_edges(&mut self) {
        self.places.fill(KnownPlace::UNKNOWN);
        self.faces.clear();
    }

    /// Clears what is known of edges if triangles have another reach now.
    pub fn match_reach(&mut self, near: Nearness) {
        let near = [near.reach, near.slack, near.smooth];
        if near != self.near {
            self.clear_edges();
            self.near = near;
        }
    }

    /// Displacement of everything before one of a particle's triangles, in view, can touch an edge (m).
    #[inline]
    pub fn clearance(&mut self, particle: u32, view: &FanView, near: Nearness) -> f32 {
        let (reach, extent) = (near.reach, view.extent);
        let known = &mut self.places[particle as usize];
        let clearance = |distance: f32| (distance - extent) * (1.0 - 1.0e-4) - reach;
        let moved = view.own.distance(known.at);
        let left = clearance(known.distance - moved);
        let is_near = clearance(known.distance + moved) <= 0.0;
        if left > 0.0 || is_near {
            return left;
        }
        // Far enough to skip it for a while.
        let within = 8.0 * extent + 2.0 * reach;
        known.at = view.own;
        let distance = self.shape.edge_distance(view.own, within, near.smooth);
        known.distance = distance.min(within);
        clearance(known.distance)
    }

    /// The planes nearest to the particles of the cloth's `blocks`, with the current tick.
    pub fn planes(&mut self, blocks: usize) -> (&mut [Planes], u32) {
        self.planes.resize(blocks, Planes::UNKNOWN);
        (&mut self.planes, self.tick)
    }

    /// Clears the positions, but not what is reused in a tick: the sides of triangles, and the planes of touching particles.
    #[cfg(test)]
    pub fn forget(&mut self) {
        self.planes.iter_mut().for_each(Planes::forget);
        for place in &mut self.places {
            place.at = Vec3::NAN;
        }
        for face in &mut self.faces {
            face.corners = [Vec3::NAN; 3];
            face.listed = [Vec3::NAN; 3];
        }
    }

    /// The memory of the faces that a particle owns.
    pub fn faces(&mut self, particle: u32, fan: Fan) -> &mut [KnownFace] {
        let known = &mut self.places[particle as usize];
        if known.faces == NONE {
            known.faces = self.faces.len() as u32;
            let end = self.faces.len() + fan.faces.len();
            self.faces.resize(end, KnownFace::UNKNOWN);
        }
        let first = known.faces as usize;
        &mut self.faces[first..first + fan.faces.len()]
    }
}

/// The memories of all colliders with edges.
#[derive(Debug, Default, Clone)]
pub(crate) struct ShapeMemories(Vec<ShapeMemory>);

impl ShapeMemories {
    /// Clears everything for another cloth.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Clears the positions.
    #[cfg(test)]
    pub fn forget(&mut self) {
        self.0.iter_mut().for_each(ShapeMemory::forget);
    }

    /// Begins a tick.
    pub fn begin(&mut self) {
        self.0.retain_mut(|memory| {
            memory.age += 1;
            memory.tick = memory.tick.wrapping_add(1);
            memory.age < FORGOTTEN
        });
    }

    /// Begins a tick again.
    pub fn restart(&mut self) {
        for memory in &mut self.0 {
            memory.tick = memory.tick.wrapping_add(1);
        }
    }

    /// The memory of a collider's edges, for a cloth with this number of particles. IDs change when colliders come and
    /// go: a memory that was not used in this tick may belong to the same shape under another ID.
    pub fn of(&mut self, id: usize, shape: &ColliderShape, particles: usize) -> &mut ShapeMemory {
        let is_of =
            |memory: &ShapeMemory| memory.shape == *shape && memory.places.len() == particles;
        let first = |is_it: &dyn Fn(&ShapeMemory) -> bool| self.0.iter().position(is_it);
        let same = first(&|memory| memory.id == id && is_of(memory));
        let known = same.or_else(|| first(&|memory| memory.age > 0 && is_of(memory)));
        // One that is scaled in each tick has another shape in each.
        let scaled = || first(&|memory| memory.id == id && memory.places.len() == particles);
        let at = known.or_else(scaled).unwrap_or(self.0.len());
        match self.0.get_mut(at) {
            None => self.0.push(ShapeMemory::new(id, shape, particles)),
            Some(memory) if known.is_none() => memory.become_of(shape),
            Some(_) => {}
        }
        let memory = &mut self.0[at];
        (memory.id, memory.age) = (id, 0);
        memory
    }
}
