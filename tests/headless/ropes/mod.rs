//! Ropes: hung, laid over things, tied to cloth, and what they carry.

mod layers;
mod paths;

use bevy::{
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_drape::{plugin::ClothBuilt, prelude::*};
use bevy_rapier3d::prelude::{Collider, ColliderMassProperties, RigidBody};

use crate::{fuzz::random::Random, rapier::app_with_rapier, support::*};

/// Air and the material take the swing of what hangs.
fn damped() -> ClothMaterial {
    ClothMaterial {
        damping: 0.5,
        ..ClothMaterial::COTTON
    }
}

/// 0.16 kg for a metre of 2 cm, which stretches by 0.005 % under 1 N.
fn hemp() -> ClothMaterial {
    ClothMaterial {
        areal_density: 8.0,
        stretch_compliance: 1.0e-6,
        ..damped()
    }
}

fn spawn(app: &mut App, rope: impl Bundle) -> Entity {
    let rope = app.world_mut().spawn(rope).id();
    tick(app, 1);
    assert_eq!(app.world().get::<ClothFault>(rope), None);
    rope
}

/// The particles in the world (m).
fn places(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let all = particles(app, cloth).positions();
    all.map(|place| frame.to_world(place)).collect()
}

fn length(places: &[Vec3]) -> f32 {
    places
        .windows(2)
        .map(|ends| ends[0].distance(ends[1]))
        .sum()
}

/// The radius of curvature a at the lowest point of a chain of some length between supports at one height, and its sag f (m):
/// `L = 2 a sinh(d ⁄ 2a)`, `f = a (cosh(d ⁄ 2a) − 1)`.
fn catenary(length: f64, distance: f64) -> [f32; 2] {
    let (mut low, mut high) = (1.0e-3_f64, 1.0e3_f64);
    for _ in 0..200 {
        let a = (low * high).sqrt();
        // The larger a, the straighter.
        if 2.0 * a * (distance / 2.0 / a).sinh() > length {
            low = a;
        } else {
            high = a;
        }
    }
    let sag = low * ((distance / 2.0 / low).cosh() - 1.0);
    [low, sag].map(|of| of as f32)
}

/// A rope pinned by its first particle hangs straight down. Between two pins it hangs as a catenary does, whatever its resolution:
/// a chain of n straight links is off by (1 ⁄ n)² of the sag, and the arc of its lowest link by h² ⁄ 8a, or by less than 1 ⁄ 500 of the
/// sag. Cotton stretches by less than 10⁻⁴ under this weight.
#[test]
fn it_hangs_as_a_chain_does() {
    for count in [11, 24, 65] {
        let spacing = 2.0 / (count - 1) as f32;
        let mut app = app();
        let free = spawn(&mut app, (Cloth::rope(count, spacing, 0.01), damped()));
        let between = Pins::new([Pin::Index(0), Pin::Index(count as usize - 1)]);
        let rope = (Cloth::rope(count, spacing, 0.01).lying(), between, damped());
        let rope = spawn(&mut app, rope);
        // The supports come closer: 1.2 m for 2 m of rope.
        for step in 1..=64 {
            let x = 2.0 - 0.8 * step as f32 / 64.0;
            change::<ClothParticles>(&mut app, rope, |particles| {
                particles
                    .set_position(count as usize - 1, Vec3::X * x)
                    .expect("it exists");
            });
            tick(&mut app, 1);
        }
        tick(&mut app, 1500);
        let hung = places(&app, free);
        let end = hung[count as usize - 1];
        assert!(end.distance(Vec3::NEG_Y * 2.0) < 1.0e-3, "{count}: {end}");
        let all = places(&app, rope);
        let sag = all.iter().map(|place| -place.y).fold(0.0, f32::max);
        let [radius, truth] = catenary(2.0, 1.2);
        println!("{count} particles: sag {sag} m, catenary {truth} m");
        let lowest = (spacing * spacing / (8.0 * radius)).min(2.0e-3 * truth);
        let tolerance = truth * (1.0 / (count - 1) as f32).powi(2) + lowest;
        assert!(
            (sag - truth).abs() < tolerance,
            "{count}: {sag} m, {truth} m"
        );
        assert!((length(&all) - 2.0).abs() < 2.0e-3, "{count}");
    }
}

/// It bends under its weight as a strip of two columns does that is as wide as the rope is thick: both are one beam. The strip may twist,
/// and does not.
#[test]
fn it_bends_as_a_strip_of_its_width() {
    let material = ClothMaterial {
        bend_rigidity: 4.0e-3,
        damping: 0.5,
        ..ClothMaterial::COTTON
    };
    let drop = |cloth: Cloth, pins: Vec<Pin>, place: Transform, last: usize| {
        let mut app = app();
        let cloth = spawn(&mut app, (cloth, Pins::new(pins), material, place));
        tick(&mut app, 1200);
        places(&app, cloth)[last].y
    };
    let rope = Cloth::rope(17, 0.02, 0.01).lying();
    let held = vec![Pin::Index(0), Pin::Index(1)];
    let rope = drop(rope, held, Transform::default(), 16);
    let strip = Cloth::new(17, 2, 0.02).lying();
    let held = vec![Pin::Column(0), Pin::Column(1)];
    let strip = drop(strip, held, Transform::default(), 16);
    assert!(strip < -0.01, "{strip} m");
    assert!(
        (rope - strip).abs() < 0.01 * strip.abs(),
        "{rope} m, {strip} m"
    );
}

/// It lies at its radius on a ball that is large or small for its spacing, also where both are scaled, and hangs down on both sides.
#[test]
fn it_hangs_over_a_ball() {
    for (ball, scale) in [(0.4, 1.0), (0.05, 1.0), (0.2, 2.0)] {
        let mut app = app();
        let place = Transform::from_xyz(0.0, ball + 0.05, 0.0).with_scale(Vec3::splat(scale));
        let rope = Cloth::rope(61, 0.025 / scale, 0.02 / scale);
        let rope = spawn(&mut app, (rope.lying().centred(), Pins::none(), place));
        app.world_mut().spawn(ClothCollider::ball(ball));
        tick(&mut app, 40);
        let distances = places(&app, rope).into_iter().map(Vec3::length);
        let nearest = distances.fold(f32::MAX, f32::min);
        // It may bounce off by a little.
        let reach = ball + 0.02;
        assert!(
            nearest > reach - 5.0e-4 && nearest < reach + 5.0e-3,
            "{ball}: {nearest} m"
        );
    }
}

/// Tied by its ends to the corners of a sail, two ropes hold it: a rope's last particle is where the corner is.
#[test]
fn it_ties_a_sail_by_its_corners() {
    let mut app = app();
    let sail = (
        Cloth::new(21, 21, 0.05),
        Pins::none(),
        damped(),
        Transform::from_xyz(0.0, -0.5, 0.0),
    );
    let sail = spawn(&mut app, sail);
    for (x, corner) in [(0.0, Corner::TopLeft), (1.0, Corner::TopRight)] {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        let rope = spawn(&mut app, (Cloth::rope(11, 0.05, 0.005), hemp(), place));
        let seam = ClothSeam::new((rope, Pin::Index(10)), (sail, Pin::Corner(corner)));
        app.world_mut().spawn(seam);
    }
    tick(&mut app, 640);
    let own = places(&app, sail);
    let mut ropes = app
        .world_mut()
        .query_filtered::<(Entity, &Cloth), Without<ClothSeam>>();
    let is_rope = |cloth: &Cloth| cloth.shape.is_rope();
    let ropes: Vec<Entity> = ropes
        .iter(app.world())
        .filter_map(|(entity, cloth)| is_rope(cloth).then_some(entity))
        .collect();
    assert_eq!(ropes.len(), 2);
    for (rope, corner) in ropes.into_iter().zip([own[0], own[20]]) {
        let all = places(&app, rope);
        let end = all[10];
        assert!(end.distance(corner) < 2.0e-3, "{end} {corner}");
        assert!(length(&all) < 0.5 * 1.02, "{}", length(&all));
    }
    assert!(own.iter().all(|place| place.y < 0.0 && place.y > -1.7));
}

/// Two slings hold a plank that rapier moves: it comes to rest in them, level, above where the ropes are when they are taut.
#[test]
fn two_of_them_hold_a_plank() {
    let mut app = app_with_rapier();
    for x in [-0.3, 0.3] {
        let ends = Pins::new([Pin::Index(0), Pin::Index(50)]);
        let rope = (
            Cloth::rope(51, 0.02, 0.01),
            ends,
            hemp(),
            ClothSettings::substeps(60),
            Transform::from_xyz(x, 1.0, 0.0),
        );
        let rope = spawn(&mut app, rope);
        // Down, across below the plank, and up.
        change::<ClothParticles>(&mut app, rope, |particles| {
            for index in 0..51 {
                let along = 0.02 * index as f32;
                let place = Vec3::new(
                    0.0,
                    -along.min(1.0 - along).min(0.35),
                    (along - 0.35).clamp(0.0, 0.3) - 0.15,
                );
                particles.set_position(index, place).expect("it exists");
            }
        });
    }
    let plank = (
        RigidBody::Dynamic,
        Collider::cuboid(0.45, 0.02, 0.14),
        ColliderMassProperties::Mass(2.0),
        RapierClothCollider,
        ClothPushBack,
        Transform::from_xyz(0.0, 0.7, 0.0),
    );
    let plank = app.world_mut().spawn(plank).id();
    tick(&mut app, 640);
    let place = app.world().get::<Transform>(plank).expect("a place");
    let up = place.rotation * Vec3::Y;
    println!("the plank is at {}, up is {up}", place.translation);
    // Less than the rope's radius: it does not sink into the ropes.
    assert!(
        (place.translation.y - 0.68).abs() < 0.01,
        "{}",
        place.translation
    );
    assert!(up.y > 0.99, "{up}");
}

/// It keeps its place when its resolution changes, and is picked, taken and let go.
#[test]
fn it_is_refined_and_taken() {
    let mut app = app();
    let rope = spawn(&mut app, (Cloth::rope(11, 0.1, 0.01), damped()));
    tick(&mut app, 600);
    let before = places(&app, rope)[10];
    app.world_mut()
        .entity_mut(rope)
        .insert(Cloth::rope(41, 0.025, 0.01));
    tick(&mut app, 1);
    let all = places(&app, rope);
    assert_eq!(all.len(), 41);
    assert!(all[40].distance(before) < 1.0e-3);
    let hit = app
        .world_mut()
        .run_system_cached(|mut rays: ClothRayCast| {
            let at = |x| Ray3d::new(Vec3::new(x, -0.51, 3.0), Dir3::NEG_Z);
            assert_eq!(rays.cast(at(0.02), 10.0), None);
            rays.cast(at(0.009), 10.0)
        })
        .expect("a system")
        .expect("the rope is there");
    assert_eq!((hit.cloth, hit.particle), (rope, 20));
    let hand = app.world_mut().spawn(hit.grab()).id();
    tick(&mut app, 2);
    change::<ClothGrab>(&mut app, hand, |grab| grab.target += Vec3::X * 0.3);
    tick(&mut app, 200);
    let held = places(&app, rope)[20];
    assert!(held.x > 0.25, "{held}");
    app.world_mut().despawn(hand);
    tick(&mut app, 1200);
    let held = places(&app, rope)[20];
    assert!(held.x.abs() < 0.02, "{held}");
}

/// A bad rope gets a fault that names the value, and nothing else stops.
#[test]
fn a_bad_rope_is_a_fault() {
    let mut app = app();
    let other = spawn(&mut app, Cloth::rope(8, 0.1, 0.01));
    for wrong in [
        Cloth::rope(1, 0.1, 0.01),
        Cloth::rope(8, 0.0, 0.01),
        Cloth::rope(8, 0.1, f32::NAN),
        Cloth::rope_along([], 0.1, 0.01),
        Cloth::rope_along([Vec3::ZERO, Vec3::X], 0.0, 0.01),
    ] {
        let rope = app.world_mut().spawn(wrong).id();
        tick(&mut app, 2);
        let fault = app.world().get::<ClothFault>(rope).expect("a fault");
        let text = fault.error.to_string();
        assert!(text.contains("rope"), "{text}");
    }
    assert_eq!(app.world().get::<ClothFault>(other), None);
}

/// A hundred ropes of any size, held anywhere, in wind, over a ball, with layers or without: all stay finite, and none is longer than it was by
/// more than a tenth.
#[test]
fn random_ropes_hold() {
    let mut random = Random(31);
    let mut longest = 0.0_f32;
    let mut app = app();
    app.insert_resource(ClothWind {
        velocity: Vec3::new(4.0, 0.0, 1.0),
        ..default()
    });
    let mut all = Vec::new();
    for number in 0..100 {
        let count = 2 + random.below(70) as u32;
        let (long, radius) = (0.3 + 2.0 * random.part(), 0.002 + 0.03 * random.part());
        let material = ClothMaterial {
            areal_density: 0.1 + 8.0 * random.part(),
            bend_rigidity: if random.one_in(2) {
                0.0
            } else {
                0.02 * random.part()
            },
            ..ClothMaterial::COTTON
        };
        let pins = match random.below(3) {
            0 => Pins::default(),
            1 => Pins::new([Pin::Index(0), Pin::Index(count as usize - 1)]),
            _ => Pins::none(),
        };
        let turn =
            Quat::from_rotation_z(6.0 * random.part()) * Quat::from_rotation_x(3.0 * random.part());
        let place = Vec3::new(5.0 * (number % 10) as f32, 0.0, 5.0 * (number / 10) as f32);
        let rope = Cloth::rope(count, long / (count - 1) as f32, radius);
        let rope = if random.one_in(2) { rope.lying() } else { rope };
        let place = Transform::from_translation(place).with_rotation(turn);
        let mut rope = app.world_mut().spawn((rope, pins, material, place));
        if random.one_in(3) {
            let spacing = long / (count - 1) as f32;
            rope.insert(ClothSelfCollision::of_thickness(spacing.min(0.02) / 4.0));
        }
        let rope = rope.id();
        let ball = place.translation + Vec3::new(0.2, -0.6, 0.1);
        app.world_mut()
            .spawn((ClothCollider::ball(0.3), Transform::from_translation(ball)));
        all.push((rope, long, ball, 0.3 + radius));
    }
    for _ in 0..240 {
        tick(&mut app, 1);
        for (rope, long, ..) in &all {
            let own = places(&app, *rope);
            assert!(own.iter().all(|place| place.is_finite()));
            longest = longest.max(length(&own) / long - 1.0);
        }
    }
    println!(
        "of 100 random ropes the longest was stretched by {:.2} %",
        100.0 * longest
    );
    assert!(longest < 0.1, "{longest}");
    let mut deepest = 0.0_f32;
    for (rope, _, ball, reach) in all {
        for (place, inverse_mass) in places(&app, rope)
            .into_iter()
            .zip(particles(&app, rope).inverse_masses())
        {
            if inverse_mass > 0.0 {
                deepest = deepest.max(reach - place.distance(ball));
            }
        }
        assert_eq!(app.world().get::<ClothFault>(rope), None);
    }
    println!("and the deepest in a ball by {:.3} mm", 1.0e3 * deepest);
    // As what hangs over a ball.
    assert!(deepest < 5.0e-4, "{deepest} m");
}
