//! Which cloths are near each other: their sub-steps run together.

use bevy::{
    ecs::entity::EntityIndexSet,
    prelude::{Entity, Query, Res, ResMut, Resource, Vec3},
};

use super::{neighbour::Neighbour, seams::Seams};
use crate::{
    contact::{ClothLayers, MutualContact},
    plugin::authoring::Ordered,
};

/// Cloths that may touch each other in the tick, island by island.
#[derive(Resource, Debug, Default)]
pub(crate) struct Islands {
    pub all: Vec<Island>,
    /// Those of the tick before.
    before: Vec<Island>,
    /// Islands that are no more, whose memory is used again.
    spare: Vec<Island>,
    /// Where each cloth may be, sorted by the first number.
    spans: Vec<Span>,
    parent: Vec<u32>,
    /// Which island the cloths of each root are, if any.
    island_of: Vec<u32>,
    /// The span of each cloth, sorted, where cloths are sewn.
    span_of: Vec<(Entity, u32)>,
}

/// Cloths that may touch each other, or that are sewn together. If all sleep, one may be woken in the tick.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Island {
    /// Ascending.
    pub cloths: Vec<Ordered>,
    pub contact: MutualContact,
    /// The same, as queries take them.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub entities: EntityIndexSet,
    /// Their seams, in the order in which they are solved.
    #[cfg_attr(feature = "serialize", serde(skip))]
    pub seams: EntityIndexSet,
}

/// Where a cloth may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub cloth: Ordered,
    pub centre: Vec3,
    pub radius: f32,
    pub layers: ClothLayers,
    /// Whether it touches cloth at all.
    pub touches: bool,
    /// The least and the greatest corner of the box that it stays in (m), once it was asked for.
    pub bounds: Option<[Vec3; 2]>,
}

/// For how long a cloth has to be calm to let those sleep that it is sewn to (s): half of what it takes to fall asleep itself.
const SETTLED: f32 = 0.25;

const NONE: u32 = u32::MAX;

/// Finds which cloths may touch each other in the tick, or are sewn together. A cloth that moves wakes sleeping cloths beside
/// it.
pub(crate) fn find_islands(
    mut islands: ResMut<Islands>,
    seams: Res<Seams>,
    mut cloths: Query<Neighbour>,
) {
    let islands = &mut *islands;
    islands.spans.clear();
    for mut cloth in &mut cloths {
        cloth.scratch.is_in_island = false;
        let settings = cloth.scratch.self_collision;
        let is_joined = settings.is_some() || seams.hold(cloth.entity);
        if is_joined && cloth.bounds.takes_part {
            islands.spans.push(Span {
                cloth: (cloth.order.copied().unwrap_or_default(), cloth.entity),
                centre: cloth.bounds.centre,
                radius: cloth.bounds.radius + settings.map_or(0.0, |of| of.thickness),
                layers: cloth.layers.copied().unwrap_or_default(),
                touches: settings.is_some(),
                bounds: None,
            });
        }
    }
    islands.recycle();
    if islands.spans.len() < 2 && seams.active.is_empty() {
        return;
    }
    islands.join(|entity| cloths.get(entity).map(|cloth| cloth.bounds()).ok());
    islands.sew(&seams);
    islands.collect(&seams);
    for island in &mut islands.all {
        wake(island, &mut cloths);
    }
}

impl Islands {
    /// Begins a tick: those of the last one are now before, and the memory of earlier ones is spare.
    fn recycle(&mut self) {
        std::mem::swap(&mut self.all, &mut self.before);
        let gone = self.all.drain(..).map(Island::emptied);
        self.spare.extend(gone);
    }

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
                    && own.touches
                    && other.touches
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

    /// Joins all cloths that are sewn together.
    pub fn sew(&mut self, seams: &Seams) {
        self.span_of.clear();
        if seams.active.is_empty() {
            return;
        }
        let spans = self.spans.iter().enumerate();
        (self.span_of).extend(spans.map(|(index, span)| (span.cloth.1, index as u32)));
        self.span_of.sort_unstable();
        for seam in &seams.active {
            if let [Some(a), Some(b)] = seam.cloths.map(|(_, cloth)| self.span(cloth)) {
                let [a, b] = [a, b].map(|span| self.find(span));
                self.parent[a.max(b) as usize] = a.min(b);
            }
        }
    }

    /// The span of a cloth, where cloths are sewn.
    fn span(&self, cloth: Entity) -> Option<u32> {
        let place = self.span_of.binary_search_by_key(&cloth, |of| of.0).ok()?;
        Some(self.span_of[place].1)
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

    /// The island of a root, which is made with it.
    fn island(&mut self, root: usize) -> &mut Island {
        if self.island_of[root] == NONE {
            self.island_of[root] = self.all.len() as u32;
            let mut island = self.spare.pop().unwrap_or_default();
            island.cloths.push(self.spans[root].cloth);
            self.all.push(island);
        }
        &mut self.all[self.island_of[root] as usize]
    }

    fn find(&mut self, mut span: u32) -> u32 {
        while self.parent[span as usize] != span {
            let above = self.parent[span as usize];
            self.parent[span as usize] = self.parent[above as usize];
            span = above;
        }
        span
    }

    /// Makes islands of cloths that are not alone, or are sewn to themselves. An island of the same cloths as before keeps
    /// its contacts.
    fn collect(&mut self, seams: &Seams) {
        self.island_of.clear();
        self.island_of.resize(self.spans.len(), NONE);
        for span in 0..self.spans.len() {
            let root = self.find(span as u32) as usize;
            if root != span {
                let cloth = self.spans[span].cloth;
                self.island(root).cloths.push(cloth);
            }
        }
        for seam in &seams.active {
            let [first, second] = seam.cloths.map(|(_, cloth)| self.span(cloth));
            if let (Some(span), true) = (first, second.is_some()) {
                let root = self.find(span) as usize;
                self.island(root).seams.insert(seam.seam);
            }
        }
        for island in &mut self.all {
            island.cloths.sort_unstable();
            let cloths = island.cloths.iter().map(|(_, cloth)| *cloth);
            island.entities.extend(cloths);
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

impl Island {
    /// Without all that it holds, but for its memory.
    fn emptied(mut self) -> Self {
        self.cloths.clear();
        self.entities.clear();
        self.seams.clear();
        self.contact = MutualContact::default();
        self
    }
}

/// Wakes all cloths of an island in which one moves.
fn wake(island: &mut Island, cloths: &mut Query<Neighbour>) {
    // A touch on one of several sewn cloths moves all of them at once.
    let is_sewn = !island.seams.is_empty();
    let mut is_moving = false;
    for cloth in cloths.iter_many(&island.entities) {
        let rest = &cloth.state.rest;
        is_moving |= !rest.is_calm() || (is_sewn && rest.calm() < SETTLED);
        if cloth.scratch.was_put {
            island.contact.forget();
        }
    }
    let mut each = cloths.iter_many_mut(&island.entities);
    while let Some(mut cloth) = each.fetch_next() {
        cloth.scratch.is_in_island = true;
        // Its contact with itself is part of its island's.
        cloth.scratch.mutual = None;
        if is_moving && cloth.state.rest.is_asleep() {
            cloth.wake();
        }
    }
}

#[cfg(test)]
mod tests {
    use bevy::ecs::world::World;

    use super::*;
    use crate::{contact::tests::Random, plugin::authoring::ClothOrder};

    /// Cloths at random places, some alike, some in other layers, some without a box.
    fn spans(random: &mut Random, world: &mut World) -> Vec<Span> {
        let count = random.below(25);
        let layers = [[1, 1], [2, 2], [3, 3], [1, 2]];
        (0..count)
            .map(|_| {
                let [memberships, filters] = layers[random.below(4) as usize];
                let centre = random.within(1.5);
                let radius = random.between(0.0, 0.8);
                let half = Vec3::splat(radius * random.part());
                Span {
                    cloth: (ClothOrder(random.below(5).into()), world.spawn_empty().id()),
                    centre,
                    radius,
                    layers: ClothLayers {
                        memberships,
                        filters,
                    },
                    touches: random.below(4) > 0,
                    bounds: (random.below(4) > 0).then_some([centre - half, centre + half]),
                }
            })
            .collect()
    }

    fn meet(a: &Span, b: &Span) -> bool {
        let boxes_meet = match (a.bounds, b.bounds) {
            (Some([low, high]), Some([other_low, other_high])) => {
                (0..3).all(|axis| low[axis] <= other_high[axis] && other_low[axis] <= high[axis])
            }
            _ => true,
        };
        a.centre.distance(b.centre) <= a.radius + b.radius
            && a.touches
            && b.touches
            && a.layers.interacts_with(b.layers)
            && boxes_meet
    }

    /// By brute force: pairs are joined until nothing changes.
    fn by_brute_force(spans: &[Span]) -> Vec<Vec<Ordered>> {
        let mut group: Vec<usize> = (0..spans.len()).collect();
        let pairs = || (0..spans.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
        for (a, b) in pairs().filter(|(a, b)| meet(&spans[*a], &spans[*b])) {
            let [from, to] = [group[a], group[b]];
            group
                .iter_mut()
                .filter(|of| **of == from)
                .for_each(|of| *of = to);
        }
        let each = (0..spans.len()).map(|of| {
            let all = spans.iter().zip(&group).filter(|(_, group)| **group == of);
            let mut cloths: Vec<Ordered> = all.map(|(span, _)| span.cloth).collect();
            cloths.sort_unstable();
            cloths
        });
        let mut islands: Vec<_> = each.filter(|cloths| cloths.len() > 1).collect();
        islands.sort_unstable();
        islands
    }

    #[test]
    fn islands_are_those_of_brute_force() {
        let (mut random, mut world) = (Random(8), World::new());
        let (mut islands, mut largest) = (Islands::default(), 0);
        for case in 0..500 {
            let spans = spans(&mut random, &mut world);
            let boxes: Vec<_> = spans
                .iter()
                .map(|span| (span.cloth.1, span.bounds))
                .collect();
            let bounds = |cloth| boxes.iter().find(|(of, _)| *of == cloth)?.1;
            let unasked = spans.iter().map(|span| Span {
                bounds: None,
                ..*span
            });
            islands.begin(unasked);
            islands.join(bounds);
            islands.sew(&Seams::default());
            islands.recycle();
            islands.collect(&Seams::default());
            let found: Vec<_> = islands.all.iter().map(|of| of.cloths.clone()).collect();
            assert_eq!(found, by_brute_force(&spans), "case {case}");
            for island in &islands.all {
                let cloths = island.cloths.iter().map(|(_, cloth)| cloth);
                assert!(island.entities.iter().eq(cloths), "case {case}");
            }
            largest = found.iter().map(Vec::len).fold(largest, usize::max);
        }
        assert!(largest > 5, "{largest} cloths");
    }
}
