//! Cloth that tears: under load, by a blade, and by the game's hand.

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

/// The elongation at which a strip begins to tear that a row of pins pulls apart slowly, a thousandth of `expected` (m) in a tick.
fn elongation_at_tear(
    app: &mut App,
    strip: impl Bundle,
    length: f32,
    expected: f32,
) -> (Entity, f32) {
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let bar = app.world_mut().spawn(Transform::default()).id();
    let lower = Pin::at_rest(move |place| place.y < 1.0e-3 - length);
    let held = ClothAttachments::new([(lower, bar)]);
    let cloth = app.world_mut().spawn((strip, top(), held)).id();
    tick(app, 1);
    let mut pulled = 0.0;
    while tears(app, cloth).is_empty() {
        pulled += 1.0e-3 * expected;
        assert!(pulled < 1.5 * expected, "it holds half as much again");
        change::<Transform>(app, bar, |bar| bar.translation.y = -pulled);
        tick(app, 1);
    }
    println!(
        "{}: tears at {:.1} % of its strength",
        surface(app, cloth),
        100.0 * pulled / expected
    );
    (cloth, pulled)
}

/// A strip that is pulled apart slowly tears within 5 % of the load that its strength stands for, at any resolution of a grid: the
/// stretch at that load is strength × compliance. Shear springs are soft, so that it hardly contracts: where its ends hold it, the
/// corners bear 2 % more. A tick pulls by a thousandth of that load.
#[test]
fn a_strip_tears_at_its_strength() {
    let material = ClothMaterial {
        stretch_compliance: 5.0e-4,
        shear_compliance: 1.0e-2,
        ..ClothMaterial::COTTON
    };
    let strength = 100.0;
    for columns in [8, 16, 32] {
        let spacing = 0.4 / (columns - 1) as f32;
        let rows = (1.0 / spacing) as u32 + 1;
        let length = (rows - 1) as f32 * spacing;
        let expected = strength * material.stretch_compliance * length;
        let strip = Cloth::new(columns, rows, spacing).flat();
        let strip = (strip, material, ClothTearing::new(strength));
        let mut app = app();
        let (cloth, found) = elongation_at_tear(&mut app, strip, length, expected);
        let ratio = found / expected;
        assert!(ratio > 0.95 && ratio < 1.05, "{found} {expected}");
        // It goes on until the strip is in two, and no piece bears too much any more.
        tick(&mut app, 200);
        let pieces = surface(&app, cloth).pieces();
        assert!(pieces >= 2, "{pieces}");
        let edges = tears(&app, cloth).edges().len();
        println!("    in {pieces} pieces, along {edges} edges");
    }
}

/// A map that makes it softer, and stiffening, change how far it stretches before it tears, and not the load.
#[test]
fn a_map_leaves_the_strength_alone() {
    let material = ClothMaterial {
        stretch_compliance: 5.0e-4,
        shear_compliance: 1.0e-2,
        ..ClothMaterial::COTTON
    };
    let (strength, length) = (100.0, 0.75);
    let softer = ClothMaterialMap {
        stretch: ClothFactor::of(0.5),
        ..default()
    };
    let stiffening = Some(ClothStiffening {
        strain: 0.02,
        factor: 5.0,
    });
    // 0.05 without either; 0.02 + 0.03 / 5 with a knee.
    for (map, stiffening, strain) in [(softer, None, 0.1), (default(), stiffening, 0.026)] {
        let material = ClothMaterial {
            stiffening,
            ..material
        };
        let strip = Cloth::new(8, 16, 0.05).flat();
        let strip = (strip, material, map, ClothTearing::new(strength));
        let expected = strain * length;
        let (_, found) = elongation_at_tear(&mut app(), strip, length, expected);
        assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
    }
}

/// Irregular meshes that a dense part hangs from tear within 6 % of their strength by default, while gravity grows slowly until they are in
/// two; under their own weight they may hold a little longer. At rest a patch bears some 5 % more or less than the mean, see `cloth/stress.rs`. They hang with their own weight alone, or with a part at their end
/// that is ten or a hundred times as dense. What counts is the weight below the first edge that tears. Under their own weight, a patch at
/// the upper border bears what hangs 0.8 σ lower, with a reach of σ = √(2n/3) spacings for n rings: they may hold by so much more. Damping
/// leaves some motion: without any, a weight would sink behind gravity. The finest meshes run where tests run at their full length.
#[test]
fn a_mesh_tears_at_its_strength() {
    let material = ClothMaterial {
        stretch_compliance: 5.0e-4,
        shear_compliance: 1.0e-2,
        damping: 0.9,
        ..ClothMaterial::COTTON
    };
    let meshes = [
        (0.1, 0.15, 4.0),
        (0.1, 0.3, 4.0),
        (0.05, 0.15, 7.0),
        (0.05, 0.3, 7.0),
        (0.025, 0.3, 12.0),
    ];
    for ((spacing, jitter, rings), dense) in meshes
        .into_iter()
        .flat_map(|mesh| [0.0, 9.0, 99.0].map(|dense| (mesh, dense)))
    {
        if spacing < 0.05 && !is_long() {
            continue;
        }
        let [begins, apart] = load_at_tear(&material, (spacing, jitter), dense);
        let reach = (2.0 * rings / 3.0_f32).sqrt() * spacing;
        // The part of the weight above the lower end, of which the patch misses as much as it reaches down.
        let own = 0.9 / (0.9 + 0.1 * (1.0 + dense));
        let allowed = 0.94..1.06 + 0.8 * reach * own;
        assert!(allowed.contains(&begins), "{begins} {allowed:?}");
        assert!(apart < 1.2 * allowed.end, "{apart}");
    }
}

/// Hangs an irregular mesh with this spacing and jitter, whose lower end is denser by so many times. Returns the load at which it begins
/// to tear, and that at which it is in two, as parts of its strength.
fn load_at_tear(material: &ClothMaterial, (spacing, jitter): (f32, f32), dense: f32) -> [f32; 2] {
    let strength = 100.0;
    let strip = irregular(0.4, 1.0, spacing, jitter);
    let weight = ClothPaint::at_rest(move |place| if place.y < -0.89 { dense } else { 0.0 });
    let mut app = app();
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let parts = (
        Cloth::triangles(strip.positions, strip.triangles).flat(),
        top(),
        *material,
        ClothMaterialMap {
            density: ClothFactor::added(weight),
            ..default()
        },
        ClothTearing::new(strength),
    );
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 1);
    let mass = motion(&app, cloth).0 as f32;
    let most = strength * 0.4 / mass;
    let (mut gravity, mut begins) = (0.0, None);
    while surface(&app, cloth).pieces() < 2 && gravity < 1.5 * most {
        gravity += 1.0e-3 * most;
        app.insert_resource(ClothGravity(Vec3::NEG_Y * gravity));
        tick(&mut app, 1);
        if begins.is_none()
            && let Some([end, _]) = tears(&app, cloth).edges().first()
        {
            begins = Some(mass_below(&app, cloth, *end) * gravity / 0.4 / strength);
        }
    }
    let (begins, apart) = (begins.unwrap_or(f32::MAX), gravity / most);
    println!(
        "{}, moved by {jitter} spacings, {dense} times denser below, {} sub-steps: tears at {:.1} % of its strength, is in two at {:.1} %",
        surface(&app, cloth),
        stats(&app, cloth).substeps,
        100.0 * begins,
        100.0 * apart
    );
    [begins, apart]
}

/// The mass of what lies lower at rest than a particle (kg).
fn mass_below(app: &App, cloth: Entity, particle: u32) -> f32 {
    let (rest, particles) = (surface(app, cloth).rest_positions(), particles(app, cloth));
    let height = rest[particle as usize].y;
    let below = (0..rest.len()).filter(|index| rest[*index].y < height);
    let weights = below.filter_map(|index| particles.inverse_mass(index));
    weights.map(f32::recip).sum()
}

/// A slit in cloth whose threads all bear too much runs on at its two ends alone, by an edge each in a tick. The sides of it tear no
/// further.
#[test]
fn a_tear_runs_from_its_ends() {
    let mut app = app();
    let parts = (Cloth::new(21, 21, 0.1), ClothTears::default());
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 60);
    let slit: Vec<[u32; 2]> = (8..12)
        .map(|column| [10 * 21 + column, 10 * 21 + column + 1])
        .collect();
    tear(&mut app, cloth, slit);
    tick(&mut app, 2);
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothTearing::new(0.01));
    for _ in 0..6 {
        let before = tears(&app, cloth).edges().len();
        tick(&mut app, 1);
        let torn = tears(&app, cloth).edges()[before..].to_vec();
        assert!((1..=2).contains(&torn.len()), "{torn:?}");
    }
}

/// How long a tick takes on average (ms).
fn ms(app: &mut App, ticks: usize) -> f64 {
    let start = Instant::now();
    tick(app, ticks);
    1000.0 * start.elapsed().as_secs_f64() / ticks as f64
}

/// A cloth of 1.6 m that hangs, and may be torn.
fn hung(side: u32, is_mesh: bool) -> (App, Entity) {
    let spacing = 1.6 / (side - 1) as f32;
    let cloth = match is_mesh {
        false => Cloth::new(side, side, spacing),
        true => mesh(1.6, 1.6, spacing),
    };
    let mut app = app();
    let parts = (cloth, top(), ClothTears::default());
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 10);
    (app, cloth)
}

/// The time between two frames.
fn pause() -> Duration {
    Duration::from_millis(if is_long() { 60 } else { 5 })
}

/// Tears a face of the whole surface out, and returns how long the next tick takes (ms). `is_ahead` builds its surface in the background,
/// in the time between two frames.
fn tear_out(app: &mut App, cloth: Entity, whole: &Surface, face: usize, is_ahead: bool) -> f64 {
    let count = surface(app, cloth).len();
    change::<ClothTears>(app, cloth, |tears| {
        tears.tear_out(whole, whole.triangles()[face]);
    });
    if is_ahead {
        app.world_mut().run_schedule(Last);
        thread::sleep(pause());
    }
    let opens = ms(app, 1);
    assert!(surface(app, cloth).len() > count);
    opens
}

fn median(mut of: Vec<f64>) -> f64 {
    of.sort_by(f64::total_cmp);
    of[of.len() / 2]
}

/// A cloth from which faces are torn out, one in a tick. Returns how long a tick of it takes (ms): whole, and torn; then the median of how much
/// longer the ticks that tear take, and the most.
fn times_of_tears(side: u32, is_mesh: bool, is_ahead: bool) -> [f64; 4] {
    let (mut app, cloth) = hung(side, is_mesh);
    let whole = ms(&mut app, 20);
    let untorn = surface(&app, cloth).clone();
    let middle = untorn.triangles().len() / 2;
    let opens: Vec<f64> = (0..11)
        .map(|number| tear_out(&mut app, cloth, &untorn, middle + 5 * number, is_ahead))
        .collect();
    let torn = ms(&mut app, 20);
    let most = opens.iter().copied().fold(0.0, f64::max);
    [whole, torn, median(opens) - torn, most - torn]
}

/// How long a tick takes (ms), in the median, each after a pause: of a whole cloth; of one that tears in each, anywhere; and of the same one,
/// once it tears no more.
fn times_of_tearing(side: u32, is_mesh: bool) -> [f64; 3] {
    let (mut app, cloth) = hung(side, is_mesh);
    let untorn = surface(&app, cloth).clone();
    let faces = untorn.triangles().len();
    let unchanged = |app: &mut App| {
        let ticks = (0..20).map(|_| {
            thread::sleep(pause());
            ms(app, 1)
        });
        median(ticks.collect())
    };
    let whole = unchanged(&mut app);
    let tears = (0..40)
        .map(|number| tear_out(&mut app, cloth, &untorn, (617 * number + 300) % faces, true))
        .skip(20);
    let tears = median(tears.collect());
    [whole, tears, unchanged(&mut app)]
}

/// A tear opens in cloth of any size in the tick after it is listed. How long that takes, with `--nocapture`; of 64², where tests run at
/// their full length.
#[test]
fn a_tear_opens_in_cloth_of_any_size() {
    let sides: &[u32] = if is_long() { &[16, 32, 64] } else { &[16, 32] };
    for &side in sides {
        for is_mesh in [false, true] {
            let [at_once, ahead] =
                [false, true].map(|is_ahead| times_of_tears(side, is_mesh, is_ahead));
            println!(
                "{side}²{}: a tick takes {:.2} ms, of the torn one {:.2}; the one that tears {:.2} more, at most {:.1}; built ahead {:.2}, at most {:.1}",
                if is_mesh { " of a mesh" } else { "" },
                at_once[0],
                at_once[1],
                at_once[2],
                at_once[3],
                ahead[2],
                ahead[3],
            );
            let [whole, tears, torn] = times_of_tearing(side, is_mesh);
            println!(
                "    after a pause: {whole:.2} ms, of one that tears in each tick {tears:.2}, once it tears no more {torn:.2}"
            );
        }
    }
}

/// The next face of each cloth to be torn out, in order.
#[derive(Resource, Default)]
struct NextFace(usize);

fn tear_next(mut next: ResMut<NextFace>, mut cloths: Query<(&mut ClothTears, &ClothBuilt)>) {
    for (mut tears, built) in &mut cloths {
        let faces = built.surface().triangles();
        tears.tear_out(built.surface(), faces[(7 * next.0) % faces.len()]);
    }
    next.0 += 1;
}

/// Cloths that tear in each frame, after its tick, have the same bits whether their surfaces are built ahead on other threads, beside the
/// systems of the game, or within the tick. It ends, too: no system waits for what waits for it.
#[test]
fn what_is_built_ahead_is_as_built_in_the_tick() {
    let start = || {
        let mut app = app();
        app.init_resource::<NextFace>();
        let cloths = [0, 1, 2, 3].map(|number| {
            let cloth = match number % 2 {
                0 => Cloth::new(14, 14, 0.1),
                _ => mesh(1.3, 1.3, 0.1),
            };
            // One that does not bend is built soonest.
            let material = ClothMaterial {
                bend_rigidity: if number < 2 { 0.0 } else { 1.0e-5 },
                ..ClothMaterial::COTTON
            };
            let parts = (cloth, material, top(), ClothTears::default());
            app.world_mut().spawn(parts).id()
        });
        tick(&mut app, 2);
        (app, cloths)
    };
    let ((mut ahead, cloths), (mut at_once, same)) = (start(), start());
    run_on_all_threads(&mut ahead);
    ahead.add_systems(Update, tear_next);
    for number in 0..if is_long() { 500 } else { 60 } {
        tick(&mut ahead, 1);
        tick(&mut at_once, 1);
        // After the frame, so that nothing sees it before the next tick.
        at_once
            .world_mut()
            .run_system_cached(tear_next)
            .expect("cloths and a number");
        for (cloth, same) in cloths.iter().zip(same) {
            let [is, expected] = [(&ahead, *cloth), (&at_once, same)].map(|(app, cloth)| {
                let particles = particles(app, cloth);
                assert!(surface(app, cloth).is_torn() || number == 0);
                particles.clone()
            });
            assert!(is == expected, "{cloth} in tick {number}");
        }
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

/// Whatever was torn after a snapshot is whole again when it is restored, and tears as before, to the bit: also in an app that
/// has just spawned its cloth.
#[test]
fn what_is_torn_is_rolled_back() {
    for cloth in [Cloth::new(9, 9, 0.1), mesh(0.8, 0.8, 0.1)] {
        let spawn = |app: &mut App| {
            let parts = (
                cloth.clone(),
                top(),
                ClothMaterial::COTTON,
                ClothTearing::default(),
            );
            app.world_mut().spawn(parts).id()
        };
        let mut app = app();
        let torn = spawn(&mut app);
        tick(&mut app, 20);
        cut_at(&mut app, -0.33);
        tick(&mut app, 10);
        let saved = ClothSnapshot::of(app.world(), torn).expect("a cloth");
        let go_on = |app: &mut App, cloth: Entity| {
            tick(app, 5);
            cut_at(app, -0.62);
            tick(app, 25);
            particles(app, cloth).clone()
        };
        let expected = go_on(&mut app, torn);
        saved.restore(app.world_mut(), torn).expect("it is there");
        assert!(go_on(&mut app, torn) == expected);
        let mut other = crate::support::app();
        let clone = spawn(&mut other);
        saved
            .restore(other.world_mut(), clone)
            .expect("it is there");
        assert!(go_on(&mut other, clone) == expected);
        // Between a cut and its opening.
        cut_at(&mut app, -0.18);
        let saved = ClothSnapshot::of(app.world(), torn).expect("a cloth");
        tick(&mut app, 20);
        let expected = particles(&app, torn).clone();
        for app in [&mut app, &mut other] {
            let mut cloths = app.world_mut().query_filtered::<Entity, With<Cloth>>();
            let cloth = cloths.single(app.world()).expect("one cloth");
            saved.restore(app.world_mut(), cloth).expect("it is there");
            tick(app, 20);
            assert_eq!(app.world().get::<ClothFault>(cloth), None);
            assert!(particles(app, cloth) == &expected);
        }
        // Mended, it is the whole cloth.
        app.world_mut()
            .entity_mut(torn)
            .insert(ClothTears::default());
        tick(&mut app, 1);
        assert_eq!(surface(&app, torn).pieces(), 1);
        assert!(!surface(&app, torn).is_torn());
    }
}

/// All edges at once: each face is a piece of its own, and falls. The mass stays: shares of areas are rounded by some 10⁻⁷. No two faces
/// cross, though those that hang from pins swing among those that fall.
#[test]
fn all_edges_may_tear_at_once() {
    for cloth in [Cloth::new(12, 12, 0.1), mesh(1.1, 1.1, 0.1)] {
        let mut app = app();
        let parts = (cloth, ClothTears::default(), ClothSelfCollision::default());
        let cloth = app.world_mut().spawn(parts).id();
        tick(&mut app, 3);
        let (edges, faces) = (
            edges_where(&app, cloth, |_| true),
            surface(&app, cloth).triangles().len(),
        );
        let (mass, _) = motion(&app, cloth);
        tear(&mut app, cloth, edges);
        for ticks in [1, 9, 20] {
            tick(&mut app, ticks);
            assert_eq!(crossings(&app, cloth), 0);
        }
        assert!((motion(&app, cloth).0 / mass - 1.0).abs() < 1.0e-6);
        assert_eq!(surface(&app, cloth).pieces(), faces);
        assert_eq!(particles(&app, cloth).len(), 3 * faces);
        assert!(particles(&app, cloth).validate().is_ok());
        assert_eq!(app.world().get::<ClothFault>(cloth), None);
    }
}

#[test]
fn what_is_no_tear_is_said() {
    let mut app = app();
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(5, 5, 0.1), ClothTears::default()))
        .id();
    tick(&mut app, 2);
    // Blades that are nowhere, or miss.
    for from in [
        [Vec3::NAN; 2],
        [Vec3::INFINITY, Vec3::ZERO],
        [Vec3::splat(3.0), Vec3::splat(4.0)],
        [Vec3::ZERO; 2],
    ] {
        assert_eq!(sweep(&mut app, from, [Vec3::splat(5.0), Vec3::ONE]), 0);
    }
    let fault = |app: &App| {
        app.world()
            .get::<ClothFault>(cloth)
            .map(|fault| fault.error.clone())
    };
    let place = position(&app, cloth, (3, 3));
    tear(&mut app, cloth, [[0, 13]]);
    tick(&mut app, 1);
    assert_eq!(
        fault(&app),
        Some(ClothError::Tear(TearError::NoSuchEdge { edge: [0, 13] }))
    );
    assert_eq!(position(&app, cloth, (3, 3)), place, "it is left out");
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothTears::default());
    tick(&mut app, 1);
    assert_eq!(fault(&app), None);
    for strength in [0.0, -3.0, f32::NAN] {
        app.world_mut()
            .entity_mut(cloth)
            .insert((ClothMaterial::COTTON, ClothTearing::new(strength)));
        tick(&mut app, 1);
        assert!(
            matches!(fault(&app), Some(ClothError::Quantity(_))),
            "{strength}"
        );
    }
    let rigid = ClothMaterial {
        stretch_compliance: 0.0,
        ..ClothMaterial::COTTON
    };
    app.world_mut()
        .entity_mut(cloth)
        .insert((rigid, ClothTearing::default()));
    tick(&mut app, 1);
    assert!(matches!(fault(&app), Some(ClothError::Quantity(_))));
}

/// The drawn mesh has the faces of the torn surface: its vertices are where the particles are, with the texture of the whole.
#[test]
fn what_is_torn_is_drawn_torn() {
    let mut app = app_that_draws(FixedUpdate);
    let asset = irregular(0.8, 0.8, 0.1, 0.3);
    let whole = Mesh::new(bevy::mesh::PrimitiveTopology::TriangleList, default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, asset.positions.clone())
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, asset.normals.clone())
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, asset.uvs.clone())
        .with_inserted_indices(bevy::mesh::Indices::U32(
            asset.triangles.iter().flatten().copied().collect(),
        ));
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(whole);
    let of_asset = app
        .world_mut()
        .spawn((Cloth::mesh(), Mesh3d(handle), top(), ClothTears::default()))
        .id();
    let of_grid = app
        .world_mut()
        .spawn((Cloth::new(9, 9, 0.1), ClothTears::default()))
        .id();
    tick(&mut app, 20);
    assert!(cut_at(&mut app, -0.43) > 14);
    tick(&mut app, 8);
    for cloth in [of_asset, of_grid] {
        let handle = app
            .world()
            .get::<Mesh3d>(cloth)
            .expect("it is drawn")
            .0
            .clone();
        let mesh = app
            .world()
            .resource::<Assets<Mesh>>()
            .get(&handle)
            .expect("its mesh");
        let Some(VertexAttributeValues::Float32x3(places)) =
            mesh.attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("positions");
        };
        let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0)
        else {
            panic!("texture coordinates");
        };
        let indices: Vec<usize> = mesh.indices().expect("indices").iter().collect();
        let surface = surface(&app, cloth);
        assert_eq!(indices.len(), 3 * surface.triangles().len());
        // No side of a drawn triangle is stretched across the cut, and the texture is where it was at rest.
        for triangle in indices.chunks(3) {
            for side in 0..3 {
                let [a, b] = [triangle[side], triangle[(side + 1) % 3]];
                let long = Vec3::from(places[a]).distance(Vec3::from(places[b]));
                let at_rest = 0.8 * Vec2::from(uvs[a]).distance(Vec2::from(uvs[b]));
                assert!(long < 1.1 * at_rest, "{long} {at_rest}");
            }
        }
        assert_eq!(surface.pieces(), 2);
    }
}

/// The parts of a cloth that was cut lie still, and it falls asleep.
#[test]
fn pieces_fall_asleep() {
    let mut app = app();
    app.world_mut()
        .spawn((ClothCollider::Plane, Transform::from_xyz(0.0, -1.4, 0.0)));
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(9, 9, 0.1), ClothTears::default()))
        .id();
    tick(&mut app, 30);
    cut_at(&mut app, -0.43);
    tick(&mut app, 900);
    assert!(stats(&app, cloth).is_asleep);
    // A cut wakes it.
    cut_at(&mut app, -0.13);
    tick(&mut app, 1);
    assert!(!stats(&app, cloth).is_asleep);
    assert_eq!(surface(&app, cloth).pieces(), 3);
}

/// A flag with a patch sewn to it, of cloth that creases: cut through both, nothing is at fault, and the seam holds what is left
/// of the patch.
#[test]
fn sewn_and_creased_cloth_is_cut() {
    let mut app = app();
    let parts = (
        ClothTears::default(),
        ClothCreasing::LEATHER,
        ClothSelfCollision::default(),
    );
    let flag = app
        .world_mut()
        .spawn((Cloth::new(13, 13, 0.1), parts.clone()))
        .id();
    let before = Transform::from_xyz(0.35, -0.35, 0.01);
    let patch = (Cloth::new(9, 9, 0.0625), Pins::none(), before, parts);
    let patch = app.world_mut().spawn(patch).id();
    let border = Pin::filter(|row, column| row % 8 == 0 || column % 8 == 0);
    let middle = Pin::filter(|row, column| (3..=9).contains(&row) && (3..=9).contains(&column));
    app.world_mut()
        .spawn(ClothSeam::new((flag, middle), (patch, border)));
    tick(&mut app, 60);
    assert!(cut_at(&mut app, -0.63) > 12 + 7);
    tick(&mut app, 120);
    for cloth in [flag, patch] {
        assert_eq!(app.world().get::<ClothFault>(cloth), None);
        assert!(particles(&app, cloth).validate().is_ok());
        assert_eq!(surface(&app, cloth).pieces(), 2);
    }
    // The upper half of the patch hangs where it was, and does not slide off.
    let corner = particles(&app, patch).position(0).expect("it exists") + before.translation;
    assert!((corner.y + 0.35).abs() < 0.1, "{corner}");
}

/// A hand holds on to cloth that tears elsewhere, and a pin by its index holds all parts after its cloth is weighed again.
#[test]
fn hands_and_pins_outlast_tears() {
    let mut app = app();
    let pins = Pins::new([Pin::Index(4), Pin::at_rest(|place| place.y > -1.0e-3)]);
    let cloth = (Cloth::new(9, 9, 0.5), pins, ClothTears::default());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 10);
    let grab = ClothGrab {
        cloth,
        particle: 76,
        ..default()
    };
    let target = particles(&app, cloth).position(76).expect("it exists");
    let hand = app.world_mut().spawn(ClothGrab { target, ..grab }).id();
    tick(&mut app, 5);
    tear(&mut app, cloth, [[4, 13], [13, 22]]);
    tick(&mut app, 5);
    assert!(app.world().get::<ClothGrab>(hand).is_some());
    assert_eq!(particles(&app, cloth).is_pinned(76), Some(true));
    change::<ClothMaterial>(&mut app, cloth, |material| material.areal_density = 0.3);
    tick(&mut app, 2);
    let pinned = particles(&app, cloth)
        .inverse_masses()
        .filter(|w| *w == 0.0);
    assert_eq!(
        pinned.count(),
        9 + 1 + 1,
        "a row, one part more of it, and the hand's"
    );
    // An edge that is none, written after the preparation, stops no tick.
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothTearing::default());
    app.add_systems(
        FixedUpdate,
        (|mut tears: Query<&mut ClothTears>| {
            tears
                .iter_mut()
                .for_each(|mut tears| assert!(tears.tear([7, 9_999]) || !tears.is_empty()));
        })
        .after(ClothSystems::Integrate)
        .before(ClothSystems::WriteBack),
    );
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_some());
}

/// A balloon that is torn open has burst: it is no fault, and has no pressure.
#[test]
fn a_balloon_bursts() {
    let mut app = app_that_draws(FixedUpdate);
    let ball = Sphere::new(0.3).mesh().ico(6).expect("few vertices");
    let ball = app.world_mut().resource_mut::<Assets<Mesh>>().add(ball);
    let parts = (
        Cloth::mesh(),
        Mesh3d(ball),
        ClothPressure::Gauge(30.0),
        ClothTears::default(),
    );
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 10);
    assert!(stats(&app, cloth).gauge_pressure > 29.0);
    let face = surface(&app, cloth).triangles()[100];
    let whole = surface(&app, cloth).clone();
    change::<ClothTears>(&mut app, cloth, |tears| {
        assert_eq!(tears.tear_out(&whole, face), 3);
    });
    tick(&mut app, 10);
    assert_eq!(app.world().get::<ClothFault>(cloth), None);
    assert_eq!(surface(&app, cloth).pieces(), 2);
    assert_eq!(stats(&app, cloth).gauge_pressure, 0.0);
}

/// A fine mesh on a cloth that is cut in two loses the triangles across the cut, and no other is stretched.
#[test]
fn a_render_mesh_is_torn_too() {
    let mut app = app_that_draws(FixedUpdate);
    let fine = Plane3d::new(Vec3::Z, Vec2::splat(0.4))
        .mesh()
        .subdivisions(30)
        .build();
    let triangles = fine.indices().expect("indices").len() / 3;
    let fine = app.world_mut().resource_mut::<Assets<Mesh>>().add(fine);
    let parts = (
        Cloth::new(9, 9, 0.1),
        ClothTears::default(),
        Visibility::Hidden,
    );
    let cloth = app.world_mut().spawn(parts).id();
    let place = Transform::from_xyz(0.4, -0.4, 0.0);
    let drawn = app
        .world_mut()
        .spawn((ClothRenderMesh { cloth }, Mesh3d(fine), place))
        .id();
    tick(&mut app, 5);
    assert!(cut_at(&mut app, -0.43) > 7);
    tick(&mut app, 20);
    let handle = app
        .world()
        .get::<Mesh3d>(drawn)
        .expect("it is drawn")
        .0
        .clone();
    let mesh = app
        .world()
        .resource::<Assets<Mesh>>()
        .get(&handle)
        .expect("its mesh");
    let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        panic!("positions");
    };
    let indices: Vec<usize> = mesh.indices().expect("indices").iter().collect();
    // A row of 31 squares is across the cut.
    let left = indices.len() / 3;
    assert!(
        left < triangles && left >= triangles - 2 * 31 * 2,
        "{left} of {triangles}"
    );
    let side = 0.8 / 31.0;
    for triangle in indices.chunks(3) {
        for at in 0..3 {
            let [a, b] =
                [triangle[at], triangle[(at + 1) % 3]].map(|vertex| Vec3::from(places[vertex]));
            assert!(
                a.distance(b) < 1.2 * std::f32::consts::SQRT_2 * side,
                "{a} {b}"
            );
        }
    }
}
