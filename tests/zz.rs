use bevy_drape as library;
#[path = "headless/support.rs"]
mod support;
#[path = "shared/meshes.rs"]
mod shared_meshes;
use bevy::prelude::*;
use bevy::app::FixedUpdate;
use bevy_drape::prelude::*;
use std::time::Instant;
use support::*;
use library::cloth as _;

#[test]
fn first_ticks() {
    for round in 0..3 {
        for kind in ["grid", "triangles", "mesh"] {
            let mut app = app_that_draws(FixedUpdate);
            for _ in 0..5 { app.update(); }
            let mesh = shared_meshes::irregular(1.6, 1.6, 1.6 / 63.0, 0.3);
            let cloth = match kind {
                "grid" => app.world_mut().spawn(Cloth::new(64, 64, 1.6 / 63.0)).id(),
                "triangles" => app.world_mut().spawn((Cloth::triangles(mesh.positions, mesh.triangles), Pins::new([Pin::at_rest(|p| p.y > -0.01)]))).id(),
                _ => {
                    let asset = Mesh::new(bevy::mesh::PrimitiveTopology::TriangleList, bevy::asset::RenderAssetUsages::all())
                        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, mesh.positions.iter().map(|p| p.to_array()).collect::<Vec<_>>())
                        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, mesh.positions.iter().map(|p| [p.x, p.y]).collect::<Vec<_>>())
                        .with_inserted_indices(bevy::mesh::Indices::U32(mesh.triangles.iter().flatten().copied().collect()));
                    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(asset);
                    app.world_mut().spawn((Cloth::mesh(), Mesh3d(handle), Pins::new([Pin::at_rest(|p| p.y > -0.01)]))).id()
                }
            };
            let times: Vec<String> = (0..5).map(|_| { let start = Instant::now(); app.update(); format!("{:.1}", start.elapsed().as_secs_f64() * 1e3) }).collect();
            println!("{round} {kind}: {} particles, {}", particles(&app, cloth).len(), times.join(" "));
        }
    }
}
