//! How triangles lay to the edges of a shape when they were looked at, so that most need not be looked at again.
//!
//! All that is remembered is said of a place: a triangle whose corners have not moved farther since than there was room
//! touches no edge, however much time has passed. So it is remembered from tick to tick, and what is forgotten is found again.

use bevy::math::Vec3;

use super::{
    ColliderShape,
    edge_contact::{EdgeContact, EdgeTest, bounds_of},
    edge_room::EdgeRoom,
    fan_view::corners_of,
};
use crate::cloth::Slot;

/// How many edges near a triangle are remembered; of more, none is.
const MAX_EDGES: usize = 8;

/// The way out of a shape is the same where a triangle's middle has moved no farther in the tick than this part of its reach:
/// only on which side of the triangle it lies counts.
const SAME_SIDE: f32 = 0.1;

/// Room is hardly any below this part of the slack, and so often it is then not measured.
const HARDLY: f32 = 0.02;
const RESTS: u32 = 12;

/// No faces are remembered.
const NONE: u32 = u32::MAX;

/// What is not used for so many ticks is forgotten.
const FORGOTTEN: u32 = 120;

/// What is known of a cloth's triangles near the edges of one shape.
#[derive(Debug, Clone)]
pub(super) struct EdgeMemory {
    /// The collider's number, and its shape.
    id: usize,
    shape: ColliderShape,
    /// How near triangles may come to edges, and for which distances edges are remembered (m).
    near: [f32; 2],
    /// Of each particle, and of each face that one of those near an edge stands for.
    places: Vec<KnownPlace>,
    faces: Vec<KnownFace>,
    /// For how many ticks it was of no use.
    age: u32,
    /// Counts ticks.
    pub tick: u32,
}

/// Where a particle was when the nearest edge was looked for.
#[derive(Debug, Clone, Copy)]
struct KnownPlace {
    /// In the shape's frame (m); NaN before the first look.
    at: Vec3,
    /// How far away the nearest edge was at least (m).
    distance: f32,
    /// The first of the faces that it stands for, if they are known.
    faces: u32,
}

/// How near a triangle may come to edges, and for which distances edges are remembered (m).
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearness {
    pub reach: f32,
    pub slack: f32,
    /// Which tick it is.
    pub tick: u32,
}

/// An edge near a triangle.
#[derive(Debug, Clone, Copy)]
struct KnownEdge {
    index: u32,
    /// How far the triangle's corners may be from where they were before it can touch (m); 0 or less if it may.
    room: f32,
    /// How often the room is not measured, as there was hardly any.
    rests: u32,
}

/// How a triangle lay to the edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownFace {
    /// Which of the corners of its fan it has.
    pub of: [u16; 3],
    /// Where its corners were in the shape's frame when edges were tested, and when they were listed (m); NaN before the first
    /// look.
    corners: [Vec3; 3],
    listed: [Vec3; 3],
    /// How far they may be from the first before any edge can touch it (m); 0 or less if one may.
    pub room: f32,
    /// The edges that may touch it while its corners are within the slack of the second, if these are not too many.
    edges: [KnownEdge; MAX_EDGES],
    count: usize,
    /// The way out of the shape where its middle was (m), in that tick.
    outside: Vec3,
    middle: Vec3,
    tick: u32,
}

impl KnownFace {
    const UNKNOWN: Self = Self {
        of: [0; 3],
        corners: [Vec3::NAN; 3],
        listed: [Vec3::NAN; 3],
        room: 0.0,
        edges: [KnownEdge {
            index: 0,
            room: 0.0,
            rests: 0,
        }; MAX_EDGES],
        count: 0,
        outside: Vec3::Y,
        middle: Vec3::NAN,
        tick: 0,
    };

    /// How far the corners have moved since (m); NaN before the first look.
    #[inline]
    pub fn moved(&self, corners: [Vec3; 3]) -> f32 {
        farthest(corners, self.corners)
    }

    /// The contact with the edge that comes nearest, or farthest through it, of a triangle whose corners have `moved` so far
    /// (m); takes over what room there is.
    pub fn deepest(
        &mut self,
        shape: &ColliderShape,
        corners: [Vec3; 3],
        near: Nearness,
        moved: f32,
    ) -> Option<EdgeContact> {
        let Nearness { reach, slack, tick } = near;
        self.room = 0.0;
        let mut test = EdgeTest::new(shape, corners, reach)?;
        let strayed = farthest(corners, self.listed);
        // NaN is looked at.
        let is_known = strayed <= slack;
        if is_known {
            for edge in &mut self.edges {
                edge.room -= moved;
            }
            self.corners = corners;
        } else {
            self.list(&test, corners, near);
        }
        let is_same = tick == self.tick && test.middle.distance(self.middle) <= SAME_SIDE * reach;
        test.outside = is_same.then_some(self.outside);
        if self.count <= MAX_EDGES {
            // Those that are not listed are as far as the slack from where the list was made.
            let strayed = if is_known { strayed } else { 0.0 };
            let left = slack * (1.0 - 1.0e-3) - strayed;
            self.room = self.test_listed(&mut test, slack).min(left);
        } else {
            let mut room = EdgeRoom::new(&test, slack);
            shape.edges_near(bounds_of(corners, reach + slack), |_, edge| {
                room.see(edge);
                test.see(edge);
            });
            self.room = room.left();
        }
        if let Some(outside) = test.outside
            && !is_same
        {
            (self.outside, self.middle, self.tick) = (outside, test.middle, tick);
        }
        test.found
    }

    /// Tests those of the listed edges that may touch. Returns how far the triangle's corners may move before any can (m).
    fn test_listed(&mut self, test: &mut EdgeTest, slack: f32) -> f32 {
        let mut measure = None;
        let mut left = slack;
        for known in &mut self.edges[..self.count] {
            if known.room <= 0.0
                && let Some(edge) = test.shape.edge(known.index)
            {
                test.see(&edge);
                known.room = 0.0;
                if known.rests > 0 {
                    known.rests -= 1;
                } else {
                    let measure = measure.get_or_insert_with(|| EdgeRoom::new(test, slack));
                    known.room = measure.of(&edge);
                    if known.room < HARDLY * slack {
                        known.rests = RESTS;
                    }
                }
            }
            left = left.min(known.room);
        }
        left
    }

    /// Remembers the edges near it.
    fn list(&mut self, test: &EdgeTest, corners: [Vec3; 3], near: Nearness) {
        (self.corners, self.listed) = (corners, corners);
        self.count = 0;
        let room = EdgeRoom::new(test, near.slack);
        let around = bounds_of(corners, near.reach + near.slack);
        test.shape.edges_near(around, |index, edge| {
            let left = room.of(edge);
            if left >= near.slack * (1.0 - 1.0e-3) {
                return;
            }
            if let Some(place) = self.edges.get_mut(self.count) {
                *place = KnownEdge {
                    index,
                    room: left,
                    rests: 0,
                };
            }
            self.count += 1;
        });
    }
}

/// How far the farthest of three points has moved (m); NaN where none is known.
#[inline]
fn farthest([a, b, c]: [Vec3; 3], [p, q, r]: [Vec3; 3]) -> f32 {
    let (a, b, c) = (
        a.distance_squared(p),
        b.distance_squared(q),
        c.distance_squared(r),
    );
    (if a > b { a } else { b }).max(c).sqrt()
}

impl EdgeMemory {
    /// Of a collider's shape, for a cloth of so many particles.
    fn new(id: usize, shape: &ColliderShape, particles: usize) -> Self {
        let place = KnownPlace {
            at: Vec3::NAN,
            distance: 0.0,
            faces: NONE,
        };
        Self {
            id,
            shape: shape.clone(),
            near: [0.0; 2],
            places: vec![place; particles],
            faces: Vec::new(),
            age: 0,
            tick: 0,
        }
    }

    /// Forgets all if triangles have another reach now.
    pub fn match_reach(&mut self, near: Nearness) {
        let near = [near.reach, near.slack];
        if near != self.near {
            let fresh = Self::new(self.id, &self.shape, self.places.len());
            let tick = self.tick;
            *self = Self {
                near,
                tick,
                ..fresh
            };
        }
    }

    /// How far everything may move before a triangle that a particle stands for can touch an edge (m). The particle is at a
    /// place of the shape's frame, and its triangles reach so far from it (m).
    pub fn room(&mut self, particle: u32, at: Vec3, extent: f32, reach: f32) -> f32 {
        let known = &mut self.places[particle as usize];
        let room = |distance: f32| (distance - extent) * (1.0 - 1.0e-4) - reach;
        let moved = at.distance(known.at);
        let left = room(known.distance - moved);
        let is_near = room(known.distance + moved) <= 0.0;
        if left > 0.0 || is_near {
            return left;
        }
        // Far enough to leave it alone for a while.
        let within = 8.0 * extent + 2.0 * reach;
        known.at = at;
        known.distance = self.shape.edge_distance(at, within).min(within);
        room(known.distance)
    }

    /// Forgets where anything was, but not which way led out of the shape: what that is asked for depends on nothing else.
    #[cfg(test)]
    pub fn forget(&mut self) {
        for place in &mut self.places {
            place.at = Vec3::NAN;
        }
        for face in &mut self.faces {
            face.corners = [Vec3::NAN; 3];
            face.listed = [Vec3::NAN; 3];
        }
    }

    /// What is known of the faces that a particle stands for, whose corners are these.
    pub fn faces(
        &mut self,
        particle: u32,
        faces: &[[Slot; 3]],
        corners: &[Slot],
    ) -> &mut [KnownFace] {
        // Those that touch a pin are left out, and may come back.
        if faces.is_empty() {
            return &mut [];
        }
        let known = &mut self.places[particle as usize].faces;
        if *known == NONE {
            *known = self.faces.len() as u32;
            self.faces.extend(faces.iter().map(|&face| KnownFace {
                of: corners_of(face, corners),
                ..KnownFace::UNKNOWN
            }));
        }
        let first = *known as usize;
        &mut self.faces[first..first + faces.len()]
    }
}

/// What is known of all colliders with edges.
#[derive(Debug, Default, Clone)]
pub(super) struct EdgeMemories(Vec<EdgeMemory>);

impl EdgeMemories {
    /// Forgets all: the cloth is another.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Forgets where anything was.
    #[cfg(test)]
    pub fn forget(&mut self) {
        self.0.iter_mut().for_each(EdgeMemory::forget);
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

    /// What is known of a collider's edges, on a cloth of so many particles. Numbers change when colliders come and go: what was not
    /// used in this tick may be of the same shape under another number.
    pub fn of(&mut self, id: usize, shape: &ColliderShape, particles: usize) -> &mut EdgeMemory {
        let is_of =
            |memory: &EdgeMemory| memory.shape == *shape && memory.places.len() == particles;
        let mut all = self.0.iter();
        let same = all.position(|memory| memory.id == id && is_of(memory));
        let mut all = self.0.iter();
        let known = same.or_else(|| all.position(|memory| memory.age > 0 && is_of(memory)));
        let at = known.unwrap_or(self.0.len());
        if known.is_none() {
            self.0.push(EdgeMemory::new(id, shape, particles));
        }
        let memory = &mut self.0[at];
        (memory.id, memory.age) = (id, 0);
        memory
    }
}
