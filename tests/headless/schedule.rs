//! Where the systems run, in what order, and with which other plugins.

use bevy::{
    diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore},
    ecs::{
        intern::Interned,
        schedule::{LogLevel, ScheduleBuildSettings, ScheduleLabel},
    },
    prelude::*,
};
use bevy_drape::{
    hierarchy::{BoundRule, BoundingVolume},
    plugin::{
        ClothDiagnosticsPlugin, ClothGizmosPlugin, ClothMeshPlugin, ClothPlugin, ClothRapierPlugin,
    },
    prelude::*,
};

use crate::{rapier::app_with_rapier, support::*};

/// Has the next run of these schedules fail if two systems of them may run in either order with effect.
pub fn refuse_ambiguities(app: &mut App) {
    let schedules = [
        PreUpdate.intern(),
        FixedUpdate.intern(),
        Update.intern(),
        PostUpdate.intern(),
    ];
    for schedule in schedules {
        // A schedule is examined when it is built, and built again when it gets another system.
        app.add_systems(schedule, || {});
        app.edit_schedule(schedule, |schedule| {
            schedule.set_build_settings(ScheduleBuildSettings {
                ambiguity_detection: LogLevel::Error,
                ..default()
            });
        });
    }
}

#[test]
fn no_system_is_ambiguous() {
    let schedules = [FixedUpdate.intern(), Update.intern(), PostUpdate.intern()];
    schedules.into_iter().for_each(find_no_ambiguity);
}

fn find_no_ambiguity(schedule: Interned<dyn ScheduleLabel>) {
    let mut app = app_that_draws(schedule);
    refuse_ambiguities(&mut app);
    app.world_mut()
        .spawn((Cloth::default(), ShowClothGizmos::default()));
    (0..3).for_each(|_| app.update());
}

#[test]
fn no_system_is_ambiguous_with_rapier() {
    let mut app = app_with_rapier();
    refuse_ambiguities(&mut app);
    tick(&mut app, 2);
}

/// A game that empties the particles where it should not, or while time stands still, costs nothing but a tick.
#[test]
fn particles_may_vanish_anywhere() {
    let vanish = |mut cloths: Query<&mut ClothParticles>| {
        for mut particles in &mut cloths {
            *particles = default();
        }
    };
    for set in [
        ClothSystems::Prepare,
        ClothSystems::Rebuild,
        ClothSystems::Query,
        ClothSystems::Integrate,
        ClothSystems::WriteBack,
    ] {
        for rule in [BoundRule::RestShape, BoundRule::Refit, BoundRule::Paper] {
            let mut app = app_with_gizmos();
            app.add_systems(FixedUpdate, vanish.after(set));
            let method = SearchMethod::Tree(BoundingVolume::Sphere, rule);
            let cloth = (Cloth::default(), ShowClothGizmos::default(), method);
            app.world_mut().spawn(cloth);
            let place = Transform::from_xyz(0.7, -0.7, 0.95);
            app.world_mut().spawn((ClothCollider::default(), place));
            tick(&mut app, 3);
        }
    }
}

/// A cloth that a game throws beyond all measure is left out, and its gizmos with it.
#[test]
fn gizmos_survive_numbers_beyond_measure() {
    let mut app = app_with_gizmos();
    let cloth = (Cloth::new(16, 16, 0.01), ShowClothGizmos::levels(0..=9));
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 2);
    for far in [1e17, 5e17, 1e20, f32::MAX, f32::NAN] {
        // Between the checks and the drawing.
        change::<ClothParticles>(&mut app, cloth, |particles| {
            particles
                .set_position(77, Vec3::splat(far))
                .expect("a particle");
        });
        tick(&mut app, 3);
        change::<ClothParticles>(&mut app, cloth, |particles| *particles = default());
        tick(&mut app, 3);
        assert!(app.world().get::<ClothFault>(cloth).is_none());
    }
}

/// The ambiguity tests can fail: a system in no order with ours is found.
#[test]
#[should_panic(expected = "ambiguous")]
fn an_ambiguous_system_is_found() {
    let mut app = app();
    app.add_systems(FixedUpdate, |_: Query<&mut ClothParticles>| {});
    refuse_ambiguities(&mut app);
    tick(&mut app, 1);
}

/// In the schedule that draws, too.
#[test]
#[should_panic(expected = "ambiguous")]
fn an_ambiguous_system_is_found_where_it_draws() {
    let mut app = app_that_draws(FixedUpdate);
    app.add_systems(PostUpdate, |_: Query<&mut ClothParticles>| {});
    refuse_ambiguities(&mut app);
    tick(&mut app, 1);
}

/// Each plugin alone, in any order, in an app that has next to nothing.
#[test]
fn each_plugin_works_alone() {
    let mut app = with_plugins(ClothPlugin::default());
    let cloth = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
    tick(&mut app, 10);
    assert!(position(&app, cloth, (0, 0)).y < -0.05);

    let mut app = with_plugins((
        ClothDiagnosticsPlugin::default(),
        ClothMeshPlugin::default(),
        ClothGizmosPlugin,
        ClothRapierPlugin::default(),
    ));
    app.world_mut().spawn(Cloth::default());
    tick(&mut app, 2);
}

/// In another schedule the cloth moves by that schedule's time.
#[test]
fn the_schedule_is_the_games_choice() {
    let mut app = with_plugins(DrapePlugins::new(Update));
    let cloth = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
    tick(&mut app, 64);
    let fallen = -position(&app, cloth, (0, 0)).y;
    // g t²/2, and the discrete formula's t Δt/2 in t²/2, less than 0.1 %. Damping holds back no fall.
    let expected = GRAVITY / 2.0;
    assert!(
        (fallen / expected - 1.0).abs() < 2e-3,
        "{fallen} {expected}"
    );
}

/// No time, no motion: a paused clock leaves a cloth bit for bit as it is.
#[test]
fn a_paused_clock_stops_the_cloth() {
    for plugins in [DrapePlugins::default(), DrapePlugins::new(Update)] {
        let mut app = with_plugins(plugins);
        let cloth = app.world_mut().spawn(Cloth::default()).id();
        tick(&mut app, 10);
        app.world_mut().resource_mut::<Time<Virtual>>().pause();
        app.update();
        let before = particles(&app, cloth).clone();
        (0..5).for_each(|_| app.update());
        assert_eq!(particles(&app, cloth), &before);
        app.world_mut().resource_mut::<Time<Virtual>>().unpause();
        (0..5).for_each(|_| app.update());
        assert_ne!(particles(&app, cloth), &before);
    }
}

#[test]
fn diagnostics_are_measured() {
    let mut app = app();
    let method = SearchMethod::Tree(BoundingVolume::Sphere, BoundRule::RestShape);
    app.world_mut().spawn((Cloth::default(), method));
    app.world_mut().spawn((
        ClothCollider::default(),
        Transform::from_xyz(0.7, -0.7, 0.95),
    ));
    tick(&mut app, 30);
    let store = app.world().resource::<DiagnosticsStore>();
    let value = |path: &DiagnosticPath| {
        store
            .get(path)
            .and_then(Diagnostic::value)
            .expect("a value")
    };
    type Plugin = ClothDiagnosticsPlugin;
    assert!(value(&Plugin::INTEGRATE) > 0.0);
    assert!(value(&Plugin::REBUILD) > 0.0 && value(&Plugin::QUERY) > 0.0);
    assert!(value(&Plugin::NODES_VISITED) > value(&Plugin::LEAF_TESTS));
    assert!(value(&Plugin::LEAF_TESTS) >= value(&Plugin::CONTACTS));
    assert!(value(&Plugin::CONTACTS) > 0.0);
    assert_eq!(value(&Plugin::COLLIDERS_NEAR), 1.0);
    assert_eq!(value(&Plugin::SEARCHES), 1.0);
    assert_eq!(value(&Plugin::SCANS) + value(&Plugin::REFITS), 0.0);
    let stretch = value(&Plugin::STRETCH);
    assert!(stretch > 0.0 && stretch < 20.0, "{stretch} %");
}
