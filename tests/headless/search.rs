//! How a cloth is searched: what is chosen and why, what is refused, and that it makes no difference to the motion.

use bevy::{
    gizmos::{GizmoAsset, GizmoHandles},
    prelude::*,
};
use bevy_drape::{
    contact::{ContactSettings, Detection, MovingCollider},
    hierarchy::SearchReason,
    hierarchy::{BoundRule, BoundingVolume},
    plugin::ClothBuilt,
    prelude::*,
    solver::{Bending, DampingFrame, Solver, TickStep},
};

use crate::{faults::expect_fault, support::*};

const SPHERES: SearchMethod = SearchMethod::Tree(BoundingVolume::Sphere, BoundRule::RestShape);
const BOXES: SearchMethod = SearchMethod::Tree(BoundingVolume::Aabb, BoundRule::Refit);

/// OBBs cannot be had from a rest shape, nor k-DOPs from the paper.
#[test]
fn a_search_that_does_not_exist_is_named() {
    let bad = SearchMethod::Tree(BoundingVolume::Obb, BoundRule::RestShape);
    expect_fault(
        (Cloth::default(), bad),
        |_, _| {},
        |error| {
            let text = error.to_string();
            matches!(error, ClothError::Bounds(BoundsError::Unsupported { .. }))
                && text.contains("OBB")
                && text.contains("rest shape")
        },
        |app, entity| change::<SearchMethod>(app, entity, |method| *method = default()),
    );
    // One that goes bad as a ball touches.
    expect_fault(
        Cloth::default(),
        |app, entity| {
            let place = Transform::from_xyz(1.2, -1.2, 0.25);
            app.world_mut().spawn((ClothCollider::ball(0.3), place));
            tick(app, 3);
            change::<SearchMethod>(app, entity, |method| {
                *method = SearchMethod::Tree(BoundingVolume::KDop18, BoundRule::Paper);
            });
        },
        |error| {
            let text = error.to_string();
            text.contains("18-DOP") && text.contains("paper")
        },
        |app, entity| change::<SearchMethod>(app, entity, |method| *method = BOXES),
    );
}

#[test]
fn a_capsule_or_box_of_no_size_is_named() {
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        for collider in [
            ClothCollider::capsule(bad, 1.0),
            ClothCollider::cuboid(1.0, bad, 1.0),
            ClothCollider::cuboid(1.0, 1.0, bad),
            // A capsule without length is a ball.
            ClothCollider::capsule(1.0, if bad == 0.0 { -0.5 } else { bad }),
        ] {
            let is_expected: fn(&ClothError) -> bool = match collider {
                ClothCollider::Capsule { .. } => |error| error.to_string().contains("capsule"),
                _ => |error| error.to_string().contains("box"),
            };
            let aside = Transform::from_xyz(9.0, 0.0, 0.0);
            expect_fault(
                (collider, aside),
                |_, _| {},
                is_expected,
                |app, entity| change::<ClothCollider>(app, entity, |shape| *shape = default()),
            );
        }
    }
}

/// Whoever has nothing near is not searched at all, and whoever is small is scanned.
#[test]
fn a_small_cloth_is_scanned_where_something_is_near() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let far = Transform::from_xyz(0.7, -0.7, 50.0);
    let ball = app.world_mut().spawn((ClothCollider::default(), far)).id();
    tick(&mut app, 3);
    let nothing = stats(&app, cloth);
    assert_eq!(nothing.search, SearchMethod::Auto);
    assert_eq!(nothing.reason, SearchReason::NothingNear);
    assert_eq!((nothing.nodes_visited, nothing.leaf_tests), (0, 0));
    assert_eq!((nothing.rebuild_ms, nothing.query_ms), (0.0, 0.0));
    assert_eq!((nothing.colliders_near, nothing.contacts), (0, 0));

    // In its place at once: its jump would else be a way past everything between.
    let near = (
        ClothCollider::default(),
        Transform::from_xyz(0.7, -0.7, 0.95),
    );
    app.world_mut().entity_mut(ball).insert(near);
    tick(&mut app, 1);
    let scanned = stats(&app, cloth);
    assert_eq!(scanned.search, SearchMethod::Scan);
    assert_eq!(scanned.reason, SearchReason::FewParticles);
    assert_eq!((scanned.nodes_visited, scanned.leaf_tests), (0, 256));
    assert_eq!(scanned.colliders_near, 1);

    for method in SearchMethod::ALL {
        change::<SearchMethod>(&mut app, cloth, |asked| *asked = method);
        tick(&mut app, 1);
        let stats = stats(&app, cloth);
        if method == SearchMethod::Auto {
            assert_eq!(stats.reason, SearchReason::FewParticles);
        } else {
            assert_eq!((stats.search, stats.reason), (method, SearchReason::Asked));
        }
        let is_tree = method.rule().is_some();
        assert_eq!(stats.nodes_visited > 0, is_tree, "{method}");
        assert!(stats.leaf_tests > 0, "{method}");
    }
}

/// One ball beside a fine cloth is found by spheres that need no update; sixty are worth a refit.
#[test]
fn a_fine_cloth_is_searched_by_what_its_colliders_are_worth() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::new(80, 80, 0.02)).id();
    let spawn = |app: &mut App, ball: u32| {
        let (column, row) = ((ball % 10) as f32, (ball / 10) as f32);
        let place = Transform::from_xyz(0.15 * column, -0.1 - 0.2 * row, 0.1);
        app.world_mut()
            .spawn((ClothCollider::ball(0.05), place))
            .id()
    };
    spawn(&mut app, 0);
    tick(&mut app, 1);
    let one = stats(&app, cloth);
    assert_eq!(one.search, SPHERES);
    assert_eq!(one.reason, SearchReason::FewColliders);
    assert_eq!(one.colliders_near, 1);
    assert!(one.nodes_visited > 0 && one.leaf_tests < 80 * 80, "{one:?}");

    let others: Vec<Entity> = (1..60).map(|ball| spawn(&mut app, ball)).collect();
    tick(&mut app, 1);
    let sixty = stats(&app, cloth);
    assert_eq!(sixty.search, BOXES);
    assert_eq!(sixty.reason, SearchReason::ManyColliders);
    assert_eq!(sixty.colliders_near, 60);

    for ball in others {
        app.world_mut().despawn(ball);
    }
    tick(&mut app, 1);
    assert_eq!(stats(&app, cloth).reason, SearchReason::FewColliders);
}

/// One that sleeps on a ball says so, and that nothing was looked at.
#[test]
fn a_sleeping_cloth_is_not_searched() {
    let mut app = app();
    let material = ClothMaterial {
        damping: 0.1,
        ..default()
    };
    let cloth = (Cloth::new(9, 9, 0.1), material, SPHERES);
    let cloth = app.world_mut().spawn(cloth).id();
    let place = Transform::from_xyz(0.4, -0.4, 0.1);
    let ball = (ClothCollider::ball(0.2), place);
    app.world_mut().spawn(ball);
    let sleeps = (0..64 * 30).any(|_| {
        tick(&mut app, 1);
        stats(&app, cloth).is_asleep
    });
    let stats = stats(&app, cloth);
    assert!(sleeps, "{stats:?}");
    assert_eq!(stats.reason, SearchReason::Asleep);
    assert_eq!((stats.nodes_visited, stats.leaf_tests), (0, 0));
    assert_eq!((stats.rebuild_ms, stats.query_ms), (0.0, 0.0));
    assert_eq!(stats.requeries, 0);
    assert!(stats.contacts > 0, "what it lies on, it lies on still");
}

/// A game pulls a stiff cloth out to twenty times its size, beside a ball that is on its way, and it snaps back. Whatever
/// the search, nothing is missed: bit by bit the motion is that of testing every particle in every sub-step, by hand.
/// (That what outruns its search is searched again, is tested beside it, where the margin can be chosen.)
#[test]
fn what_snaps_back_is_not_missed() {
    let stiff = ClothMaterial {
        stretch_compliance: 0.0,
        shear_compliance: 0.0,
        ..default()
    };
    let settings = ClothSettings {
        tethers: false,
        ..default()
    };
    let start = |method: SearchMethod| {
        let mut app = app_with_moving_balls();
        let cloth = (
            Cloth::default(),
            Pins::none(),
            stiff,
            settings,
            method,
            NarrowPhase::Particles,
        );
        let cloth = app.world_mut().spawn(cloth).id();
        let balls = [(0.7, -0.7, 0.35), (2.0, -3.0, 0.2)].map(|(x, y, z)| {
            let ball = (ClothCollider::ball(0.4), Moving(-2.0));
            let ball = (ball, Transform::from_xyz(x, y, z));
            app.world_mut().spawn(ball).id()
        });
        tick(&mut app, 2);
        change::<ClothParticles>(&mut app, cloth, |particles| {
            for index in (0..particles.len()).filter(|index| index % 16 > 11) {
                let position = particles.position(index).expect("a particle");
                let pulled = position * 20.0 + Vec3::Z * (index as f32 / 200.0);
                particles.set_position(index, pulled).expect("a particle");
            }
        });
        (app, cloth, balls)
    };
    let places = |app: &App, balls: [Entity; 2]| {
        balls.map(|ball| {
            app.world()
                .get::<Transform>(ball)
                .expect("there")
                .translation
        })
    };

    let (mut app, cloth, balls) = start(SearchMethod::Scan);
    let (mut truth, mut contacts) = (Vec::new(), 0);
    for _ in 0..30 {
        let mut by_hand = particles(&app, cloth).clone();
        let from = places(&app, balls);
        let contacts_before = app.world().get::<ClothContacts>(cloth).cloned();
        tick(&mut app, 1);
        let to = places(&app, balls);
        let built = app
            .world()
            .get::<ClothBuilt>(cloth)
            .expect("what was built");
        let contact_settings = ContactSettings {
            particle_radius: settings.particle_radius,
            friction: stiff.friction,
            narrow_phase: NarrowPhase::Particles,
            ..default()
        };
        let mut detection = Detection::default();
        detection.begin(built.surface(), f32::INFINITY);
        detection.set_particle_radius(settings.particle_radius);
        let everything: Vec<u32> = (0..256).collect();
        let both = [0, 1].map(|id| MovingCollider::ball(0.4, from[id], to[id]));
        for (id, ball) in both.iter().enumerate() {
            let known = contacts_before
                .as_ref()
                .and_then(|known| known.with(balls[id]));
            if known.is_none_or(|contact| contact.is_embedded) {
                let others = both.iter();
                detection.embed(id, ball, known.is_some(), &everything, &by_hand, others);
            }
            detection.add(
                id,
                ball,
                contact_settings.narrow_phase,
                &everything,
                &by_hand,
            );
        }
        let step = TickStep {
            substeps: Substepping::needed(16, TICK),
            acceleration: Vec3::NEG_Y * GRAVITY,
            damping: stiff.damping,
            damped_against: DampingFrame::CentreOfMass,
            ..default()
        };
        let mut solver = Solver::new(built.springs(), &by_hand);
        solver.set_bending(Bending::new(built.surface(), &stiff));
        solver.advance(&mut by_hand, step, &[], |particles, substep| {
            detection.respond(particles, &contact_settings, substep, |_| {})
        });
        assert_eq!(particles(&app, cloth), &by_hand);
        let stats = stats(&app, cloth);
        contacts += stats.contacts;
        truth.push(by_hand);
    }
    assert!(contacts > 30, "{contacts}");

    for method in SearchMethod::ALL {
        let (mut app, cloth, _) = start(method);
        for (step, truth) in truth.iter().enumerate() {
            tick(&mut app, 1);
            let is_complete = method.rule() != Some(BoundRule::Paper);
            assert!(
                !is_complete || particles(&app, cloth) == truth,
                "{method}, tick {step}"
            );
        }
    }
}

/// Which colours the cloths' gizmos were drawn in.
fn drawn(app: &App) -> Vec<LinearRgba> {
    let handles = app.world().resource::<GizmoHandles>();
    let assets = app.world().resource::<Assets<GizmoAsset>>();
    let handle = handles
        .handles()
        .get(&std::any::TypeId::of::<ClothGizmos>())
        .expect("a group");
    let asset = handle.as_ref().and_then(|handle| assets.get(handle));
    asset.map_or_else(Vec::new, |asset| {
        let buffer = asset.buffer();
        let colors = buffer.list_colors.iter().chain(&buffer.strip_colors);
        colors.copied().collect()
    })
}

/// However it is searched, what touches is drawn red; and what vanishes, begins again or is NaN is no trouble.
#[test]
fn every_search_is_drawn() {
    let look = ClothGizmos::default();
    for method in SearchMethod::ALL {
        for collider in [
            ClothCollider::ball(0.3),
            ClothCollider::cuboid(0.4, 0.4, 0.6),
        ] {
            let mut app = app_with_gizmos();
            let cloth = (Cloth::default(), method, ShowClothGizmos::levels(0..=9));
            let cloth = app.world_mut().spawn(cloth).id();
            // Its surface is where half of the particles' radius is.
            let place = Transform::from_xyz(0.7, -0.9, 0.305);
            let ball = app.world_mut().spawn((collider.clone(), place)).id();
            tick(&mut app, 2);
            let colors = drawn(&app);
            for color in [look.touching, look.untouched] {
                let color = color.to_linear();
                assert!(colors.contains(&color), "{method} {collider:?} {color:?}");
            }
            app.world_mut().despawn(ball);
            tick(&mut app, 1);
            let colors = drawn(&app);
            assert!(!colors.contains(&look.touching.to_linear()), "{method}");
            assert!(!colors.is_empty(), "{method}");
            app.world_mut().spawn((collider, place));
            change::<ClothParticles>(&mut app, cloth, |particles| *particles = default());
            tick(&mut app, 2);
            change::<ClothParticles>(&mut app, cloth, |particles| {
                let bad = Vec3::splat(f32::NAN);
                particles.set_position(77, bad).expect("a particle");
            });
            tick(&mut app, 2);
            assert!(drawn(&app).is_empty(), "what is not valid is not drawn");
            change::<ClothParticles>(&mut app, cloth, |particles| *particles = default());
            tick(&mut app, 2);
            assert!(drawn(&app).contains(&look.touching.to_linear()), "{method}");
            app.world_mut().despawn(cloth);
            tick(&mut app, 2);
            assert!(drawn(&app).is_empty());
        }
    }
}
