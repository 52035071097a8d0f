//! The same app without a window, where a script slashes the banner and tears off what still hangs: a report and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::{contact::intersections, prelude::*};
use examples_shared::{
    headless::Run,
    measured::TickTime,
    report::{Report, is_now},
};
use serde::Serialize;

use crate::scene::Sword;

/// When the sword slashes, when a hand pulls at the lower corner, and when it lets go (s).
const SLASHED: f32 = 2.5;
const PULLED: f32 = 3.5;
const LET_GO: f32 = 7.0;
/// How fast it pulls, towards where (m/s).
const PULL: Vec3 = Vec3::new(0.15, -0.25, 0.2);

/// The printed report.
#[derive(Serialize, Resource, Default, Clone)]
struct Own {
    /// Edges torn by the sword, and by load.
    cut: usize,
    torn: usize,
    pieces: usize,
    /// Mass of all parts now over that of the whole banner.
    mass: f32,
    /// The longest tick in which something tore, and the longest of the others (ms).
    tearing_ms: f64,
    whole_ms: f64,
    /// The most triangle pairs that intersected in any tick, by brute force.
    intersections: usize,
}

/// Simulates, prints the report, and saves `tear.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Own>()
        .add_systems(
            FixedUpdate,
            (slash, take_hold, pull)
                .chain()
                .before(ClothSystems::Prepare),
        )
        .add_systems(FixedLast, measure);
    let report = Report {
        title: "A banner and a sword",
        picture: Some(run.picture()),
        figures: run.finish(),
        own: run.app.world().resource::<Own>().clone(),
    };
    let code = report.print(&mut run, |Report { own, .. }| {
        println!("  cut              {} edges by the sword", own.cut);
        println!("  torn             {} edges by its load", own.torn);
        println!(
            "  ticks            {:.1} ms at most; {:.1} ms where it tears",
            own.whole_ms, own.tearing_ms
        );
        println!(
            "  pieces           {}, which together have {:.4} of the mass",
            own.pieces, own.mass
        );
        println!(
            "  intersections    {} triangle pairs at most",
            own.intersections
        );
    });
    let own = &report.own;
    let expected = [
        (own.cut > 0, "the sword cuts the banner"),
        (own.torn > 0, "what hangs on is torn off by its load"),
        (own.pieces > 1, "there are two pieces"),
        ((own.mass - 1.0).abs() < 1.0e-4, "no mass is lost"),
        (own.intersections == 0, "nothing passes through itself"),
    ];
    report.check(code, LET_GO, &expected)
}

fn slash(time: Res<Time>, mut swords: Query<&mut Sword>) {
    if is_now(&time, SLASHED) {
        swords
            .iter_mut()
            .for_each(|mut sword| sword.slashing = Some(0.0));
    }
}

/// A hand takes the lower right corner.
fn take_hold(
    time: Res<Time>,
    cloths: Query<(Entity, &ClothParticles, &ClothFrame, &Cloth)>,
    mut commands: Commands,
) {
    if !is_now(&time, PULLED) {
        return;
    }
    for (cloth, particles, frame, made) in &cloths {
        let ClothShape::Grid(grid) = &made.shape else {
            continue;
        };
        // Those of the whole banner keep their indices when it is cut.
        let particle = grid.columns * grid.rows - 1;
        let Some(place) = particles.position(particle as usize) else {
            continue;
        };
        let target = frame.to_world(place);
        let hand = ClothGrab {
            cloth,
            particle,
            target,
            ..default()
        };
        commands.spawn((hand, Transform::from_translation(target)));
    }
}

fn pull(time: Res<Time>, mut hands: Query<(Entity, &mut ClothGrab)>, mut commands: Commands) {
    for (entity, mut hand) in &mut hands {
        hand.target += PULL * time.delta_secs();
        if is_now(&time, LET_GO) {
            commands.entity(entity).despawn();
        }
    }
}

fn measure(
    tick: Res<TickTime>,
    mut torn: MessageReader<ClothTorn>,
    time: Res<Time>,
    cloths: Query<(&ClothBuilt, &ClothParticles)>,
    mut whole: Local<Option<f32>>,
    mut own: ResMut<Own>,
) {
    // The first ones build the cloth.
    let is_later = whole.is_some();
    match torn.is_empty() {
        true if is_later => own.whole_ms = own.whole_ms.max(tick.ms),
        true => {}
        false => own.tearing_ms = own.tearing_ms.max(tick.ms),
    }
    for torn in torn.read() {
        match time.elapsed_secs() < SLASHED + 0.5 {
            true => own.cut += torn.edges,
            false => own.torn += torn.edges,
        }
        own.pieces = torn.pieces;
    }
    for (built, particles) in &cloths {
        let masses = particles.inverse_masses().filter(|w| *w > 0.0);
        let mass: f32 = masses.map(|w| 1.0 / w).sum();
        own.mass = mass / *whole.get_or_insert(mass);
        let found = intersections(&[(built.surface(), particles.positions().collect())]);
        own.intersections = own.intersections.max(found);
    }
}
