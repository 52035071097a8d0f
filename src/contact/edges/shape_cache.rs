//! A cache of earlier tests near a shape, so that most particles and triangles are not tested again.

use std::ops::Range;

use super::{
    fan_view::FanView,
    shape_memory::{ShapeMemories, ShapeMemory},
    sharp_edges::{EdgeMotion, push_off_edges},
};
use crate::{
    cloth::{ClothParticles, Surface},
    contact::{
        candidates::Guard,
        colliders::ColliderShape,
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

    /// The cache of some candidates of a collider, with the memory of its shape where that is needed. The collider has an
    /// ID and a shape, and the cloth a number of particles.
    pub fn of(
        &mut self,
        candidates: Range<usize>,
        shape: Option<(usize, &ColliderShape, usize)>,
    ) -> ColliderCache<'_> {
        let memories = &mut self.memories;
        ColliderCache {
            first: candidates.start,
            clear: &mut self.clear[candidates.clone()],
            near_edges: &mut self.near_edges[candidates],
            guard: &mut self.guard,
            memory: shape.map(|(id, shape, count)| memories.of(id, shape, count)),
            view: &mut self.view,
        }
    }
}

/// The cache of a collider's candidates.
pub(crate) struct ColliderCache<'a> {
    /// Index of its first candidate among all.
    pub first: usize,
    pub clear: &'a mut [f32],
    pub near_edges: &'a mut [u32],
    pub guard: &'a mut Guard,
    memory: Option<&'a mut ShapeMemory>,
    pub view: &'a mut FanView,
}

/// Pushes particles out of a shape with edges. With a surface, pushes its triangles off the edges, too.
pub(crate) fn push_shape(
    particles: &mut ClothParticles,
    pushing: &mut ParticlesNearEdges,
    mut known: ColliderCache,
    triangles: Option<&Surface>,
) -> ContactResult {
    // Particles come last, so that none is inside at the end.
    let mut by_edges = ContactResult::default();
    if let Some(surface) = triangles
        && let Some(memory) = known.memory.as_deref_mut()
    {
        let motion = EdgeMotion::new(pushing, surface.spacing().longest, memory.tick);
        let of = (known.first, known.clear, known.near_edges);
        let by = (&mut *known.guard, known.view, memory);
        by_edges = push_off_edges(particles, pushing, surface, of, by, &motion);
    }
    known.guard.tell(pushing.contacts);
    let at = (&pushing.motion, pushing.settings);
    let planes = match known.memory {
        Some(memory) => memory.planes(particles.layout().blocks()),
        None => (&mut [][..], 0),
    };
    let found = push_particles(particles, pushing.contacts, planes, at, pushing.lanes);
    found.and(&by_edges)
}
