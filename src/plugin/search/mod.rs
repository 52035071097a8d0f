//! Which colliders are near each cloth, and which particles they may touch within the tick.
//!
//! In: the particles, the reach of each cloth, the motions of colliders and their tree. Out: the colliders near, volumes and
//! visited nodes, and the candidates.

use bevy::{
    ecs::query::QueryData,
    math::bounding::BoundingSphere,
    platform::time::Instant,
    prelude::{Entity, Query, ResMut, Vec3},
};

use super::{
    authoring::{ClothOrder, Ordered},
    clock::milliseconds_since,
    frame::ClothFrame,
    prepare::{ColliderMotion, ColliderTree, cover},
    state::{
        BroadPhaseBounds, ClothBuilt, ClothContacts, ClothScratch, ClothSearch, ClothState,
        ClothStats, RestsOn,
    },
    threads::for_each,
};
use crate::{
    cloth::ClothParticles,
    contact::{ClothLayers, Detection, NarrowPhase, Touch, meets_triangles},
    hierarchy::{BoundRule, BoundingVolume, SearchMethod, SearchReason},
};

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct SearchQuery {
    built: &'static ClothBuilt,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    search: &'static mut ClothSearch,
    state: &'static mut ClothState,
    scratch: &'static mut ClothScratch,
    stats: &'static mut ClothStats,
    broad_phase: &'static mut BroadPhaseBounds,
    layers: Option<&'static ClothLayers>,
    contacts: &'static ClothContacts,
}

/// A tick in which fewer cloths take part is not shared among threads: handing out work costs more than the search.
const MIN_TO_SHARE: usize = 128;

type Collider = (
    &'static ColliderMotion,
    Option<&'static ClothLayers>,
    Option<&'static ClothOrder>,
);

/// The colliders, and the tree of their bounds.
struct Colliders<'a, 'w, 's> {
    tree: &'a ColliderTree,
    all: Query<'w, 's, Collider>,
}

impl Colliders<'_, '_, '_> {
    /// The colliders that may come within `reach` of a point of the world (m), and whose layers match.
    fn near(
        &self,
        point: Vec3,
        reach: f32,
        layers: ClothLayers,
    ) -> impl Iterator<Item = (Entity, &ColliderMotion)> {
        self.tree.near(point, reach).filter_map(move |entity| {
            let motion = self.get(entity, layers)?;
            motion.comes_near(point, reach).then_some((entity, motion))
        })
    }

    /// The motion of a collider, if its layers match.
    fn get(&self, entity: Entity, layers: ClothLayers) -> Option<&ColliderMotion> {
        let (motion, others, _) = self.all.get(entity).ok()?;
        let others = others.copied().unwrap_or_default();
        others.interacts_with(layers).then_some(motion)
    }

    /// A collider's key to sort by.
    fn order(&self, entity: Entity) -> Ordered {
        let collider = self.all.get(entity).ok();
        let order = collider.and_then(|(_, _, order)| order.copied());
        (order.unwrap_or_default(), entity)
    }
}

/// Finds the colliders near each cloth, chooses how to search, and updates the bounding volumes if the search needs
/// them. A collider that comes near a sleeping cloth, or leaves it, wakes it.
pub(crate) fn rebuild_hierarchies(
    mut cloths: Query<SearchQuery>,
    colliders: Query<Collider>,
    mut tree: ResMut<ColliderTree>,
) {
    let (mut taking_part, mut has_sleeping_contacts) = (0, false);
    for cloth in &cloths {
        taking_part += usize::from(cloth.broad_phase.takes_part);
        has_sleeping_contacts |= cloth.broad_phase.has_sleeping_contacts;
    }
    if taking_part == 0 || (tree.is_empty() && !has_sleeping_contacts) {
        return;
    }
    tree.refit();
    let colliders = Colliders {
        tree: &tree,
        all: colliders,
    };
    for_each(&mut cloths, taking_part >= MIN_TO_SHARE, |mut cloth| {
        cloth.look_around(&colliders);
    });
}

/// Finds the particles that each collider near may touch within the tick.
pub(crate) fn query_collisions(mut cloths: Query<SearchQuery>) {
    let is_searched = |cloth: &SearchQueryReadOnlyItem| cloth.broad_phase.is_searched;
    let searched = cloths.iter().filter(is_searched).count();
    if searched > 0 {
        let at_once = searched >= MIN_TO_SHARE;
        for_each(&mut cloths, at_once, |mut cloth| cloth.query());
    }
}

impl SearchQueryItem<'_, '_> {
    /// Finds the colliders near, if the cloth takes part in the tick and there are any.
    fn look_around(&mut self, colliders: &Colliders) {
        let bounds = *self.broad_phase;
        let mut near = colliders.near(bounds.centre, bounds.radius, self.layers());
        if bounds.takes_part && (bounds.has_sleeping_contacts || near.next().is_some()) {
            self.find_near(colliders);
        }
    }

    fn layers(&self) -> ClothLayers {
        self.layers.copied().unwrap_or_default()
    }

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
            // Without time nothing moves yet.
            let stands = (self.scratch.step).is_some_and(|step| step.seconds == 0.0);
            if stands || self.sleeps_on(&root, colliders) {
                return;
            }
            self.state.rest.disturb();
        }
        let BroadPhaseBounds { centre, radius, .. } = *self.broad_phase;
        let layers = self.layers();
        let scratch = &mut *self.scratch;
        let (near, carried) = (&mut scratch.near, scratch.carried.as_ref());
        // Besides moving by itself, a particle may be dragged by a collider, to other colliders that may drag it on.
        let mut dragged = 0.0_f32;
        loop {
            near.clear();
            let seen = |(entity, motion): (Entity, &ColliderMotion)| {
                Some((entity, motion.seen_from(self.frame, carried)?))
            };
            let around = colliders.near(centre, radius + dragged, layers);
            near.extend(around.filter_map(seen));
            let travels = near
                .iter()
                .map(|(_, near)| near.max_surface_travel(near.farthest_distance(&root)));
            let farthest = travels.fold(0.0, f32::max);
            if farthest <= dragged || !farthest.is_finite() {
                break;
            }
            dragged = farthest;
        }
        // Independent of the order of the tree, and of spawning.
        near.sort_unstable_by_key(|(entity, _)| colliders.order(*entity));
        let near = near.len();
        (scratch.detection).begin(self.built.surface(), scratch.reach + dragged);
        self.stats.colliders_near = near;
        if near == 0 {
            // The collider that it slept on is gone.
            self.stats.reason = SearchReason::NothingNear;
            self.search.query.clear();
            return;
        }
        self.broad_phase.is_searched = true;
        let stretch = self.state.stretch.bound;
        let (method, reason) = (scratch.search).chosen(self.particles.len(), near, stretch);
        (self.stats.search, self.stats.reason) = (method, reason);
        if let SearchMethod::Tree(volume, rule) = method {
            let start = Instant::now();
            let tree = self.built.tree();
            let bounds = &mut self.search.bounds;
            let outcome = bounds.rebuild((volume, rule), tree, self.particles, stretch);
            debug_assert!(outcome.is_ok(), "the choice was checked as the tick began");
            self.stats.rebuild_ms = milliseconds_since(start);
        }
    }

    /// Whether all colliders that touched a cloth as it fell asleep still rest in place, and no other has come.
    fn sleeps_on(&mut self, root: &BoundingSphere, colliders: &Colliders) -> bool {
        let layers = self.layers();
        let far = Vec3::from(self.frame.isometry().translation).length();
        let rests_still = |known: &mut RestsOn| {
            let motion = colliders.get(known.entity, layers);
            let moving = motion.and_then(|motion| motion.seen_from(self.frame, None));
            moving.is_some_and(|moving| known.still_rests(&moving, far))
        };
        let state = &mut *self.state;
        let known = &mut state.resting.on;
        if !known.iter_mut().all(rests_still) {
            return false;
        }
        let scratch = &mut *self.scratch;
        let (settings, stretch) = (&scratch.contact_settings, state.stretch.bound);
        let (bounds, query) = &mut scratch.sleep_query;
        let (tree, surface) = (self.built.tree(), self.built.surface());
        let BroadPhaseBounds { centre, radius, .. } = *self.broad_phase;
        let cover = cover(settings, stretch, self.built);
        let mut has_bounds = false;
        for (entity, motion) in colliders.near(centre, radius, layers) {
            if known.iter().any(|known| known.entity == entity) {
                continue;
            }
            let Some(collider) = motion.seen_from(self.frame, None) else {
                continue;
            };
            if !has_bounds {
                let rest_shape = (BoundingVolume::Sphere, BoundRule::RestShape);
                let outcome = bounds.rebuild(rest_shape, tree, self.particles, stretch);
                debug_assert!(outcome.is_ok(), "spheres have a rest shape");
                has_bounds = true;
            }
            // Nothing of the cloth moves towards anything.
            let (probe, narrow_phase) =
                Detection::probe_within(0.0, &collider, settings, surface, cover, root);
            query.clear();
            query.search(tree, bounds, self.particles, &probe);
            let met = match narrow_phase {
                NarrowPhase::Triangles | NarrowPhase::Auto => {
                    let bare = collider.probe(0.0, settings.particle_radius, root);
                    meets_triangles(surface, self.particles, query.candidates(), &bare)
                }
                NarrowPhase::Particles => !query.candidates().is_empty(),
            };
            if met {
                return false;
            }
        }
        true
    }

    /// Finds the particles that each collider near may touch, if there is any.
    fn query(&mut self) {
        if !(self.broad_phase.is_searched && self.built.matches(self.particles)) {
            return;
        }
        let start = Instant::now();
        let root = self.root();
        let scratch = &mut *self.scratch;
        let ClothSearch { bounds, query } = &mut *self.search;
        let (tree, surface) = (self.built.tree(), self.built.surface());
        let (detection, settings) = (&mut scratch.detection, &scratch.contact_settings);
        let cover = cover(settings, self.state.stretch.bound, self.built);
        query.clear();
        let mut is_dragged = false;
        for (id, &(entity, ref collider)) in scratch.near.iter().enumerate() {
            let (probe, narrow_phase) = detection.probe(collider, settings, surface, cover, &root);
            let found = match self.stats.search {
                SearchMethod::Tree(..) => query.search(tree, bounds, self.particles, &probe),
                SearchMethod::Auto | SearchMethod::Scan => query.scan(self.particles, &probe),
            };
            is_dragged |= !(found.is_empty() || collider.is_settled())
                && collider.max_surface_travel(1.0) > 0.0;
            let found = &query.candidates()[found];
            let known = self.contacts.with(entity);
            if known.is_none_or(|contact| contact.is_embedded) {
                let others = scratch.near.iter().map(|(_, other)| other);
                let was_embedded = known.is_some();
                detection.embed(id, collider, was_embedded, found, self.particles, others);
            }
            detection.add(id, collider, narrow_phase, found, self.particles);
        }
        if is_dragged {
            self.state.rest.disturb();
        }
        let by_triangles = |touch: &&Touch| touch.narrow_phase == NarrowPhase::Triangles;
        self.stats.by_triangles = detection.touches().iter().filter(by_triangles).count();
        self.stats.nodes_visited = query.nodes_visited();
        self.stats.leaf_tests = query.leaf_tests();
        self.stats.query_ms = milliseconds_since(start);
    }
}

#[cfg(test)]
mod tests;
