//! Chooses the level of detail of each cloth, and which cloths are moved in a tick.

use bevy::{
    ecs::query::QueryData,
    prelude::{Entity, Has, Local, Query, Res, ResMut, Time, Vec3, With},
};

use super::{
    colliders::{ColliderMotion, ColliderTree},
    islands::{Islands, Span},
    seams::Seams,
    source::Cameras,
};
use crate::{
    cloth::ClothParticles,
    contact::{ClothLayers, ClothSelfCollision},
    plugin::{
        authoring::{ClothLod, ClothLodLevel, ClothOrder, ClothTeleport, GlobalClothLod},
        frame::ClothFrame,
        state::{ClothBuilt, ClothState},
    },
    solver::ClothSettings,
};

/// For how many ticks a cloth is moved in each after something that moves was near: half a second of Bevy's 64 Hz.
const KEPT: u32 = 32;

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct LodQuery {
    entity: Entity,
    lod: Option<&'static ClothLod>,
    built: &'static ClothBuilt,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    settings: Option<&'static ClothSettings>,
    self_collision: Option<&'static ClothSelfCollision>,
    state: &'static mut ClothState,
    layers: Option<&'static ClothLayers>,
    order: Option<&'static ClothOrder>,
    teleports: Has<ClothTeleport>,
}

/// A cloth, and its wanted level.
#[derive(Debug, Clone, Copy)]
struct WantedLevel {
    /// Around the whole of it, as far as it may get until it is moved again, in the world (m).
    span: Span,
    level: ClothLodLevel,
    /// The place of the one whose level and phase all have that are near each other.
    group: usize,
    phase: u32,
    is_due: bool,
}

impl WantedLevel {
    /// Whether it may touch other cloth, or is sewn to it.
    fn is_joined(&self, seams: &Seams) -> bool {
        self.span.touches || seams.hold(self.span.cloth.1)
    }
}

/// Memory that a tick works in.
#[derive(Debug, Default)]
pub(crate) struct Work {
    wanted: Vec<WantedLevel>,
    groups: Islands,
}

type Colliders<'w, 's> = Query<'w, 's, (&'static ColliderMotion, Option<&'static ClothLayers>)>;

/// Decides what happens to each cloth in the tick. Costs nothing if there is no level of detail.
pub(crate) fn choose_levels(
    mut cloths: Query<LodQuery>,
    own: Query<(), With<ClothLod>>,
    global: Option<Res<GlobalClothLod>>,
    cameras: Cameras,
    colliders: Colliders,
    mut tree: ResMut<ColliderTree>,
    (time, seams): (Res<Time>, Res<Seams>),
    mut work: Local<Work>,
) {
    let is_asked_for = !own.is_empty() || global.is_some();
    // Cloths at another level come back to the full one.
    if !is_asked_for && cloths.iter().all(|cloth| cloth.state.lod.is_full()) {
        return;
    }
    tree.refit();
    let seconds = time.delta_secs();
    let global = global.as_ref().map(|global| &global.0);
    let Work { wanted, groups } = &mut *work;
    wanted.clear();
    for mut cloth in &mut cloths {
        let mut own = cloth.wanted(global, &cameras);
        if let ClothLodLevel::Every(_) = own.level {
            let span = own.span;
            let near = tree.near(span.centre, span.radius);
            let mut near = near.filter_map(|entity| colliders.get(entity).ok());
            let comes_near = near.any(|(motion, others)| {
                span.layers
                    .interacts_with(others.copied().unwrap_or_default())
                    && (motion.is_moving() || motion.is_body())
                    && motion.comes_near(span.centre, span.radius)
            });
            let kept = &mut cloth.state.lod.kept;
            *kept = match comes_near {
                true => KEPT,
                false => kept.saturating_sub(1),
            };
            if *kept > 0 {
                own.level = ClothLodLevel::Full;
            }
        }
        wanted.push(own);
    }
    wanted.sort_unstable_by_key(|own| own.span.cloth);
    for (place, own) in wanted.iter_mut().enumerate() {
        (own.group, own.phase) = (place, place as u32);
    }
    let is_coarse = |own: &WantedLevel| own.level != ClothLodLevel::Full && own.is_joined(&seams);
    if wanted.iter().any(is_coarse) {
        group(wanted, groups, &seams);
    }
    for place in 0..wanted.len() {
        let own = wanted[place];
        let of_group = wanted[own.group];
        let Ok(mut cloth) = cloths.get_mut(own.span.cloth.1) else {
            continue;
        };
        // Sleeping cloth costs next to nothing.
        let rests = cloth.state.rest.is_asleep();
        let lod = &mut cloth.state.lod;
        let turn = (of_group.phase, of_group.is_due, rests);
        lod.begin(of_group.level, turn, seconds);
    }
}

impl LodQueryItem<'_, '_> {
    /// Middle and radius of a sphere around it, in its frame (m); `None` for one that is not built, nor resumed from a snapshot.
    fn sphere(&self) -> Option<(Vec3, f32)> {
        if self.state.is_valid && self.built.matches(self.particles) {
            let stretch = self.state.stretch.bound;
            let root = self.built.tree().root_sphere(self.particles, stretch);
            return Some((root.center.into(), root.radius()));
        }
        self.state.lod.sphere.filter(|_| self.state.resumes)
    }

    /// The level that it would have alone.
    fn wanted(&mut self, global: Option<&ClothLod>, cameras: &Cameras) -> WantedLevel {
        let layers = self.layers.copied().unwrap_or_default();
        let order = self.order.copied().unwrap_or_default();
        let mut wanted = WantedLevel {
            span: Span {
                cloth: (order, self.entity),
                centre: Vec3::ZERO,
                radius: 0.0,
                layers,
                touches: false,
                bounds: None,
            },
            level: ClothLodLevel::Full,
            group: 0,
            phase: 0,
            is_due: true,
        };
        // Errors of a level of detail are reported when the cloth is prepared.
        let lod = self.lod.or(global).filter(|lod| lod.validate().is_ok());
        // One that was not built yet, or can't be, is looked at in each tick.
        let Some((centre, radius)) = self.sphere() else {
            return wanted;
        };
        wanted.span.centre = self.frame.to_world(centre);
        let state = &mut self.state.lod;
        if let Some(lod) = lod {
            let nearest = cameras.nearest(wanted.span.centre);
            let is_hidden = nearest.is_some() && cameras.is_hidden(self.entity);
            let distance = nearest.map_or(0.0, |distance| (distance - radius).max(0.0));
            state.passed = lod.passed(distance, state.passed);
            let last = state.passed.checked_sub(1);
            let by_distance = last.map(|last| lod.distances[last].1);
            wanted.level = lod.level.or(by_distance).unwrap_or_default();
            if is_hidden && lod.hidden.coarseness() > wanted.level.coarseness() {
                wanted.level = lod.hidden;
            }
        }
        let ticks = wanted.level.ticks().unwrap_or(1) as f32;
        // The displacement by acceleration grows with the square of the time.
        let times = (ticks / state.moved_by() as f32).max(1.0);
        let around = self.settings.copied().unwrap_or_default().particle_radius;
        let around = self.built.surface().rope_radius().unwrap_or(around);
        let thickness = self.self_collision.map_or(0.0, |of| of.thickness);
        wanted.span.radius = radius + 2.0 * state.reach * times * times + around.max(thickness);
        wanted.span.touches = self.self_collision.is_some();
        wanted.is_due = self.teleports || self.state.lod.is_due();
        wanted
    }
}

/// Gives cloths that may touch each other, or are sewn together, the finest of their levels, and moves them in the same ticks.
fn group(wanted: &mut [WantedLevel], groups: &mut Islands, seams: &Seams) {
    let joined = wanted.iter().filter(|own| own.is_joined(seams));
    groups.begin(joined.map(|own| own.span));
    groups.join(|_| None);
    groups.sew(seams);
    let place_of =
        |wanted: &[WantedLevel], cloth| wanted.binary_search_by_key(&cloth, |own| own.span.cloth);
    for (cloth, root) in groups.roots() {
        let (Ok(place), Ok(root)) = (place_of(wanted, cloth), place_of(wanted, root)) else {
            continue;
        };
        let own = wanted[place];
        wanted[place].group = root;
        let all = &mut wanted[root];
        if own.level.coarseness() < all.level.coarseness() {
            all.level = own.level;
        }
        all.is_due |= own.is_due;
    }
}
