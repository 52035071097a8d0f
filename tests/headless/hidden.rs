//! Cloths that are hidden, and what is no cloth any more.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A cloth moves the same, to the last bit, whether it, or what it is a child of, is hidden or not; and its mesh is as it should be
/// as soon as it is seen.
#[test]
fn a_hidden_cloth_moves_on() {
    let mut app = app_that_draws(FixedUpdate);
    let seen = app
        .world_mut()
        .spawn((Cloth::default(), Visibility::default()))
        .id();
    let hidden = app
        .world_mut()
        .spawn((Cloth::default(), Visibility::Hidden))
        .id();
    let below = app
        .world_mut()
        .spawn((Cloth::default(), Visibility::default()))
        .id();
    let above = app
        .world_mut()
        .spawn((Transform::default(), Visibility::Hidden))
        .add_child(below)
        .id();
    tick(&mut app, 40);
    for cloth in [hidden, below] {
        assert_eq!(particles(&app, cloth), particles(&app, seen));
    }
    let drawn = |app: &App, cloth: Entity| {
        let mesh = app.world().get::<Mesh3d>(cloth).expect("a mesh");
        let mesh = app.world().resource::<Assets<Mesh>>().get(&mesh.0);
        let positions = mesh.expect("an asset").attribute(Mesh::ATTRIBUTE_POSITION);
        positions
            .and_then(|values| values.as_float3())
            .expect("positions")
            .to_vec()
    };
    for cloth in [hidden, below] {
        assert_ne!(drawn(&app, cloth), drawn(&app, seen));
    }
    for entity in [hidden, above] {
        app.world_mut()
            .entity_mut(entity)
            .insert(Visibility::Visible);
    }
    tick(&mut app, 1);
    for cloth in [hidden, below] {
        assert_eq!(drawn(&app, cloth), drawn(&app, seen));
    }
}

/// What was a cloth draws what it drew before it was one: its own mesh where it had one, and nothing where it had none.
#[test]
fn what_is_no_cloth_any_more_draws_what_it_drew_before() {
    let mut app = app_that_draws(FixedUpdate);
    let own = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Cuboid::default());
    let with = app
        .world_mut()
        .spawn((Cloth::default(), Mesh3d(own.clone())))
        .id();
    let without = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 3);
    for cloth in [with, without] {
        let drawn = app.world().get::<Mesh3d>(cloth).expect("a mesh").0.clone();
        assert_ne!(drawn, own);
        // A new mesh of the plugin's own is none that the entity had.
        change::<Cloth>(&mut app, cloth, |cloth| *cloth = Cloth::new(9, 9, 0.1));
        tick(&mut app, 3);
        app.world_mut().entity_mut(cloth).remove::<Cloth>();
        tick(&mut app, 1);
    }
    assert_eq!(
        app.world().get::<Mesh3d>(with).map(|mesh| &mesh.0),
        Some(&own)
    );
    assert!(app.world().get::<Mesh3d>(without).is_none());
}

/// With a level of detail, what is hidden costs nothing, be it its own doing or an ancestor's, and goes on where it was when it is seen
/// again. By hand it is as the game says; where no camera is, nobody can see whether.
#[test]
fn a_hidden_cloth_with_a_level_of_detail_costs_nothing() {
    for has_camera in [true, false] {
        let mut app = app_that_draws(FixedUpdate);
        if has_camera {
            app.world_mut()
                .spawn((Camera::default(), Transform::from_xyz(0.0, 0.0, 5.0)));
        }
        let world = app.world_mut();
        let near = ClothLod::by_distance([(100.0, ClothLodLevel::Frozen)]);
        let sheet = (Cloth::new(5, 5, 0.1), near.clone(), Visibility::default());
        let own = world.spawn(sheet).id();
        let above = world
            .spawn((Transform::default(), Visibility::default()))
            .id();
        let sheet = (Cloth::new(5, 5, 0.1), near.clone(), ChildOf(above));
        let below = world.spawn((sheet, Visibility::default())).id();
        let by_hand = (Cloth::new(5, 5, 0.1), ClothLod::at(ClothLodLevel::Full));
        let by_hand = world.spawn((by_hand, Visibility::Hidden)).id();
        tick(&mut app, 10);
        for cloth in [own, below] {
            assert!(stats(&app, cloth).substeps > 0);
        }
        for entity in [own, above] {
            change::<Visibility>(&mut app, entity, |visibility| {
                *visibility = Visibility::Hidden;
            });
        }
        tick(&mut app, 3);
        let before = [own, below].map(|cloth| particles(&app, cloth).clone());
        tick(&mut app, 10);
        for (cloth, before) in [own, below].into_iter().zip(&before) {
            assert_eq!(stats(&app, cloth).substeps == 0, has_camera);
            assert_eq!(particles(&app, cloth) == before, has_camera);
        }
        assert!(stats(&app, by_hand).substeps > 0);
        for entity in [own, above] {
            change::<Visibility>(&mut app, entity, |visibility| {
                *visibility = Visibility::Visible;
            });
        }
        tick(&mut app, 3);
        for cloth in [own, below] {
            assert_eq!(stats(&app, cloth).level, ClothLodLevel::Full);
            assert!(stats(&app, cloth).substeps > 0);
        }
    }
}
