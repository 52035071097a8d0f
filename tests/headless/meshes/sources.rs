//! Where the mesh comes from, and when.

use std::{thread, time::Duration};

use bevy::{
    asset::LoadState, camera::visibility::VisibilityPlugin, gltf::GltfPlugin, mesh::MeshPlugin,
    prelude::*, time::TimeUpdateStrategy, world_serialization::WorldSerializationPlugin,
};
use bevy_drape::prelude::*;

use super::sheets::*;
use crate::support::*;

/// An asset that comes some ticks later: until then there is nothing, then it falls, and nothing is wrong any more.
#[test]
fn a_cloth_waits_for_its_mesh() {
    let mut app = app_that_draws(FixedUpdate);
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    let cloth = spawn(&mut app, &handle, ());
    tick(&mut app, 5);
    assert!(particles(&app, cloth).is_empty());
    assert_eq!(mesh_of(&app, cloth), handle);
    let mesh = sheet_asset(4, 4);
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    meshes.insert(&handle, mesh).expect("it is reserved");
    tick(&mut app, 16);
    assert_eq!(fault(&app, cloth), None);
    assert_eq!(particles(&app, cloth).len(), 16);
    // 16 ticks are 0.25 s.
    let fallen = by_vertex(&app, cloth)[0].expect("a particle").y;
    assert!((fallen + GRAVITY / 32.0).abs() < 0.03, "{fallen}");
}

fn app_that_loads() -> App {
    with_plugins((
        assets(),
        MeshPlugin,
        ImagePlugin::default(),
        VisibilityPlugin,
        WorldSerializationPlugin,
        GltfPlugin::default(),
        DrapePlugins::default(),
    ))
}

/// Lets time stand still until an asset is loaded or has failed to.
fn wait_for(app: &mut App, handle: &Handle<Mesh>) {
    let paused = TimeUpdateStrategy::ManualDuration(Duration::ZERO);
    app.insert_resource(paused);
    for _ in 0..2000 {
        app.update();
        let server = app.world().resource::<AssetServer>();
        match server.get_load_state(handle) {
            Some(LoadState::Loaded | LoadState::Failed(_)) => break,
            _ => thread::sleep(Duration::from_millis(5)),
        }
    }
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
}

/// A model of a file: on its way it is no fault, then it is cloth, held by what its artist painted.
#[test]
fn a_file_is_loaded() {
    let mut app = app_that_loads();
    let server = app.world().resource::<AssetServer>();
    let handle: Handle<Mesh> = server.load("models/tent.glb#Mesh0/Primitive0");
    let cloth = spawn(&mut app, &handle, ());
    tick(&mut app, 1);
    assert_eq!(fault(&app, cloth), None, "what is on its way is no fault");
    wait_for(&mut app, &handle);
    tick(&mut app, 20);
    assert_eq!(fault(&app, cloth), None);
    let vertices = meshes(&app)
        .get(&handle)
        .expect("the model")
        .count_vertices();
    assert!(!particles(&app, cloth).is_empty());
    assert_eq!(surface(&app, cloth).vertices(), vertices);
    assert!(particles(&app, cloth).largest_speed() > 0.5, "it falls");
}

#[test]
fn a_file_that_is_not_there_is_a_fault() {
    let mut app = app_that_loads();
    let server = app.world().resource::<AssetServer>();
    let handle: Handle<Mesh> = server.load("models/nothing.glb#Mesh0/Primitive0");
    let cloth = spawn(&mut app, &handle, ());
    tick(&mut app, 1);
    wait_for(&mut app, &handle);
    tick(&mut app, 1);
    let fault = fault(&app, cloth);
    assert!(
        matches!(&fault, Some(ClothError::Mesh(MeshError::Failed { reason })) if reason.contains("nothing.glb")),
        "{fault:?}"
    );
}

#[test]
fn without_a_mesh_there_is_nothing_until_one_comes() {
    let mut app = app_that_draws(FixedUpdate);
    let cloth = app.world_mut().spawn(Cloth::mesh()).id();
    tick(&mut app, 3);
    assert_eq!(
        fault(&app, cloth),
        Some(ClothError::Mesh(MeshError::NotLoaded))
    );
    let handle = add(&mut app, sheet_asset(3, 3));
    app.world_mut().entity_mut(cloth).insert(Mesh3d(handle));
    tick(&mut app, 3);
    assert_eq!(fault(&app, cloth), None);
    assert_eq!(particles(&app, cloth).len(), 9);
}

/// Another `Mesh3d` is another cloth, drawn as that, and its own is given back in the end.
#[test]
fn another_mesh_is_another_cloth() {
    let mut app = app_that_draws(FixedUpdate);
    let first = add(&mut app, sheet_asset(3, 3));
    let second = add(&mut app, sheet_asset(5, 4));
    let cloth = spawn(&mut app, &first, ());
    tick(&mut app, 10);
    assert_eq!(particles(&app, cloth).len(), 9);
    app.world_mut()
        .entity_mut(cloth)
        .insert(Mesh3d(second.clone()));
    tick(&mut app, 1);
    let at_rest: Vec<Vec3> = surface(&app, cloth).rest_positions().into();
    assert_eq!(at_rest.len(), 20);
    // As new: fallen for a tick only.
    for (place, rest) in particles(&app, cloth).positions().zip(at_rest) {
        assert!(place.distance(rest) < 0.01, "{place} {rest}");
    }
    tick(&mut app, 2);
    let drawn = meshes(&app).get(&mesh_of(&app, cloth)).expect("a mesh");
    assert_eq!(drawn.count_vertices(), 20);
    assert!(![&first, &second].contains(&&mesh_of(&app, cloth)));
    app.world_mut().entity_mut(cloth).remove::<Cloth>();
    tick(&mut app, 1);
    assert_eq!(mesh_of(&app, cloth), second);
}

/// A mesh that is edited is built again from what it then is; others of it, too.
#[test]
fn an_edited_mesh_is_built_anew() {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, sheet_asset(3, 3));
    let cloths = [(); 2].map(|()| spawn(&mut app, &handle, ()));
    tick(&mut app, 10);
    assert!(
        cloths
            .iter()
            .all(|cloth| particles(&app, *cloth).len() == 9)
    );
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&handle).expect("the asset") = sheet_asset(6, 2);
    // Bevy tells of it as the frame ends.
    tick(&mut app, 3);
    for cloth in cloths {
        assert_eq!(particles(&app, cloth).len(), 12);
        let drawn = self::meshes(&app).get(&mesh_of(&app, cloth));
        assert_eq!(drawn.expect("a mesh").count_vertices(), 12);
        assert_eq!(fault(&app, cloth), None);
    }
    // Once, not in every tick.
    let before = by_vertex(&app, cloths[0])[0].expect("a particle").y;
    tick(&mut app, 20);
    let after = by_vertex(&app, cloths[0])[0].expect("a particle").y;
    assert!(after < before - 0.3, "{before} {after}");
}

/// Also while its cloth sleeps.
#[test]
fn an_edited_mesh_wakes_its_cloth() {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, sheet_asset(3, 3));
    let cloth = spawn(&mut app, &handle, by_its_edge());
    let mut ticks = 0;
    while ticks < 10 || !stats(&app, cloth).is_asleep {
        tick(&mut app, 1);
        ticks += 1;
        assert!(ticks < 64 * 60, "it does not come to rest");
    }
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&handle).expect("the asset") = sheet_asset(6, 2);
    tick(&mut app, 3);
    assert_eq!(particles(&app, cloth).len(), 12);
}

/// An edit that makes it no cloth is a fault, and one that mends it mends the cloth.
#[test]
fn an_edit_may_break_and_mend() {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, sheet_asset(3, 3));
    let cloth = spawn(&mut app, &handle, ());
    tick(&mut app, 3);
    let edit = |app: &mut App, mesh: Mesh| {
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        *meshes.get_mut(&handle).expect("the asset") = mesh;
        tick(app, 3);
    };
    edit(&mut app, asset(&[Vec3::X; 3], &[[0, 1, 2]]));
    assert_eq!(
        fault(&app, cloth),
        Some(ClothError::Mesh(MeshError::WithoutArea { triangles: 1 }))
    );
    edit(&mut app, sheet_asset(2, 2));
    assert_eq!(fault(&app, cloth), None);
    assert_eq!(particles(&app, cloth).len(), 4);
}

/// Without any assets, in an app that has no meshes at all.
#[test]
fn triangles_need_no_assets() {
    let mut app = app();
    assert!(!app.world().contains_resource::<Assets<Mesh>>());
    let (positions, triangles) = sheet(6, 6);
    let cloth = (Cloth::triangles(positions, triangles), by_its_edge());
    let cloth = app.world_mut().spawn(cloth).id();
    let asked = app.world_mut().spawn(Cloth::mesh()).id();
    tick(&mut app, 128);
    assert_eq!(fault(&app, cloth), None);
    assert_eq!(
        fault(&app, asked),
        Some(ClothError::Mesh(MeshError::NotLoaded))
    );
    let places = by_vertex(&app, cloth);
    assert_eq!(places.len(), 36);
    for (vertex, place) in places.into_iter().enumerate() {
        let place = place.expect("a particle");
        // Pinned along the x-axis, it swings about it.
        let (pinned, radius) = (vertex < 6, (vertex / 6) as f32 * 0.1);
        let hangs = Vec2::new(place.y, place.z).length();
        assert!(pinned == (hangs == 0.0), "{vertex}: {place}");
        assert!(hangs < radius * 1.05 + 0.001, "{vertex}: {place}");
    }
}
