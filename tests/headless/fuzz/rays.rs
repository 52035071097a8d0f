//! Rays at cloths, and hands that hold them.

use bevy::{ecs::system::RunSystemOnce, prelude::*};
use bevy_drape::prelude::*;

use super::{look::place_of, random::Random};

/// Hands that there are, at most.
const MOST: usize = 3;

/// Casts a ray at a cloth or anywhere, and may take hold where it hits.
pub fn cast(world: &mut World, all: &mut Vec<Entity>, cloth: Entity, random: &mut Random) {
    let from = random.place();
    let to = match place_of(world, cloth, random) {
        Some(at) if !random.one_in(4) => at,
        _ => random.place(),
    };
    // Bevy has no direction that is not finite or has no length.
    let Ok(direction) = Dir3::new(to - from) else {
        return;
    };
    let origin = match random.below(6) {
        0 => random.vector(),
        1 => to,
        _ => from,
    };
    let farthest = match random.one_in(3) {
        true => random.number(),
        false => f32::INFINITY,
    };
    let (ray, is_alone) = (Ray3d::new(origin, direction), random.one_in(4));
    let cast = move |mut rays: ClothRayCast| {
        rays.cast_where(ray, farthest, |other| !is_alone || other == cloth)
    };
    let hit = world
        .run_system_once(cast)
        .expect("it borrows cloths alone");
    let Some(hit) = hit else {
        return;
    };
    assert!(!is_alone || hit.cloth == cloth, "{hit:?}");
    check(world, &hit, farthest);
    // A ray may hit the control cloth, which nobody takes hold of.
    let may_hold = all.contains(&hit.cloth) && hands(world, all).len() < MOST;
    if may_hold && random.one_in(3) {
        all.push(world.spawn(hit.grab()).id());
    }
}

/// Fails for a hit that is too far away, or that names a face or a particle that is not there.
fn check(world: &World, hit: &ClothHit, farthest: f32) {
    let built = world.get::<ClothBuilt>(hit.cloth);
    let particles = world.get::<ClothParticles>(hit.cloth);
    let (Some(built), Some(particles)) = (built, particles) else {
        panic!("{hit:?} is of no cloth");
    };
    let surface = built.surface();
    let face = match surface.rope_radius() {
        Some(_) => {
            let first = hit.face as u32;
            Some([first, first + 1, first + 1])
        }
        None => surface.triangles().get(hit.face).copied(),
    };
    let is_there = |corner: &u32| particles.position(*corner as usize).is_some();
    let is_part = |weight: &f32| (0.0..=1.0).contains(weight);
    assert!(
        face == Some(hit.particles)
            && hit.particles.iter().all(is_there)
            && hit.particles.contains(&hit.particle)
            && hit.weights.iter().all(is_part)
            && (0.0..=farthest).contains(&hit.distance),
        "{hit:?}, at most {farthest} m away"
    );
}

fn hands(world: &World, all: &[Entity]) -> Vec<Entity> {
    let is_hand = |entity: &Entity| world.get::<ClothGrab>(*entity).is_some();
    all.iter().copied().filter(is_hand).collect()
}

/// Takes hold of a cloth from any distance, moves a hand, or lets go.
pub fn hold(world: &mut World, all: &mut Vec<Entity>, cloth: Entity, random: &mut Random) {
    let hands = hands(world, all);
    match random.pick(&hands).copied() {
        Some(hand) if hands.len() >= MOST || random.one_in(2) => move_hand(world, hand, random),
        _ => all.extend(take(world, cloth, random)),
    }
}

/// A new hand, at one of the cloth's particles or away from it.
fn take(world: &mut World, cloth: Entity, random: &mut Random) -> Option<Entity> {
    let count = world.get::<ClothParticles>(cloth)?.len();
    let at = place_of(world, cloth, random)?;
    let away = match random.one_in(2) {
        true => random.vector(),
        false => 0.1 * random.place(),
    };
    let grab = ClothGrab {
        cloth,
        particle: random.below(count) as u32,
        target: at + away,
        ..default()
    };
    Some(world.spawn(grab).id())
}

fn move_hand(world: &mut World, hand: Entity, random: &mut Random) {
    match random.below(5) {
        0 => {
            world.entity_mut(hand).remove::<ClothGrab>();
        }
        1 => {
            world.despawn(hand);
        }
        _ => {
            if let Some(mut grab) = world.get_mut::<ClothGrab>(hand) {
                grab.target = random.place();
                grab.stretch = random.part();
                grab.speed = 10.0 * random.part();
            }
        }
    }
}
