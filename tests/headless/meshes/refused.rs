//! Meshes that are no cloth, and the least that is.

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_drape::{cloth::MAX_MESH_PARTICLES, prelude::*};

use super::sheets::*;
use crate::support::*;

/// What is wrong with a cloth of an asset; nothing is simulated of it, and another cloth is.
fn refused(mesh: Mesh) -> ClothError {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, mesh);
    let cloth = spawn(&mut app, &handle, ());
    let other = app
        .world_mut()
        .spawn((Cloth::new(3, 3, 0.1), Pins::none()))
        .id();
    tick(&mut app, 1);
    assert!(particles(&app, cloth).is_empty());
    assert_eq!(mesh_of(&app, cloth), handle);
    assert!(particles(&app, other).largest_speed() > 0.0);
    fault(&app, cloth).expect("a fault")
}

#[test]
fn what_is_no_cloth_is_named() {
    let lines = |topology| {
        let places = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        Mesh::new(topology, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
    };
    for (topology, name) in [
        (PrimitiveTopology::LineList, "LineList"),
        (PrimitiveTopology::PointList, "PointList"),
    ] {
        let error = refused(lines(topology));
        assert_eq!(
            error,
            ClothError::Mesh(MeshError::Topology {
                topology: name.into()
            })
        );
    }
    let (positions, triangles) = sheet(3, 3);
    let mut without = asset(&positions, &triangles);
    without.remove_attribute(Mesh::ATTRIBUTE_POSITION);
    assert_eq!(refused(without), MeshError::WithoutPositions.into());

    let left_over = asset(&positions, &triangles);
    let left_over = left_over.with_inserted_indices(Indices::U32(vec![0, 1, 3, 4]));
    assert_eq!(
        refused(left_over),
        MeshError::IndexCount { indices: 4 }.into()
    );

    let mut nowhere = positions.clone();
    nowhere[5].z = f32::NAN;
    let error = refused(asset(&nowhere, &triangles));
    assert!(
        matches!(
            error,
            ClothError::Mesh(MeshError::VertexNotFinite { vertex: 5, .. })
        ),
        "{error}"
    );
    nowhere[5].z = f32::INFINITY;
    let error = refused(asset(&nowhere, &triangles));
    assert!(
        matches!(
            error,
            ClothError::Mesh(MeshError::VertexNotFinite { vertex: 5, .. })
        ),
        "{error}"
    );

    let mut beyond = triangles.clone();
    beyond[3][1] = 9;
    let expected = ClothError::Mesh(MeshError::TriangleOutOfRange {
        triangle: 3,
        corners: beyond[3],
        vertices: 9,
    });
    assert_eq!(refused(asset(&positions, &beyond)), expected);

    let flat: Vec<Vec3> = (0..9).map(|x| Vec3::X * x as f32).collect();
    let error = refused(asset(&flat, &triangles));
    assert_eq!(error, MeshError::WithoutArea { triangles: 8 }.into());
}

/// A million vertices in a million places; and more vertices than are even looked at, all in one place.
#[test]
fn a_mesh_may_be_too_large() {
    const COUNT: u32 = 999_999;
    let listed = |positions: Vec<[f32; 3]>| {
        Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    };
    let place = |vertex: u32| {
        let [x, y] = [vertex / 3 % 1000, vertex / 3000].map(|at| at as f32);
        let corner = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]][(vertex % 3) as usize];
        [x + corner[0], y + corner[1], 0.0]
    };
    let error = refused(listed((0..COUNT).map(place).collect()));
    assert_eq!(
        error,
        ClothError::Mesh(MeshError::TooLarge {
            particles: COUNT as usize
        })
    );
    let more = 8 * MAX_MESH_PARTICLES + 1;
    let error = refused(listed(vec![[0.0; 3]; more]));
    assert_eq!(error, MeshError::TooLarge { particles: more }.into());
}

/// What is in the render world alone can't be read; one that is in both can.
#[test]
fn what_the_renderer_took_is_not_readable() {
    let mut taken = sheet_asset(3, 3);
    taken.asset_usage = RenderAssetUsages::RENDER_WORLD;
    taken.take_gpu_data().expect("it was there");
    assert_eq!(refused(taken), MeshError::NotReadable.into());
}

/// Taken after the cloth was built, it matters no more: it is drawn and moves on.
#[test]
fn a_cloth_outlasts_its_asset() {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, sheet_asset(4, 4));
    let cloth = spawn(&mut app, &handle, ());
    tick(&mut app, 4);
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    meshes.remove(&handle).expect("it was there");
    let before = by_vertex(&app, cloth)[0].expect("a particle").y;
    tick(&mut app, 20);
    assert_eq!(fault(&app, cloth), None);
    assert!(by_vertex(&app, cloth)[0].expect("a particle").y < before - 0.3);
    // And so with another material, whose springs are made again.
    change::<ClothMaterial>(&mut app, cloth, |material| {
        *material = ClothMaterial::RUBBER;
    });
    tick(&mut app, 2);
    assert_eq!(fault(&app, cloth), None);
}

/// One triangle of three particles falls as anything does.
#[test]
fn a_single_triangle_falls() {
    let mut app = app_that_draws(FixedUpdate);
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Z];
    let handle = add(&mut app, asset(&positions, &[[0, 2, 1]]));
    let material = ClothMaterial {
        damping: 0.0,
        ..default()
    };
    let cloth = spawn(&mut app, &handle, material);
    tick(&mut app, 64);
    assert_eq!(fault(&app, cloth), None);
    assert_eq!(particles(&app, cloth).len(), 3);
    for (place, start) in by_vertex(&app, cloth).into_iter().zip(positions) {
        let fallen = start - place.expect("a particle");
        let expected = Vec3::Y * GRAVITY / 2.0;
        // A sub-step more or less, and its unevenness.
        assert!(fallen.distance(expected) < 0.02, "{fallen}");
    }
}

#[test]
fn a_weld_that_is_no_distance_is_named() {
    for weld in [-0.1, f32::NAN, f32::INFINITY] {
        let mut app = app();
        let (positions, triangles) = sheet(3, 3);
        let cloth = Cloth::triangles(positions, triangles).welded(weld);
        let cloth = app.world_mut().spawn(cloth).id();
        tick(&mut app, 1);
        let fault = fault(&app, cloth);
        assert!(
            matches!(fault, Some(ClothError::Mesh(MeshError::Quantity(_)))),
            "{fault:?}"
        );
    }
}
