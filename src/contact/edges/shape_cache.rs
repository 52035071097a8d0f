//! A cache of earlier tests near a shape, so that most particles and triangles are not tested again.

use std::ops::Range;

use super::{
    fan_view::FanView,
    shape_memory::ShapeMemories,
    sharp_edges::{EdgeMotion, push_off_edges},
};
use crate::{
    cloth::{ClothParticles, Surface},
    contact::{
        candidates::Guard,
        particles::{ContactResult, ParticlesNearEdges, push_particles},
    },
};

/// The cache of each candidate of a tick. Only used for shapes with edges, or whose nearest point is expensive; empty in a scene
/// without them.
#[derive(Debug, Default, Clone)]
pub(crate) struct ShapeCache {
    /// Until when a candidate's triangles can touch no edge, by the guard.
    clear: Vec<f32>,
    /// In the places of each collider's candidates, those whose triangles may touch an edge before the next search, then
    /// [`NONE`](super::sharp_edges::NONE).
    near_edges: Vec<u32>,
    pub guard: Guard,
    /// Memories of edges, across ticks.
    pub memories: ShapeMemories,
    view: FanView,
}

impl ShapeCache {
    /// Clears everything for other candidates.
    pub fn clear(&mut self) {
        self.clear.clear();
        self.near_edges.clear();
    }

    /// Clears the memory of edges.
    #[cfg(test)]
    pub fn forget_edges(&mut self) {
        self.memories.forget();
        let candidates = self.clear.len();
        self.clear();
        self.reserve(candidates);
    }

    /// Resizes for a number of candidates.
    pub fn reserve(&mut self, candidates: usize) {
        if self.clear.len() < candidates {
            self.near_edges
                .extend(self.clear.len() as u32..candidates as u32);
            self.clear.resize(candidates, f32::NEG_INFINITY);
        }
    }

    /// Pushes particles out of a shape with edges, or whose nearest point is expensive; `by_triangles` pushes the triangles
    /// of their surface off the edges, too. The collider has an ID, and its candidates a range.
    pub fn push(
        &mut self,
        (particles, surface): (&mut ClothParticles, &Surface),
        pushing: &mut ParticlesNearEdges,
        (id, candidates): (usize, Range<usize>),
        by_triangles: bool,
    ) -> ContactResult {
        let shape = &pushing.motion.collider.shape;
        let mut memory = (by_triangles || shape.is_geometry())
            .then(|| self.memories.of(id, shape, surface.len()));
        // Particles come last, so that none is inside at the end.
        let mut by_edges = ContactResult::default();
        if by_triangles && let Some(memory) = memory.as_deref_mut() {
            let motion = EdgeMotion::new(pushing, surface.spacing().longest, memory.tick);
            let first = candidates.start;
            let clear = &mut self.clear[candidates.clone()];
            let near_edges = &mut self.near_edges[candidates];
            let of = (first, clear, near_edges);
            let by = (&mut self.guard, &mut self.view, memory);
            by_edges = push_off_edges(particles, pushing, surface, of, by, &motion);
        }
        self.guard.tell(pushing.contacts);
        let planes = match memory {
            Some(memory) => memory.planes(particles.layout().blocks()),
            None => (&mut [][..], 0),
        };
        let (of, lanes) = (&pushing.motion, pushing.lanes);
        let found = push_particles(particles, pushing.contacts, planes, of, lanes);
        found.and(&by_edges)
    }
}
