//! The same app without a window, where a script takes a peg off and pulls at the sheet: a report and a picture.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::{contact::intersections, prelude::*};
use examples_shared::{
    headless::Run,
    report::{Report, is_now},
};
use serde::Serialize;

use crate::scene::{self, Peg};

/// When a peg of the bath towel comes off, when a hand takes the sheet, and when it lets go (s).
const TAKEN_OFF: f32 = 2.0;
const PULLED: f32 = 3.0;
const LET_GO: f32 = 5.0;
/// Where the hand looks from, and at which point: low on the sheet.
const EYE: Vec3 = Vec3::new(0.6, 1.2, 3.0);
const AIM: Vec3 = Vec3::new(0.25, 0.95, 0.0);
/// How fast it pulls, towards where (m/s).
const PULL: Vec3 = Vec3::new(0.5, 0.4, 1.0);

/// The printed report.
#[derive(Serialize, Resource, Default, Clone)]
struct Own {
    pegs_off: usize,
    /// How far the hand was from the sheet's point as it took hold, how far it moved, and how far its target did (m).
    grabbed_at_m: f32,
    pulled_m: f32,
    wanted_m: f32,
    /// The most that the sheet was stretched while it was pulled (%).
    stretch_percent: f32,
    /// The most triangle pairs that intersected in any tick, by brute force.
    intersections: usize,
}

/// Simulates, prints the report, and saves `laundry.png`.
pub fn report(mut run: Run) -> ExitCode {
    run.app
        .init_resource::<Own>()
        .add_systems(
            FixedUpdate,
            (take_off_a_peg, take_hold, pull, let_go)
                .chain()
                .before(ClothSystems::Prepare),
        )
        .add_systems(FixedLast, measure);
    let report = Report {
        title: "Laundry on a line",
        picture: Some(run.picture()),
        figures: run.finish(),
        own: run.app.world().resource::<Own>().clone(),
    };
    let code = report.print(&mut run, |Report { own, .. }| {
        println!("  pegs taken off   {}", own.pegs_off);
        println!(
            "  hand             took hold {:.2} m away; pulled {:.2} of {:.2} m: the sheet is taut; stretched by {:.1} % at most",
            own.grabbed_at_m, own.pulled_m, own.wanted_m, own.stretch_percent
        );
        println!("  intersections    {} triangle pairs at most", own.intersections);
    });
    let own = &report.own;
    let expected = [
        (own.pegs_off == 1, "a peg is taken off"),
        (own.pulled_m > 0.5, "the hand pulls at the sheet"),
        (
            own.stretch_percent < 15.0,
            "the sheet stays within the limit of stretch",
        ),
        (own.intersections == 0, "no cloth passes through itself"),
    ];
    report.check(code, LET_GO, &expected)
}

fn take_off_a_peg(
    time: Res<Time>,
    names: Query<(Entity, &Name), With<Cloth>>,
    pegs: Query<&Peg>,
    of_cloth: Query<(Entity, &Peg)>,
    mut cloths: Query<&mut ClothAttachments>,
    mut own: ResMut<Own>,
    mut commands: Commands,
) {
    if !is_now(&time, TAKEN_OFF) {
        return;
    }
    let towel = names.iter().find(|(_, name)| name.as_str() == "bath towel");
    let peg = towel.and_then(|(towel, _)| of_cloth.iter().find(|(_, peg)| peg.cloth == towel));
    if let Some((peg, _)) = peg {
        scene::take_off(peg, &pegs, &mut cloths, &mut commands);
        own.pegs_off += 1;
    }
}

fn take_hold(
    time: Res<Time>,
    mut rays: ClothRayCast,
    mut own: ResMut<Own>,
    mut commands: Commands,
) {
    if !is_now(&time, PULLED) {
        return;
    }
    let Ok(direction) = Dir3::new(AIM - EYE) else {
        return;
    };
    if let Some(hit) = rays.cast(Ray3d::new(EYE, direction), f32::INFINITY) {
        own.grabbed_at_m = hit.distance;
        commands.spawn((hit.grab(), Start(hit.point)));
    }
}

/// Where a hand took hold.
#[derive(Component)]
struct Start(Vec3);

fn pull(
    time: Res<Time>,
    mut hands: Query<(&mut ClothGrab, &Start, &Transform)>,
    stats: Query<&ClothStats>,
    mut own: ResMut<Own>,
) {
    for (mut hand, start, place) in &mut hands {
        hand.target += PULL * time.delta_secs();
        own.wanted_m = hand.target.distance(start.0);
        // The hand of the first tick is not placed yet.
        if own.wanted_m > 0.1 {
            own.pulled_m = place.translation.distance(start.0);
        }
        if let Ok(stats) = stats.get(hand.cloth) {
            let stretch = 100.0 * stats.stretch.structural;
            own.stretch_percent = own.stretch_percent.max(stretch);
        }
    }
}

fn let_go(time: Res<Time>, hands: Query<Entity, With<ClothGrab>>, mut commands: Commands) {
    if is_now(&time, LET_GO) {
        hands
            .iter()
            .for_each(|hand| commands.entity(hand).despawn());
    }
}

fn measure(cloths: Query<(&ClothBuilt, &ClothParticles)>, mut own: ResMut<Own>) {
    for (built, particles) in &cloths {
        let found = intersections(&[(built.surface(), particles.positions().collect())]);
        own.intersections = own.intersections.max(found);
    }
}
