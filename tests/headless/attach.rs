//! Pins that follow entities, and teleports.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A cloth whose left column follows a pole.
fn flag(pole: Transform) -> (App, Entity, Entity) {
    let mut app = app();
    let pole = app.world_mut().spawn(pole).id();
    let attached = ClothAttachments::new([(Pin::Column(0), pole)]);
    let flag = (Cloth::new(12, 8, 0.1), Pins::none(), attached);
    let flag = app
        .world_mut()
        .spawn((flag, Transform::from_xyz(1.0, 2.0, 3.0)))
        .id();
    tick(&mut app, 1);
    (app, flag, pole)
}

fn in_world(app: &App, cloth: Entity, cell: (u32, u32)) -> Vec3 {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    frame.to_world(position(app, cloth, cell))
}

/// Offsets are kept, turned and scaled with the target, wherever the target was when the cloth was attached.
#[test]
fn attached_pins_go_where_their_target_takes_them() {
    let start = Transform::from_xyz(-1.0, 0.5, 0.0).with_rotation(Quat::from_rotation_y(0.7));
    let (mut app, flag, pole) = flag(start);
    let rest: Vec<Vec3> = (0..8).map(|row| in_world(&app, flag, (row, 0))).collect();
    for step in 1..=40 {
        let step = step as f32;
        let goal = Transform::from_xyz(-1.0 + 0.02 * step, 0.5, 0.01 * step)
            .with_rotation(Quat::from_rotation_y(0.7 + 0.02 * step))
            .with_scale(Vec3::splat(1.0 + 0.002 * step));
        change::<Transform>(&mut app, pole, |transform| *transform = goal);
        tick(&mut app, 1);
        for (row, rest) in rest.iter().enumerate() {
            let expected = goal.to_matrix() * start.to_matrix().inverse() * rest.extend(1.0);
            let found = in_world(&app, flag, (row as u32, 0));
            // Some ten roundings of numbers of a few metres.
            assert!(
                found.distance(expected.truncate()) < 1.0e-5,
                "{found} {expected}"
            );
        }
    }
    // And what hangs from them follows.
    assert!(in_world(&app, flag, (0, 1)).distance(in_world(&app, flag, (0, 0))) < 0.2);
}

/// In the course of a tick they move evenly, so that a target that moves at a steady speed tears at nothing: the
/// cloth is stretched no more than one whose own transform moves likewise.
#[test]
fn they_move_smoothly_over_the_sub_steps() {
    let stretch = |attached: bool| {
        let (mut app, flag, pole) = flag(Transform::IDENTITY);
        if !attached {
            change::<Pins>(&mut app, flag, |pins| *pins = Pins::new([Pin::Column(0)]));
            app.world_mut()
                .entity_mut(flag)
                .remove::<ClothAttachments>();
        }
        let moved = if attached { pole } else { flag };
        let mut largest = 0.0_f32;
        for _ in 0..64 {
            change::<Transform>(&mut app, moved, |t| t.translation.z += 2.0 / 64.0);
            tick(&mut app, 1);
            let stats = app.world().get::<ClothStats>(flag).expect("figures");
            largest = largest.max(stats.stretch.structural);
        }
        largest
    };
    let (attached, own) = (stretch(true), stretch(false));
    assert!((attached / own - 1.0).abs() < 0.05, "{attached} {own}");
}

#[test]
fn what_is_released_falls_and_pins_of_the_games_own_stay() {
    let (mut app, flag, _) = flag(Transform::IDENTITY);
    change::<Pins>(&mut app, flag, |pins| *pins = Pins::new([Pin::Cell(0, 11)]));
    tick(&mut app, 5);
    let (held, pinned) = (in_world(&app, flag, (4, 0)), in_world(&app, flag, (0, 11)));
    tick(&mut app, 5);
    assert_eq!(in_world(&app, flag, (4, 0)), held);
    app.world_mut()
        .entity_mut(flag)
        .remove::<ClothAttachments>();
    tick(&mut app, 20);
    assert!(in_world(&app, flag, (4, 0)).distance(held) > 0.1);
    assert_eq!(in_world(&app, flag, (0, 11)), pinned);
}

/// A target that is despawned or has no transform is a fault that is named, and mended by another target.
#[test]
fn a_target_that_is_gone_is_named() {
    let (mut app, flag, pole) = flag(Transform::IDENTITY);
    tick(&mut app, 3);
    app.world_mut().despawn(pole);
    tick(&mut app, 3);
    let fault = app.world().get::<ClothFault>(flag).expect("a fault");
    let expected = ClothError::Target(TargetError::NoTarget {
        pin: format!("{:?}", Pin::Column(0)),
        target: pole,
    });
    assert_eq!(fault.error, expected);
    assert!(fault.error.to_string().contains(&pole.to_string()));
    let before = particles(&app, flag).clone();
    tick(&mut app, 3);
    assert_eq!(particles(&app, flag), &before);

    let other = app
        .world_mut()
        .spawn(Transform::from_xyz(0.0, 1.0, 0.0))
        .id();
    let attached = ClothAttachments::new([(Pin::Column(0), other)]);
    app.world_mut().entity_mut(flag).insert(attached);
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(flag).is_none());
    assert_ne!(particles(&app, flag), &before);

    let outside = ClothAttachments::new([(Pin::Row(8), other)]);
    app.world_mut().entity_mut(flag).insert(outside);
    tick(&mut app, 1);
    let fault = app.world().get::<ClothFault>(flag).expect("a fault");
    assert!(matches!(
        fault.error,
        ClothError::Pin(PinError::OutOfRange { .. })
    ));
}

/// A cloth that is built again is attached again, where it then is.
#[test]
fn attachments_outlast_a_new_build() {
    let (mut app, flag, pole) = flag(Transform::IDENTITY);
    change::<ClothParticles>(&mut app, flag, |particles| *particles = default());
    tick(&mut app, 1);
    change::<Cloth>(&mut app, flag, |cloth| *cloth = Cloth::new(8, 6, 0.1));
    tick(&mut app, 1);
    let before = in_world(&app, flag, (3, 0));
    change::<Transform>(&mut app, pole, |transform| transform.translation.x = 0.05);
    tick(&mut app, 1);
    let moved = in_world(&app, flag, (3, 0)) - before;
    assert!((moved - Vec3::X * 0.05).length() < 1.0e-6, "{moved}");
}

/// A teleported cloth is, seen from its entity, what it would have been without: to the last bit, but for gravity's
/// direction under a rotation.
#[test]
fn a_teleport_gives_no_speed() {
    let run = |teleport: Option<Vec3>| {
        let mut app = app();
        let cloth = app.world_mut().spawn(Cloth::default()).id();
        change::<ClothMaterial>(&mut app, cloth, |material| material.damping = 0.0);
        change::<ClothSettings>(&mut app, cloth, |settings| settings.sleeps = false);
        tick(&mut app, 40);
        if let Some(to) = teleport {
            let there = (Transform::from_translation(to), ClothTeleport);
            app.world_mut().entity_mut(cloth).insert(there);
        }
        tick(&mut app, 40);
        assert!(app.world().get::<ClothTeleport>(cloth).is_none());
        (
            particles(&app, cloth).clone(),
            in_world(&app, cloth, (0, 0)),
        )
    };
    let ((stayed, _), (gone, pin)) = (run(None), run(Some(Vec3::new(1000.0, 50.0, -3.0))));
    assert!(stayed == gone);
    assert_eq!(pin, Vec3::new(1000.0, 50.0, -3.0));
}

/// With attachments the cloth goes along with the first one's target, though its own entity stays.
#[test]
fn a_cape_teleports_with_its_bearer() {
    let (mut app, cape, bearer) = flag(Transform::IDENTITY);
    tick(&mut app, 60);
    let cells = [(0, 0), (7, 0), (3, 6), (7, 11)];
    let before = cells.map(|cell| in_world(&app, cape, cell));
    let speed = particles(&app, cape).largest_speed();
    let jump = Transform::from_xyz(40.0, 1.0, 2.0).with_rotation(Quat::from_rotation_y(1.0));
    app.world_mut().entity_mut(cape).insert(ClothTeleport);
    change::<Transform>(&mut app, bearer, |transform| *transform = jump);
    tick(&mut app, 1);
    // What a tick of its own motion comes to, and the rounding of 40 m in some ten operations.
    let allowed = (speed + GRAVITY * TICK) * TICK * 1.5 + 1.0e-4;
    for (cell, before) in cells.into_iter().zip(before) {
        let expected = jump.transform_point(before);
        let found = in_world(&app, cape, cell);
        assert!(
            found.distance(expected) < allowed,
            "{cell:?}: {found} {expected}"
        );
    }
    // It goes on as one that has stayed, but for what rounding at 40 m does to its speed in a tick: 4e-6 m in a sub-step of
    // 1/1280 s is 5e-3 m/s.
    let after = particles(&app, cape).largest_speed();
    let (mut app, stayed, _) = flag(Transform::IDENTITY);
    tick(&mut app, 61);
    let expected = particles(&app, stayed).largest_speed();
    assert!((after - expected).abs() < 0.05, "{after} {expected}");
}

/// Likewise where its own entity goes along: a cape that is its bearer's child.
#[test]
fn a_child_teleports_with_its_bearer() {
    let mut app = app();
    let bearer = app.world_mut().spawn(Transform::IDENTITY).id();
    let attached = ClothAttachments::new([(Pin::Row(0), bearer)]);
    let cape = (
        Cloth::new(8, 8, 0.1),
        Pins::none(),
        attached,
        ChildOf(bearer),
    );
    let cape = app
        .world_mut()
        .spawn((cape, Transform::from_xyz(0.0, 1.5, 0.0)))
        .id();
    tick(&mut app, 40);
    let before = [(0, 0), (7, 7)].map(|cell| in_world(&app, cape, cell));
    let jump = Transform::from_xyz(-30.0, 0.0, 7.0);
    app.world_mut().entity_mut(cape).insert(ClothTeleport);
    change::<Transform>(&mut app, bearer, |transform| *transform = jump);
    tick(&mut app, 1);
    for (cell, before) in [(0, 0), (7, 7)].into_iter().zip(before) {
        let found = in_world(&app, cape, cell);
        let expected = jump.transform_point(before);
        assert!(
            found.distance(expected) < 0.01,
            "{cell:?}: {found} {expected}"
        );
    }
}

/// A change of one attachment leaves the others' offsets as they are, and masses that the game set.
#[test]
fn a_change_of_attachments_leaves_the_others_alone() {
    let (mut app, flag, pole) = flag(Transform::IDENTITY);
    tick(&mut app, 5);
    change::<ClothParticles>(&mut app, flag, |particles| {
        particles.set_inverse_mass((4, 6), 0.0).expect("a particle");
    });
    let held = in_world(&app, flag, (4, 6));
    let before = in_world(&app, flag, (3, 0));
    let other = app.world_mut().spawn(Transform::IDENTITY).id();
    let both = ClothAttachments::new([(Pin::Cell(0, 11), other), (Pin::Column(0), pole)]);
    app.world_mut().entity_mut(flag).insert(both);
    // While it changes, the pole moves on.
    change::<Transform>(&mut app, pole, |transform| transform.translation.y = 0.08);
    tick(&mut app, 1);
    let moved = in_world(&app, flag, (3, 0)) - before;
    assert!((moved - Vec3::Y * 0.08).length() < 1.0e-5, "{moved}");
    assert_eq!(in_world(&app, flag, (4, 6)), held);
    app.world_mut()
        .entity_mut(flag)
        .remove::<ClothAttachments>();
    tick(&mut app, 10);
    assert_eq!(in_world(&app, flag, (4, 6)), held);
    assert_eq!(particles(&app, flag).is_pinned((3, 0)), Some(false));
    assert_eq!(particles(&app, flag).is_pinned((0, 11)), Some(false));
    assert_ne!(in_world(&app, flag, (3, 0)), before + moved);
}

/// Of targets of one name, a cloth takes the one with the nearest common ancestor: each copy of a figure has its own.
#[test]
fn a_copy_of_a_figure_has_its_own_target() {
    let mut app = app();
    let figures = [0.0, 3.0].map(|x| {
        let figure = app.world_mut().spawn(Transform::from_xyz(x, 0.0, 0.0)).id();
        let bone = (Name::new("shoulders"), Transform::default());
        let bone = app.world_mut().spawn((bone, ChildOf(figure))).id();
        let attached = ClothAttachments::new([(Pin::Row(0), "shoulders")]);
        let cape = (Cloth::new(6, 6, 0.1), Pins::none(), attached);
        let cape = app.world_mut().spawn((cape, ChildOf(figure))).id();
        (bone, cape)
    });
    tick(&mut app, 2);
    for (bone, cape) in figures {
        let [before, others] = [cape, figures[0].1].map(|of| in_world(&app, of, (0, 0)));
        change::<Transform>(&mut app, bone, |place| place.translation.y += 0.05);
        tick(&mut app, 1);
        // Some ten roundings of numbers of a few metres.
        let moved = in_world(&app, cape, (0, 0)) - before;
        assert!(moved.distance(0.05 * Vec3::Y) < 1.0e-5, "{moved}");
        let first = in_world(&app, figures[0].1, (0, 0)) - others;
        assert!(cape == figures[0].1 || first.length() < 1.0e-5, "{first}");
    }
}

/// Of those that are so called, one that is nowhere is no target.
#[test]
fn a_target_without_a_place_is_not_meant() {
    let mut app = app();
    let pole = Name::new("pole");
    app.world_mut().spawn(pole.clone());
    app.world_mut().spawn((pole, Transform::default()));
    let attached = ClothAttachments::new([(Pin::Row(0), "pole")]);
    let cloth = (Cloth::new(6, 6, 0.1), Pins::none(), attached);
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 16);
    assert_eq!(app.world().get::<ClothFault>(cloth), None);
    assert_eq!(position(&app, cloth, (0, 0)).y, 0.0);
}
