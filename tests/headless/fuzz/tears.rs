//! Tears by hand, by a blade and under load, and mended ones.

use std::collections::BTreeMap;

use bevy::{ecs::system::RunSystemOnce, prelude::*};
use bevy_drape::prelude::*;

use super::{
    look::{place_of, surface_of},
    mutate::OTHERS,
    random::Random,
};

/// Particles of a cloth that is torn along all of its edges, at most: six times as many may come of it.
const MOST: usize = 120;

/// Counts edges that load tears.
#[derive(Resource, Default)]
pub struct UnderLoad {
    /// Number of torn edges before the plugin looks for more.
    before: BTreeMap<Entity, usize>,
    pub edges: usize,
}

/// Notes tears that there are already, after the last act of a tick.
pub fn note(
    cloths: Query<(Entity, &ClothTears), With<ClothTearing>>,
    mut found: ResMut<UnderLoad>,
) {
    let torn = cloths.iter();
    found.before = torn
        .map(|(cloth, tears)| (cloth, tears.edges().len()))
        .collect();
}

/// Counts those that came since then.
pub fn count(cloths: Query<(Entity, &ClothTears)>, mut found: ResMut<UnderLoad>) {
    for (cloth, tears) in &cloths {
        let before = found.before.get(&cloth);
        found.edges += before.map_or(0, |before| tears.edges().len() - before);
    }
}

/// The tears of all cloths.
pub fn all(world: &mut World) -> BTreeMap<Entity, ClothTears> {
    let mut cloths = world.query::<(Entity, &ClothTears)>();
    let cloths = cloths.iter(world);
    cloths
        .map(|(cloth, tears)| (cloth, tears.clone()))
        .collect()
}

/// Tears a cloth, lets load tear it, or mends it.
pub fn tear(world: &mut World, entity: Entity, random: &mut Random) {
    let Some(surface) = surface_of(world, entity) else {
        return;
    };
    match random.below(12) {
        0 => {
            let tearing = ClothTearing::new(random.number());
            world.entity_mut(entity).insert(tearing);
        }
        1 => change_map(world, entity, random),
        2..=7 => {
            let known = world.get::<ClothTears>(entity).cloned();
            let mut tears = known.unwrap_or_default();
            by_hand(&mut tears, &surface, random);
            world.entity_mut(entity).insert(tears);
        }
        8 => {
            if let Some(mut tears) = world.get_mut::<ClothTears>(entity) {
                *tears = ClothTears::none();
            }
        }
        _ => cut(world, entity, random),
    }
}

/// Gives it another stretch and density, or takes the map away.
fn change_map(world: &mut World, entity: Entity, random: &mut Random) {
    let map = ClothMaterialMap {
        stretch: ClothFactor::of(random.number()),
        density: ClothFactor::added(ClothPaint::vertices([1.0; 30])),
        ..default()
    };
    let mut cloth = world.entity_mut(entity);
    match random.one_in(2) {
        true => cloth.insert(map),
        false => cloth.remove::<ClothMaterialMap>(),
    };
}

/// Tears faces out, the cloth off its particles, everything apart, or along what is no edge.
fn by_hand(tears: &mut ClothTears, surface: &Surface, random: &mut Random) {
    let count = surface.len();
    let mut particle = || random.below(count) as u32;
    let [a, b, c] = [particle(), particle(), particle()];
    match random.below(7) {
        0..=1 => {
            for _ in 0..random.below(40) {
                if let Some(face) = random.pick(surface.triangles()) {
                    tears.tear_out(surface, *face);
                }
            }
        }
        2 => {
            // The first of a grid is pinned by default.
            for of in [0, a, b] {
                tears.tear_off(surface, of);
            }
        }
        3 if count <= MOST => {
            let sides = |[a, b, c]: &[u32; 3]| [[*a, *b], [*b, *c], [*c, *a]];
            let sides = surface.triangles().iter().flat_map(sides);
            tears.tear_all(sides.map(|side| side.map(|end| surface.origin_of(end))));
        }
        4 => {
            // Hardly ever a face.
            tears.tear_out(surface, [a, b, c]);
        }
        5 => {
            let nowhere = [a, count as u32, OTHERS, u32::MAX];
            tears.tear([a, nowhere[random.below(nowhere.len())]]);
        }
        _ => {
            if let Some([a, b, _]) = random.pick(surface.triangles()) {
                tears.tear([*b, *a].map(|end| surface.origin_of(end)));
            }
        }
    }
}

/// Sweeps a blade anywhere, or exactly through particles and pins, at times without an area.
fn cut(world: &mut World, entity: Entity, random: &mut Random) {
    world
        .entity_mut(entity)
        .insert_if_new(ClothTears::default());
    let is_exact = random.one_in(2);
    let mut end = || match is_exact {
        true => place_of(world, entity, random).unwrap_or_default(),
        false => random.place(),
    };
    let from = [end(), end()];
    let mut to = [end(), end()];
    if random.one_in(6) {
        to[random.below(2)] = from[random.below(2)];
    }
    let cut = move |mut blade: ClothBlade| blade.sweep(from, to);
    world.run_system_once(cut).expect("it borrows cloths alone");
}
