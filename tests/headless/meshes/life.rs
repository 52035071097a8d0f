//! What a grid does a mesh does too: it rests, is carried and teleported, holds tolerances, is counted and shown.

use std::{f32::consts::FRAC_PI_2, ptr, sync::Arc};

use bevy::{
    diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore},
    gizmos::{GizmoAsset, GizmoHandles},
    prelude::*,
};
use bevy_drape::{
    hierarchy::{BoundRule, BoundingVolume},
    plugin::{ClothBuilt, ClothDiagnosticsPlugin},
    prelude::*,
};

use super::sheets::*;
use crate::support::*;

/// Turned so that a lying sheet hangs by its edge, down from its transform.
fn hanging() -> Transform {
    Transform::from_rotation(Quat::from_rotation_x(FRAC_PI_2))
}

/// The triangles of a sheet that is held by its edge.
fn held(columns: u32, rows: u32) -> (Cloth, Pins) {
    let (positions, triangles) = sheet(columns, rows);
    (Cloth::triangles(positions, triangles), by_its_edge())
}

fn in_world(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    particles(app, cloth)
        .positions()
        .map(|place| frame.to_world(place))
        .collect()
}

/// Still it sleeps, and moves by not a bit; a ball that comes wakes it, and so does a pin.
#[test]
fn a_mesh_sleeps_and_wakes() {
    let mut app = app_with_moving_balls();
    let cloth = app.world_mut().spawn((held(7, 7), hanging())).id();
    let is_asleep = |app: &App| stats(app, cloth).is_asleep;
    let fall_asleep = |app: &mut App| {
        let mut ticks = 0;
        while !is_asleep(app) {
            tick(app, 1);
            ticks += 1;
            assert!(ticks < 64 * 60, "it does not come to rest");
        }
    };
    tick(&mut app, 1);
    assert!(!is_asleep(&app));
    fall_asleep(&mut app);
    let asleep = particles(&app, cloth).clone();
    tick(&mut app, 30);
    assert!(is_asleep(&app) && particles(&app, cloth) == &asleep);
    assert_eq!(stats(&app, cloth).substeps, 0);

    let place = Transform::from_xyz(0.3, -0.4, -0.8);
    let ball = (ClothCollider::ball(0.15), Moving(2.0), place);
    let ball = app.world_mut().spawn(ball).id();
    tick(&mut app, 40);
    assert!(!is_asleep(&app) && particles(&app, cloth) != &asleep);
    app.world_mut().despawn(ball);
    fall_asleep(&mut app);
    let asleep = particles(&app, cloth).clone();
    change::<Pins>(&mut app, cloth, |pins| *pins = Pins::new([Pin::Vertex(0)]));
    tick(&mut app, 5);
    assert!(!is_asleep(&app) && particles(&app, cloth) != &asleep);
}

/// It jumps with its shape and speed, to the last bit; carried, its pins go along and the rest follows.
#[test]
fn a_mesh_teleports_and_follows() {
    let run = |teleport: bool| {
        let mut app = app();
        let material = ClothMaterial {
            damping: 0.0,
            ..default()
        };
        let cloth = app.world_mut().spawn((held(6, 6), material)).id();
        tick(&mut app, 20);
        if teleport {
            let there = (Transform::from_xyz(500.0, 20.0, -3.0), ClothTeleport);
            app.world_mut().entity_mut(cloth).insert(there);
        }
        tick(&mut app, 20);
        particles(&app, cloth).clone()
    };
    assert!(run(false) == run(true));

    let mut app = app();
    let cloth = app.world_mut().spawn((held(6, 6), hanging())).id();
    tick(&mut app, 1);
    for step in 1..=64 {
        change::<Transform>(&mut app, cloth, |place| {
            place.translation.x = step as f32 / 64.0;
            place.rotate_y(0.01);
        });
        tick(&mut app, 1);
        let place = *app.world().get::<Transform>(cloth).expect("a place");
        let surface = surface(&app, cloth).clone();
        let places = in_world(&app, cloth);
        for (rest, found) in surface.rest_positions().iter().zip(&places) {
            let carried = place.transform_point(*rest);
            let off = carried.distance(*found);
            let is_pinned = rest.z < 0.01;
            assert!(off < if is_pinned { 1.0e-5 } else { 0.45 }, "{step}: {off}");
        }
        let stretch = stats(&app, cloth).stretch.structural;
        assert!(stretch < 0.1, "{step}: {stretch}");
    }
    assert!(particles(&app, cloth).largest_speed() > 0.2, "it swings");
}

/// Dropped from where it lies, it holds what is asked for in every tick, and takes more sub-steps for less.
#[test]
fn a_mesh_holds_a_tolerance() {
    let substeps = [0.05, 0.01].map(|tolerance| {
        let mut app = app();
        let settings = ClothSettings::tolerance(tolerance);
        let cloth = app.world_mut().spawn((held(12, 12), settings)).id();
        let mut substeps = 0;
        for number in 0..128 {
            tick(&mut app, 1);
            let stats = stats(&app, cloth);
            let stretch = stats.stretch.structural;
            assert!(stretch <= tolerance, "{stretch} in tick {number}");
            substeps += stats.substeps;
        }
        assert_eq!(messages::<ClothLimitExceeded>(&mut app), []);
        substeps
    });
    assert!(substeps[1] > substeps[0], "{substeps:?}");
}

/// Hung by one vertex without tethers, in two sub-steps: it is reported, with the figure that is among its own.
#[test]
fn a_mesh_beyond_its_limits_is_reported() {
    let mut app = app();
    let settings = ClothSettings {
        tethers: false,
        sleeps: false,
        ..ClothSettings::substeps(2)
    };
    let (cloth, _) = held(32, 32);
    let cloth = (cloth, Pins::new([Pin::Vertex(0)]), settings);
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 64);
    let reported = messages::<ClothLimitExceeded>(&mut app);
    // Once, and again when it is ten times worse.
    assert!((1..=2).contains(&reported.len()), "{reported:?}");
    for reported in reported {
        assert_eq!(
            (reported.cloth, reported.limit),
            (cloth, ClothLimit::Stretch)
        );
        assert!(reported.quantity > reported.good_up_to, "{reported:?}");
    }
    assert_eq!(stats(&app, cloth).exceeded, Some(ClothLimit::Stretch));
    assert!(stats(&app, cloth).stretch.structural > 0.15);
}

/// Figures of its own, and the sums over all cloths.
#[test]
fn a_mesh_is_counted() {
    let mut app = app();
    let by_tree = SearchMethod::Tree(BoundingVolume::Sphere, BoundRule::RestShape);
    let mesh = app.world_mut().spawn((held(24, 24), by_tree)).id();
    let grid = app
        .world_mut()
        .spawn((Cloth::default(), Transform::from_xyz(20.0, 0.0, 0.0)))
        .id();
    let place = Transform::from_xyz(1.15, -0.1, 1.0);
    app.world_mut().spawn((ClothCollider::ball(0.05), place));
    let mut searched = 0;
    for _ in 0..30 {
        tick(&mut app, 1);
        let [mesh, grid] = [mesh, grid].map(|cloth| stats(&app, cloth));
        let store = app.world().resource::<DiagnosticsStore>();
        let value = |path: &DiagnosticPath| store.get(path).and_then(Diagnostic::value);
        type Plugin = ClothDiagnosticsPlugin;
        assert_eq!(
            value(&Plugin::SUBSTEPS),
            Some(f64::from(mesh.substeps + grid.substeps))
        );
        assert_eq!(value(&Plugin::CONTACTS), Some(mesh.contacts as f64));
        assert_eq!(
            value(&Plugin::NODES_VISITED),
            Some(mesh.nodes_visited as f64)
        );
        assert_eq!(
            value(&Plugin::COLLIDERS_NEAR),
            Some(mesh.colliders_near as f64)
        );
        let stretch = mesh.stretch.structural.max(grid.stretch.structural);
        assert_eq!(value(&Plugin::STRETCH), Some(100.0 * f64::from(stretch)));
        if mesh.contacts > 0 {
            searched += 1;
            assert_eq!(mesh.search, by_tree);
            // A small ball on a large sheet.
            assert!((1..576).contains(&mesh.leaf_tests), "{}", mesh.leaf_tests);
        }
    }
    assert!(searched > 5, "{searched}");
}

/// Its volumes and springs are drawn where it is.
#[test]
fn gizmos_show_a_mesh() {
    let drawn = |show: ShowClothGizmos| {
        let mut app = app_with_gizmos();
        app.insert_resource(ClothGravity(Vec3::ZERO));
        let place = Transform::from_xyz(3.0, 0.0, 0.0);
        app.world_mut().spawn((held(8, 8), place, show));
        tick(&mut app, 2);
        let handles = app.world().resource::<GizmoHandles>().handles();
        let assets = app.world().resource::<Assets<GizmoAsset>>();
        let handle = handles.get(&std::any::TypeId::of::<ClothGizmos>());
        let asset = handle
            .and_then(Option::as_ref)
            .and_then(|handle| assets.get(handle));
        asset.map_or_else(Vec::new, |asset| {
            let buffer = asset.buffer();
            let corners = buffer.list_positions.iter().chain(&buffer.strip_positions);
            corners
                .copied()
                .filter(|corner| !corner.is_nan())
                .collect::<Vec<Vec3>>()
        })
    };
    assert!(drawn(ShowClothGizmos::nothing()).is_empty());
    // The sheet is 0.7 m wide; the root is a sphere around it.
    let middle = Vec3::new(3.35, 0.0, 0.35);
    for (show, radius) in [
        (ShowClothGizmos::level(0), 1.2),
        (ShowClothGizmos::level(2), 0.8),
        (ShowClothGizmos::springs(), 0.5),
    ] {
        let corners = drawn(show.clone());
        assert!(corners.len() > 20, "{show:?}: {}", corners.len());
        for corner in &corners {
            assert!(corner.distance(middle) < radius, "{show:?}: {corner}");
        }
    }
    // All 7 × 8 threads either way and 49 diagonals, two corners each, at least.
    let springs = drawn(ShowClothGizmos::springs()).len();
    assert!(springs >= 2 * (2 * 56 + 49), "{springs}");
}

/// A thousand cloths of one mesh and material have one surface, springs and tree; of another material they have other
/// springs and that surface. Another scale or weld is another surface.
#[test]
fn cloths_made_alike_share_what_they_are() {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, sheet_asset(3, 3));
    let cloths: Vec<Entity> = (0..1000).map(|_| spawn(&mut app, &handle, ())).collect();
    let others = [
        spawn(&mut app, &handle, Transform::from_scale(Vec3::splat(2.0))),
        app.world_mut()
            .spawn((Cloth::mesh().welded(0.0), Mesh3d(handle.clone())))
            .id(),
    ];
    fn built(app: &App, cloth: Entity) -> &ClothBuilt {
        app.world().get(cloth).expect("what was built")
    }
    let all_share = |app: &App, cloths: &[Entity]| {
        let first = built(app, cloths[0]);
        assert_eq!(first.surface().len(), 9);
        cloths.iter().all(|cloth| {
            let cloth = built(app, *cloth);
            Arc::ptr_eq(cloth.surface(), first.surface())
                && ptr::eq(cloth.springs(), first.springs())
                && ptr::eq(cloth.tree(), first.tree())
        })
    };
    tick(&mut app, 2);
    assert!(all_share(&app, &cloths));
    for other in others {
        assert!(!Arc::ptr_eq(surface(&app, cloths[0]), surface(&app, other)));
    }
    let before = surface(&app, cloths[0]).clone();
    let (changed, unchanged) = cloths.split_at(500);
    for cloth in changed {
        change::<ClothMaterial>(&mut app, *cloth, |material| {
            *material = ClothMaterial::RUBBER;
        });
    }
    tick(&mut app, 2);
    for half in [changed, unchanged] {
        assert!(all_share(&app, half));
        assert!(Arc::ptr_eq(surface(&app, half[0]), &before));
    }
    let [one, other] = [changed, unchanged].map(|half| built(&app, half[0]).springs());
    assert!(!ptr::eq(one, other));
    for cloth in unchanged {
        change::<ClothMaterial>(&mut app, *cloth, |material| {
            *material = ClothMaterial::RUBBER;
        });
    }
    tick(&mut app, 2);
    assert!(all_share(&app, &cloths));
    assert!(Arc::ptr_eq(surface(&app, cloths[0]), &before));
}
