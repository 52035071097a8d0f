//! Colliders on bones.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::rig::*;
use crate::{meshes::sheets::fault, support::*};

fn colliders(app: &mut App) -> Vec<(Entity, ClothCollider, GlobalTransform)> {
    let mut query = app.world_mut().query::<(Entity, &ClothCollider)>();
    let all: Vec<_> = query
        .iter(app.world())
        .map(|(a, b)| (a, b.clone()))
        .collect();
    let place = |entity| app.world().get::<GlobalTransform>(entity).copied();
    all.into_iter()
        .map(|(entity, collider)| (entity, collider, place(entity).expect("a place")))
        .collect()
}

fn bones() -> ClothBones {
    ClothBones::new([
        ClothBone::capsule("bone 0", "bone 1", 0.05),
        ClothBone::ball("bone 2", 0.1),
    ])
}

/// They are where their bones are, whatever scale the bones have as they are found, and go where those go.
#[test]
fn colliders_are_on_their_bones() {
    for scale in [1.0, 0.01] {
        let mut app = app_that_draws(FixedUpdate);
        let rig = rig(&mut app, ());
        change::<Transform>(&mut app, rig.root, |root| root.scale = Vec3::splat(scale));
        app.world_mut().entity_mut(rig.root).insert(bones());
        for count in 0..20 {
            pose(&mut app, &rig, count as f32 * TICK);
            tick(&mut app, 2);
            assert_eq!(fault(&app, rig.root), None);
            let found = colliders(&mut app);
            assert_eq!(found.len(), 2);
            let head = |bone: usize| {
                let place = app.world().get::<GlobalTransform>(rig.bones[bone]);
                place.expect("a bone").translation()
            };
            for (_, collider, place) in &found {
                let shape = collider.scaled(place.scale()).expect("a shape");
                match collider {
                    ClothCollider::Ball { .. } => {
                        assert!(place.translation().distance(head(2)) < 1.0e-5);
                        assert!((shape.radius().expect("one") - 0.1).abs() < 1.0e-5);
                    }
                    ClothCollider::Capsule { half_length, .. } => {
                        assert!((shape.radius().expect("one") - 0.05).abs() < 1.0e-5);
                        for (end, bone) in [(-1.0, 0), (1.0, 1)] {
                            let end = place.transform_point(Vec3::Y * end * *half_length);
                            assert!(end.distance(head(bone)) < 1.0e-5, "{end}");
                        }
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
    }
}

/// They wait for the scene; a name that is not in it is a fault; another list replaces them, and they go with their component.
#[test]
fn they_wait_for_the_scene_and_are_made_anew() {
    let mut app = app_that_draws(FixedUpdate);
    let hero = (Name::new("hero"), Transform::default(), bones());
    let hero = app.world_mut().spawn(hero).id();
    tick(&mut app, 3);
    assert_eq!((colliders(&mut app).len(), fault(&app, hero)), (0, None));
    let rig = rig(&mut app, ());
    app.world_mut().entity_mut(rig.root).insert(ChildOf(hero));
    tick(&mut app, 2);
    assert_eq!(colliders(&mut app).len(), 2);
    let known = colliders(&mut app)[0].0;
    tick(&mut app, 5);
    assert_eq!(colliders(&mut app)[0].0, known, "not made again");
    let tail = ClothBones::new([ClothBone::ball("tail", 0.1)]);
    app.world_mut().entity_mut(hero).insert(tail);
    tick(&mut app, 2);
    let named = |error: &ClothError| error.to_string().contains("tail");
    assert!(fault(&app, hero).is_some_and(|error| named(&error)));
    let one = ClothBones::new([ClothBone::ball("bone 1", 0.2)]);
    app.world_mut().entity_mut(hero).insert(one);
    tick(&mut app, 2);
    assert_eq!((colliders(&mut app).len(), fault(&app, hero)), (1, None));
    // The scene is spawned again.
    app.world_mut().entity_mut(rig.root).despawn();
    tick(&mut app, 2);
    assert_eq!(colliders(&mut app).len(), 0);
    let rig = self::rig(&mut app, ());
    app.world_mut().entity_mut(rig.root).insert(ChildOf(hero));
    tick(&mut app, 2);
    assert_eq!(colliders(&mut app).len(), 1);
    app.world_mut().entity_mut(hero).remove::<ClothBones>();
    tick(&mut app, 2);
    assert_eq!(colliders(&mut app).len(), 0);
}

/// An arm that strikes a hanging cloth at 20 m/s takes it along; a collider that is a child of a bone is one line, too.
#[test]
fn an_animated_bone_does_not_pass_through() {
    for by_name in [true, false] {
        let mut app = app();
        let shoulder = Transform::from_xyz(0.55, 0.0, 0.0);
        let shoulder = app.world_mut().spawn((shoulder, Name::new("hero"))).id();
        let arm = (
            Transform::from_xyz(0.0, -0.6, 0.0),
            Name::new("hand"),
            ChildOf(shoulder),
        );
        let arm = app.world_mut().spawn(arm).id();
        change::<Transform>(&mut app, shoulder, |arm| {
            arm.rotation = Quat::from_rotation_x(1.2);
        });
        if by_name {
            let hand = ClothBones::new([ClothBone::ball("hand", 0.12)]);
            app.world_mut().entity_mut(shoulder).insert(hand);
        } else {
            app.world_mut()
                .entity_mut(arm)
                .with_child(ClothCollider::ball(0.12));
        }
        let cloth = app.world_mut().spawn(Cloth::new(12, 12, 0.1)).id();
        tick(&mut app, 10);
        let mut inside = 0.0_f32;
        for count in 0..5 {
            let angle = 1.2 - 0.5 * count as f32;
            change::<Transform>(&mut app, shoulder, |arm| {
                arm.rotation = Quat::from_rotation_x(angle);
            });
            tick(&mut app, 1);
            let hand = Vec3::new(0.55, 0.0, 0.0) + Quat::from_rotation_x(angle) * Vec3::Y * -0.6;
            for place in particles(&app, cloth).positions() {
                inside = inside.max(0.12 - place.distance(hand));
            }
        }
        let hand = Quat::from_rotation_x(-0.8) * Vec3::Y * -0.6;
        let pushed = particles(&app, cloth).positions();
        let farthest = pushed.map(|place| place.z).fold(
            0.0,
            |a: f32, b| {
                if b.abs() > a.abs() { b } else { a }
            },
        );
        assert!(
            farthest * hand.z > 0.0 && farthest.abs() > 0.3,
            "{farthest} {hand}"
        );
        assert!(inside < 0.02, "{inside}");
    }
}
