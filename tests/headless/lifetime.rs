//! Entities and components that come and go while cloth and ball touch.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A copy of a cloth begins where the first is, with touches and messages of its own.
#[test]
fn a_copy_has_its_own_touches() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let place = Transform::from_xyz(0.7, -0.7, 0.95);
    app.world_mut().spawn((ClothCollider::default(), place));
    tick(&mut app, 2);
    messages::<ClothTouchStarted>(&mut app);
    let copy = app.world_mut().entity_mut(cloth).clone_and_spawn();
    tick(&mut app, 60);
    let started = messages::<ClothTouchStarted>(&mut app);
    assert!(
        started.iter().any(|reported| reported.cloth == copy),
        "{started:?}"
    );
    assert_eq!(particles(&app, cloth), particles(&app, copy));
}

#[test]
fn despawning_either_is_harmless_and_reported() {
    let mut app = app_with_moving_balls();
    let (cloth, ball) = spawn_pass(&mut app);
    tick(&mut app, 60);
    assert_eq!(messages::<ClothTouchStarted>(&mut app).len(), 1);
    app.world_mut().despawn(ball);
    tick(&mut app, 2);
    let stopped = messages::<ClothTouchStopped>(&mut app);
    assert!(
        matches!(stopped[..], [ClothTouchStopped { collider, .. }] if collider == ball),
        "{stopped:?}"
    );
    assert_eq!(red(&app, cloth), [0; 5]);

    let (second, ball) = spawn_pass(&mut app);
    app.world_mut().despawn(cloth);
    tick(&mut app, 60);
    assert_eq!(messages::<ClothTouchStarted>(&mut app).len(), 1);
    app.world_mut().despawn(second);
    tick(&mut app, 2);
    let stopped = messages::<ClothTouchStopped>(&mut app);
    assert!(
        matches!(stopped[..], [ClothTouchStopped { collider, cloth, .. }] if collider == ball && cloth == second),
        "{stopped:?}"
    );
}

/// A ball that jumps sweeps through what lies between; inserted again, it has not come from anywhere.
#[test]
fn a_teleport_sweeps_nothing() {
    let pushed = |teleport: bool| {
        let mut app = app();
        let cloth = app.world_mut().spawn(Cloth::default()).id();
        let place = Transform::from_xyz(0.7, -0.7, -1.0);
        let ball = (ClothCollider::ball(0.3), place);
        let ball = app.world_mut().spawn(ball).id();
        tick(&mut app, 2);
        change::<Transform>(&mut app, ball, |transform| transform.translation.z = 1.0);
        if teleport {
            app.world_mut()
                .entity_mut(ball)
                .insert(ClothCollider::ball(0.3));
        }
        tick(&mut app, 1);
        app.world()
            .get::<ClothStats>(cloth)
            .expect("figures")
            .contacts
    };
    assert!(pushed(false) > 0);
    assert_eq!(pushed(true), 0);
}

/// What is taken from an entity is gone: no ball lingers, no cloth moves on, and the touch ends.
#[test]
fn components_may_be_removed() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let place = Transform::from_xyz(0.7, -0.7, 0.95);
    let ball = app
        .world_mut()
        .spawn((ClothCollider::default(), place))
        .id();
    let touches = |app: &App| {
        let contacts = app.world().get::<ClothContacts>(cloth);
        contacts.expect("contacts").with(ball).is_some()
    };
    tick(&mut app, 2);
    assert!(touches(&app));
    app.world_mut().entity_mut(ball).remove::<ClothCollider>();
    tick(&mut app, 2);
    assert!(!touches(&app));
    assert_eq!(messages::<ClothTouchStopped>(&mut app).len(), 1);

    app.world_mut()
        .entity_mut(ball)
        .insert(ClothCollider::default());
    // The cloth has to swing back.
    tick(&mut app, 60);
    assert!(touches(&app));
    app.world_mut().entity_mut(cloth).remove::<Pins>();
    tick(&mut app, 30);
    assert!(position(&app, cloth, (0, 0)).y < -0.1, "nothing holds it");
    let mut entity = app.world_mut().entity_mut(cloth);
    entity.remove::<(ClothMaterial, ClothSettings, SearchMethod, NarrowPhase)>();
    let before = position(&app, cloth, (0, 0));
    tick(&mut app, 5);
    assert!(
        position(&app, cloth, (0, 0)).y < before.y,
        "the defaults count"
    );

    app.world_mut().entity_mut(cloth).remove::<Cloth>();
    let before = particles(&app, cloth).clone();
    tick(&mut app, 5);
    assert_eq!(particles(&app, cloth), &before);
    assert!(app.world().get::<ClothStats>(cloth).is_none());
    app.world_mut().entity_mut(cloth).insert(Cloth::default());
    tick(&mut app, 5);
    assert_ne!(
        particles(&app, cloth),
        &before,
        "it goes on from where it was"
    );
}

/// Particles that come with a cloth keep their masses; pins pin all the same.
#[test]
fn particles_that_come_with_a_cloth_keep_their_masses() {
    let mut app = app();
    let surface = Cloth::new(4, 4, 0.1).surface(Vec3::ONE).expect("a grid");
    let mut own = ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("particles");
    own.set_inverse_mass((3, 3), 5.0).expect("a particle");
    own.set_inverse_mass((2, 0), 0.0).expect("a particle");
    let cloth = app.world_mut().spawn((Cloth::new(4, 4, 0.1), own)).id();
    tick(&mut app, 2);
    let inverse_mass = |cell: (u32, u32)| particles(&app, cloth).inverse_mass(cell);
    assert_eq!(inverse_mass((3, 3)), Some(5.0));
    assert_eq!(inverse_mass((2, 0)), Some(0.0));
    assert_eq!(inverse_mass((0, 1)), Some(0.0));
}

/// What a tick has prepared is not done in another: a cloth that lost its particles between two systems of a tick, with
/// pins that were to move, and that comes back smaller and at fault.
#[test]
fn what_was_prepared_does_not_outlast_its_tick() {
    #[derive(Resource, Default)]
    struct Loses(bool);
    let mut app = app();
    app.init_resource::<Loses>();
    let lose = |loses: Res<Loses>, cloths: Query<Entity, With<Cloth>>, mut commands: Commands| {
        if loses.0 {
            for cloth in &cloths {
                commands.entity(cloth).remove::<ClothParticles>();
            }
        }
    };
    let between = lose
        .after(ClothSystems::Prepare)
        .before(ClothSystems::Rebuild);
    app.add_systems(FixedUpdate, between);
    let pole = app.world_mut().spawn(Transform::default()).id();
    let attached = ClothAttachments::new([(Pin::Row(19), pole)]);
    let cloth = (Cloth::new(20, 20, 0.1), Pins::none(), attached);
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 2);
    change::<Transform>(&mut app, pole, |place| place.translation.x = 0.05);
    app.insert_resource(Loses(true));
    tick(&mut app, 1);
    app.insert_resource(Loses(false));
    app.world_mut().despawn(pole);
    let smaller = (Cloth::new(3, 3, 0.1), ClothParticles::default());
    app.world_mut().entity_mut(cloth).insert(smaller);
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_some());
    app.world_mut()
        .entity_mut(cloth)
        .remove::<ClothAttachments>();
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    assert_eq!(particles(&app, cloth).len(), 9);
}

/// What was pinned and attached is free again when it becomes a cloth again without pins.
#[test]
fn a_removed_cloth_is_not_pinned_for_ever() {
    let mut app = app();
    let pole = app.world_mut().spawn(Transform::default()).id();
    let attached = ClothAttachments::new([(Pin::Column(0), pole)]);
    let cloth = app.world_mut().spawn((Cloth::default(), attached)).id();
    tick(&mut app, 5);
    let mut entity = app.world_mut().entity_mut(cloth);
    entity.remove::<(Cloth, ClothAttachments)>();
    entity.insert((Cloth::default(), Pins::none()));
    tick(&mut app, 64);
    let particles = particles(&app, cloth);
    assert!(particles.inverse_masses().all(|w| w > 0.0));
    assert!(particles.positions().all(|at| at.y < -2.0));
}
