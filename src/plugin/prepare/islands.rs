//! Which cloths are near each other: their sub-steps run together.

use bevy::{
    ecs::{
        entity::Entity,
        query::{QueryData, With},
        resource::Resource,
        system::{Query, ResMut},
    },
    math::{Mat3, Vec3},
};

use crate::{
    cloth::ClothParticles,
    contact::{ClothLayers, ClothSelfCollision, MutualContact},
    plugin::{
        authoring::{ClothOrder, Ordered},
        frame::ClothFrame,
        state::{BroadPhaseBounds, ClothBuilt, ClothScratch, ClothState},
    },
};

/// Cloths that may touch each other in the tick, island by island.
#[derive(Resource, Debug, Default)]
pub(crate) struct Islands {
    pub all: Vec<Island>,
    /// Those of the tick before.
    before: Vec<Island>,
    /// Where each cloth may be, sorted by the first number.
    spans: Vec<Span>,
    parent: Vec<u32>,
    /// Which island the cloths of each root are, if any.
    island_of: Vec<u32>,
}

/// Cloths that may touch each other. If all sleep, one may be woken in the tick.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Island {
    /// Ascending.
    pub cloths: Vec<Ordered>,
    pub contact: MutualContact,
}

/// Where a cloth may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub cloth: Ordered,
    pub centre: Vec3,
    pub radius: f32,
    pub layers: ClothLayers,
    /// The least and the greatest corner of the box that it stays in (m), once it was asked for.
    pub bounds: Option<[Vec3; 2]>,
}

const NONE: u32 = u32::MAX;

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Neighbour {
    entity: Entity,
    built: &'static ClothBuilt,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    bounds: &'static mut BroadPhaseBounds,
    state: &'static mut ClothState,
    scratch: &'static mut ClothScratch,
    layers: Option<&'static ClothLayers>,
    order: Option<&'static ClothOrder>,
}

/// Those that touch cloth at all.
type Neighbours<'w, 's> = Query<'w, 's, Neighbour, With<ClothSelfCollision>>;

/// Finds which cloths may touch each other in the tick. A cloth that moves wakes sleeping cloths beside it.
pub(crate) fn find_islands(mut islands: ResMut<Islands>, mut cloths: Neighbours) {
    let islands = &mut *islands;
    islands.spans.clear();
    for mut cloth in &mut cloths {
        cloth.scratch.is_in_island = false;
        if let Some(settings) = cloth.scratch.self_collision
            && cloth.bounds.takes_part
        {
            islands.spans.push(Span {
                cloth: (cloth.order.copied().unwrap_or_default(), cloth.entity),
                centre: cloth.bounds.centre,
                radius: cloth.bounds.radius + settings.thickness,
                layers: cloth.layers.copied().unwrap_or_default(),
                bounds: None,
            });
        }
    }
    std::mem::swap(&mut islands.all, &mut islands.before);
    islands.all.clear();
    if islands.spans.len() < 2 {
        return;
    }
    islands.join(|entity| cloths.get(entity).map(|cloth| cloth.bounds()).ok());
    islands.collect();
    for island in &mut islands.all {
        wake(island, &mut cloths);
    }
}

impl Islands {
    /// Cloths that are each alone, to be joined.
    pub fn begin(&mut self, spans: impl Iterator<Item = Span>) {
        self.spans.clear();
        self.spans.extend(spans);
    }

    /// Each cloth, with one that all have in common that it was joined with.
    pub fn roots(&mut self) -> impl Iterator<Item = (Ordered, Ordered)> {
        (0..self.spans.len()).map(|span| {
            let root = self.find(span as u32) as usize;
            (self.spans[span].cloth, self.spans[root].cloth)
        })
    }

    /// Joins all cloths whose spheres meet, by a sweep along the x axis, and then the boxes that they stay in.
    pub fn join(&mut self, bounds: impl Fn(Entity) -> Option<[Vec3; 2]>) {
        let first = |span: &Span| span.centre.x - span.radius;
        self.spans
            .sort_unstable_by(|a, b| first(a).total_cmp(&first(b)).then(a.cloth.cmp(&b.cloth)));
        self.parent.clear();
        self.parent.extend(0..self.spans.len() as u32);
        for a in 0..self.spans.len() {
            let own = self.spans[a];
            let end = own.centre.x + own.radius;
            for b in a + 1..self.spans.len() {
                let other = self.spans[b];
                if first(&other) > end {
                    break;
                }
                let reach = own.radius + other.radius;
                if own.centre.distance_squared(other.centre) <= reach * reach
                    && own.layers.interacts_with(other.layers)
                    && self.find(a as u32) != self.find(b as u32)
                    && self.boxes_meet([a, b], &bounds)
                {
                    let [a, b] = [a, b].map(|span| self.find(span as u32));
                    self.parent[a.max(b) as usize] = a.min(b);
                }
            }
        }
    }

    /// Whether the boxes of two cloths meet. Boxes are computed once, and a cloth without a box meets all.
    fn boxes_meet(
        &mut self,
        spans: [usize; 2],
        bounds: impl Fn(Entity) -> Option<[Vec3; 2]>,
    ) -> bool {
        let [a, b] = spans.map(|index| {
            let span = &mut self.spans[index];
            span.bounds = span.bounds.or_else(|| bounds(span.cloth.1));
            span.bounds
        });
        match (a, b) {
            (Some([low, high]), Some([other_low, other_high])) => {
                // NaN is not apart.
                !(low.cmpgt(other_high).any() || other_low.cmpgt(high).any())
            }
            _ => true,
        }
    }

    fn find(&mut self, mut span: u32) -> u32 {
        while self.parent[span as usize] != span {
            let above = self.parent[span as usize];
            self.parent[span as usize] = self.parent[above as usize];
            span = above;
        }
        span
    }

    /// Makes islands of cloths that are not alone. An island of the same cloths as before keeps its contacts.
    fn collect(&mut self) {
        self.island_of.clear();
        self.island_of.resize(self.spans.len(), NONE);
        for span in 0..self.spans.len() {
            let root = self.find(span as u32) as usize;
            if root == span {
                continue;
            }
            if self.island_of[root] == NONE {
                self.island_of[root] = self.all.len() as u32;
                let mut island = Island::default();
                island.cloths.push(self.spans[root].cloth);
                self.all.push(island);
            }
            let island = &mut self.all[self.island_of[root] as usize];
            island.cloths.push(self.spans[span].cloth);
        }
        for island in &mut self.all {
            island.cloths.sort_unstable();
            let known = self
                .before
                .iter_mut()
                .find(|before| before.cloths == island.cloths);
            if let Some(known) = known {
                island.contact = std::mem::take(&mut known.contact);
            }
        }
        // In an order that does not depend on where they are.
        self.all.sort_unstable_by(|a, b| a.cloths.cmp(&b.cloths));
    }
}

/// Wakes all cloths of an island in which one moves.
fn wake(island: &mut Island, cloths: &mut Neighbours) {
    let mut is_moving = false;
    let entities = || island.cloths.iter().map(|(_, cloth)| cloth);
    for cloth in cloths.iter_many(entities()) {
        let rest = &cloth.state.rest;
        is_moving |= !rest.is_asleep() && !rest.is_calm();
        if cloth.scratch.was_put {
            island.contact.forget();
        }
    }
    let mut each = cloths.iter_many_mut(entities());
    while let Some(mut cloth) = each.fetch_next() {
        cloth.scratch.is_in_island = true;
        // Its contact with itself is part of its island's.
        cloth.scratch.mutual = None;
        if is_moving && cloth.state.rest.is_asleep() {
            cloth.wake();
        }
    }
}

impl NeighbourItem<'_, '_> {
    /// Wakes a cloth that was prepared as a sleeping one.
    fn wake(&mut self) {
        self.state.rest.disturb();
        self.state.rests_on.clear();
        self.bounds.has_sleeping_contacts = false;
        let scratch = &mut *self.scratch;
        scratch.near.clear();
        scratch.detection.begin(self.built.surface(), scratch.reach);
    }
}

impl NeighbourReadOnlyItem<'_, '_> {
    /// The least and the greatest corner of the box in the world that the cloth stays in within the tick (m): where its particles
    /// are, and as far around as they may get by themselves, and again as far should something drag them.
    fn bounds(&self) -> [Vec3; 2] {
        let ends = [Vec3::MAX, Vec3::MIN];
        let [low, high] = self
            .particles
            .positions()
            .fold(ends, |[low, high], place| [low.min(place), high.max(place)]);
        let axes = Mat3::from_quat(self.frame.isometry().rotation);
        let half = (high - low) / 2.0;
        let half =
            axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        let centre = self.frame.to_world(low.midpoint(high));
        let thickness = self.scratch.self_collision.map_or(0.0, |of| of.thickness);
        let around = 2.0 * self.scratch.reach + thickness + 1.0e-5 * centre.length();
        let half = half * (1.0 + 1.0e-5) + around;
        [centre - half, centre + half]
    }
}
