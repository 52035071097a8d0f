//! The same app without a window, where a script slashes the banner and pulls at it: a report and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::{contact::intersections, prelude::*};
use serde::Serialize;

use crate::{
    scene::Sword,
    shared::{headless::Run, parts::report::Report},
};

/// When the sword slashes, and when a hand takes hold (s).
const SLASHED: f32 = 2.5;
const PULLED: f32 = 4.5;
/// Where the hand looks from, and at which point, and how fast it pulls (m/s).
const EYE: Vec3 = Vec3::new(-0.25, 1.9, 3.0);
const AIM: Vec3 = Vec3::new(-0.25, 1.75, 0.0);
const PULL: Vec3 = Vec3::new(-0.2, -0.6, 0.5);

/// The printed report.
#[derive(Serialize, Resource, Default, Clone)]
struct Own {
    /// Edges torn by the sword, and by load.
    cut: usize,
    torn: usize,
    pieces: usize,
    /// Mass of all parts now over that of the whole banner.
    mass: f32,
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
    report.print(&mut run, |Report { own, .. }| {
        println!("  cut              {} edges by the sword", own.cut);
        println!("  torn             {} edges by a hand that pulls", own.torn);
        println!(
            "  pieces           {}, which together have {:.4} of the mass",
            own.pieces, own.mass
        );
        println!(
            "  intersections    {} triangle pairs at most",
            own.intersections
        );
    })
}

/// Whether this time is passed in this tick.
fn is_now(time: &Time, seconds: f32) -> bool {
    let now = time.elapsed_secs();
    now >= seconds && now - time.delta_secs() < seconds
}

fn slash(time: Res<Time>, mut swords: Query<&mut Sword>) {
    if is_now(&time, SLASHED) {
        swords
            .iter_mut()
            .for_each(|mut sword| sword.slashing = Some(0.0));
    }
}

fn take_hold(time: Res<Time>, mut rays: ClothRayCast, mut commands: Commands) {
    if let Ok(direction) = Dir3::new(AIM - EYE)
        && is_now(&time, PULLED)
        && let Some(hit) = rays.cast(Ray3d::new(EYE, direction), f32::INFINITY)
    {
        commands.spawn(hit.grab());
    }
}

fn pull(time: Res<Time>, mut hands: Query<&mut ClothGrab>) {
    for mut hand in &mut hands {
        hand.target += PULL * time.delta_secs();
    }
}

fn measure(
    mut torn: MessageReader<ClothTorn>,
    swords: Query<&Sword>,
    cloths: Query<(&ClothBuilt, &ClothParticles)>,
    mut whole: Local<Option<f32>>,
    mut own: ResMut<Own>,
) {
    for torn in torn.read() {
        match swords.iter().any(|sword| sword.slashing.is_some()) {
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
