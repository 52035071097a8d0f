//! The cost of a ray.

use std::{hint::black_box, time::Duration};

use bevy::{ecs::system::SystemState, prelude::*, time::TimeUpdateStrategy};
use bevy_drape::{plugin::ClothBuilt, prelude::*};

use super::{TURNS, median, seconds};

/// Rays that are cast in turn.
const RAYS: u32 = 64;

/// A ray at a sheet that hangs by two corners, against a test of all of its faces.
pub fn rays() {
    println!("\na ray at a sheet that hangs by two corners (µs)\n");
    println!(
        "{:>6} {:>10} {:>10} {:>12} {:>10}",
        "size", "from ahead", "along it", "every face", "hits"
    );
    for side in [16, 32, 64, 128, 256] {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
                1.0 / 64.0,
            )));
        let pins = Pins::new([Pin::Corner(Corner::TopLeft), Pin::Corner(Corner::TopRight)]);
        let cloth = Cloth::new(side, side, 2.0 / (side - 1) as f32).centred();
        let cloth = app.world_mut().spawn((cloth, pins)).id();
        (0..48).for_each(|_| app.update());
        let spread = |number: u32| {
            // As in a sunflower, over the inner part of the sheet.
            let (angle, radius) = (2.4 * number as f32, (number as f32 / RAYS as f32).sqrt());
            0.7 * radius * Vec2::from_angle(angle)
        };
        let ahead = |number| Ray3d::new(spread(number).extend(2.0), Dir3::NEG_Z);
        let along = |number| {
            let height = spread(number).y;
            let direction = Dir3::new(Vec3::new(-1.0, 0.0, -0.05)).expect("a length");
            Ray3d::new(Vec3::new(3.0, height, 0.1), direction)
        };
        let (built, particles) = (
            app.world().get::<ClothBuilt>(cloth).expect("it is built"),
            app.world()
                .get::<ClothParticles>(cloth)
                .expect("they exist"),
        );
        let places: Vec<Vec3> = particles.positions().collect();
        let faces = built.surface().triangles().to_vec();
        let mut state = SystemState::<ClothRayCast>::new(app.world_mut());
        let mut rays = state.get_mut(app.world_mut()).expect("it reads alone");
        let mut found = [const { Vec::new() }; 3];
        let mut hits = 0;
        for _ in 0..TURNS {
            for (times, ray) in found
                .iter_mut()
                .zip([&ahead as &dyn Fn(u32) -> Ray3d, &along])
            {
                let mut number = 0;
                times.push(seconds(2.0e-4, || {
                    number = (number + 1) % RAYS;
                    rays.cast(black_box(ray(number)), 100.0)
                }));
            }
            let mut number = 0;
            found[2].push(seconds(2.0e-4, || {
                number = (number + 1) % RAYS;
                let ray = black_box(ahead(number));
                let hits = faces
                    .iter()
                    .filter_map(|face| distance(ray, face.map(|corner| places[corner as usize])));
                hits.min_by(f32::total_cmp)
            }));
            hits = (0..RAYS)
                .filter(|&number| rays.cast(ahead(number), 100.0).is_some())
                .count();
        }
        let [ahead, along, every] = found.map(|mut times| 1.0e6 * median(&mut times));
        println!(
            "{:>6} {ahead:>10.2} {along:>10.2} {every:>12.1} {hits:>10}",
            format!("{side}²")
        );
    }
}

/// Along a ray to a triangle, if it hits it (m): Möller and Trumbore (1997).
fn distance(ray: Ray3d, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let across = ray.direction.cross(ac);
    let inverse = ab.dot(across).recip();
    let offset = ray.origin - a;
    let u = offset.dot(across) * inverse;
    let v = ray.direction.dot(offset.cross(ab)) * inverse;
    let is_hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    is_hit.then(|| ac.dot(offset.cross(ab)) * inverse)
}
