//! Cloth that tears: under load, by a blade, and by the game's hand.

mod life;
mod loads;
mod messages;
mod parts;
mod picture;
mod strength;
mod times;

use std::{
    thread,
    time::{Duration, Instant},
};

use bevy::{ecs::system::SystemState, mesh::VertexAttributeValues, prelude::*};
use bevy_drape::{contact::intersections, plugin::ClothBuilt, prelude::*};

use crate::{shared_meshes::irregular, support::*};

/// Random numbers (Knuth's constants).
pub(crate) struct Random(pub(crate) u32);

impl Random {
    /// From −1 to 1.
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    pub(crate) fn place(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

pub(crate) fn surface(app: &App, cloth: Entity) -> &Surface {
    app.world()
        .get::<ClothBuilt>(cloth)
        .expect("it is built")
        .surface()
}

pub(crate) fn tears(app: &App, cloth: Entity) -> &ClothTears {
    app.world().get(cloth).expect("tears")
}

pub(crate) fn tear(
    app: &mut App,
    cloth: Entity,
    edges: impl IntoIterator<Item = [u32; 2]>,
) -> usize {
    let mut tears = app.world_mut().get_mut::<ClothTears>(cloth).expect("tears");
    tears.tear_all(edges)
}

pub(crate) fn sweep(app: &mut App, from: [Vec3; 2], to: [Vec3; 2]) -> usize {
    let mut state = SystemState::<ClothBlade>::new(app.world_mut());
    let mut blade = state
        .get_mut(app.world_mut())
        .expect("cloths alone are borrowed");
    blade.sweep(from, to)
}

/// A horizontal cut through everything at this height.
pub(crate) fn cut_at(app: &mut App, height: f32) -> usize {
    let along = |z: f32| [Vec3::new(-9.0, height, z), Vec3::new(9.0, height, z)];
    sweep(app, along(-9.0), along(9.0))
}

/// Mass of the free particles (kg), and their momentum (kg m/s).
pub(crate) fn motion(app: &App, cloth: Entity) -> (f64, Vec3) {
    let particles = particles(app, cloth);
    let (mut mass, mut momentum) = (0.0, Vec3::ZERO);
    for index in 0..particles.len() {
        let weight = particles.inverse_mass(index).expect("it exists");
        if weight > 0.0 {
            mass += f64::from(1.0 / weight);
            momentum += particles.velocity(index).expect("it exists") / weight;
        }
    }
    (mass, momentum)
}

pub(crate) fn crossings(app: &App, cloth: Entity) -> usize {
    let places: Vec<Vec3> = particles(app, cloth).positions().collect();
    intersections(&[(surface(app, cloth), places)])
}

pub(crate) fn mesh(width: f32, height: f32, spacing: f32) -> Cloth {
    let mesh = irregular(width, height, spacing, 0.3);
    Cloth::triangles(mesh.positions, mesh.triangles)
}

/// Pins the upper border.
pub(crate) fn top() -> Pins {
    Pins::new([Pin::at_rest(|place| place.y > -1.0e-3)])
}

/// The edges of faces for both of whose ends `is_there` holds at rest.
pub(crate) fn edges_where(
    app: &App,
    cloth: Entity,
    is_there: impl Fn(Vec3) -> bool,
) -> Vec<[u32; 2]> {
    let surface = surface(app, cloth);
    let sides = |[a, b, c]: &[u32; 3]| [[*a, *b], [*b, *c], [*c, *a]];
    let sides = surface.triangles().iter().flat_map(sides);
    let rest = |end: u32| surface.rest_positions()[end as usize];
    let are_there = |[a, b]: &[u32; 2]| is_there(rest(*a)) && is_there(rest(*b));
    sides
        .filter(are_there)
        .map(|edge| edge.map(|end| surface.origin_of(end)))
        .collect()
}

/// Each particle goes on from where it is, and the mass is shared out. Where a slit opens in cloth that hangs, the weight of
/// the 0.6 m below is on a row of 0.1 m alone: its velocity changes by no more than 6 g in a tick.
#[test]
fn a_tear_moves_nothing_and_loses_nothing() {
    for cloth in [Cloth::new(13, 13, 0.1), mesh(1.2, 1.2, 0.1)] {
        let mut app = app();
        let parts = (cloth, top(), ClothTears::default());
        let cloth = app.world_mut().spawn(parts).id();
        tick(&mut app, 60);
        let before = particles(&app, cloth).clone();
        let (mass, _) = motion(&app, cloth);
        let edges = edges_where(&app, cloth, |rest| {
            (rest.y + 0.6).abs() < 0.045 && rest.x < 0.75
        });
        let count = tear(&mut app, cloth, edges);
        assert!(count > 4, "{count}");
        tick(&mut app, 1);
        let told = messages::<ClothTorn>(&mut app);
        assert_eq!(told.len(), 1);
        assert_eq!(
            (told[0].cloth, told[0].edges, told[0].pieces),
            (cloth, count, 1)
        );
        assert!((told[0].place.y + 0.6).abs() < 0.1);
        assert!((motion(&app, cloth).0 / mass - 1.0).abs() < 1.0e-6);
        let after = particles(&app, cloth);
        assert!(after.len() > before.len());
        for index in 0..before.len() {
            let of = |particles: &ClothParticles| particles.position(index).expect("it exists");
            let expected = before.velocity(index).expect("it exists") * TICK;
            let went = of(after) - of(&before);
            assert!(
                went.distance(expected) < 6.0 * GRAVITY * TICK * TICK,
                "{index}: {went} {expected}"
            );
        }
    }
}

/// A banner that is cut in two: the lower part falls freely, as one piece, and the upper part hangs. Its material has no
/// damping.
#[test]
fn a_banner_that_is_cut_falls_in_two() {
    for cloth in [Cloth::new(13, 17, 0.1), mesh(1.2, 1.6, 0.1)] {
        let mut app = app();
        let undamped = ClothMaterial {
            damping: 0.0,
            ..ClothMaterial::COTTON
        };
        let parts = (cloth, top(), undamped, ClothTears::default());
        let cloth = app.world_mut().spawn(parts).id();
        tick(&mut app, 120);
        assert!(cut_at(&mut app, -0.83) > 11);
        tick(&mut app, 1);
        assert_eq!(messages::<ClothTorn>(&mut app)[0].pieces, 2);
        let rest = surface(&app, cloth).rest_positions().to_vec();
        // Away from the cut, at which a mesh's edges are anywhere.
        let lower = |index: &usize| rest[*index].y < -1.0;
        let middle = |app: &App| {
            let all = particles(app, cloth);
            let of = (0..all.len())
                .filter(lower)
                .map(|index| all.position(index).expect("it exists").y);
            of.clone().sum::<f32>() / of.count() as f32
        };
        let from = middle(&app);
        tick(&mut app, 19);
        let seconds = 20.0 * TICK;
        let fell = from - middle(&app);
        let [first, rest_of_it] = [TICK, seconds].map(|t| GRAVITY * t * t / 2.0);
        let expected = rest_of_it - first;
        assert!(
            (fell / expected - 1.0).abs() < 0.02,
            "{fell} m of {expected}"
        );
        let highest = particles(&app, cloth)
            .positions()
            .map(|place| place.y)
            .fold(f32::MIN, f32::max);
        assert!(highest > -1.0e-3, "the pins hold the rest");
    }
}

/// A torn cloth is told apart from the whole one in all that depends on its particles: pins by row or vertex, attachments and
/// the attributes hold all parts of what they held.
#[test]
fn pins_and_attachments_hold_both_sides() {
    let mut app = app();
    let post = app
        .world_mut()
        .spawn(Transform::from_xyz(0.2, -0.4, 0.0))
        .id();
    let held = ClothAttachments::new([(Pin::Cell(4, 2), post)]);
    let parts = (Cloth::new(5, 9, 0.1), held, ClothTears::default());
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 30);
    // Down from the middle of the upper border to the post, and on.
    let down = (0..6).map(|row| [row * 5 + 2, row * 5 + 7]);
    assert_eq!(tear(&mut app, cloth, down), 6);
    tick(&mut app, 1);
    let surface = surface(&app, cloth);
    let parts_of =
        |of: u32| (0..surface.len() as u32).filter(move |index| surface.origin_of(*index) == of);
    for whole in [2, 22] {
        assert_eq!(parts_of(whole).count(), 2, "{whole}");
        let particles = particles(&app, cloth);
        assert!(parts_of(whole).all(|part| particles.is_pinned(part as usize) == Some(true)));
    }
    let parts: Vec<u32> = parts_of(22).collect();
    for step in 1..60 {
        let place = Vec3::new(0.2, -0.4, 0.002 * step as f32);
        change::<Transform>(&mut app, post, |post| post.translation = place);
        tick(&mut app, 1);
        for part in &parts {
            let found = particles(&app, cloth)
                .position(*part as usize)
                .expect("it exists");
            assert!(found.distance(place) < 1.0e-5, "{found} {place}");
        }
    }
    // And other pins hold all parts, too.
    app.world_mut()
        .entity_mut(cloth)
        .insert((Pins::new([Pin::Row(1)]), ClothAttachments::default()));
    tick(&mut app, 1);
    let pinned = particles(&app, cloth)
        .inverse_masses()
        .filter(|w| *w == 0.0)
        .count();
    assert_eq!(pinned, 6, "five, of which one is two");
}

/// Torn off its only pin, a cloth falls, and leaves a scrap there.
#[test]
fn a_cloth_is_torn_off_its_pin() {
    for cloth in [Cloth::new(9, 9, 0.1), mesh(0.8, 0.8, 0.1)] {
        let mut app = app();
        let corner = Pins::new([Pin::Near {
            point: Vec3::ZERO,
            radius: 0.01,
        }]);
        let cloth = app
            .world_mut()
            .spawn((cloth, corner, ClothTears::default()))
            .id();
        tick(&mut app, 30);
        let pinned = particles(&app, cloth)
            .inverse_masses()
            .position(|w| w == 0.0)
            .expect("a pin");
        let whole = surface(&app, cloth).clone();
        change::<ClothTears>(&mut app, cloth, |tears| {
            assert!(tears.tear_off(&whole, pinned as u32) > 0);
        });
        tick(&mut app, 64);
        assert_eq!(surface(&app, cloth).pieces(), 2);
        let rest = surface(&app, cloth).rest_positions();
        let places = particles(&app, cloth).positions();
        let fallen = places
            .zip(rest)
            .filter(|(place, rest)| rest.length() > 0.25 && place.y < rest.y - 2.0);
        let far = rest.iter().filter(|rest| rest.length() > 0.25);
        assert_eq!(fallen.count(), far.count());
    }
}

/// A hundred random cuts through cloth that falls and flutters, a thousand with `BEVY_DRAPE_LONG`: nothing is lost, and the mass
/// stays. With layers no triangles intersect.
#[test]
fn random_cuts_lose_nothing() {
    let mut random = Random(5);
    let count = if is_long() { 1_000 } else { 100 };
    for run in 0..count / 10 {
        let cloth = match run % 2 {
            0 => Cloth::new(12, 12, 0.1),
            _ => mesh(1.1, 1.1, 0.1),
        };
        let mut app = app();
        app.insert_resource(ClothWind {
            velocity: 4.0 * random.place(),
            ..default()
        });
        let parts = (cloth, top(), ClothTears::default(), ClothAir::default());
        let cloth = app.world_mut().spawn(parts).id();
        let has_layers = run % 4 < 2;
        if has_layers {
            app.world_mut()
                .entity_mut(cloth)
                .insert(ClothSelfCollision::default());
        }
        tick(&mut app, 10);
        let (mass, _) = motion(&app, cloth);
        let mut torn = 0;
        for cut in 0..10 {
            let middle = Vec3::new(0.55, -0.55, 0.0) + 0.6 * random.place();
            let [along, across] = [0.8, 0.8].map(|length| length * random.place());
            torn += sweep(
                &mut app,
                [middle - along - across, middle + along - across],
                [middle - along + across, middle + along + across],
            );
            tick(&mut app, 12);
            let particles = particles(&app, cloth);
            assert!(particles.validate().is_ok(), "{run} {cut}");
            assert_eq!(app.world().get::<ClothFault>(cloth), None);
            let (mass_now, _) = motion(&app, cloth);
            assert!((mass_now / mass - 1.0).abs() < 1.0e-5, "{run} {cut}");
            if has_layers {
                assert_eq!(crossings(&app, cloth), 0, "{run} {cut}");
            }
        }
        assert_eq!(torn, tears(&app, cloth).edges().len());
    }
}
