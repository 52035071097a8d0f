//! How a cloth from a mesh is drawn: in a mesh of its own, with the asset's vertices, seams and all.

use bevy::{mesh::VertexAttributeValues, prelude::*};
use bevy_drape::prelude::*;

use super::sheets::*;
use crate::{mesh::vertices, support::*};

/// Two halves of a sheet with a seam in its middle: vertices 4 columns wide on either side, each with its own.
pub fn seamed() -> (Mesh, Vec<[usize; 2]>) {
    let (left, triangles) = sheet(4, 6);
    let count = left.len() as u32;
    let right = left.iter().map(|place| *place + Vec3::X * 0.3);
    let positions: Vec<Vec3> = left.iter().copied().chain(right).collect();
    let others = triangles
        .iter()
        .map(|corners| corners.map(|corner| corner + count));
    let triangles: Vec<[u32; 3]> = triangles.iter().copied().chain(others).collect();
    let half = |vertex: usize| vertex / count as usize;
    let of_halves = |halves: [Vec3; 2]| -> Vec<[f32; 3]> {
        let vertices = 0..positions.len();
        vertices
            .map(|vertex| halves[half(vertex)].normalize().to_array())
            .collect()
    };
    let normals = of_halves([Vec3::new(-0.3, 1.0, 0.0), Vec3::new(0.4, 1.0, 0.1)]);
    // The texture of the second half is elsewhere.
    let uvs: Vec<[f32; 2]> = (0..positions.len())
        .map(|vertex| {
            [
                positions[vertex].x + 7.0 * half(vertex) as f32,
                positions[vertex].z,
            ]
        })
        .collect();
    let seam = (0..6).map(|row| [4 * row + 3, 24 + 4 * row]).collect();
    let mesh = asset(&positions, &triangles)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    (mesh, seam)
}

fn uvs(mesh: &Mesh) -> Vec<[f32; 2]> {
    match mesh.attribute(Mesh::ATTRIBUTE_UV_0) {
        Some(VertexAttributeValues::Float32x2(uvs)) => uvs.clone(),
        other => panic!("{other:?}"),
    }
}

/// The seam is closed and has one normal in every tick; what the two sides have of their own they keep. The asset is what
/// it was, and others draw it.
#[test]
fn a_seam_stays_closed_and_the_asset_as_it_was() {
    let mut app = app_that_draws(FixedUpdate);
    let (mesh, seam) = seamed();
    let handle = add(&mut app, mesh.clone());
    let other = app.world_mut().spawn(Mesh3d(handle.clone())).id();
    let cloth = spawn(&mut app, &handle, by_its_edge());
    let ball = Transform::from_xyz(0.35, -0.4, 0.1);
    app.world_mut().spawn((ClothCollider::ball(0.2), ball));
    for _ in 0..64 {
        tick(&mut app, 1);
        let places = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION);
        let normals = vertices(&app, cloth, Mesh::ATTRIBUTE_NORMAL);
        for &[left, right] in &seam {
            assert_eq!(places[left], places[right]);
            assert_eq!(normals[left], normals[right]);
            assert!((normals[left].length() - 1.0).abs() < 1.0e-5);
        }
    }
    assert_eq!(particles(&app, cloth).len(), 42);
    let places = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    assert!(places[seam[5][0]].y < -0.1, "it has moved");
    let drawn = meshes(&app).get(&mesh_of(&app, cloth)).expect("a mesh");
    assert_eq!(uvs(drawn), uvs(&mesh));
    assert_eq!(meshes(&app).get(&handle), Some(&mesh), "bit by bit");
    assert_eq!(mesh_of(&app, other), handle);
    assert_ne!(mesh_of(&app, cloth), handle);
    app.world_mut().entity_mut(cloth).remove::<Cloth>();
    tick(&mut app, 1);
    assert_eq!(mesh_of(&app, cloth), handle);
}

/// Tangents follow the texture, and the side that w says does not change; a mesh without tangents gets none.
#[test]
fn tangents_follow_the_texture() {
    for sides in [None, Some([1.0, -1.0])] {
        let mut app = app_that_draws(FixedUpdate);
        let (positions, triangles) = sheet(5, 5);
        // u grows along +z, v along −x.
        let uvs: Vec<_> = positions.iter().map(|at| [at.z, -at.x]).collect();
        let mut mesh = asset(&positions, &triangles)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 1.0, 0.0]; 25])
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
        if let Some(sides) = sides {
            let side = |vertex: usize| [1.0, 0.0, 0.0, sides[vertex % 2]];
            let tangents: Vec<_> = (0..25).map(side).collect();
            mesh.insert_attribute(Mesh::ATTRIBUTE_TANGENT, tangents);
        }
        let handle = add(&mut app, mesh);
        let cloth = spawn(&mut app, &handle, by_its_edge());
        tick(&mut app, 2);
        let check = |app: &App, expected: Option<Vec3>| {
            let drawn = meshes(app).get(&mesh_of(app, cloth)).expect("a mesh");
            let tangents = match (sides, drawn.attribute(Mesh::ATTRIBUTE_TANGENT)) {
                (None, None) => return,
                (Some(_), Some(VertexAttributeValues::Float32x4(tangents))) => tangents,
                (_, other) => panic!("{other:?}"),
            };
            let normals = vertices(app, cloth, Mesh::ATTRIBUTE_NORMAL);
            for (vertex, (&[x, y, z, w], normal)) in tangents.iter().zip(normals).enumerate() {
                let tangent = Vec3::new(x, y, z);
                assert_eq!(Some(w), sides.map(|sides| sides[vertex % 2]));
                assert!((tangent.length() - 1.0).abs() < 1.0e-5);
                assert!(tangent.dot(normal).abs() < 1.0e-5);
                let expected = expected.unwrap_or_else(|| Vec3::X.cross(normal));
                assert!(
                    tangent.dot(expected) > 0.98,
                    "{vertex}: {tangent} {expected}"
                );
            }
        };
        check(&app, Some(Vec3::Z));
        // It swings about the x-axis: the way in which u grows is across that.
        tick(&mut app, 18);
        let bottom = by_vertex(&app, cloth)[22].expect("a particle");
        assert!(bottom.y < -0.3, "{bottom}");
        check(&app, None);
    }
}

/// The front is where the asset's normals are, whichever way its triangles run.
#[test]
fn the_front_is_where_the_normals_are() {
    let (positions, triangles) = sheet(5, 5);
    let reversed: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let mixed = (triangles.iter().zip(&reversed)).enumerate();
    let mixed: Vec<_> = mixed
        .map(|(at, (one, other))| if at % 3 == 0 { *one } else { *other })
        .collect();
    for triangles in [&triangles, &reversed, &mixed] {
        for up in [Vec3::Y, Vec3::NEG_Y] {
            let mut app = app_that_draws(FixedUpdate);
            app.insert_resource(ClothGravity(Vec3::ZERO));
            let mesh = asset(&positions, triangles)
                .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![up.to_array(); 25]);
            let handle = add(&mut app, mesh);
            let cloth = spawn(&mut app, &handle, ());
            tick(&mut app, 3);
            for normal in vertices(&app, cloth, Mesh::ATTRIBUTE_NORMAL) {
                assert!(normal.dot(up) > 0.99, "{normal} {up}");
            }
        }
    }
}

/// A mesh without normals gets some: it is lit.
#[test]
fn a_mesh_without_normals_gets_some() {
    let mut app = app_that_draws(FixedUpdate);
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let (positions, triangles) = sheet(3, 3);
    let handle = add(&mut app, asset(&positions, &triangles));
    let cloth = spawn(&mut app, &handle, ());
    tick(&mut app, 3);
    let normals = vertices(&app, cloth, Mesh::ATTRIBUTE_NORMAL);
    assert!(normals.into_iter().all(|normal| normal.dot(Vec3::Y) > 0.99));
}

/// Triangles of the game's are drawn, too: with their vertices, and without a texture.
#[test]
fn triangles_are_drawn() {
    let mut app = app_that_draws(FixedUpdate);
    let (positions, triangles) = sheet(4, 3);
    let cloth = (Cloth::triangles(positions, triangles), by_its_edge());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 20);
    let before = by_vertex(&app, cloth);
    tick(&mut app, 1);
    // With no overstep the picture is that of a tick ago.
    let drawn = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    let drawn: Vec<_> = drawn.into_iter().map(Some).collect();
    assert_eq!(drawn, before);
    let mesh = meshes(&app).get(&mesh_of(&app, cloth)).expect("a mesh");
    assert_eq!(mesh.indices().expect("indices").len(), 3 * 12);
    assert!(!mesh.contains_attribute(Mesh::ATTRIBUTE_UV_0));
}
