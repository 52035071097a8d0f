//! Garbage for every component, at any time: nothing panics or hangs, what has no fault is finite, and what nobody touches is as it is without.
//!
//! Seconds long, in CI minutes. `BEVY_DRAPE_FUZZ=500 cargo test --test headless fuzz` does five hundred runs of 400 ticks, and prints what it has counted;
//! `BEVY_DRAPE_SEED=7` begins with another seed.

mod acts;
mod bakes;
mod look;
mod mutate;
pub mod random;
mod rays;
mod seams;
mod tears;

use std::{f32::consts::FRAC_PI_2, time::Instant};

use bevy::{ecs::entity::EntityHashSet, prelude::*, time::TimeUpdateStrategy};
use bevy_drape::prelude::*;

use self::{
    acts::{Pool, act},
    mutate::OTHERS,
    random::Random,
    tears::UnderLoad,
};
use crate::support::*;

/// Runs, and ticks of each: by default, when they are to take seconds, and where tests run at their full length.
const RUNS: [u64; 2] = [2, 30];
const TICKS: [usize; 2] = [100, 400];

/// Farther than this nothing without a fault may be from its frame (m), as `ClothParticles::validate` has it.
const FARTHEST: f32 = 1.0e18;

fn told(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

/// Where the control cloth is: far from all acts.
const CONTROL: Vec3 = Vec3::new(0.0, 3000.0, 0.0);

/// An app with a cloth, and a ball that swings below it, to be compared.
fn app_with_control() -> (App, Entity) {
    let mut app = app_that_draws(FixedUpdate);
    let place = Transform::from_translation(CONTROL);
    // Half-spaces and what is huge reach it too.
    let layers = ClothLayers::new(!OTHERS, !OTHERS);
    let cloth = (Cloth::new(8, 8, 0.1).lying(), layers, place);
    let cloth = app.world_mut().spawn(cloth).id();
    let ball = Transform::from_translation(CONTROL + Vec3::new(0.35, -0.3, 0.35));
    app.world_mut()
        .spawn((ClothCollider::ball(0.2), layers, ball));
    (app, cloth)
}

/// The time, gravity and air of a tick, the same in both apps.
fn set_world(app: &mut App, random: &mut Random) {
    match random.below(60) {
        0 => {
            let seconds = [
                1.0e-6,
                1.0e-3,
                1.0 / 240.0,
                1.0 / 64.0,
                1.0 / 10.0,
                1.0,
                10.0,
            ];
            let seconds = seconds[random.below(seconds.len())];
            let mut time = app.world_mut().resource_mut::<Time<Fixed>>();
            time.set_timestep_seconds(seconds);
            // One tick an update, however long it is.
            let (step, left) = (time.timestep(), time.overstep());
            time.discard_overstep(left);
            app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
            let mut time = app.world_mut().resource_mut::<Time<Virtual>>();
            time.set_max_delta(2 * step);
        }
        1 => app.world_mut().resource_mut::<Time<Virtual>>().pause(),
        2..=6 => app.world_mut().resource_mut::<Time<Virtual>>().unpause(),
        7 => drop(app.insert_resource(ClothGravity(random.vector()))),
        8..=17 => drop(
            app.init_resource::<ClothGravity>()
                .insert_resource(ClothGravity::default()),
        ),
        18 => {
            let wind = ClothWind {
                velocity: random.vector(),
                gusts: random.number(),
                turbulence: random.number(),
                turbulence_length: random.number(),
                ..default()
            };
            app.insert_resource(wind);
        }
        19..=22 => drop(app.world_mut().remove_resource::<ClothWind>()),
        _ => {}
    }
}

/// A place or figure that is not finite, of a cloth that has no fault and was looked at in the last tick: one of those that were
/// `there` as it began. Acts between the systems may enable one that no system has seen, and may write particles of one that
/// sleeps: the next tick looks at both.
fn wrong(app: &mut App, there: &EntityHashSet) -> Option<String> {
    let mut cloths = app.world_mut().query_filtered::<(
        Entity,
        &ClothParticles,
        &ClothContacts,
        &ClothStats,
    ), Without<ClothFault>>();
    for (entity, particles, contacts, stats) in cloths.iter(app.world()) {
        // What waits for an asset or a skeleton is not moved, and is looked at when it is.
        let is_written = app.world().resource::<Pool>().written.contains(&entity);
        let is_moved = stats.substeps > 0 || stats.is_asleep && !is_written;
        if stats.level != ClothLodLevel::Full || !is_moved || !there.contains(&entity) {
            continue;
        }
        for (index, place) in particles.positions().enumerate() {
            let speed = particles.velocity(index).expect("it exists");
            if !(place.length() < FARTHEST && speed.is_finite()) {
                return Some(format!(
                    "{entity}: particle {index} at {place}, {speed} m/s, asleep: {}",
                    stats.is_asleep
                ));
            }
        }
        for contact in contacts.iter() {
            let figures = [contact.deepest_penetration, contact.area, contact.volume];
            let given = [contact.impulse, contact.angular_impulse];
            if !(figures.iter().all(|f| f.is_finite()) && given.iter().all(|f| f.is_finite())) {
                return Some(format!("{entity}: {contact:?}"));
            }
        }
        let is_finite = stats.air_impulse.is_finite() && stats.gauge_pressure.is_finite();
        if !is_finite {
            return Some(format!("{entity}: {stats:?}"));
        }
    }
    None
}

/// Whether a zone of wind may be so large by now that it reaches the control cloth, or gravity has thrown that to where zones are.
fn may_blow(app: &mut App, control: Entity) -> bool {
    let is_near = |at: Vec3| at.length() < CONTROL.length() / 4.0;
    let is_thrown = !particles(app, control).positions().all(is_near);
    let mut zones = app
        .world_mut()
        .query::<(&ClothWindZone, Option<&GlobalTransform>)>();
    zones.iter(app.world()).any(|(zone, place)| {
        if is_thrown {
            return true;
        }
        let length = match zone.shape {
            ClothWindShape::Ball { radius } => radius,
            ClothWindShape::Cuboid { half_size } => half_size.length(),
            ClothWindShape::Cone { length, angle } => length / (FRAC_PI_2 - angle),
            _ => f32::INFINITY,
        };
        let place = place.copied().unwrap_or_default();
        let reach = 4.0 * length * place.scale().abs().max_element() + place.translation().length();
        let is_near = reach < CONTROL.length() / 4.0;
        !is_near
    })
}

/// Places, motions and masses, that NaN may be compared as well.
fn bits(particles: &ClothParticles) -> Vec<u32> {
    let places = particles.positions().flat_map(|at| at.to_array());
    let moved = particles.displacements().flat_map(|by| by.to_array());
    let all = places.chain(moved).chain(particles.inverse_masses());
    all.map(f32::to_bits).collect()
}

#[derive(Default)]
struct Counts {
    acts: usize,
    cloth_ticks: usize,
    faults: usize,
    /// Ticks of seams without a fault.
    seams: usize,
    /// Tears that opened.
    opened: usize,
    /// Edges that load tore.
    under_load: usize,
    /// Snapshots that changed what was torn.
    restored: usize,
    bits: usize,
    substeps: u64,
    slowest: f64,
}

/// Acts between two of the systems of a tick.
fn between(world: &mut World) {
    if world.resource_mut::<Random>().one_in(6) {
        act(world);
    }
}

/// The same once particles have been moved: what is written into them now is looked at in the next tick.
fn late(world: &mut World) {
    world.resource_mut::<Pool>().is_late = true;
    between(world);
    world.resource_mut::<Pool>().is_late = false;
}

/// Saves the world and the other app's, or puts both back, as an act has asked for. Counts what changes tears.
fn follow_request(
    [app, alone]: [&mut App; 2],
    saved: &mut Option<[ClothWorldSnapshot; 2]>,
    counts: &mut Counts,
) {
    let before = tears::all(app.world_mut());
    let Some(saves) = app.world_mut().resource_mut::<Pool>().request.take() else {
        return;
    };
    if saves {
        *saved = Some([app, alone].map(|app| ClothWorldSnapshot::of(app.world_mut())));
    } else if let Some([own, other]) = saved
        // Something may have gone meanwhile: an error.
        && own.restore(app.world_mut()).is_ok()
    {
        other.restore(alone.world_mut()).expect("nothing has gone");
        // The plugin gives tears to a cloth that had none.
        let is_torn = |cloth: &Entity, tears: &ClothTears| {
            before.get(cloth).map_or(&[][..], ClothTears::edges) != tears.edges()
        };
        let after = tears::all(app.world_mut());
        counts.restored += usize::from(after.iter().any(|(cloth, tears)| is_torn(cloth, tears)));
    }
}

/// Adds the figures of a tick.
fn count(world: &mut World, counts: &mut Counts) {
    counts.cloth_ticks += world.query::<&Cloth>().iter(world).count();
    let mut faulty = world.query_filtered::<(), (With<Cloth>, With<ClothFault>)>();
    counts.faults += faulty.iter(world).count();
    let mut sewn = world.query_filtered::<(), (With<ClothSeam>, Without<ClothFault>)>();
    counts.seams += sewn.iter(world).count();
    let mut all = world.query::<&ClothStats>();
    let all = all.iter(world);
    counts.substeps += all
        .map(|stats| u64::from(stats.substeps.min(10_000)))
        .sum::<u64>();
}

/// Counts tears, and acts between the systems of a tick, if it is to.
fn add_systems(app: &mut App, acts_between: bool) {
    use ClothSystems::{Integrate, Prepare, Query, Rebuild, WriteBack};
    app.init_resource::<UnderLoad>().add_systems(
        FixedUpdate,
        (
            tears::note.after(Integrate).before(WriteBack),
            tears::count.after(WriteBack),
        ),
    );
    if acts_between {
        app.add_systems(
            FixedUpdate,
            (
                between.after(Prepare).before(Rebuild),
                between.after(Rebuild).before(Query),
                between.after(Query).before(Integrate),
                late.after(Integrate).before(tears::note),
            ),
        );
    }
}

fn run(seed: u64, acts_between: bool, counts: &mut Counts) {
    let (mut app, control) = app_with_control();
    let (mut alone, same) = app_with_control();
    let roots =
        [0.0, 0.4, -0.4].map(|x| app.world_mut().spawn(Transform::from_xyz(x, 0.0, 0.0)).id());
    app.insert_resource(Random(seed));
    app.insert_resource(Pool {
        roots: roots.to_vec(),
        ..default()
    });
    add_systems(&mut app, acts_between);
    let mut saved: Option<[ClothWorldSnapshot; 2]> = None;
    let mut is_in_wind = false;
    let mut of_world = Random(seed ^ 0xABCD);
    for number in 0..TICKS[usize::from(is_long())] {
        for _ in 0..app.world_mut().resource_mut::<Random>().below(4) {
            act(app.world_mut());
        }
        let before = of_world.clone();
        set_world(&mut app, &mut of_world);
        set_world(&mut alone, &mut before.clone());
        follow_request([&mut app, &mut alone], &mut saved, counts);
        let world = app.world_mut();
        // Before the tick any may be written.
        world.resource_mut::<Pool>().written.clear();
        let mut cloths = world.query_filtered::<Entity, With<Cloth>>();
        let there: EntityHashSet = cloths.iter(world).collect();
        let elapsed = |app: &App| app.world().resource::<Time<Fixed>>().elapsed();
        let before = elapsed(&app);
        let start = Instant::now();
        app.update();
        counts.slowest = counts.slowest.max(start.elapsed().as_secs_f64());
        alone.update();
        bakes::record(app.world_mut());
        let told = messages::<ClothTorn>(&mut app);
        counts.opened += told.iter().filter(|torn| torn.edges > 0).count();
        let context = format!("seed {seed}, tick {number}, acts between systems: {acts_between}");
        if elapsed(&app) > before
            && let Some(wrong) = wrong(&mut app, &there)
        {
            panic!("{context}: {wrong}");
        }
        count(app.world_mut(), counts);
        is_in_wind |= may_blow(&mut app, control);
        if is_in_wind {
            continue;
        }
        let (own, truth) = (particles(&app, control), particles(&alone, same));
        let [own, truth] = [own, truth].map(bits);
        assert!(own == truth, "{context}: the control cloth is another");
        counts.bits += 32 * own.len();
    }
    counts.acts += app.world().resource::<Pool>().acts;
    counts.under_load += app.world().resource::<UnderLoad>().edges;
}

#[test]
fn garbage_harms_nobody_else() {
    let (runs, seed) = (told("BEVY_DRAPE_FUZZ"), told("BEVY_DRAPE_SEED"));
    let mut counts = Counts::default();
    let first = seed.unwrap_or(0);
    let all = runs.unwrap_or(RUNS[usize::from(is_long())]);
    for seed in first..first + all {
        run(seed, seed % 2 == 1, &mut counts);
        if runs.is_some() {
            let Counts {
                acts,
                cloth_ticks,
                faults,
                seams,
                opened,
                under_load,
                restored,
                bits,
                substeps,
                slowest,
            } = &counts;
            println!(
                "{} runs: {acts} acts, {cloth_ticks} cloth-ticks, {faults} of them with a fault, {seams} seam-ticks without one, {opened} tears opened, {under_load} edges torn under load, {restored} snapshots of other tears, {substeps} sub-steps, {bits} bits compared, the slowest tick {slowest:.2} s",
                seed + 1 - first
            );
        }
    }
    // It is worth the name.
    assert!(counts.bits > 0 && counts.faults > 0 && counts.faults < counts.cloth_ticks);
    assert!(counts.seams > 0, "no seam has worked");
    let torn = [counts.opened, counts.under_load];
    assert!(
        torn.iter().all(|count| *count > 0),
        "tears opened, edges torn under load: {torn:?}"
    );
    // Not in a short run.
    assert!(
        counts.restored > 0 || !is_long(),
        "no snapshot of other tears was restored"
    );
}
