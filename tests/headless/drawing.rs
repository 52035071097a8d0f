//! Where pins are drawn, at every phase between two ticks: where that is drawn which carries them.

use std::time::Duration;

use bevy::{prelude::*, time::TimeUpdateStrategy};
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::TransformInterpolation;

use crate::{mesh::vertices, support::*};

/// What moves, and how fast (m/s, rad/s).
#[derive(Component)]
struct Carrier;

const SPEED: f32 = 3.0;
const TURN: f32 = 2.0;

/// How a carrier is moved.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Moved {
    /// In each fixed tick.
    Ticked,
    /// Likewise, and drawn between them.
    Smoothed,
    /// In each frame.
    Framed,
}

fn carry(mut carriers: Query<&mut Transform, With<Carrier>>, time: Res<Time>) {
    for mut place in &mut carriers {
        place.translation.x += SPEED * time.delta_secs();
        place.rotate_y(TURN * time.delta_secs());
    }
}

fn app(moved: Moved) -> App {
    let mut app = app_that_draws_smoothly();
    match moved {
        Moved::Framed => app.add_systems(Update, carry),
        _ => app.add_systems(FixedUpdate, carry.before(ClothSystems::Prepare)),
    };
    app
}

/// Spawns what will be moved.
fn spawn_carrier(app: &mut App, moved: Moved, bundle: impl Bundle) -> Entity {
    let place = Transform::from_xyz(0.3, 1.0, -0.2);
    let mut carrier = app.world_mut().spawn((place, bundle));
    if moved == Moved::Smoothed {
        carrier.insert(TransformInterpolation);
    }
    carrier.id()
}

/// Frames of a third of a tick, after some ticks.
fn frames(app: &mut App, mut look: impl FnMut(&App)) {
    tick(app, 10);
    let third = Duration::from_secs_f32(TICK / 3.0);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(third));
    for _ in 0..10 {
        app.update();
        look(app);
    }
}

/// Vertices in the world, as they are drawn.
fn drawn(app: &App, cloth: Entity) -> Vec<Vec3> {
    let place = drawn_at(app, cloth);
    let vertices = vertices(app, cloth, Mesh::ATTRIBUTE_POSITION).into_iter();
    vertices.map(|at| place.transform_point(at)).collect()
}

fn drawn_at(app: &App, entity: Entity) -> GlobalTransform {
    *app.world().get(entity).expect("a place")
}

/// An attached column is on its target and a pinned one on its entity, to a rounding; and beside them no seam opens: the
/// next particles are as far away as the cloth has them, which was pulled at by all that motion.
#[test]
fn pins_are_drawn_where_their_carriers_are() {
    for moved in [Moved::Ticked, Moved::Smoothed, Moved::Framed] {
        for is_attached in [true, false] {
            let mut app = app(moved);
            let cloth = Cloth::new(9, 7, 0.1);
            let (target, cloth) = if is_attached {
                let target = spawn_carrier(&mut app, moved, ());
                let attached = ClothAttachments::new([(Pin::Column(0), target)]);
                let cloth = (cloth, Pins::none(), attached, Visibility::default());
                (target, app.world_mut().spawn(cloth).id())
            } else {
                let cloth = (cloth, Pins::new([Pin::Column(0)]), Visibility::default());
                let cloth = spawn_carrier(&mut app, moved, cloth);
                (cloth, cloth)
            };
            app.update();
            app.world_mut().entity_mut(target).insert(Carrier);
            let grid = Cloth::new(9, 7, 0.1).grid(Vec3::ONE).expect("a grid");
            let start = if is_attached {
                Transform::from_xyz(0.3, 1.0, -0.2)
            } else {
                Transform::IDENTITY
            };
            frames(&mut app, |app| {
                let vertices = drawn(app, cloth);
                let target = drawn_at(app, target);
                for row in 0..7 {
                    let offset = grid.rest_position(row, 0) - start.translation;
                    let expected = target.transform_point(offset);
                    let found = vertices[grid.index(row, 0) as usize];
                    // Some ten roundings of numbers up to 4 m.
                    let off = found.distance(expected);
                    assert!(off < 1.0e-5, "{moved:?} {is_attached}: {off} m");
                    let next = vertices[grid.index(row, 1) as usize].distance(found);
                    assert!(
                        (0.08..0.125).contains(&next),
                        "{moved:?} {is_attached}: {next} m"
                    );
                }
            });
        }
    }
}

/// A ball that is interpolated as the curtain is does not come through it at any phase: no vertex is inside of the ball
/// by more than the chord between two ticks is below the arc.
#[test]
fn an_interpolated_ball_stays_behind_the_curtain() {
    let mut app = app(Moved::Ticked);
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(24, 24, 0.05).centred(), Visibility::default()))
        .id();
    let ball = (
        ClothCollider::ball(0.25),
        Carrier,
        TransformInterpolation,
        Transform::from_xyz(-0.9, -0.2, -0.1),
    );
    let ball = app.world_mut().spawn(ball).id();
    let mut touched = false;
    frames(&mut app, |app| {
        touched |= stats(app, cloth).contacts > 0;
        let centre = drawn_at(app, ball).translation();
        let nearest = drawn(app, cloth).into_iter().map(|at| at.distance(centre));
        let nearest = nearest.fold(f32::MAX, f32::min);
        // A way of 47 mm a tick over a ball of 0.25 m: 47²/(8 × 250) = 1.1 mm.
        assert!(nearest > 0.25 - 0.0012, "{nearest}");
    });
    assert!(touched);
}

/// What the game hides costs no update, and is right in the frame in which it is shown.
#[test]
fn a_hidden_cloth_is_not_updated() {
    let mut app = app_that_draws(FixedUpdate);
    let cloth = (Cloth::default(), Pins::none(), Visibility::default());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 10);
    change::<Visibility>(&mut app, cloth, |visibility| {
        *visibility = Visibility::Hidden;
    });
    tick(&mut app, 1);
    let hidden = drawn(&app, cloth);
    tick(&mut app, 20);
    assert_eq!(drawn(&app, cloth), hidden);
    let before: Vec<Vec3> = particles(&app, cloth).positions().collect();
    change::<Visibility>(&mut app, cloth, |visibility| {
        *visibility = Visibility::Visible;
    });
    tick(&mut app, 1);
    // With no overstep the picture is that of a tick ago.
    assert_eq!(drawn(&app, cloth), before);
}

/// From one target to another, one metre beside it, the picture moves no more than the cloth does.
#[test]
fn another_attachment_moves_the_picture_no_more_than_the_cloth() {
    let mut app = app_that_draws_smoothly();
    let targets = [0.0, 1.0].map(|x| {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        app.world_mut().spawn(place).id()
    });
    let attached = |target| ClothAttachments::new([(Pin::Column(0), target)]);
    let cloth = (Cloth::new(9, 7, 0.1), Pins::none(), attached(targets[0]));
    let cloth = (cloth, Visibility::default());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 10);
    let before = drawn(&app, cloth)[30];
    let quarter = Duration::from_secs_f32(TICK / 4.0);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(quarter));
    app.world_mut()
        .entity_mut(cloth)
        .insert(attached(targets[1]));
    for _ in 0..8 {
        app.update();
        let moved = drawn(&app, cloth)[30].distance(before);
        // It falls, at 2 m/s by now, for two ticks.
        assert!(moved < 0.07, "{moved} m");
    }
}

/// A row that is pinned to a still entity and a corner that a hand pulls about: both are drawn where they are, with no
/// seam beside either, and so they are at the origin, in the first tick of a motion.
#[test]
fn each_pin_is_drawn_on_its_own_carrier() {
    for start in [Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)] {
        let mut app = app(Moved::Ticked);
        let hand = Transform::from_translation(start + Vec3::new(0.0, -0.6, 0.0));
        let hand = app.world_mut().spawn(hand).id();
        let corner = Pin::Corner(Corner::BottomLeft);
        let attached = ClothAttachments::new([(corner, hand)]);
        let place = Transform::from_translation(start);
        let cloth = (
            Cloth::new(9, 7, 0.1),
            attached,
            place,
            Visibility::default(),
        );
        let cloth = app.world_mut().spawn(cloth).id();
        app.update();
        app.update();
        app.world_mut().entity_mut(hand).insert(Carrier);
        let third = Duration::from_secs_f32(TICK / 3.0);
        app.insert_resource(TimeUpdateStrategy::ManualDuration(third));
        for _ in 0..6 {
            app.update();
            let (vertices, hand) = (drawn(&app, cloth), drawn_at(&app, hand));
            for column in 0..9 {
                let expected = start + Vec3::X * 0.1 * column as f32;
                let off = vertices[column].distance(expected);
                assert!(off < 1.0e-5, "column {column}: {off} m");
                let below = vertices[column + 9].distance(vertices[column]);
                assert!((0.08..0.12).contains(&below), "column {column}: {below} m");
            }
            let off = vertices[6 * 9].distance(hand.translation());
            assert!(off < 1.0e-5, "{off} m");
            let beside = vertices[6 * 9 + 1].distance(vertices[6 * 9]);
            assert!((0.08..0.135).contains(&beside), "{beside} m");
        }
    }
}
