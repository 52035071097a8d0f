//! The picture of cloth that tears.

use std::{collections::HashMap, f32::consts::FRAC_PI_2, time::Duration};

use bevy::{
    mesh::{Indices, PrimitiveTopology, VertexAttributeValues},
    prelude::*,
    time::TimeUpdateStrategy,
};
use bevy_drape::prelude::*;

use crate::{
    mesh::vertices,
    meshes::sheets::{add, mesh_of, meshes},
    shared_meshes::irregular,
    support::*,
    tears::{cut_at, surface, top},
};

/// The mesh that is drawn of a cloth.
struct Picture {
    places: Vec<Vec3>,
    normals: Vec<Vec3>,
    /// Bits of the texture coordinates.
    uvs: Vec<[u32; 2]>,
    corners: Vec<usize>,
}

impl Picture {
    fn of(app: &App, cloth: Entity) -> Self {
        let mesh = meshes(app).get(&mesh_of(app, cloth)).expect("its mesh");
        let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0)
        else {
            panic!("no texture coordinates");
        };
        Self {
            places: vertices(app, cloth, Mesh::ATTRIBUTE_POSITION),
            normals: vertices(app, cloth, Mesh::ATTRIBUTE_NORMAL),
            uvs: uvs.iter().map(|uv| uv.map(f32::to_bits)).collect(),
            corners: mesh.indices().expect("indices").iter().collect(),
        }
    }

    /// The normals of the faces around each vertex.
    fn faces(&self) -> Vec<Vec<Vec3>> {
        let mut faces = vec![Vec::new(); self.places.len()];
        for corners in self.corners.chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|at| self.places[corners[at]]);
            let normal = (b - a).cross(c - a).normalize();
            corners.iter().for_each(|at| faces[*at].push(normal));
        }
        faces
    }
}

fn pass(app: &mut App, time: Duration) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(time));
    app.update();
}

/// A cut opens without a jump: the picture a microsecond before the tick is compared with that of the tick itself, at an overstep of
/// nothing. Each vertex is where the one with its texture coordinates was. That is exact but for 10⁻⁶ s of motion and four roundings of
/// places up to 1 m, 5·10⁻⁷ m.
///
/// A normal is the mean of those of faces around, so that where a vertex becomes two, it differs by no more than these do among each other.
/// Elsewhere it stays: triangles are at least 0.02 m high, and places off by 4·10⁻⁶ m turn them by 4·10⁻⁴.
#[test]
fn a_cut_opens_without_a_jump_of_the_picture() {
    let mut app = app_that_draws(FixedUpdate);
    let asset = irregular(0.8, 0.8, 0.1, 0.2);
    let corners = asset.triangles.iter().flatten().copied().collect();
    let whole = Mesh::new(PrimitiveTopology::TriangleList, default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, asset.positions.clone())
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, asset.normals.clone())
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, asset.uvs.clone())
        .with_inserted_indices(Indices::U32(corners));
    let handle = add(&mut app, whole);
    // They lie, and swing down from a border.
    let lying = Transform::from_rotation(Quat::from_rotation_x(-FRAC_PI_2));
    let parts = || (lying, top(), ClothTears::default());
    let of_asset = (Cloth::mesh(), Mesh3d(handle), parts());
    let of_asset = app.world_mut().spawn(of_asset).id();
    let of_grid = (Cloth::new(9, 9, 0.1), parts());
    let of_grid = app.world_mut().spawn(of_grid).id();
    tick(&mut app, 20);
    let (moment, ticked) = (Duration::from_micros(1), Duration::from_nanos(15_625_000));
    pass(&mut app, ticked - moment);
    let cloths = [of_asset, of_grid];
    let before = cloths.map(|cloth| Picture::of(&app, cloth));
    let heights = particles(&app, of_grid).positions();
    let frame: &ClothFrame = app.world().get(of_grid).expect("a frame");
    let height = heights.map(|at| frame.to_world(at).y).sum::<f32>() / 81.0;
    assert!(cut_at(&mut app, height) > 14);
    pass(&mut app, moment);
    for (cloth, before) in cloths.into_iter().zip(before) {
        assert_eq!(surface(&app, cloth).pieces(), 2);
        let after = Picture::of(&app, cloth);
        let speed = particles(&app, cloth).largest_speed();
        let known = before.uvs.iter().zip(0..);
        let known: HashMap<[u32; 2], usize> = known.map(|(uv, vertex)| (*uv, vertex)).collect();
        assert_eq!(known.len(), before.uvs.len(), "each has a place of its own");
        let origins: Vec<usize> = after.uvs.iter().map(|uv| known[uv]).collect();
        let mut parts = vec![0; before.places.len()];
        origins.iter().for_each(|origin| parts[*origin] += 1);
        assert!(parts.iter().all(|parts| *parts > 0) && origins.len() > parts.len());
        let faces = before.faces();
        for (vertex, &origin) in origins.iter().enumerate() {
            let moved = after.places[vertex].distance(before.places[origin]);
            assert!(moved < 1.0e-6 * speed + 1.0e-6, "{vertex}: {moved} m");
            let around = &faces[origin];
            let pairs = around
                .iter()
                .flat_map(|a| around.iter().map(|b| a.distance(*b)));
            let spread = match parts[origin] {
                1 => 0.0,
                _ => pairs.fold(0.0, f32::max),
            };
            let turned = after.normals[vertex].distance(before.normals[origin]);
            assert!(turned < spread + 1.0e-3, "{vertex}: {turned} {spread}");
        }
    }
}
