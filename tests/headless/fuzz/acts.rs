//! What is done to a world.

use bevy::{
    ecs::{entity::EntityHashSet, entity_disabling::Disabled},
    prelude::*,
    reflect::PartialReflect,
};
use bevy_drape::prelude::*;

use super::{
    bakes,
    mutate::{OTHERS, components, makers, mutate},
    random::Random,
    rays, seams,
    tears::tear,
};
use crate::meshes::sheets::{sheet, sheet_asset};

/// Entities that are done something to, at most.
const MOST: usize = 18;

/// What the driver knows of the world.
#[derive(Resource, Default)]
pub struct Pool {
    /// Cloths, colliders, zones and what carries them.
    pub all: Vec<Entity>,
    /// What others are children of, and is nobody's child.
    pub roots: Vec<Entity>,
    /// Whether to save the world before the next tick, or to put it back.
    pub request: Option<bool>,
    /// Whether a tick has moved particles already.
    pub is_late: bool,
    /// Cloths whose particles were written between two systems of the tick.
    pub written: EntityHashSet,
    /// How many acts there were.
    pub acts: usize,
}

/// Does one thing at random.
pub fn act(world: &mut World) {
    world.resource_scope(|world, mut random: Mut<Random>| {
        world.resource_scope(|world, mut pool: Mut<Pool>| {
            pool.all.retain(|entity| world.get_entity(*entity).is_ok());
            pool.acts += 1;
            one(world, &mut pool, &mut random);
            for &entity in &pool.all {
                keep_to_layers(world, entity);
                keep_short(world, entity);
            }
        });
    });
}

/// Without layers of its own it would meet what nobody is to touch.
fn keep_to_layers(world: &mut World, entity: Entity) {
    let others = ClothLayers::new(OTHERS, OTHERS);
    if let Ok(mut entity) = world.get_entity_mut(entity) {
        let layers = entity.get::<ClothLayers>();
        if layers.is_none_or(|layers| layers.interacts_with(ClothLayers::new(!OTHERS, !OTHERS))) {
            entity.insert(others);
        }
    }
}

/// A path of millions of particles is valid, but takes minutes.
fn keep_short(world: &mut World, entity: Entity) {
    let Some(ClothShape::RopePath(path)) = world.get::<Cloth>(entity).map(|cloth| &cloth.shape)
    else {
        return;
    };
    let parts = path.points.windows(2).map(|of| of[0].distance(of[1]));
    // Of more than 2²⁴ there is a fault at once.
    if (1.0e3..2.0e7).contains(&(parts.sum::<f32>() / path.spacing)) {
        let short = Cloth::rope_along([Vec3::ZERO, Vec3::X], 0.1, 0.02);
        world.entity_mut(entity).insert(short);
    }
}

fn one(world: &mut World, pool: &mut Pool, random: &mut Random) {
    let Some(&entity) = random.pick(&pool.all) else {
        return spawn(world, pool, random);
    };
    match random.below(29) {
        0..=1 if pool.all.len() < MOST => spawn(world, pool, random),
        0..=1 => {
            world.despawn(entity);
        }
        2..=5 => write(world, entity, random),
        6..=9 => heal(world, entity),
        10..=11 => {
            let makers = makers(world);
            if let Some((component, default)) = random.pick(&makers) {
                let mut value = default.default();
                for _ in 0..random.below(3) {
                    mutate(value.as_partial_reflect_mut(), random);
                }
                insert(world, entity, component, value.as_partial_reflect());
            }
        }
        12 => {
            let known = components(world, entity);
            if let Some(component) = random.pick(&known) {
                component.remove(&mut world.entity_mut(entity));
            }
        }
        13 => match random.pick(&pool.roots) {
            Some(&root) if !random.one_in(3) => {
                world.entity_mut(entity).insert(ChildOf(root));
            }
            _ => {
                world.entity_mut(entity).remove::<ChildOf>();
            }
        },
        14 => match random.one_in(2) {
            true => drop(world.entity_mut(entity).insert(Disabled)),
            false => {
                for &entity in &pool.all {
                    world.entity_mut(entity).remove::<Disabled>();
                }
            }
        },
        15 => drop(world.entity_mut(entity).insert(ClothTeleport)),
        16..=17 if !pool.is_late => {
            place_particle(world, entity, random);
            pool.written.insert(entity);
        }
        18 => replace_mesh(world, entity, random),
        21..=22 => tear(world, entity, random),
        26..=28 => more(world, pool, entity, random),
        19 => pool.request = Some(random.one_in(2)),
        20 => {
            let places = random.pick(&pool.roots).copied();
            if let Some(mut place) = places.and_then(|root| world.get_mut::<Transform>(root)) {
                place.translation = random.place();
                place.rotation = Quat::from_rotation_y(random.number());
            }
        }
        _ => {
            let to = random.place();
            if let Some(mut place) = world.get_mut::<Transform>(entity) {
                place.translation = to;
            }
        }
    }
}

/// Writes into a component that is there.
fn write(world: &mut World, entity: Entity, random: &mut Random) {
    let known = components(world, entity);
    if let Some(component) = random.pick(&known)
        && let Some(mut value) = component.reflect_mut(world.entity_mut(entity))
    {
        mutate(value.as_partial_reflect_mut(), random);
    }
}

/// Takes back what was written, so that not all is at fault in the end.
fn heal(world: &mut World, entity: Entity) {
    let cloth = Cloth::new(5, 6, 0.1);
    let mut entity = world.entity_mut(entity);
    if entity.contains::<Cloth>() {
        entity.insert((
            cloth,
            ClothMaterial::default(),
            ClothSettings::default(),
            Pins::default(),
        ));
        entity.remove::<(
            ClothAttachments,
            ClothSkin,
            ClothAir,
            ClothPressure,
            ClothLod,
            ClothInertia,
            ClothSelfCollision,
            ClothMaterialMap,
            ClothTearing,
            ClothTears,
            ClothCreasing,
        )>();
    } else if entity.contains::<ClothCollider>() {
        entity
            .insert(ClothCollider::ball(0.2))
            .remove::<ClothBody>();
    }
    entity.insert(Transform::default());
}

fn insert(
    world: &mut World,
    entity: Entity,
    component: &ReflectComponent,
    value: &dyn PartialReflect,
) {
    let registry = world.resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    component.insert(&mut world.entity_mut(entity), value, &registry);
}

fn spawn(world: &mut World, pool: &mut Pool, random: &mut Random) {
    let place = Transform::from_translation(random.place());
    let (positions, triangles) = sheet(4, 5);
    let [columns, rows] = [2 + random.below(8) as u32, 2 + random.below(8) as u32];
    let grid = || Cloth::new(columns, rows, 0.1);
    let ball = |radius| ClothCollider::ball(radius);
    let entity = match random.below(16) {
        0..=2 => world.spawn((grid(), place)).id(),
        3 => world
            .spawn((grid(), Pins::none(), ClothSelfCollision::default(), place))
            .id(),
        4 => world
            .spawn((Cloth::triangles(positions, triangles), place))
            .id(),
        5 => {
            let target = random
                .pick(&pool.all)
                .copied()
                .unwrap_or(Entity::PLACEHOLDER);
            let attached = ClothAttachments::new([(Pin::Row(0), target)]);
            world.spawn((grid(), Pins::none(), attached, place)).id()
        }
        6 => {
            let mesh = match random.one_in(2) {
                true => sheet_asset(5, 4),
                false => Sphere::new(0.2).mesh().ico(2).expect("few"),
            };
            let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
            let gas = ClothPressure::gas(0.03);
            world
                .spawn((Cloth::mesh(), Mesh3d(mesh), Pins::none(), gas, place))
                .id()
        }
        7 => world.spawn((ball(random.number()), place)).id(),
        8 => world
            .spawn((ball(0.3), ClothBody::ball(0.5, 0.3), place))
            .id(),
        9 => world
            .spawn((ClothCollider::cuboid(0.2, 0.1, random.number()), place))
            .id(),
        10 => world.spawn((ClothCollider::plane(), place)).id(),
        13 => {
            let stiffer = ClothPaint::at_rest(|place| 20.0 * place.x.abs());
            let map = ClothMaterialMap {
                stretch: ClothFactor::added(stiffer.clone()),
                bending: ClothFactor::of(stiffer),
                ..default()
            };
            let material = ClothMaterial {
                stiffening: random.one_in(2).then(default),
                ..default()
            };
            world.spawn((grid(), material, map, place)).id()
        }
        12 => {
            let rope = Cloth::rope(columns * rows, 0.1, 0.02);
            world
                .spawn((rope, ClothSelfCollision::default(), place))
                .id()
        }
        14 => {
            let rope = rope_along(random);
            world
                .spawn((rope, ClothSelfCollision::default(), place))
                .id()
        }
        11 => {
            let cloth = random.pick(&pool.all).copied();
            let grab = ClothGrab {
                cloth: cloth.unwrap_or(Entity::PLACEHOLDER),
                particle: random.below(30) as u32,
                target: random.place(),
                ..default()
            };
            world.spawn(grab).id()
        }
        _ => world.spawn((ClothWindZone::default(), place)).id(),
    };
    pool.all.push(entity);
}

/// A rope along a path that may be too short, turn back on itself, or lead nowhere.
fn rope_along(random: &mut Random) -> Cloth {
    let nowhere = [Vec3::NAN, Vec3::INFINITY, Vec3::splat(1.0e11), Vec3::MAX];
    let mut points: Vec<Vec3> = Vec::new();
    for _ in 0..random.below(7) {
        let known = random.pick(&points).copied();
        let point = match random.below(12) {
            0 => nowhere[random.below(nowhere.len())],
            1..=2 => known.unwrap_or_default(),
            3 => known.unwrap_or_default() + 1.0e-7 * Vec3::X,
            _ => Vec3::new(random.part(), random.part(), random.part()),
        };
        points.push(point);
    }
    Cloth::rope_along(points, 0.1, 0.02)
}

/// Writes particles as a game does, by their own functions.
fn place_particle(world: &mut World, entity: Entity, random: &mut Random) {
    let Some(mut particles) = world.get_mut::<ClothParticles>(entity) else {
        return;
    };
    let index = random.below(particles.len());
    let outcome = match random.below(5) {
        0 => particles.set_position(index, random.vector()),
        1 => particles.set_velocity(index, random.vector()),
        2 => particles.set_inverse_mass(index, random.number()),
        3 => particles.set_position(index, random.place()),
        _ => {
            *particles = ClothParticles::default();
            Ok(())
        }
    };
    // What can't be written is told to who writes it.
    drop(outcome);
}

/// Sews, creases, looks, holds or records.
fn more(world: &mut World, pool: &mut Pool, entity: Entity, random: &mut Random) {
    let Pool { all, roots, .. } = pool;
    match random.below(8) {
        0..=2 => seams::act(world, all, roots, random),
        3 => crease(world, entity, random),
        4..=5 => rays::cast(world, all, entity, random),
        6 => rays::hold(world, all, entity, random),
        _ => bakes::begin(world, entity, random),
    }
}

/// Has a cloth crease at curvatures that it reaches as it falls or is pushed, or no longer.
fn crease(world: &mut World, entity: Entity, random: &mut Random) {
    let mut cloth = world.entity_mut(entity);
    if !cloth.contains::<Cloth>() || random.one_in(4) {
        cloth.remove::<ClothCreasing>();
        return;
    }
    // A grid with 0.1 m between its particles bends by at most 20/m.
    let creasing = ClothCreasing {
        yield_curvature: 0.01 + 5.0 * random.part() * random.part(),
        hardening: [0.0, 0.9 * random.part()][random.below(2)],
    };
    cloth.insert(creasing);
    if random.one_in(2) {
        let paper = ClothMaterial {
            bend_rigidity: 3.0e-4,
            ..default()
        };
        cloth.insert(paper);
    }
}

fn replace_mesh(world: &mut World, entity: Entity, random: &mut Random) {
    let Some(handle) = world.get::<Mesh3d>(entity).map(|mesh| mesh.0.clone()) else {
        return;
    };
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    match random.below(3) {
        0 => drop(meshes.remove(&handle)),
        1 => drop(meshes.insert(&handle, sheet_asset(4, 4))),
        _ => {
            let other = meshes.add(sheet_asset(6, 3));
            world.entity_mut(entity).insert(Mesh3d(other));
        }
    }
}
