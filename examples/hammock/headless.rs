//! The same app without a window, as fast as possible: a report and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::Velocity;
use examples_shared::{headless::Run, report::Report};
use serde::Serialize;

use crate::scene::{self, Ball};

/// The printed report.
#[derive(Serialize)]
struct Own {
    ball_kg: f32,
    cloth_kg: f64,
    /// How high the ball got again after it first fell into the hammock (m).
    bounce_m: f32,
    /// Where the ball is at last (m), and how far it moved and how fast it was in the last second (mm, mm/s).
    height_m: f32,
    last_moves_mm: f32,
    last_speed_mm_s: f32,
}

/// Where the ball was after each tick (m), and how fast (m/s).
#[derive(Resource, Default)]
struct Way {
    places: Vec<Vec3>,
    speeds: Vec<f32>,
}

/// Simulates, prints the report, and saves `hammock.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Way>()
        .add_systems(FixedLast, follow);
    let report = Report {
        title: "A ball in a hammock",
        picture: Some(run.picture()),
        own: own(&mut run),
        figures: run.finish(),
    };
    report.print(&mut run, |Report { own, .. }| {
        println!(
            "  masses           ball {} kg, cloth {:.2} kg",
            own.ball_kg, own.cloth_kg
        );
        println!("  bounce           {:.2} m", own.bounce_m);
        println!(
            "  at the end       {:.3} m high; in the last second moved {:.2} mm, at most {:.1} mm/s",
            own.height_m, own.last_moves_mm, own.last_speed_mm_s
        );
    })
}

fn own(run: &mut Run) -> Own {
    let second = run.ticks_in(1.0) as usize;
    let world = run.app.world_mut();
    let mut cloths = world.query::<&ClothParticles>();
    let masses = cloths.iter(world).flat_map(ClothParticles::inverse_masses);
    let cloth_kg = masses
        .filter(|w| *w > 0.0)
        .map(|w| 1.0 / f64::from(w))
        .sum();
    let way = world.resource::<Way>();
    let heights: Vec<f32> = way.places.iter().map(|place| place.y).collect();
    // The first time that it goes up again, and how high it gets from there.
    let turn = heights.windows(2).position(|pair| pair[1] > pair[0]);
    let after = turn.map_or(&[][..], |turn| &heights[turn..]);
    let lowest = after.first().copied().unwrap_or(f32::NAN);
    let highest = after.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let last = way.places.len().saturating_sub(second);
    let places = || way.places[last..].iter().copied();
    let low = places().fold(Vec3::MAX, Vec3::min);
    let high = places().fold(Vec3::MIN, Vec3::max);
    Own {
        ball_kg: scene::MASS,
        cloth_kg,
        bounce_m: highest - lowest,
        height_m: heights.last().copied().unwrap_or(f32::NAN),
        last_moves_mm: 1.0e3 * high.distance(low),
        last_speed_mm_s: 1.0e3 * way.speeds[last..].iter().copied().fold(0.0, f32::max),
    }
}

fn follow(balls: Query<(&Transform, &Velocity), With<Ball>>, mut way: ResMut<Way>) {
    for (transform, velocity) in &balls {
        way.places.push(transform.translation);
        way.speeds.push(velocity.linear.length());
    }
}
