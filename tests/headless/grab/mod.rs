//! Rays that hit cloth, and hands that hold it.

mod life;

use bevy::{
    ecs::{entity_disabling::Disabled, system::SystemState},
    prelude::*,
};
use bevy_drape::{plugin::ClothBuilt, prelude::*};

use crate::{shared_meshes::irregular, support::*};

/// The first hit of a ray.
fn cast(app: &mut App, ray: Ray3d) -> Option<ClothHit> {
    let mut state = SystemState::<ClothRayCast>::new(app.world_mut());
    let mut rays = state
        .get_mut(app.world_mut())
        .expect("it reads cloths alone");
    rays.cast(ray, f32::INFINITY)
}

/// Takes hold of a particle, where it is.
fn take(app: &mut App, cloth: Entity, particle: usize) -> Entity {
    let target = place(app, cloth, particle);
    let grab = ClothGrab {
        cloth,
        particle: particle as u32,
        target,
        ..default()
    };
    app.world_mut().spawn(grab).id()
}

/// Where a particle is in the world (m).
fn place(app: &App, cloth: Entity, particle: usize) -> Vec3 {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let place = particles(app, cloth).position(particle);
    frame.to_world(place.expect("it exists"))
}

fn aim(app: &mut App, hand: Entity, target: Vec3) {
    change::<ClothGrab>(app, hand, |grab| grab.target = target);
}

/// How far a hand is from what pins a particle, as the cloth lies at rest (m).
fn at_rest(app: &App, cloth: Entity, particles: [usize; 2]) -> f32 {
    let built = app.world().get::<ClothBuilt>(cloth).expect("it is built");
    let [a, b] = particles.map(|particle| built.surface().rest_positions()[particle]);
    a.distance(b)
}

fn pinned(app: &App, cloth: Entity) -> Vec<usize> {
    let all = particles(app, cloth).inverse_masses().enumerate();
    all.filter(|(_, w)| *w == 0.0)
        .map(|(index, _)| index)
        .collect()
}

/// A ray finds the nearest of several cloths, its face and the point on it, wherever they are, turned and scaled.
#[test]
fn a_ray_finds_the_nearest_cloth() {
    let mut app = app();
    let turned = Transform::from_xyz(0.3, 2.0, -1.0)
        .with_rotation(Quat::from_rotation_y(0.4))
        .with_scale(Vec3::new(2.0, 1.0, 1.5));
    let all = Pins::filter(|_, _| true);
    let mut spawn = |place: Transform| {
        let cloth = (Cloth::new(9, 9, 0.1).centred(), all.clone(), place);
        app.world_mut().spawn(cloth).id()
    };
    let near = spawn(turned);
    let far = spawn(turned.with_translation(Vec3::new(0.3, 2.0, -3.0)));
    let ray = Ray3d::new(Vec3::new(0.35, 2.1, 4.0), Dir3::NEG_Z);
    assert_eq!(cast(&mut app, ray), None, "no tick has built anything");
    tick(&mut app, 1);
    let hit = cast(&mut app, ray).expect("it is in front of both");
    assert_eq!(hit.cloth, near);
    // Its plane goes through its middle, at an angle of 0.4 to the x axis.
    let expected = Vec3::new(0.35, 2.1, -1.0 - 0.05 * 0.4_f32.tan());
    assert!(
        hit.point.distance(expected) < 2.0e-6,
        "{} {expected}",
        hit.point
    );
    assert!((hit.distance - (4.0 - expected.z)).abs() < 2.0e-6);
    let normal = Vec3::new(0.4_f32.sin(), 0.0, 0.4_f32.cos());
    assert!(hit.normal.distance(normal) < 1.0e-6, "{}", hit.normal);
    let each = hit.particles.iter().zip(hit.weights);
    let point: Vec3 = each
        .map(|(&of, w)| w * place(&app, near, of as usize))
        .sum();
    assert!(point.distance(hit.point) < 2.0e-6);
    let built = app.world().get::<ClothBuilt>(near).expect("it is built");
    assert_eq!(built.surface().triangles()[hit.face], hit.particles);
    // Rays anywhere else, each with its nearest particle of the sheet.
    for step in 0..400 {
        let (across, up) = (
            (step % 20) as f32 / 13.0 - 0.4,
            (step / 20) as f32 / 26.0 + 1.6,
        );
        let Some(hit) = cast(
            &mut app,
            Ray3d::new(Vec3::new(across, up, 4.0), Dir3::NEG_Z),
        ) else {
            continue;
        };
        let far = |particle: u32| place(&app, hit.cloth, particle as usize).distance(hit.point);
        let nearest = hit
            .particles
            .into_iter()
            .map(far)
            .fold(f32::INFINITY, f32::min);
        assert_eq!(far(hit.particle), nearest);
    }
    // From behind, the other one is nearer.
    let behind = Ray3d::new(Vec3::new(0.35, 2.1, -9.0), Dir3::Z);
    let hit = cast(&mut app, behind).expect("both");
    assert_eq!(hit.cloth, far);
    assert!(hit.normal.distance(-normal) < 1.0e-6, "{}", hit.normal);
    let mut state = SystemState::<ClothRayCast>::new(app.world_mut());
    let mut rays = state
        .get_mut(app.world_mut())
        .expect("it reads cloths alone");
    let other = rays.cast_where(ray, f32::INFINITY, |cloth| cloth != near);
    assert_eq!(other.map(|hit| hit.cloth), Some(far));
    assert_eq!(rays.cast(ray, 1.0), None);
}

/// The particle is where the hand is, to the last rounding, and the rest hangs from it. Let go, all is as before.
#[test]
fn a_hand_takes_cloth_along_and_lets_go() {
    let mut app = app();
    let sheet = (Cloth::new(20, 20, 0.05), Transform::from_xyz(0.0, 2.0, 0.0));
    let cloth = app.world_mut().spawn(sheet).id();
    tick(&mut app, 32);
    let before = pinned(&app, cloth);
    let masses: Vec<f32> = particles(&app, cloth).inverse_masses().collect();
    let middle = 10 * 20 + 10;
    let start = place(&app, cloth, middle);
    let hand = take(&mut app, cloth, middle);
    tick(&mut app, 1);
    assert!(place(&app, cloth, middle).distance(start) < 1.0e-6);
    for step in 1..=32 {
        let target = start + Vec3::new(0.0, 0.004, 0.006) * step as f32;
        aim(&mut app, hand, target);
        tick(&mut app, 1);
        let hand = app.world().get::<Transform>(hand).expect("a place");
        // By an offset that is added and taken away.
        assert!(hand.translation.distance(target) < 1.0e-6);
        assert!(place(&app, cloth, middle).distance(target) < 1.0e-6);
    }
    assert_eq!(pinned(&app, cloth).len(), before.len() + 1);
    assert!(app.world().get::<ClothFault>(hand).is_none());
    app.world_mut().despawn(hand);
    tick(&mut app, 1);
    assert_eq!(pinned(&app, cloth), before);
    let after: Vec<f32> = particles(&app, cloth).inverse_masses().collect();
    assert_eq!(after, masses);
    let held = app.world().get::<ClothAttachments>(cloth);
    assert!(held.is_some_and(|held| held.iter().len() == 0));
    tick(&mut app, 256);
    // It still swings a little.
    assert!(place(&app, cloth, middle).distance(start) < 0.05);
}

/// A hand that pulls away stops where cloth from the pin to it is taut: its length at rest, straight on a flat sheet, and
/// 2 % more. On a grid and on a mesh; towards anywhere.
#[test]
fn a_hand_pulls_no_farther_than_the_cloth_reaches() {
    let mesh = irregular(0.95, 0.95, 0.05, 0.3);
    let last = mesh.positions.len() - 1;
    let mesh = Cloth::triangles(mesh.positions.clone(), mesh.triangles.clone());
    let cloths = [
        ("grid", Cloth::new(20, 20, 0.05), Pin::Index(0), 399),
        ("mesh", mesh, Pin::Vertex(0), last),
    ];
    for (name, cloth, pin, vertex) in cloths {
        for direction in [Vec3::X, Vec3::Y, Vec3::new(1.0, 2.0, -3.0).normalize()] {
            let mut app = app();
            let cloth = (cloth.clone(), Pins::new([pin.clone()]));
            let cloth = app.world_mut().spawn(cloth).id();
            tick(&mut app, 64);
            let built = app.world().get::<ClothBuilt>(cloth).expect("it is built");
            let particle = |vertex| built.surface().particle_of_vertex(vertex);
            let [pin, held] = [0, vertex].map(|vertex| particle(vertex).expect("a corner"));
            let hand = take(&mut app, cloth, held);
            tick(&mut app, 1);
            let start = place(&app, cloth, held);
            aim(&mut app, hand, start + 10.0 * direction);
            tick(&mut app, 320);
            let length = at_rest(&app, cloth, [pin, held]);
            let found = place(&app, cloth, pin).distance(place(&app, cloth, held));
            assert!(
                (found / length - 1.02).abs() < 1.0e-4,
                "{name}: {found} {length}"
            );
            // Straight towards the target.
            let along = (place(&app, cloth, held) - place(&app, cloth, pin)).normalize();
            let wanted = (start + 10.0 * direction - place(&app, cloth, pin)).normalize();
            assert!(along.dot(wanted) > 0.999, "{name}: {along} {wanted}");
            let stretch = stats(&app, cloth).stretch.structural;
            println!("{name}, {direction}: stretched by {:.1} %", 100.0 * stretch);
            // Irregular meshes are less stiff around a single particle.
            assert!(stretch < 0.2, "{name}: {stretch}");
        }
    }
}

/// Two hands that pull a free sheet apart stop where it is taut between them.
#[test]
fn two_hands_pull_a_sheet_taut() {
    let mut app = app();
    let cloth = (Cloth::new(16, 16, 0.05), Pins::none());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    let held = [0, 255];
    let hands = held.map(|particle| take(&mut app, cloth, particle));
    tick(&mut app, 2);
    for (hand, direction) in hands
        .into_iter()
        .zip([Vec3::new(-1.0, 1.0, 0.0), Vec3::new(1.0, -1.0, 0.0)])
    {
        aim(&mut app, hand, 5.0 * direction);
    }
    tick(&mut app, 128);
    for entity in [cloth, hands[0], hands[1]] {
        assert_eq!(app.world().get::<ClothFault>(entity), None);
    }
    assert_eq!(pinned(&app, cloth), held);
    let [a, b] = held.map(|particle| place(&app, cloth, particle));
    let length = at_rest(&app, cloth, held);
    let ratio = a.distance(b) / length;
    // The other hand's particle counts as a pin.
    assert!((ratio - 1.02).abs() < 1.0e-4, "{ratio}");
}

/// On a cloth that nothing pins, a hand goes everywhere, at its speed.
#[test]
fn a_hand_is_as_fast_as_it_may_be() {
    let mut app = app();
    let cloth = (Cloth::new(8, 8, 0.05), Pins::none());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    let hand = take(&mut app, cloth, 0);
    change::<ClothGrab>(&mut app, hand, |grab| grab.speed = 2.0);
    tick(&mut app, 1);
    let start = place(&app, cloth, 0);
    aim(&mut app, hand, start + 3.0 * Vec3::Y);
    for step in 1..=32 {
        tick(&mut app, 1);
        let risen = place(&app, cloth, 0).y - start.y;
        let expected = 2.0 * TICK * step as f32;
        assert!((risen - expected).abs() < 1.0e-5, "{risen} {expected}");
    }
    tick(&mut app, 96);
    assert_eq!(place(&app, cloth, 0), start + 3.0 * Vec3::Y);
}

/// A game's own attachments and a hand's do not disturb each other, even where the game writes its own anew.
#[test]
fn attachments_of_the_game_stay() {
    let mut app = app();
    let pole = app.world_mut().spawn(Transform::default()).id();
    let own = ClothAttachments::new([(Pin::Column(0), pole)]);
    let cloth = (Cloth::new(10, 10, 0.05), Pins::none(), own.clone());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 2);
    let before = pinned(&app, cloth);
    let hand = take(&mut app, cloth, 99);
    tick(&mut app, 2);
    let held = pinned(&app, cloth);
    assert!(held.len() == before.len() + 1 && held.contains(&99));
    app.world_mut().entity_mut(cloth).insert(own.clone());
    tick(&mut app, 2);
    assert_eq!(pinned(&app, cloth), held);
    // A hand does not let go of the game's pins.
    let other = take(&mut app, cloth, 50);
    tick(&mut app, 2);
    app.world_mut().entity_mut(other).remove::<ClothGrab>();
    app.world_mut().despawn(hand);
    tick(&mut app, 1);
    assert_eq!(pinned(&app, cloth), before);
    assert_eq!(app.world().get::<ClothAttachments>(cloth), Some(&own));
}

/// Bad input is a fault of the hand, by its quantity and value. The cloth goes on, and so does the hand once it is
/// mended.
#[test]
fn bad_hands_have_faults() {
    type Spoil = fn(&mut ClothGrab);
    let spoilt: [(&str, Spoil); 6] = [
        ("target", |grab| grab.target.y = f32::NAN),
        ("target", |grab| grab.target.x = f32::INFINITY),
        ("target", |grab| grab.target.z = 1.0e13),
        ("stretch", |grab| grab.stretch = f32::NAN),
        ("speed", |grab| grab.speed = -0.1),
        ("100", |grab| grab.particle = 100),
    ];
    for (name, spoil) in spoilt {
        let mut app = app();
        let cloth = app.world_mut().spawn(Cloth::new(10, 10, 0.05)).id();
        tick(&mut app, 1);
        let hand = take(&mut app, cloth, 55);
        let good = app.world().get::<ClothGrab>(hand).expect("a hand").clone();
        change::<ClothGrab>(&mut app, hand, spoil);
        tick(&mut app, 2);
        let fault = app.world().get::<ClothFault>(hand);
        let text = fault.expect("a fault").error.to_string();
        assert!(text.contains(name), "{name}: {text}");
        assert!(app.world().get::<ClothFault>(cloth).is_none(), "{name}");
        assert!(stats(&app, cloth).substeps > 0, "{name}");
        change::<ClothGrab>(&mut app, hand, |grab| *grab = good.clone());
        tick(&mut app, 2);
        assert!(app.world().get::<ClothFault>(hand).is_none(), "{name}");
        assert!(pinned(&app, cloth).contains(&55), "{name}");
    }
    let mut app = app();
    // Neither below another entity, nor on the cloth itself.
    let cloth = app.world_mut().spawn(Cloth::new(10, 10, 0.05)).id();
    tick(&mut app, 1);
    let parent = app.world_mut().spawn(Transform::default()).id();
    let child = take(&mut app, cloth, 55);
    app.world_mut().entity_mut(child).insert(ChildOf(parent));
    let own = ClothGrab { cloth, ..default() };
    app.world_mut().entity_mut(cloth).insert(own);
    tick(&mut app, 2);
    for alone in [child, cloth] {
        let fault = app.world().get::<ClothFault>(alone).expect("a fault");
        assert_eq!(fault.error, TargetError::HandNotAlone.into());
    }
    assert!(!pinned(&app, cloth).contains(&55));
    let hand = app.world_mut().spawn(ClothGrab::default()).id();
    tick(&mut app, 2);
    let fault = app.world().get::<ClothFault>(hand).expect("a fault");
    let cloth = Entity::PLACEHOLDER;
    assert_eq!(fault.error, TargetError::NoSuchCloth { cloth }.into());
    let cloth = app.world_mut().spawn(Cloth::new(4, 4, 0.1)).id();
    change::<ClothGrab>(&mut app, hand, |grab| grab.cloth = cloth);
    tick(&mut app, 2);
    assert!(app.world().get::<ClothFault>(hand).is_none());
}
