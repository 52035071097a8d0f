//! A cache of earlier tests near a shape, so that most particles and triangles are not tested again.

use std::ops::Range;

use super::{
    ColliderShape,
    edge_memory::{EdgeMemories, EdgeMemory},
    fan_view::FanView,
    guard::Guard,
    particle::{Found, push_particles},
    planes::Planes,
    pushing::Pushing,
    sharp::{EdgeMotion, push_off_edges},
};
use crate::cloth::{ClothParticles, Surface};

/// No candidate.
pub(super) const NONE: u32 = u32::MAX;

/// The cache of each candidate of a tick. Only used for shapes with edges; empty in a scene without them.
#[derive(Debug, Default, Clone)]
pub(super) struct ShapeCache {
    /// One for each contact block.
    planes: Vec<Planes>,
    /// Until when a candidate's triangles can touch no edge, by the guard.
    clear: Vec<f32>,
    /// In the places of each collider's candidates, those whose triangles may touch an edge before the next search, then
    /// [`NONE`].
    near_edges: Vec<u32>,
    pub guard: Guard,
    /// Memories of edges, across ticks.
    pub memories: EdgeMemories,
    view: FanView,
}

impl ShapeCache {
    /// Clears everything for other candidates.
    pub fn clear(&mut self) {
        self.planes.clear();
        self.clear.clear();
        self.near_edges.clear();
    }

    /// Clears the memory of edges.
    #[cfg(test)]
    pub fn forget_edges(&mut self) {
        self.memories.forget();
        let counts = [self.clear.len(), self.planes.len()];
        self.clear();
        self.make_room(counts);
    }

    /// Resizes for a number of candidates and of contact blocks.
    pub fn make_room(&mut self, [candidates, blocks]: [usize; 2]) {
        if self.planes.len() < blocks {
            self.planes.resize(blocks, Planes::UNKNOWN);
        }
        if self.clear.len() < candidates {
            self.near_edges
                .extend(self.clear.len() as u32..candidates as u32);
            self.clear.resize(candidates, f32::NEG_INFINITY);
        }
    }

    /// The cache of some candidates of a collider, with its memory of edges where triangles are tested. The collider
    /// has an ID and a shape, and the cloth a number of particles.
    pub fn of(
        &mut self,
        [candidates, blocks]: [Range<usize>; 2],
        edges: Option<(usize, &ColliderShape, usize)>,
    ) -> Known<'_> {
        let memories = &mut self.memories;
        Known {
            first: candidates.start,
            planes: &mut self.planes[blocks],
            clear: &mut self.clear[candidates.clone()],
            near_edges: &mut self.near_edges[candidates],
            guard: &mut self.guard,
            memory: edges.map(|(id, shape, count)| memories.of(id, shape, count)),
            view: &mut self.view,
        }
    }
}

/// The cache of a collider's candidates.
pub(super) struct Known<'a> {
    /// Index of its first candidate among all.
    pub first: usize,
    planes: &'a mut [Planes],
    pub clear: &'a mut [f32],
    pub near_edges: &'a mut [u32],
    pub guard: &'a mut Guard,
    memory: Option<&'a mut EdgeMemory>,
    pub view: &'a mut FanView,
}

/// Pushes particles out of a shape with edges. With a surface, pushes its triangles off the edges, too.
pub(super) fn push_shape(
    particles: &mut ClothParticles,
    pushing: &mut Pushing,
    mut known: Known,
    triangles: Option<&Surface>,
) -> Found {
    // Particles come last, so that none is inside at the end.
    let mut by_edges = Found::default();
    if let Some(surface) = triangles
        && let Some(memory) = known.memory.take()
    {
        let motion = EdgeMotion::new(pushing, surface.spacing().longest, memory.tick);
        by_edges = push_off_edges(particles, pushing, surface, (&mut known, memory), &motion);
    }
    known.guard.tell(pushing.contacts);
    let at = (pushing.collider, pushing.settings, pushing.substep);
    let found = push_particles(particles, pushing.contacts, known.planes, at, pushing.lanes);
    found.and(&by_edges)
}
