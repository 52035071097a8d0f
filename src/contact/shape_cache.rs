//! A cache of earlier tests near a shape, so that most particles and triangles are not tested again.

use std::ops::Range;

use super::{
    ColliderShape,
    candidates::Fans,
    edge_memory::{EdgeMemories, EdgeMemory},
    fan_view::FanView,
    geometry_particles::{KnownParticle, push_particles_out},
    guard::Guard,
    particle::{Found, push_particles},
    pushing::Pushing,
    sharp::{EdgeMotion, push_off_edges},
};
use crate::cloth::ClothParticles;

/// The cache of each candidate of a tick. Only used for shapes with edges; empty in a scene without them.
#[derive(Debug, Default, Clone)]
pub(super) struct ShapeCache {
    particles: Vec<KnownParticle>,
    /// Until when a candidate's triangles can touch no edge, by the guard.
    clear: Vec<f32>,
    pub guard: Guard,
    /// Memories of edges, across ticks.
    pub memories: EdgeMemories,
    view: FanView,
}

impl ShapeCache {
    /// Clears everything for other candidates.
    pub fn clear(&mut self) {
        self.particles.clear();
        self.clear.clear();
    }

    /// Clears the memory of edges.
    #[cfg(test)]
    pub fn forget_edges(&mut self) {
        self.memories.forget();
        self.clear.fill(f32::NEG_INFINITY);
    }

    /// Resizes for a number of candidates.
    pub fn make_room(&mut self, candidates: usize) {
        if self.clear.len() < candidates {
            self.particles.resize(candidates, KnownParticle::default());
            self.clear.resize(candidates, f32::NEG_INFINITY);
        }
    }

    /// The cache of some candidates of a collider, with its memory of edges where triangles are tested. The collider
    /// has an ID and a shape, and the cloth a number of particles.
    pub fn of(
        &mut self,
        candidates: Range<usize>,
        edges: Option<(usize, &ColliderShape, usize)>,
    ) -> Known<'_> {
        let memories = &mut self.memories;
        Known {
            particles: &mut self.particles[candidates.clone()],
            clear: &mut self.clear[candidates],
            guard: &mut self.guard,
            memory: edges.map(|(id, shape, count)| memories.of(id, shape, count)),
            view: &mut self.view,
        }
    }
}

/// The cache of a collider's candidates.
pub(super) struct Known<'a> {
    particles: &'a mut [KnownParticle],
    clear: &'a mut [f32],
    guard: &'a mut Guard,
    memory: Option<&'a mut EdgeMemory>,
    view: &'a mut FanView,
}

/// Pushes particles out of a shape with edges. With the fans and the spacing (m) of its triangles, pushes those off its
/// edges, too.
pub(super) fn push_shape(
    particles: &mut ClothParticles,
    pushing: &mut Pushing,
    known: Known,
    triangles: Option<(&Fans, f32)>,
) -> Found {
    // Particles come last, so that none is inside at the end.
    let mut by_edges = Found::default();
    if let Some((fans, spacing)) = triangles
        && let Some(memory) = known.memory
    {
        let motion = EdgeMotion::new(pushing, spacing, memory.tick);
        let of = (known.clear, &mut *known.guard, memory, known.view);
        by_edges = push_off_edges(particles, pushing, fans, of, &motion);
    }
    let found = match pushing.collider.shape {
        ColliderShape::Geometry(_) => {
            push_particles_out(particles, pushing, known.particles, known.guard)
        }
        _ => {
            let at = (pushing.collider, pushing.settings, pushing.substep);
            push_particles(particles, pushing.contacts, at, pushing.lanes)
        }
    };
    found.and(&by_edges)
}
