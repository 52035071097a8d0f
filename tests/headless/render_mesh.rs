//! Fine meshes that coarse cloths drive.

use bevy::{
    asset::RenderAssetUsages, camera::primitives::Aabb, mesh::VertexAttributeValues, prelude::*,
};
use bevy_drape::prelude::*;

use crate::{
    mesh::vertices,
    meshes::sheets::{add, fault, mesh_of, meshes, sheet, sheet_asset},
    support::*,
};

/// A lying sheet of 7 × 7 particles, 0.1 m apart, that hangs by one edge, where `sheet` is: along +x and +z.
fn coarse() -> (Cloth, Pins) {
    (Cloth::new(7, 7, 0.1).lying(), Pins::new([Pin::Row(0)]))
}

/// Vertices where they are drawn in the world.
fn drawn(app: &App, entity: Entity) -> Vec<Vec3> {
    let place = *app.world().get::<GlobalTransform>(entity).expect("a place");
    let vertices = vertices(app, entity, Mesh::ATTRIBUTE_POSITION).into_iter();
    vertices.map(|at| place.transform_point(at)).collect()
}

fn driven(cloth: Entity, mesh: Handle<Mesh>, place: Transform) -> impl Bundle {
    (
        ClothRenderMesh { cloth },
        Mesh3d(mesh),
        place,
        Visibility::default(),
    )
}

/// A mesh whose vertices are those of the cloth is drawn where the cloth is, to roundings of some metres, however both entities are
/// placed and scaled, wherever the mesh's entity goes, and though the cloth itself is hidden. Its bounds hold it.
#[test]
fn is_drawn_where_the_cloth_is() {
    let turned = Transform::from_xyz(0.4, 1.0, -0.3).with_rotation(Quat::from_rotation_y(0.7));
    let scaled = turned.with_scale(Vec3::new(2.0, 1.0, 0.5));
    for (place, own) in [
        (Transform::IDENTITY, Transform::IDENTITY),
        (turned, Transform::from_xyz(-0.2, 0.3, 0.1)),
        (
            scaled,
            Transform::from_rotation(Quat::from_rotation_z(0.3))
                .with_scale(Vec3::new(0.5, 3.0, 1.5)),
        ),
    ] {
        let mut app = app_that_draws(FixedUpdate);
        let seen = (coarse(), place, Visibility::default());
        let seen = app.world_mut().spawn(seen).id();
        let hidden = (coarse(), place, Visibility::Hidden);
        let hidden = app.world_mut().spawn(hidden).id();
        // The cloth's vertices at rest, as the mesh's entity has them.
        tick(&mut app, 1);
        let surface = Cloth::new(7, 7, 0.1)
            .lying()
            .surface(Vec3::ONE)
            .expect("a grid");
        let to_own = own.to_matrix().inverse() * place.to_matrix();
        let positions: Vec<_> = surface
            .rest_positions()
            .iter()
            .map(|at| to_own.transform_point3(*at))
            .collect();
        let mesh = crate::meshes::sheets::asset(&positions, surface.triangles());
        let mesh = add(&mut app, mesh);
        let fine = app
            .world_mut()
            .spawn(driven(hidden, mesh.clone(), own))
            .id();
        let unwritten = vertices(&app, hidden, Mesh::ATTRIBUTE_POSITION);
        for ticks in [20, 20, 1] {
            tick(&mut app, ticks);
            let (found, expected) = (drawn(&app, fine), drawn(&app, seen));
            assert!(expected[48].y < place.translation.y - 0.05, "it has moved");
            for (found, expected) in found.iter().zip(&expected) {
                let off = found.distance(*expected);
                assert!(off < 1.0e-5, "{off} m");
            }
            let aabb = app.world().get::<Aabb>(fine).expect("bounds");
            for vertex in vertices(&app, fine, Mesh::ATTRIBUTE_POSITION) {
                let outside =
                    (vertex - Vec3::from(aabb.center)).abs() - Vec3::from(aabb.half_extents);
                assert!(outside.max_element() < 1.0e-4, "{outside}");
            }
            // The mesh's entity may be anywhere.
            change::<Transform>(&mut app, fine, |own| {
                own.translation += Vec3::new(5.0, 0.0, 1.0);
            });
        }
        // The cloth's own mesh is not written while it is hidden.
        let own = vertices(&app, hidden, Mesh::ATTRIBUTE_POSITION);
        assert_eq!(own, unwritten);
        // Others draw the asset as it was.
        let at_rest = match meshes(&app)
            .get(&mesh)
            .and_then(|mesh| mesh.attribute(Mesh::ATTRIBUTE_POSITION))
        {
            Some(VertexAttributeValues::Float32x3(at_rest)) => at_rest.clone(),
            other => panic!("{other:?}"),
        };
        assert!(
            positions
                .iter()
                .zip(at_rest)
                .all(|(a, b)| a.to_array() == b)
        );
    }
}

/// Of a fine mesh with a seam, both sides stay together, with one normal; normals are of length 1 and tangents at right angles to
/// them, also under a scale that is another along each axis.
#[test]
fn seams_stay_closed_and_tangents_at_right_angles() {
    for scale in [Vec3::ONE, Vec3::new(1.0, 2.0, 0.5)] {
        let mut app = app_that_draws(FixedUpdate);
        let cloth = app.world_mut().spawn(coarse()).id();
        let (mut positions, triangles) = sheet(13, 13);
        positions
            .iter_mut()
            .for_each(|at| *at = (*at * 0.5 + Vec3::Y * 0.01) / scale);
        // Every vertex twice: a seam everywhere.
        let twice: Vec<Vec3> = positions.iter().chain(&positions).copied().collect();
        let others = triangles
            .iter()
            .map(|corners| corners.map(|corner| corner + 169));
        let triangles: Vec<_> = triangles.iter().copied().chain(others).collect();
        let tangent = |vertex: usize| [1.0, 0.0, 0.0, if vertex < 169 { 1.0 } else { -1.0 }];
        let tangents: Vec<[f32; 4]> = (0..338).map(tangent).collect();
        let mesh = crate::meshes::sheets::asset(&twice, &triangles)
            .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, tangents);
        let mesh = add(&mut app, mesh);
        let fine = driven(cloth, mesh, Transform::from_scale(scale));
        let fine = app.world_mut().spawn(fine).id();
        tick(&mut app, 30);
        let places = vertices(&app, fine, Mesh::ATTRIBUTE_POSITION);
        let normals = vertices(&app, fine, Mesh::ATTRIBUTE_NORMAL);
        let drawn = meshes(&app).get(&mesh_of(&app, fine)).expect("a mesh");
        let Some(VertexAttributeValues::Float32x4(tangents)) =
            drawn.attribute(Mesh::ATTRIBUTE_TANGENT)
        else {
            panic!("tangents");
        };
        for vertex in 0..169 {
            assert_eq!(places[vertex], places[vertex + 169]);
            assert_eq!(normals[vertex], normals[vertex + 169]);
            assert!((normals[vertex].length() - 1.0).abs() < 1.0e-5);
            let [x, y, z, side] = tangents[vertex + 169];
            assert_eq!(side, -1.0);
            let across = Vec3::new(x, y, z).dot(normals[vertex]);
            assert!(across.abs() < 2.0e-6, "{across}");
        }
        assert!(places[168].y * scale.y < -0.05, "it has moved");
    }
}

/// A cloth that sleeps has neither its own mesh written nor those that it drives.
#[test]
fn a_sleeping_cloth_writes_nothing() {
    let mut app = app_that_draws(FixedUpdate);
    let all = (
        Cloth::new(7, 7, 0.1).lying(),
        Pins::filter(|_, _| true),
        Visibility::Hidden,
    );
    let cloth = app.world_mut().spawn(all).id();
    let mesh = add(&mut app, sheet_asset(7, 7));
    let fine = app
        .world_mut()
        .spawn(driven(cloth, mesh, Transform::IDENTITY))
        .id();
    tick(&mut app, 200);
    assert!(stats(&app, cloth).is_asleep);
    let own = mesh_of(&app, fine).id();
    let mut reader = app
        .world()
        .resource::<Messages<AssetEvent<Mesh>>>()
        .get_cursor_current();
    for _ in 0..5 {
        app.update();
        let events = app.world().resource::<Messages<AssetEvent<Mesh>>>();
        assert!(reader.read(events).all(|event| !event.is_modified(own)));
    }
}

/// What is wrong is named, on the mesh's entity; mending it takes the fault away, and so does taking the component away, which gives the
/// asset back.
#[test]
fn what_is_wrong_is_named() {
    let mut app = app_that_draws(FixedUpdate);
    let cloth = app.world_mut().spawn(coarse()).id();
    let good = add(&mut app, sheet_asset(9, 9));
    let fine = app
        .world_mut()
        .spawn(driven(cloth, good.clone(), Transform::IDENTITY))
        .id();
    tick(&mut app, 2);
    assert_eq!(fault(&app, fine), None);
    assert_ne!(mesh_of(&app, fine), good);

    let mut renderers = sheet_asset(9, 9);
    renderers.asset_usage = RenderAssetUsages::RENDER_WORLD;
    let mut nowhere = sheet_asset(9, 9);
    if let Some(VertexAttributeValues::Float32x3(at)) =
        nowhere.attribute_mut(Mesh::ATTRIBUTE_POSITION)
    {
        at[7][1] = f32::NAN;
    }
    for (mesh, is_expected) in [
        (
            renderers,
            (|error| matches!(error, ClothError::Mesh(MeshError::NotReadable)))
                as fn(ClothError) -> bool,
        ),
        (nowhere, |error| {
            matches!(
                error,
                ClothError::Mesh(MeshError::VertexNotFinite { vertex: 7, .. })
            )
        }),
    ] {
        let bad = add(&mut app, mesh);
        app.world_mut().entity_mut(fine).insert(Mesh3d(bad));
        tick(&mut app, 2);
        let error = fault(&app, fine).expect("a fault");
        assert!(is_expected(error.clone()), "{error}");
        app.world_mut()
            .entity_mut(fine)
            .insert(Mesh3d(good.clone()));
        tick(&mut app, 2);
        assert_eq!(fault(&app, fine), None);
    }

    let far = driven(cloth, good.clone(), Transform::from_xyz(0.0, 30.0, 0.0));
    let far = app.world_mut().spawn(far).id();
    tick(&mut app, 2);
    let error = fault(&app, far).expect("a fault");
    assert!(
        matches!(error, ClothError::Mesh(MeshError::BoundTooFar { .. })),
        "{error}"
    );

    app.world_mut().despawn(cloth);
    tick(&mut app, 2);
    assert_eq!(
        fault(&app, fine),
        Some(ClothError::Target(TargetError::NoSuchCloth { cloth }))
    );
    app.world_mut().entity_mut(fine).remove::<ClothRenderMesh>();
    tick(&mut app, 1);
    assert_eq!(fault(&app, fine), None);
    assert_eq!(mesh_of(&app, fine), good);
}

/// An asset that changes is bound anew, and so is a mesh whose cloth becomes another.
#[test]
fn is_bound_anew_where_something_changes() {
    let mut app = app_that_draws(FixedUpdate);
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(7, 7, 0.1).lying(), Pins::filter(|_, _| true)))
        .id();
    let mesh = add(&mut app, sheet_asset(9, 9));
    let fine = driven(cloth, mesh.clone(), Transform::IDENTITY);
    let fine = app.world_mut().spawn(fine).id();
    tick(&mut app, 2);
    let bound = mesh_of(&app, fine);
    app.world_mut()
        .resource_mut::<Assets<Mesh>>()
        .insert(mesh.id(), sheet_asset(5, 5))
        .expect("an id of its own");
    tick(&mut app, 3);
    assert_eq!(drawn(&app, fine).len(), 25);
    assert_ne!(mesh_of(&app, fine), bound);
    let bound = mesh_of(&app, fine);
    tick(&mut app, 2);
    assert_eq!(mesh_of(&app, fine), bound, "once");
    change::<Cloth>(&mut app, cloth, |cloth| {
        *cloth = Cloth::new(4, 4, 0.2).lying();
    });
    tick(&mut app, 3);
    assert_ne!(mesh_of(&app, fine), bound);
    assert_eq!(fault(&app, fine), None);
}
