//! Which colliders are near each cloth, and which particles they may touch within the tick.

use bevy::{
    ecs::{entity::Entity, query::QueryData, system::Query},
    math::bounding::BoundingSphere,
    platform::time::Instant,
};

use super::{
    ClothFrame, ClothSearch, ClothStats, ClothTopology,
    colliders::ColliderMotion,
    components::{ClothTick, Vicinity},
    tick::milliseconds_since,
};
use crate::{
    cloth::{ClothGrid, ClothParticles},
    contact::{Detection, MovingCollider, NarrowPhase, Terms, Touch, meets_triangles},
    hierarchy::{BoundRule, BoundingVolume, SearchMethod, SearchReason},
};

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Searching {
    topology: &'static ClothTopology,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    search: &'static mut ClothSearch,
    tick: &'static mut ClothTick,
    stats: &'static mut ClothStats,
    vicinity: &'static mut Vicinity,
}

type Colliders<'w, 's> = Query<'w, 's, (Entity, &'static ColliderMotion)>;

/// Finds the colliders near each cloth, by one test of its root each; chooses how to search, and brings the bounding
/// volumes up to date where that asks for it. What comes near a cloth that sleeps, or leaves it, wakes it.
pub(super) fn rebuild_hierarchies(mut cloths: Query<Searching>, colliders: Colliders) {
    for mut cloth in &mut cloths {
        let Vicinity {
            centre,
            radius,
            takes_part,
            listens,
            ..
        } = *cloth.vicinity;
        let is_near = |(_, motion): (Entity, &ColliderMotion)| motion.comes_near(centre, radius);
        if takes_part && (listens || colliders.iter().any(is_near)) {
            cloth.find_near(&colliders);
        }
    }
}

/// Finds the particles that each collider near may touch within the tick.
pub(super) fn query_collisions(mut cloths: Query<Searching>) {
    for mut cloth in &mut cloths {
        if cloth.vicinity.is_searched && cloth.topology.fits(cloth.particles) {
            cloth.query();
        }
    }
}

impl SearchingItem<'_, '_> {
    fn root(&self) -> BoundingSphere {
        self.topology
            .tree
            .root_sphere(self.particles, self.tick.stretch.bound)
    }

    fn find_near(&mut self, colliders: &Colliders) {
        if !self.topology.fits(self.particles) {
            return;
        }
        let root = self.root();
        if self.tick.rest.is_asleep() {
            if self.sleeps_on(&root, colliders) {
                return;
            }
            self.tick.rest.disturb();
        }
        let Vicinity { centre, radius, .. } = *self.vicinity;
        let ClothTick {
            near,
            detection,
            reach,
            ..
        } = &mut *self.tick;
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
            let drags = near.iter().map(|(_, near)| near.drag(near.beyond(&root)));
            let farthest = drags.fold(0.0, f32::max);
            if farthest <= dragged || !farthest.is_finite() {
                break;
            }
            dragged = farthest;
        }
        detection.begin(*reach + dragged);
        let near = near.len();
        self.stats.colliders_near = near;
        if near == 0 {
            // What it slept on has gone.
            self.stats.reason = SearchReason::NothingNear;
            self.search.query.clear();
            return;
        }
        self.vicinity.is_searched = true;
        let stretch = self.tick.stretch.bound;
        let (method, reason) = self.tick.search.chosen(self.particles.len(), near, stretch);
        (self.stats.search, self.stats.reason) = (method, reason);
        if let SearchMethod::Tree(volume, rule) = method {
            let start = Instant::now();
            let ClothTopology { tree, .. } = self.topology;
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
        let ClothTick {
            near,
            detection,
            scout,
            terms,
            stretch,
            ..
        } = &mut *self.tick;
        let stretch = stretch.bound;
        let touches = detection.touches();
        let rests_on = |entity: Entity, collider: &MovingCollider| {
            let knows = |touch: &Touch| {
                near.get(touch.id)
                    .is_some_and(|(known, _)| *known == entity)
            };
            touches
                .iter()
                .any(|touch| knows(touch) && touch.collider == *collider)
        };
        let (bounds, query) = scout;
        let tree = &self.topology.tree;
        let rest_shape = (BoundingVolume::Sphere, BoundRule::RestShape);
        let outcome = bounds.rebuild(rest_shape, tree, self.particles, stretch);
        debug_assert!(outcome.is_ok(), "spheres have a rest shape");
        let Vicinity { centre, radius, .. } = *self.vicinity;
        let cover = cover(terms, stretch, &self.topology.grid);
        let mut still = 0;
        // Nothing of the cloth moves towards anything.
        let listening = Detection::default();
        for (entity, motion) in colliders {
            let is_near = motion.comes_near(centre, radius);
            if !is_near && touches.is_empty() {
                continue;
            }
            let Some(collider) = motion.seen_from(self.frame) else {
                continue;
            };
            if rests_on(entity, &collider) {
                still += 1;
            } else if is_near {
                let (probe, narrow_phase) =
                    listening.probe(&collider, terms, &self.topology.grid, cover, root);
                query.clear();
                query.search(tree, bounds, self.particles, &probe);
                let met = match narrow_phase {
                    NarrowPhase::Triangles => {
                        let bare = collider.probe(0.0, terms.particle_radius, root);
                        meets_triangles(self.particles, query.candidates(), &bare)
                    }
                    NarrowPhase::Auto | NarrowPhase::Particles => !query.candidates().is_empty(),
                };
                if met {
                    return false;
                }
            }
        }
        still == touches.len()
    }

    fn query(&mut self) {
        let start = Instant::now();
        let root = self.root();
        let tick = &mut *self.tick;
        let ClothSearch { bounds, query } = &mut *self.search;
        let ClothTopology { tree, grid, .. } = self.topology;
        let cover = cover(&tick.terms, tick.stretch.bound, grid);
        query.clear();
        let mut is_dragged = false;
        for (id, (_, collider)) in tick.near.iter().enumerate() {
            let (probe, narrow_phase) =
                tick.detection
                    .probe(collider, &tick.terms, grid, cover, &root);
            let found = match self.stats.search {
                SearchMethod::Tree(..) => query.search(tree, bounds, self.particles, &probe),
                SearchMethod::Auto | SearchMethod::Scan => query.scan(self.particles, &probe),
            };
            is_dragged |= !found.is_empty() && collider.drag(1.0) > 0.0;
            let found = &query.candidates()[found];
            tick.detection
                .add(id, collider, narrow_phase, found, self.particles, grid);
        }
        if is_dragged {
            tick.rest.disturb();
        }
        let by_triangles = |touch: &&Touch| touch.narrow_phase == NarrowPhase::Triangles;
        self.stats.by_triangles = tick.detection.touches().iter().filter(by_triangles).count();
        self.stats.nodes_visited = query.nodes_visited();
        self.stats.leaf_tests = query.leaf_tests();
        self.stats.query_ms = milliseconds_since(start);
    }
}

/// How far a triangle reaches from the particle that stands for it (m), at most: along a spring or two.
pub(super) fn cover(terms: &Terms, stretch: f32, grid: &ClothGrid) -> f32 {
    match terms.narrow_phase {
        NarrowPhase::Particles => 0.0,
        // Along a diagonal, without shear springs along both sides of it.
        NarrowPhase::Auto | NarrowPhase::Triangles => {
            grid.spacing().element_sum() * (1.0 + stretch) * (1.0 + 1.0e-5)
        }
    }
}
