//! Cuts and tears: momentum, frames, blades in the worst places, scenes, search, and pieces that meet.

mod repeat;

use std::array::from_fn;

use bevy::camera::visibility::VisibilityClass;
use bevy::ecs::{entity::EntityHashMap, system::SystemState};
use bevy::{math::DVec3, prelude::*, world_serialization::serde::WorldDeserializer};
use bevy_drape::hierarchy::{NodeBounds, Probe, TopDownQuery, brute_force};
use bevy_drape::{prelude::*, solver::Stretch};
use serde::de::DeserializeSeed;

use crate::tears::{Random, crossings, cut_at, mesh, surface, sweep, tear, tears, top};
use crate::{push_back::flat, scenes::app_with_assets, support::*};

#[track_caller]
fn the<T>(of: Option<T>) -> T {
    of.expect("it exists")
}

fn spawn(app: &mut App, parts: impl Bundle) -> Entity {
    app.world_mut().spawn(parts).id()
}

/// The particles of the only cloth as preparation leaves them: torn, and not moved yet.
#[derive(Resource, Default)]
struct Noted(ClothParticles);

fn note(cloth: Single<&ClothParticles>, mut noted: ResMut<Noted>) {
    noted.0.clone_from(&cloth);
}

/// An app that notes them, without gravity and air, in which balls may move.
fn app_in_space() -> App {
    let mut app = app_with_moving_balls();
    let note = note.after(ClothSystems::Prepare);
    let note = note.before(ClothSystems::Rebuild);
    let mut wind = ClothWind::new(Vec3::ZERO);
    wind.density = 0.0;
    app.insert_resource(ClothGravity(Vec3::ZERO));
    app.insert_resource(wind).init_resource::<Noted>();
    app.add_systems(FixedUpdate, note);
    app
}

fn sheets() -> [Cloth; 2] {
    [Cloth::new(13, 13, 0.1), mesh(1.2, 1.2, 0.1)]
}

fn threads(stretch_compliance: f32, damping: f32) -> ClothMaterial {
    ClothMaterial {
        stretch_compliance,
        shear_compliance: 20.0 * stretch_compliance,
        damping,
        ..ClothMaterial::COTTON
    }
}

fn each(app: &mut App, cloth: Entity, write: impl Fn(&mut ClothParticles, usize)) {
    let particles = app.world_mut().get_mut::<ClothParticles>(cloth);
    let particles = the(particles).into_inner();
    (0..particles.len()).for_each(|index| write(particles, index));
}

fn assert_sound(app: &App, cloth: Entity) {
    assert_eq!(app.world().get::<ClothFault>(cloth), None);
    assert_eq!(particles(app, cloth).validate(), Ok(()));
}

/// Strips of a woven grid are pulled apart slowly, one along its columns and one along its rows. Each tears across the pull, within
/// 5 % of the stretch at its own strength: strength × compliance. That is the tolerance of `a_strip_tears_at_its_strength`; shear springs
/// are even softer here, so that the strips hardly contract. Exchanged, the strengths would be off by 60 %. Sub-steps leave up to 0.3 % of a
/// length unsolved, a twentieth of the stretch at which they tear.
#[test]
fn warp_and_weft_tear_at_their_own_strengths() {
    let (mut material, mut tearing) = (threads(5.0e-4, 0.01), ClothTearing::new(100.0));
    let weft = material.weft.insert(ClothWeft::default());
    (weft.stretch_compliance, tearing.weft_strength) = (1.0e-3, 60.0);
    material.shear_compliance = 2.0e-2;
    let columns = (Cloth::new(8, 16, 0.05), [0, 15].map(Pin::Row));
    let rows = (Cloth::new(16, 8, 0.05), [0, 15].map(Pin::Column));
    for ((strip, [held, pulled]), way, strain, step) in [
        (columns, Vec3::NEG_Y, 100.0 * 5.0e-4, 1),
        (rows, Vec3::X, 60.0 * 1.0e-3, 16),
    ] {
        let mut app = app_in_space();
        let bar = spawn(&mut app, Transform::default());
        let held = (Pins::new([held]), ClothAttachments::new([(pulled, bar)]));
        let cloth = spawn(&mut app, (strip.flat(), material, held, tearing));
        tick(&mut app, 1);
        let mut ratio = 0.0_f32;
        while tears(&app, cloth).is_empty() && ratio < 1.5 {
            ratio += 1.0e-3;
            let place = ratio * strain * 0.75 * way;
            change::<Transform>(&mut app, bar, |bar| bar.translation = place);
            tick(&mut app, 1);
        }
        assert!((ratio - 1.0).abs() < 0.05, "{way}: {ratio}");
        let [a, b] = tears(&app, cloth).edges()[0];
        assert_eq!(b - a, step, "{way}: along a row, or along a column");
    }
}

/// Mass (kg), momentum (kg m/s), and angular momentum about the origin (kg m²/s).
fn motion(particles: &ClothParticles) -> (f64, [DVec3; 2]) {
    let (mut mass, mut momenta) = (0.0, [DVec3::ZERO; 2]);
    for index in 0..particles.len() {
        let own = 1.0 / f64::from(the(particles.inverse_mass(index)));
        let momentum = own * the(particles.velocity(index)).as_dvec3();
        let place = the(particles.position(index)).as_dvec3();
        mass += own;
        momenta = [momenta[0] + momentum, momenta[1] + place.cross(momentum)];
    }
    (mass, momenta)
}

/// Soft cloth without damping flies through empty space, turns, and is cut twice through its middle. As a cut opens, each particle has the
/// velocity and place of the one that it was, to the bit. Older particles keep their indices. Of cloth that collides with itself, a cut moves
/// a particle by at most `room`. That is a fiftieth of the way to the middle of faces beside it, `HALF_WIDTH` of `cloth/surface/torn/parted`, which is
/// shorter than their longest side.
///
/// Mass and momentum stay: areas of parts add up within 10⁻⁶, and floats round their masses by less. Speeds are less than 4 m/s,
/// 1.5 of the throw and 2.3 rad/s × 0.85 m of the turn, and places within 2 m. Angular momentum changes by at most mass × `room` × speed, and
/// that rounding. In the tick itself, sixteen sub-steps round momentum by 10⁻⁵. A sweep turns free cloth by up to 1 % in 4 s
/// (`truth/motion.rs`); the springs beside a cut begin pressed, so 10⁻³ is allowed in a tick.
#[test]
fn a_cut_keeps_velocities_mass_and_both_momenta() {
    for (sheet, has_layers) in sheets()
        .into_iter()
        .flat_map(|of| [(of.clone(), false), (of, true)])
    {
        let mut app = app_in_space();
        let how = (threads(1.0e-2, 0.0), ClothSettings::substeps(16));
        let cloth = (sheet, Pins::none(), how, ClothTears::default());
        let cloth = spawn(&mut app, cloth);
        if has_layers {
            let layers = ClothSelfCollision::default();
            app.world_mut().entity_mut(cloth).insert(layers);
        }
        tick(&mut app, 1);
        each(&mut app, cloth, |particles, index| {
            let arm = the(particles.position(index)) - Vec3::new(0.6, -0.6, 0.0);
            let velocity = Vec3::new(0.5, 1.0, -1.0) + Vec3::new(0.5, 1.0, 2.0).cross(arm);
            the(particles.set_velocity(index, velocity).ok());
        });
        for _ in 0..2 {
            tick(&mut app, 10);
            let (whole, before) = (surface(&app, cloth).clone(), particles(&app, cloth).clone());
            let middle = before.positions().sum::<Vec3>() / before.len() as f32;
            assert!(cut_at(&mut app, middle.y) > 6);
            tick(&mut app, 1);
            let (torn, opened) = (surface(&app, cloth), &app.world().resource::<Noted>().0);
            assert!(torn.pieces() > whole.pieces() && opened.len() > before.len());
            let room = if has_layers {
                0.02 * torn.spacing().longest
            } else {
                0.0
            };
            for part in 0..opened.len() {
                let goes_on = |from: usize| {
                    let way = the(before.position(from)) - the(opened.position(part));
                    let is_of = whole.origin_of(from as u32) == torn.origin_of(part as u32);
                    let goes_on = before.velocity(from) == opened.velocity(part);
                    is_of && goes_on && way.length() <= room
                };
                let first = if part < before.len() { part } else { 0 };
                assert!((first..before.len().min(part + 1)).any(goes_on), "{part}");
            }
            let [before, opened, after] = [&before, opened, particles(&app, cloth)].map(motion);
            assert!((opened.0 / before.0 - 1.0).abs() < 2.0e-6);
            assert_eq!(after.0, opened.0);
            let size = 4.0 * before.0;
            for (now, linear, angular) in [(opened, 2.0e-6, 2.0e-6), (after, 1.2e-5, 1.0e-3)] {
                let [given, turned]: [f64; 2] = from_fn(|of| now.1[of].distance(before.1[of]));
                assert!(given < linear * size, "{given} kg m/s");
                let allowed = (2.0 * angular + f64::from(room)) * size;
                assert!(turned < allowed, "{turned} kg m²/s of {allowed}");
            }
        }
    }
}

fn sweep_one(app: &mut App, [from, to]: [[Vec3; 2]; 2], only: Entity) -> usize {
    let mut state = SystemState::<ClothBlade>::new(app.world_mut());
    let mut blade = the(state.get_mut(app.world_mut()).ok());
    blade.sweep_where(from, to, |cloth| cloth == only)
}

/// Cloths that are turned, scaled, and below a parent that has moved, are cut as one at the identity is by a blade in the same place of the
/// cloth. Pins hold them, so that places agree within some roundings of 4 m. The cut misses the middles of faces by far more.
/// The last two are in one place in the world: `sweep_where` cuts the one that it lets through, and not the other.
#[test]
fn a_blade_cuts_alike_in_any_frame() {
    let grids = [0.1, 0.05].map(|spacing| Cloth::new(9, 9, spacing));
    let meshes = [0.8, 0.4].map(|side| mesh(side, side, side / 8.0));
    let place = |x: f32, turn: f32, scale: f32| {
        let turn = Quat::from_euler(EulerRot::XYZ, 0.3, turn, -0.6);
        let place = Transform::from_xyz(x, 1.0, 0.5).with_rotation(turn);
        place.with_scale(Vec3::splat(scale))
    };
    let (moved, scaled) = (place(-0.4, 0.9, 1.5), place(1.4, -2.0, 2.0));
    let below = GlobalTransform::from(scaled).reparented_to(&moved.into());
    let places = [Transform::IDENTITY, place(2.0, 2.2, 1.0), scaled, scaled];
    for [large, small] in [grids, meshes] {
        let mut app = app();
        let parent = spawn(&mut app, place(-1.0, 1.2, 1.5));
        let cloths: [Entity; 4] = from_fn(|at| {
            let cloth = if at < 2 { &large } else { &small };
            let own = if at < 3 { places[at] } else { below };
            let parts = (Pins::new([Pin::at_rest(|_| true)]), ClothTears::default());
            spawn(&mut app, (cloth.clone(), own, parts))
        });
        app.world_mut().entity_mut(parent).add_child(cloths[3]);
        tick(&mut app, 2);
        change::<Transform>(&mut app, parent, |place| *place = moved);
        tick(&mut app, 2);
        for (at, (cloth, place)) in cloths.into_iter().zip(places).enumerate() {
            let place = place.with_scale(Vec3::ONE);
            let blade = [(-0.2, -0.104), (1.0, -0.62)]
                .map(|(x, y)| [-1.0, 1.0].map(|z| place.transform_point(Vec3::new(x, y, z))));
            assert!(sweep_one(&mut app, blade, cloth) > 5);
            let is_torn = cloths.map(|cloth| !tears(&app, cloth).is_empty());
            let expected: [bool; 4] = from_fn(|other| other <= at);
            assert_eq!(is_torn, expected);
            assert_eq!(tears(&app, cloth), tears(&app, cloths[0]));
        }
        tick(&mut app, 2);
        for cloth in cloths {
            assert_sound(&app, cloth);
            assert!(surface(&app, cloth).pieces() > 1);
        }
    }
}

/// The edges that a blade tears which goes exactly from one particle to another, and `beyond` of that way on at both ends. The cloth
/// then falls for half a second.
fn cut_between(sheet: &Cloth, pins: &Pins, ends: [usize; 2], beyond: f32) -> Vec<[u32; 2]> {
    let mut app = app_in_space();
    let cloth = (sheet.clone().flat(), pins.clone(), ClothTears::default());
    let cloth = spawn(&mut app, cloth);
    tick(&mut app, 1);
    let whole = surface(&app, cloth).clone();
    let rest = whole.rest_positions();
    each(&mut app, cloth, |particles, index| {
        the(particles.set_position(index, rest[index]).ok());
    });
    let [a, b] = ends.map(|vertex| rest[the(whole.particle_of_vertex(vertex))]);
    let way = beyond * (b - a);
    let [from, to] = [a - way, b + way].map(|end| [end - Vec3::Z, end + Vec3::Z]);
    sweep(&mut app, from, to);
    let mut edges = tears(&app, cloth).edges().to_vec();
    app.insert_resource(ClothGravity::default());
    tick(&mut app, 32);
    assert_sound(&app, cloth);
    assert!(surface(&app, cloth).pieces() <= 2, "{ends:?} {beyond}");
    edges.sort_unstable();
    edges
}

/// Blades go exactly through particles, along rows, columns, diagonals, pins and a single edge, up to a border or beyond it. They cut
/// in at most two, harm nothing, and do the same each time. The grid's places are binary fractions, so that all of this is exact. A row or
/// an edge is cut just there, since the way from face to face crosses the blade once. Along a border there is nothing to cut.
#[test]
fn blades_in_the_worst_places_are_harmless() {
    let row: Vec<[u32; 2]> = (36..44).map(|at| [at, at + 1]).collect();
    let grid = Cloth::new(9, 9, 0.125);
    for pins in [Pins::default(), Pins::new([Pin::Row(4)]), Pins::none()] {
        for (ends, beyond, expected) in [
            ([36, 44], 0.0, Some(&row[..])),
            ([36, 44], 1.0, Some(&row[..])),
            ([39, 40], 0.0, Some(&row[3..4])),
            ([4, 76], 1.0, None),
            ([0, 80], 1.0, None),
            ([8, 72], 0.0, None),
            ([0, 8], 1.0, Some(&row[..0])),
            ([40, 40], 0.0, Some(&row[..0])),
        ] {
            let [found, again] = [(); 2].map(|()| cut_between(&grid, &pins, ends, beyond));
            assert_eq!(found, again);
            assert_eq!(found, expected.unwrap_or(&found), "{ends:?} {beyond}");
        }
    }
    let sheet = mesh(0.8, 0.8, 0.1);
    for ends in [[36, 44], [30, 50], [40, 41], [12, 67], [0, 8], [20, 20]] {
        let runs = [0.0, 0.0, 2.0, 2.0].map(|on| cut_between(&sheet, &top(), ends, on));
        assert!(runs[0] == runs[1] && runs[2] == runs[3], "{ends:?}");
    }
}
