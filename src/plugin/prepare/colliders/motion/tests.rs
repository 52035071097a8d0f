//! Where the mass of a body is, and where it is left, whatever the frame of its shape.

use bevy::{prelude::*, time::TimeUpdateStrategy};
use parry3d::shape::SharedShape;

use super::*;
use crate::plugin::{authoring::ClothPush, simulation::ClothPlugin};

/// Turns and places are floats of about 1.
const ROUNDING: f32 = 1.0e-6;

fn app_with(collider: ClothCollider, body: ClothBody, place: Transform) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ClothPlugin::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    app.update();
    let entity = app.world_mut().spawn((collider, body, place)).id();
    app.update();
    (app, entity)
}

fn moving(app: &App, entity: Entity) -> MovingCollider {
    let motion = app.world().get::<ColliderMotion>(entity);
    let moving = motion.and_then(|motion| motion.seen_from(&ClothFrame::default(), None));
    moving.expect("it is followed")
}

fn mass(app: &App, entity: Entity) -> BodyMass {
    moving(app, entity).body.expect("it is a body")
}

/// A capsule whose shape is neither where its entity is nor turned as that.
fn aside() -> ClothCollider {
    let ends = [Vec3::new(0.2, 0.1, -0.5), Vec3::new(0.2, 0.1, 0.5)];
    ClothCollider::parry(SharedShape::capsule(ends[0], ends[1], 0.1))
}

/// A body that turns a quarter in one tick is in that tick as hard to move as it was when it began, and in the next as it then is.
#[test]
fn a_mass_is_that_of_the_ticks_beginning() {
    let body = ClothBody {
        centre_of_mass: Vec3::X * 0.3,
        ..ClothBody::new(1.0, Vec3::new(1.0, 2.0, 4.0))
    };
    let (mut app, entity) = app_with(ClothCollider::ball(0.5), body, Transform::IDENTITY);
    let quarter = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    app.world_mut()
        .entity_mut(entity)
        .insert(Transform::from_rotation(quarter));
    for (centre, least) in [(Vec3::X, Vec3::X), (Vec3::Y, Vec3::Y)] {
        app.update();
        let mass = mass(&app, entity);
        assert!(mass.centre.distance(centre * 0.3) < ROUNDING, "{mass:?}");
        let turned = mass.inverse_inertia * least;
        assert!(turned.distance(least) < ROUNDING, "{mass:?}");
    }
}

/// All the way round, each tick turns by as much as the transform did, and never by the rest of the circle.
#[test]
fn a_turn_is_the_shorter_way_round() {
    let axis = Vec3::new(0.6, 0.0, 0.8);
    let turned = |angle| Transform::from_rotation(Quat::from_axis_angle(axis, angle));
    let collider = ClothCollider::cuboid(0.1, 0.2, 0.3);
    let (mut app, entity) = app_with(collider, ClothBody::ball(1.0, 0.1), turned(0.0));
    for count in 1_u8..64 {
        let place = turned(0.1 * f32::from(count));
        app.world_mut().entity_mut(entity).insert(place);
        app.update();
        let turn = moving(&app, entity).turn;
        assert!(
            turn.distance(axis * 0.1) < 10.0 * ROUNDING,
            "{count}: {turn}"
        );
    }
}

/// The centre of mass is seen from the shape's origin, and the inertia in the entity's frame, which is not that of the shape.
#[test]
fn a_mass_is_where_the_entity_has_it() {
    let inertia = Vec3::new(1.0, 2.0, 4.0);
    let body = ClothBody {
        centre_of_mass: Vec3::new(0.2, 0.1, 0.25),
        ..ClothBody::new(1.0, inertia)
    };
    let turned = Quat::from_rotation_y(0.6);
    let place = Transform::from_xyz(3.0, 0.0, 0.0).with_rotation(turned);
    let (app, entity) = app_with(aside(), body, place);
    let mass = mass(&app, entity);
    let arm = turned * Vec3::Z * 0.25;
    assert!(mass.centre.distance(arm) < ROUNDING, "{mass:?}");
    for (axis, moment) in [Vec3::X, Vec3::Y, Vec3::Z]
        .into_iter()
        .zip(inertia.to_array())
    {
        let axis = turned * axis;
        let turned = mass.inverse_inertia * axis;
        assert!(turned.distance(axis / moment) < ROUNDING, "{mass:?}");
    }
}

/// What is pushed is where the push left it, and goes nowhere by itself in the next tick: neither where its shape is aside, nor where
/// its transform is mirrored.
#[test]
fn what_is_pushed_stays_there() {
    let body = ClothBody::ball(1.0, 0.1);
    let turned = Quat::from_rotation_x(0.4);
    let place = Transform::from_xyz(1.0, 2.0, 0.5).with_rotation(turned);
    let mirrored = place.with_scale(Vec3::new(1.0, -1.0, 1.0));
    for (collider, place) in [
        (ClothCollider::ball(0.3), place),
        (aside(), place),
        (aside(), mirrored),
    ] {
        let (mut app, entity) = app_with(collider, body, place);
        let before = moving(&app, entity).pose_at(1.0);
        let change = BodyChange {
            translation: Vec3::new(0.02, -0.01, 0.03),
            rotation: Vec3::new(0.1, -0.2, 0.05),
            ..BodyChange::default()
        };
        let mut entity_mut = app.world_mut().entity_mut(entity);
        let mut motion = entity_mut
            .get_mut::<ColliderMotion>()
            .expect("it is followed");
        let (gone, turned) = motion.pushed(&change, &body);
        let mut transform = entity_mut.get_mut::<Transform>().expect("a place");
        transform.translation += gone;
        transform.rotation = (turned * transform.rotation).normalize();
        app.update();
        let moving = moving(&app, entity);
        assert!(moving.travel() < ROUNDING, "{}", moving.travel());
        assert!(moving.turn.length() < ROUNDING, "{}", moving.turn);
        let after = moving.pose_at(1.0);
        let gone = Vec3::from(after.translation - before.translation);
        assert!(gone.distance(change.translation) < ROUNDING, "{gone}");
        let turned = (after.rotation * before.rotation.inverse()).to_scaled_axis();
        assert!(turned.distance(change.rotation) < ROUNDING, "{turned}");
    }
}

/// What is no collider any more, or nowhere, was not pushed: a push is not given twice.
#[test]
fn a_push_ends_with_its_collider() {
    let push = ClothPush {
        velocity: Vec3::X,
        ..ClothPush::default()
    };
    for takes_place in [true, false] {
        let collider = ClothCollider::ball(0.3);
        let (mut app, entity) = app_with(collider, ClothBody::ball(1.0, 0.3), Transform::IDENTITY);
        let mut entity_mut = app.world_mut().entity_mut(entity);
        entity_mut.insert(push);
        if takes_place {
            entity_mut.remove::<Transform>();
        } else {
            entity_mut.remove::<ClothCollider>();
        }
        app.update();
        let left = app.world().get::<ClothPush>(entity);
        assert_eq!(left, Some(&ClothPush::default()));
    }
}
