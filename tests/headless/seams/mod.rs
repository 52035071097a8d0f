//! Cloths that are sewn together.

mod close;
mod copies;
mod hang;
mod life;

use bevy::{
    ecs::{entity_disabling::Disabled, world::EntityWorldMut},
    prelude::*,
};
use bevy_drape::{plugin::ClothBuilt, prelude::*};

use crate::{
    meshes::sheets::{add, asset},
    shared_meshes::irregular,
    support::*,
};

/// The particles of a cloth in the world (m).
pub fn places(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let all = particles(app, cloth).positions();
    all.map(|place| frame.to_world(place)).collect()
}

/// A row of a grid in the world (m).
fn row(app: &App, cloth: Entity, row: usize) -> Vec<Vec3> {
    let columns = particles(app, cloth).columns() as usize;
    places(app, cloth)[row * columns..(row + 1) * columns].to_vec()
}

/// A column of a grid in the world (m).
fn column(app: &App, cloth: Entity, column: usize) -> Vec<Vec3> {
    let columns = particles(app, cloth).columns() as usize;
    let all = places(app, cloth);
    all.into_iter().skip(column).step_by(columns).collect()
}

/// A point of a line of evenly spaced particles.
fn along(line: &[Vec3], at: f32) -> Vec3 {
    let place = at * (line.len() - 1) as f32;
    let first = (place as usize).min(line.len() - 2);
    line[first].lerp(line[first + 1], place - first as f32)
}

/// The largest distance of the finer line's particles from the other line (m).
fn gap(a: &[Vec3], b: &[Vec3]) -> f32 {
    let (fine, coarse) = if a.len() >= b.len() { (a, b) } else { (b, a) };
    let last = (fine.len() - 1) as f32;
    let each = fine.iter().enumerate();
    let gaps = each.map(|(index, place)| along(coarse, index as f32 / last).distance(*place));
    gaps.fold(0.0, f32::max)
}

/// The particles of a line of a cloth whose places at rest are `among`: where each is along `axis` at rest, as a fraction of
/// the line, and where it is in the world (m). Sorted by the former.
pub fn line(
    app: &App,
    cloth: Entity,
    among: impl Fn(Vec3) -> bool,
    axis: Vec3,
) -> Vec<(f32, Vec3)> {
    let built = app.world().get::<ClothBuilt>(cloth).expect("it is built");
    let rest = built.surface().rest_positions().iter();
    let each = rest.zip(places(app, cloth));
    let named = each.filter(|(rest, _)| among(**rest));
    let mut line: Vec<(f32, Vec3)> = named.map(|(rest, place)| (rest.dot(axis), place)).collect();
    line.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (line[0].0, line[line.len() - 1].0);
    for (at, _) in &mut line {
        *at = (*at - first) / (last - first);
    }
    line
}

/// The largest distance of the finer line's particles from the points of the other that they are sewn to (m).
pub fn apart(first: &[(f32, Vec3)], second: &[(f32, Vec3)]) -> f32 {
    let (fine, coarse) = match second.len() > first.len() {
        true => (second, first),
        false => (first, second),
    };
    let off = |(at, place): &(f32, Vec3)| {
        let next = coarse.partition_point(|(own, _)| own < at);
        let next = next.clamp(1, coarse.len() - 1);
        let ((from, a), (to, b)) = (coarse[next - 1], coarse[next]);
        a.lerp(b, (at - from) / (to - from)).distance(*place)
    };
    fine.iter().map(off).fold(0.0, f32::max)
}

fn sew(app: &mut App, seam: ClothSeam) -> Entity {
    app.world_mut().spawn(seam).id()
}

/// The momentum of some cloths in the world (kg m/s), and their kinetic energy (J).
fn motion(app: &App, cloths: &[Entity]) -> (Vec3, f32) {
    let mut sum = (Vec3::ZERO, 0.0);
    for &cloth in cloths {
        let all = particles(app, cloth);
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        for index in 0..all.len() {
            let mass = 1.0 / all.inverse_mass(index).expect("it exists");
            if mass.is_finite() {
                let velocity = all.velocity(index).expect("it exists");
                sum.0 += mass * (frame.isometry().rotation * velocity);
                sum.1 += 0.5 * mass * velocity.length_squared();
            }
        }
    }
    sum
}

/// What gravity moves in a sub-step, of the fewest that a tick has (m): what the springs of one cloth do not know yet of the
/// other.
const IN_A_SUBSTEP: f32 = GRAVITY * (TICK / 4.0) * (TICK / 4.0);

/// The fall by gravity in a sub-step of the last tick (m). The cloth was awake in it.
fn fall_in_a_substep(app: &App, cloth: Entity) -> f32 {
    let substeps = stats(app, cloth).substeps;
    assert!(substeps > 0);
    let dt = TICK / substeps as f32;
    GRAVITY * dt * dt
}

fn is_top(rest: Vec3) -> bool {
    rest.y > -1.0e-3
}

fn is_bottom(rest: Vec3, height: f32) -> bool {
    rest.y < 1.0e-3 - height
}
