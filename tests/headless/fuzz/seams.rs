//! Seams between cloths, and mischief with the cloths that they join.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::{look::surface_of, random::Random};

/// Seams that there are, at most: cloths that are sewn together take the same number of sub-steps.
const MOST: usize = 3;

/// Single particles of a side, at most.
const LONGEST: usize = 12;

/// Sews two of the cloths, or does something to a seam or to one of its cloths.
pub fn act(world: &mut World, all: &mut Vec<Entity>, roots: &[Entity], random: &mut Random) {
    let is_seam = |entity: &Entity| world.get::<ClothSeam>(*entity).is_some();
    let seams: Vec<Entity> = all.iter().copied().filter(is_seam).collect();
    match random.pick(&seams).copied() {
        Some(seam) if seams.len() >= MOST || random.one_in(2) => change(world, roots, seam, random),
        _ => {
            let seam = sew(world, all, random);
            all.extend(seam);
        }
    }
}

/// Sews two cloths, or one to itself, by particles that exist and with valid numbers.
fn sew(world: &mut World, all: &[Entity], random: &mut Random) -> Option<Entity> {
    let cloths: Vec<(Entity, Arc<Surface>)> = all
        .iter()
        .filter_map(|&cloth| Some((cloth, surface_of(world, cloth)?)))
        .collect();
    let mut side = || {
        let (cloth, surface) = random.pick(&cloths)?;
        Some(ClothSeamSide::new(*cloth, pins(surface, random)))
    };
    let seam = ClothSeam::new(side()?, side()?).closing_in(random.part());
    let seam = ClothSeam {
        compliance: [0.0, 1.0e-5, 1.0e-2, 10.0][random.below(4)],
        ..seam
    };
    Some(world.spawn(seam).id())
}

/// Some particles of a surface: a line of it, a region, or a list in any order.
fn pins(surface: &Surface, random: &mut Random) -> Vec<Pin> {
    let (count, long) = (surface.len(), 1 + random.below(LONGEST));
    let first = random.below(count);
    let grid = surface
        .as_grid()
        .map(|grid| [grid.rows(), grid.columns()].map(|count| count as usize));
    match (random.below(8), grid) {
        (0, Some([rows, _])) => vec![Pin::Row(random.below(rows) as u32)],
        (1, Some([_, columns])) => vec![Pin::Column(random.below(columns) as u32)],
        (2, _) => vec![Pin::Near {
            point: surface.rest_positions()[first],
            radius: 0.25,
        }],
        (3, _) => (0..long).map(|_| Pin::Index(random.below(count))).collect(),
        _ => {
            let step = 1 + random.below(3);
            let line = (0..long).map(|index| (first + index * step) % count);
            line.map(Pin::Index).collect()
        }
    }
}

/// Opens or closes a seam, undoes it, or disturbs one of its cloths.
fn change(world: &mut World, roots: &[Entity], seam: Entity, random: &mut Random) {
    let Some(mut of) = world.get_mut::<ClothSeam>(seam) else {
        return;
    };
    let side = match random.one_in(2) {
        true => &of.first,
        false => &of.second,
    };
    let ClothTarget::Entity(cloth) = side.cloth else {
        return;
    };
    let [from, to] = [random.part(), random.part()];
    match random.below(10) {
        // A zip, which opens from either end or from both.
        0 => of.sewn = [from, 1.0],
        1 => of.sewn = [0.0, to],
        2 => of.sewn = [from, to],
        // Heals it.
        3..=4 => {
            (of.sewn, of.seconds) = ([0.0, 1.0], from);
            of.compliance = 1.0e-3 * to;
        }
        5 => {
            world.despawn(seam);
        }
        _ => disturb(world, roots, cloth, random),
    }
}

/// Takes a sewn cloth away, or has it sleep, hang elsewhere, be of another size, or freeze.
fn disturb(world: &mut World, roots: &[Entity], cloth: Entity, random: &mut Random) {
    let Ok(mut cloth) = world.get_entity_mut(cloth) else {
        return;
    };
    match random.below(5) {
        0 => cloth.despawn(),
        1 => {
            // Pinned all over it rests, and the more gravity, the sooner it sleeps: after half a second.
            let pins = Pins::new([Pin::at_rest(|_| true)]);
            let settings = ClothSettings {
                gravity: Some(100.0 * Vec3::NEG_Y),
                ..default()
            };
            cloth.insert((pins, settings));
        }
        2 => {
            if let Some(&root) = random.pick(roots) {
                cloth.insert(ChildOf(root));
            }
        }
        3 => {
            let turned = Transform::from_rotation(Quat::from_rotation_z(6.0 * random.part()));
            let scaled = turned.with_scale(Vec3::splat(0.5 + random.part()));
            cloth.remove::<ChildOf>().insert(scaled);
        }
        _ => {
            cloth.insert(ClothLod::at(ClothLodLevel::Frozen));
        }
    }
}
