//! Which colliders are near each cloth, and which particles they may touch within the tick.

use bevy::{
    ecs::{entity::Entity, query::QueryData, system::Query},
    math::bounding::BoundingSphere,
    platform::time::Instant,
};

use super::{
    ClothBuilt, ClothFrame, ClothScratch, ClothSearch, ClothState, ClothStats, broad_phase::cover,
    clock::milliseconds_since, colliders::ColliderMotion, components::BroadPhaseBounds,
};
use crate::{
    cloth::ClothParticles,
    contact::{Detection, NarrowPhase, Touch, meets_triangles},
    hierarchy::{BoundRule, BoundingVolume, SearchMethod, SearchReason},
};

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Searching {
    built: &'static ClothBuilt,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    search: &'static mut ClothSearch,
    state: &'static mut ClothState,
    scratch: &'static mut ClothScratch,
    stats: &'static mut ClothStats,
    broad_phase: &'static mut BroadPhaseBounds,
}

type Colliders<'w, 's> = Query<'w, 's, (Entity, &'static ColliderMotion)>;

/// Finds the colliders near each cloth, by one test of its root each; chooses how to search, and brings the bounding
/// volumes up to date where that asks for it. What comes near a cloth that sleeps, or leaves it, wakes it.
pub(super) fn rebuild_hierarchies(mut cloths: Query<Searching>, colliders: Colliders) {
    for mut cloth in &mut cloths {
        let BroadPhaseBounds {
            centre,
            radius,
            takes_part,
            has_sleeping_contacts,
            ..
        } = *cloth.broad_phase;
        let is_near = |(_, motion): (Entity, &ColliderMotion)| motion.comes_near(centre, radius);
        if takes_part && (has_sleeping_contacts || colliders.iter().any(is_near)) {
            cloth.find_near(&colliders);
        }
    }
}

/// Finds the particles that each collider near may touch within the tick.
pub(super) fn query_collisions(mut cloths: Query<Searching>) {
    for mut cloth in &mut cloths {
        if cloth.broad_phase.is_searched && cloth.built.matches(cloth.particles) {
            cloth.query();
        }
    }
}

impl SearchingItem<'_, '_> {
    fn root(&self) -> BoundingSphere {
        self.built
            .tree()
            .root_sphere(self.particles, self.state.stretch.bound)
    }

    fn find_near(&mut self, colliders: &Colliders) {
        if !self.built.matches(self.particles) {
            return;
        }
        let root = self.root();
        if self.state.rest.is_asleep() {
            if self.sleeps_on(&root, colliders) {
                return;
            }
            self.state.rest.disturb();
        }
        let BroadPhaseBounds { centre, radius, .. } = *self.broad_phase;
        let ClothScratch {
            near,
            detection,
            reach,
            ..
        } = &mut *self.scratch;
        // Besides by itself, a particle may get as far as a collider drags it, to others that may drag it on.
        let mut dragged = 0.0_f32;
        loop {
            near.clear();
            let comes_near = colliders
                .iter()
                .filter(|(_, motion)| motion.comes_near(centre, radius + dragged));
            let seen = |(entity, motion): (Entity, &ColliderMotion)| {
                Some((entity, motion.seen_from(self.frame)?))
            };
            near.extend(comes_near.filter_map(seen));
            let travels = near
                .iter()
                .map(|(_, near)| near.max_surface_travel(near.farthest_distance(&root)));
            let farthest = travels.fold(0.0, f32::max);
            if farthest <= dragged || !farthest.is_finite() {
                break;
            }
            dragged = farthest;
        }
        detection.begin(self.built.surface(), *reach + dragged);
        let near = near.len();
        self.stats.colliders_near = near;
        if near == 0 {
            // What it slept on has gone.
            self.stats.reason = SearchReason::NothingNear;
            self.search.query.clear();
            return;
        }
        self.broad_phase.is_searched = true;
        let stretch = self.state.stretch.bound;
        let (method, reason) = self
            .scratch
            .search
            .chosen(self.particles.len(), near, stretch);
        (self.stats.search, self.stats.reason) = (method, reason);
        if let SearchMethod::Tree(volume, rule) = method {
            let start = Instant::now();
            let tree = self.built.tree();
            let outcome = self
                .search
                .bounds
                .rebuild((volume, rule), tree, self.particles, stretch);
            debug_assert!(outcome.is_ok(), "the choice was checked as the tick began");
            self.stats.rebuild_ms = milliseconds_since(start);
        }
    }

    /// Whether all that touched a cloth as it fell asleep still rests where it did, and nothing else has come.
    fn sleeps_on(&mut self, root: &BoundingSphere, colliders: &Colliders) -> bool {
        let ClothScratch {
            sleep_query,
            contact_settings,
            ..
        } = &mut *self.scratch;
        let stretch = self.state.stretch.bound;
        let rests_on = &self.state.rests_on;
        let (bounds, query) = sleep_query;
        let (tree, surface) = (self.built.tree(), self.built.surface());
        let rest_shape = (BoundingVolume::Sphere, BoundRule::RestShape);
        let outcome = bounds.rebuild(rest_shape, tree, self.particles, stretch);
        debug_assert!(outcome.is_ok(), "spheres have a rest shape");
        let BroadPhaseBounds { centre, radius, .. } = *self.broad_phase;
        let cover = cover(contact_settings, stretch, surface);
        let mut still = 0;
        // Nothing of the cloth moves towards anything.
        let sleep_detection = Detection::default();
        for (entity, motion) in colliders {
            let is_near = motion.comes_near(centre, radius);
            if !is_near && rests_on.is_empty() {
                continue;
            }
            let Some(collider) = motion.seen_from(self.frame) else {
                continue;
            };
            if rests_on
                .iter()
                .any(|(known, way)| *known == entity && *way == collider)
            {
                still += 1;
            } else if is_near {
                let (probe, narrow_phase) =
                    sleep_detection.probe(&collider, contact_settings, surface, cover, root);
                query.clear();
                query.search(tree, bounds, self.particles, &probe);
                let met = match narrow_phase {
                    NarrowPhase::Triangles => {
                        let bare = collider.probe(0.0, contact_settings.particle_radius, root);
                        meets_triangles(surface, self.particles, query.candidates(), &bare)
                    }
                    NarrowPhase::Auto | NarrowPhase::Particles => !query.candidates().is_empty(),
                };
                if met {
                    return false;
                }
            }
        }
        still == rests_on.len()
    }

    fn query(&mut self) {
        let start = Instant::now();
        let root = self.root();
        let scratch = &mut *self.scratch;
        let ClothSearch { bounds, query } = &mut *self.search;
        let (tree, surface) = (self.built.tree(), self.built.surface());
        let cover = cover(&scratch.contact_settings, self.state.stretch.bound, surface);
        query.clear();
        let mut is_dragged = false;
        for (id, (_, collider)) in scratch.near.iter().enumerate() {
            let (probe, narrow_phase) =
                scratch
                    .detection
                    .probe(collider, &scratch.contact_settings, surface, cover, &root);
            let found = match self.stats.search {
                SearchMethod::Tree(..) => query.search(tree, bounds, self.particles, &probe),
                SearchMethod::Auto | SearchMethod::Scan => query.scan(self.particles, &probe),
            };
            is_dragged |= !found.is_empty() && collider.max_surface_travel(1.0) > 0.0;
            let found = &query.candidates()[found];
            scratch
                .detection
                .add(id, collider, narrow_phase, found, self.particles);
        }
        if is_dragged {
            self.state.rest.disturb();
        }
        let by_triangles = |touch: &&Touch| touch.narrow_phase == NarrowPhase::Triangles;
        self.stats.by_triangles = scratch
            .detection
            .touches()
            .iter()
            .filter(by_triangles)
            .count();
        self.stats.nodes_visited = query.nodes_visited();
        self.stats.leaf_tests = query.leaf_tests();
        self.stats.query_ms = milliseconds_since(start);
    }
}
