//! What happens when a ball and a cloth meet.

use bevy::{ecs::entity_disabling::Disabled, prelude::*};
use bevy_drape::{
    contact::{
        ColliderShape, ContactSettings, Detection, MovingCollider, NarrowPhase, deepest_penetration,
    },
    hierarchy::NodeState,
    hierarchy::{BoundRule, BoundingVolume},
    plugin::{ClothBuilt, ClothSearch},
    prelude::*,
    solver::{Bending, Solver, TickStep},
};

use crate::support::*;

/// The ball comes, passes through, and goes: green, red, green; and messages at both ends.
#[test]
fn spheres_turn_red_and_back_green() {
    for rule in [BoundRule::RestShape, BoundRule::Refit, BoundRule::Paper] {
        let mut app = app_with_moving_balls();
        let (cloth, ball) = spawn_pass(&mut app);
        let method = SearchMethod::Tree(BoundingVolume::Sphere, rule);
        app.world_mut().entity_mut(cloth).insert(method);
        tick(&mut app, 10);
        assert_eq!(red(&app, cloth), [0; 5], "{rule:?}");
        assert!(messages::<ClothTouchStarted>(&mut app).is_empty());
        // A cloth that is hit may bounce off for some ticks.
        let mut most = 0;
        for _ in 0..60 {
            tick(&mut app, 1);
            let stats = app.world().get::<ClothStats>(cloth).expect("figures");
            let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
            let particles = contacts.with(ball).map_or(0, |contact| contact.particles);
            assert_eq!(stats.contacts, particles);
            let reds = red(&app, cloth);
            assert!(reds[4] >= particles, "what touches is red");
            if particles > most {
                most = particles;
                assert!(
                    reds[..4].iter().all(|&red| red > 0) && reds[4] < 256,
                    "{rule:?}: {reds:?}"
                );
                assert!(stats.leaf_tests > 0 && stats.leaf_tests < stats.nodes_visited);
            }
        }
        assert!(most > 10, "{rule:?}: {most}");
        let started = messages::<ClothTouchStarted>(&mut app);
        let first = started.first().expect("a message");
        assert!(
            first.cloth == cloth && first.collider == ball && first.particles > 0,
            "{first:?}"
        );
        assert!(first.deepest_penetration > 0.0, "{first:?}");
        tick(&mut app, 400);
        assert_eq!(red(&app, cloth), [0; 5], "{rule:?}");
        let search = app.world().get::<ClothSearch>(cloth).expect("a search");
        let built = app.world().get::<ClothBuilt>(cloth).expect("a tree");
        let states = search.query().states(built.tree());
        let is_unvisited = |state: &NodeState| *state == NodeState::Unvisited;
        assert!(states[1..].iter().all(is_unvisited));
        let started = started.len() + messages::<ClothTouchStarted>(&mut app).len();
        let stopped = messages::<ClothTouchStopped>(&mut app);
        assert_eq!(stopped.len(), started, "what starts stops");
        assert!(
            stopped
                .iter()
                .all(|reported| reported.deepest_penetration > 0.0 && reported.particles > 0)
        );
        assert!(stopped.iter().any(|reported| reported.particles > 10));
    }
}

/// Whatever is searched, and how, the same contacts are found: bit by bit the same motion. The paper's rule excepted.
#[test]
fn complete_methods_give_the_same_motion() {
    let run = |method| {
        let mut app = app_with_moving_balls();
        let (cloth, _) = spawn_pass(&mut app);
        app.world_mut().entity_mut(cloth).insert(method);
        tick(&mut app, 90);
        let mut positions: Vec<Vec3> = particles(&app, cloth).positions().collect();
        positions.push(Vec3::splat(
            app.world()
                .get::<ClothStats>(cloth)
                .expect("figures")
                .contacts as f32,
        ));
        positions
    };
    let scanned = run(SearchMethod::Scan);
    for method in SearchMethod::ALL {
        if method.rule() != Some(BoundRule::Paper) {
            assert_eq!(run(method), scanned, "{method}");
        }
    }
}

/// A ball that lies in a cloth held by its rim: no particle deeper than 1 % of its radius, nor any point of the
/// flat triangles between them.
#[test]
fn a_resting_ball_does_not_sink_in() {
    let mut app = app_with_moving_balls();
    let radius = 0.3;
    let cloth = Cloth::new(33, 33, 0.05);
    let rim = Pins::filter(|row, column| row % 32 == 0 || column % 32 == 0);
    let slack = ClothMaterial {
        stretch_compliance: 5.0e-3,
        shear_compliance: 1.0e-2,
        ..default()
    };
    let flat = Transform::from_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let entity = app.world_mut().spawn((cloth, rim, slack, flat)).id();
    // In the cloth's middle, coming down along the world's y.
    let at = |height: f32| Transform::from_xyz(0.8, height, 0.8);
    let ball = app
        .world_mut()
        .spawn((ClothCollider::ball(radius), at(radius + 0.1)))
        .id();
    for step in 0..128 {
        let height = radius + 0.1 - 0.4 * step as f32 / 127.0;
        change::<Transform>(&mut app, ball, |transform| *transform = at(height));
        tick(&mut app, 1);
    }
    tick(&mut app, 128);

    let world = app.world();
    let frame = world.get::<ClothFrame>(entity).expect("a frame");
    let settings = world.get::<ClothSettings>(entity).expect("settings");
    let particles = particles(&app, entity);
    let centre = frame.from_world(
        world
            .get::<Transform>(ball)
            .expect("a transform")
            .translation,
    );
    let contact = *world
        .get::<ClothContacts>(entity)
        .expect("contacts")
        .with(ball)
        .expect("a contact");
    assert!(contact.particles > 30, "{contact:?}");
    let ball = ColliderShape::Ball { radius };
    let pose = Isometry3d::from_translation(centre);
    let left = deepest_penetration(particles, &ball, pose, settings.particle_radius);
    assert!(left < 0.01 * f64::from(radius), "{left} m of {radius}");

    let built = world.get::<ClothBuilt>(entity).expect("what was built");
    let mut deepest = 0.0_f32;
    for triangle in built.surface().triangles() {
        let [a, b, c] =
            triangle.map(|index| particles.position(index as usize).expect("a particle"));
        // The sagitta is largest in the middle of the longest edge; the middle and the edges' middles show it.
        for point in [
            (a + b + c) / 3.0,
            (a + b) / 2.0,
            (b + c) / 2.0,
            (a + c) / 2.0,
        ] {
            deepest = deepest.max(radius - point.distance(centre));
        }
    }
    assert!(deepest < 0.01 * radius, "{deepest} m of {radius}");
}

/// The first cloth does not notice a second pair, nor a bullet far away: bit for bit, and node for node.
#[test]
fn a_second_cloth_and_ball_do_not_disturb_the_first() {
    let run = |second: bool| {
        let mut app = app_with_moving_balls();
        let (cloth, ball) = spawn_pass(&mut app);
        if second {
            let place = Transform::from_xyz(5.0, 0.0, 0.0);
            let other = app.world_mut().spawn((Cloth::new(9, 21, 0.07), place)).id();
            let place = Transform::from_xyz(5.3, -0.7, -1.0);
            let other_ball = (ClothCollider::ball(0.2), Moving(1.0), place);
            let other_ball = app.world_mut().spawn(other_ball).id();
            let place = Transform::from_xyz(200.0, 0.0, 0.0);
            let bullet = (ClothCollider::ball(0.2), Moving(300.0), place);
            app.world_mut().spawn(bullet);
            tick(&mut app, 70);
            let contacts = |cloth| app.world().get::<ClothContacts>(cloth).expect("contacts");
            assert!(contacts(other).with(other_ball).is_some());
            assert!(contacts(other).with(ball).is_none());
            assert!(contacts(cloth).with(ball).is_some());
            assert!(contacts(cloth).with(other_ball).is_none());
        } else {
            tick(&mut app, 70);
        }
        let search = app.world().get::<ClothSearch>(cloth).expect("a search");
        let visits = search.query().visits().to_vec();
        (particles(&app, cloth).clone(), visits)
    };
    assert_eq!(run(false), run(true));
}

/// Two balls at once are two contacts.
#[test]
fn one_cloth_touches_two_balls() {
    let mut app = app_with_moving_balls();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let balls = [0.3, 1.2].map(|x| {
        let place = Transform::from_xyz(x, -0.9, -0.5);
        app.world_mut()
            .spawn((ClothCollider::ball(0.25), Moving(1.0), place))
            .id()
    });
    tick(&mut app, 35);
    let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
    assert_eq!(contacts.iter().len(), 2);
    assert!(balls.iter().all(|&ball| contacts.with(ball).is_some()));
}

/// `RestShape` holds what a game has stretched since the last tick: its radii grow with the stretch present.
#[test]
fn what_a_game_stretches_is_found() {
    let mut app = app();
    let cloth = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
    let corner = Vec3::new(7.5, -7.5, 0.0);
    let ball = (
        ClothCollider::ball(0.3),
        Transform::from_translation(corner),
    );
    app.world_mut().spawn(ball);
    tick(&mut app, 1);
    change::<ClothParticles>(&mut app, cloth, |particles| {
        for index in 0..particles.len() {
            let stretched = particles.position(index).expect("a particle") * 5.0;
            particles
                .set_position(index, stretched)
                .expect("a particle");
        }
    });
    tick(&mut app, 1);
    let search = app.world().get::<ClothSearch>(cloth).expect("a search");
    assert!(search.query().candidates().contains(&255));
}

/// No contact is lost for want of a candidate: with every particle a candidate in every sub-step, by hand, the
/// motion is the same bit for bit. Two balls, a still one beside the cloth and a fast one.
#[test]
fn the_candidates_are_complete() {
    for speed in [0.5, 3.0, 12.0] {
        let mut app = app_with_moving_balls();
        let cloth = app.world_mut().spawn(Cloth::default()).id();
        let balls = [(0.4, -0.9, -0.42, 0.0), (1.0, -1.0, -1.0, speed)].map(|(x, y, z, speed)| {
            let place = Transform::from_xyz(x, y, z);
            let ball = (ClothCollider::ball(0.4), Moving(speed), place);
            app.world_mut().spawn(ball).id()
        });
        let places = |app: &App| {
            balls.map(|ball| {
                let transform = app.world().get::<Transform>(ball).expect("a transform");
                transform.translation
            })
        };
        // Two ticks: the first motion of a collider is known from the second on.
        tick(&mut app, 2);
        // A hem that the game has pulled to the far side of the still ball, to snap back through it.
        change::<ClothParticles>(&mut app, cloth, |particles| {
            for column in 2..6 {
                let pulled = Vec3::new(0.1 * column as f32, -1.2, -0.9);
                particles
                    .set_position((15, column), pulled)
                    .expect("a particle");
            }
        });
        let (mut contacts, mut found) = (0, 0);
        for _ in 0..100 {
            let mut by_hand = particles(&app, cloth).clone();
            let from = places(&app);
            tick(&mut app, 1);
            let to = places(&app);
            let material = ClothMaterial::COTTON;
            let step = TickStep {
                substeps: Substepping::needed(16, TICK),
                acceleration: Vec3::NEG_Y * GRAVITY,
                damping: material.damping,
                ..default()
            };
            let everything: Vec<u32> = (0..256).collect();
            let built = app
                .world()
                .get::<ClothBuilt>(cloth)
                .expect("what was built");
            let mut solver = Solver::new(built.springs(), &by_hand);
            solver.set_bending(Bending::new(built.surface(), &material));
            let contact_settings = ContactSettings {
                particle_radius: 0.01,
                friction: material.friction,
                narrow_phase: NarrowPhase::Particles,
                ..default()
            };
            let mut detection = Detection::default();
            detection.begin(built.surface(), f32::INFINITY);
            for (id, (from, to)) in from.into_iter().zip(to).enumerate() {
                let ball = MovingCollider::ball(0.4, from, to);
                detection.add(
                    id,
                    &ball,
                    contact_settings.narrow_phase,
                    &everything,
                    &by_hand,
                );
            }
            solver.advance(&mut by_hand, step, &[], |particles, substep| {
                detection.respond(particles, &contact_settings, substep, |_| {})
            });
            let touches = detection.touches().iter();
            found += touches
                .flat_map(|touch| detection.points(touch))
                .filter(|point| point.depth > 0.0)
                .count();
            let stats = app.world().get::<ClothStats>(cloth).expect("figures");
            contacts += stats.contacts;
            assert_eq!(particles(&app, cloth), &by_hand, "{speed} m/s");
        }
        assert!(contacts > 100 && found == contacts, "{contacts} {found}");
    }
}

/// A collider of the default radius is the paper's.
#[test]
fn a_collider_alone_is_enough() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let ball = app
        .world_mut()
        .spawn((
            ClothCollider::default(),
            Transform::from_xyz(0.7, -0.7, 0.95),
        ))
        .id();
    tick(&mut app, 30);
    assert!(
        app.world()
            .get::<ClothContacts>(cloth)
            .expect("contacts")
            .with(ball)
            .is_some()
    );
    let outside = particles(&app, cloth)
        .positions()
        .skip(16)
        .all(|position| position.distance(Vec3::new(0.7, -0.7, 0.95)) > 1.0099);
    assert!(outside);
}

/// The touches of a disabled cloth end when a game replaces its contacts, as those of any other.
#[test]
fn contacts_of_a_disabled_cloth_stop_when_they_are_replaced() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let place = Transform::from_xyz(0.75, -0.75, 0.0);
    app.world_mut().spawn((ClothCollider::ball(0.3), place));
    tick(&mut app, 2);
    assert_eq!(messages::<ClothTouchStarted>(&mut app).len(), 1);
    app.world_mut().entity_mut(cloth).insert(Disabled);
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothContacts::default());
    tick(&mut app, 1);
    assert_eq!(messages::<ClothTouchStopped>(&mut app).len(), 1);
    app.world_mut().entity_mut(cloth).remove::<Disabled>();
    tick(&mut app, 2);
    assert_eq!(messages::<ClothTouchStarted>(&mut app).len(), 1);
}
