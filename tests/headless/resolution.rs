//! A grid whose resolution changes while it hangs or flies.

use bevy::prelude::*;
use bevy_drape::{plugin::ClothBuilt, prelude::*};

use crate::support::*;

/// Side of the cloth (m).
const SIDE: f32 = 1.2;

fn of_side(side: u32) -> Cloth {
    Cloth::new(side, side, SIDE / (side - 1) as f32)
}

fn in_world(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame: &ClothFrame = app.world().get(cloth).expect("a frame");
    let positions = particles(app, cloth).positions();
    positions.map(|at| frame.to_world(at)).collect()
}

/// How far a point is from the triangles of a surface of particles (m).
fn distance(point: Vec3, places: &[Vec3], triangles: &[[u32; 3]]) -> f32 {
    let to_edge = |[a, b]: [Vec3; 2]| {
        let part = (point - a).dot(b - a) / a.distance_squared(b);
        point.distance(a.lerp(b, part.clamp(0.0, 1.0)))
    };
    let to_triangle = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| places[corner as usize]);
        let normal = (b - a).cross(c - a).normalize();
        let height = (point - a).dot(normal);
        let foot = point - height * normal;
        let sides = [[a, b], [b, c], [c, a]];
        let is_inside = |[from, to]: [Vec3; 2]| (to - from).cross(foot - from).dot(normal) >= 0.0;
        if sides.into_iter().all(is_inside) {
            height.abs()
        } else {
            sides.map(to_edge).into_iter().fold(f32::MAX, f32::min)
        }
    };
    triangles.iter().map(to_triangle).fold(f32::MAX, f32::min)
}

/// A cloth at rest, pinned by its upper edge, attached by it, or hung by two corners, goes from 16² to 32² and to 9²: in the next
/// tick no particle is farther from where the surface was than a fold bulges between its particles, an eighth of the squared spacing
/// over a radius of 5 cm, and none is faster than a fall of two ticks makes it: folds of another resolution hang otherwise by a little.
#[test]
fn a_cloth_at_rest_stays_where_it_is() {
    for name in ["edge", "attached", "corners"] {
        let mut app = app();
        let damped = ClothMaterial {
            damping: 0.05,
            ..default()
        };
        let pole = app.world_mut().spawn(Transform::default()).id();
        let pins = match name {
            "edge" => Pins::new([Pin::Row(0)]),
            "attached" => Pins::none(),
            _ => Pins::new([Pin::Corner(Corner::TopLeft), Pin::Corner(Corner::TopRight)]),
        };
        let place = Transform::from_xyz(3.0, 1.0, -2.0).with_rotation(Quat::from_rotation_y(0.4));
        let cloth = app
            .world_mut()
            .spawn((of_side(16), damped, pins, place))
            .id();
        if name == "attached" {
            let attached = ClothAttachments::new([(Pin::Row(0), pole)]);
            app.world_mut().entity_mut(cloth).insert(attached);
        }
        tick(&mut app, 64 * 20);
        for side in [32, 9] {
            let before = in_world(&app, cloth);
            let built: &ClothBuilt = app.world().get(cloth).expect("built");
            let triangles = built.surface().triangles().to_vec();
            change::<Cloth>(&mut app, cloth, |cloth| cloth.shape = of_side(side).shape);
            tick(&mut app, 1);
            let after = in_world(&app, cloth);
            assert_eq!(after.len(), (side * side) as usize);
            let spacing = SIDE / (side.min(16) - 1) as f32;
            let bound = spacing * spacing / (8.0 * 0.05);
            let apart = after.iter().map(|at| distance(*at, &before, &triangles));
            let farthest = apart.fold(0.0, f32::max);
            let speed = particles(&app, cloth).largest_speed();
            println!(
                "{name}, {side}²: {:.2} mm off, {speed:.3} m/s",
                1e3 * farthest
            );
            assert!(farthest < bound, "{name}, {side}: {farthest} {bound}");
            assert!(speed < 2.0 * GRAVITY * TICK, "{name}, {side}: {speed} m/s");
            tick(&mut app, 64 * 20);
            assert!(particles(&app, cloth).largest_speed() < 0.01);
        }
    }
}

/// One that flies and turns keeps its momentum, to what a coarser sum over its surface leaves out: its velocities are those of a
/// turn, linear, so that their mean stays but for rounding. Its centre goes on.
#[test]
fn a_cloth_that_flies_goes_on() {
    let mut app = app();
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let undamped = ClothMaterial {
        damping: 0.0,
        ..default()
    };
    let cloth = (of_side(16), Pins::none(), undamped);
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    change::<ClothParticles>(&mut app, cloth, |particles| {
        for index in 0..particles.len() {
            let at = particles.position(index).expect("a particle");
            let velocity = Vec3::new(2.0, 1.0, 0.0) + Vec3::Y.cross(at) * 3.0;
            particles.set_velocity(index, velocity).expect("a particle");
        }
    });
    let mean = |app: &App, of: &dyn Fn(&ClothParticles, usize) -> Vec3| {
        let particles = particles(app, cloth);
        let mass = |index| 1.0 / particles.inverse_mass(index).expect("a particle");
        let all = 0..particles.len();
        let sum: Vec3 = all
            .clone()
            .map(|index| mass(index) * of(particles, index))
            .sum();
        sum / all.map(mass).sum::<f32>()
    };
    let velocity = |app: &App| mean(app, &|of, index| of.velocity(index).expect("a particle"));
    let centre = |app: &App| mean(app, &|of, index| of.position(index).expect("a particle"));
    tick(&mut app, 16);
    for side in [32, 9, 16] {
        let (was, from) = (velocity(&app), centre(&app));
        change::<Cloth>(&mut app, cloth, |cloth| cloth.shape = of_side(side).shape);
        tick(&mut app, 1);
        let (is, to) = (velocity(&app), centre(&app));
        assert!(
            is.distance(was) < 0.005 * was.length(),
            "{side}: {was} {is}"
        );
        assert!(
            to.distance(from + was * TICK) < 2.0e-3,
            "{side}: {from} {to}"
        );
    }
}

/// Another rectangle is another cloth, at rest; and so is another mesh.
#[test]
fn another_shape_begins_anew() {
    let mut app = app();
    let cloth = app.world_mut().spawn((of_side(16), Pins::none())).id();
    tick(&mut app, 64);
    assert!(particles(&app, cloth).largest_speed() > 5.0);
    let larger = Cloth::new(16, 16, 2.0 * SIDE / 15.0);
    change::<Cloth>(&mut app, cloth, |cloth| cloth.shape = larger.shape);
    tick(&mut app, 1);
    assert!(particles(&app, cloth).largest_speed() < 1.0);
}
