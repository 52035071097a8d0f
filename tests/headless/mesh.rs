//! The mesh on the particles.

use std::time::Duration;

use bevy::{
    camera::primitives::Aabb, mesh::VertexAttributeValues, prelude::*, time::TimeUpdateStrategy,
};
use bevy_drape::prelude::*;

use crate::support::*;

pub fn vertices(app: &App, cloth: Entity, attribute: bevy::mesh::MeshVertexAttribute) -> Vec<Vec3> {
    let handle = &app.world().get::<Mesh3d>(cloth).expect("a mesh").0;
    let mesh = app
        .world()
        .resource::<Assets<Mesh>>()
        .get(handle)
        .expect("an asset");
    match mesh.attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(values)) => {
            values.iter().map(|&value| value.into()).collect()
        }
        other => panic!("{other:?}"),
    }
}

/// Where the vertices are in the world, by the entity's own transform: where the particles are.
#[test]
fn the_mesh_follows_the_particles_and_its_bounds_stay_true() {
    let mut app = app_that_draws(FixedUpdate);
    let place = Transform::from_xyz(1.0, 2.0, 3.0)
        .with_rotation(Quat::from_rotation_y(0.5))
        .with_scale(Vec3::new(2.0, 1.5, -1.0));
    let parent = app
        .world_mut()
        .spawn((Transform::from_xyz(0.0, 7.0, 0.0), Visibility::default()))
        .id();
    let cloth = app
        .world_mut()
        .spawn((
            Cloth::default(),
            place,
            Visibility::default(),
            ChildOf(parent),
        ))
        .id();
    app.world_mut()
        .spawn((ClothCollider::ball(0.5), Transform::from_xyz(2.0, 8.0, 2.5)));
    tick(&mut app, 60);
    let before: Vec<Vec3> = particles(&app, cloth).positions().collect();
    tick(&mut app, 1);
    // With no overstep the picture is that of a tick ago.
    let global = *app
        .world()
        .get::<GlobalTransform>(cloth)
        .expect("a transform");
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let drawn = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    for (vertex, particle) in drawn.iter().zip(&before) {
        let distance = global
            .transform_point(*vertex)
            .distance(frame.to_world(*particle));
        assert!(distance < 1e-5, "{distance}");
    }
    for normal in vertices(&app, cloth, Mesh::ATTRIBUTE_NORMAL) {
        assert!((normal.length() - 1.0).abs() < 1e-5);
    }
    let bounds = app.world().get::<Aabb>(cloth).expect("bounds");
    let (least, most) = drawn
        .iter()
        .fold((Vec3::MAX, Vec3::MIN), |(a, b), p| (a.min(*p), b.max(*p)));
    assert!(
        Vec3::from(bounds.min()).distance(least) < 1e-5
            && Vec3::from(bounds.max()).distance(most) < 1e-5
    );
    assert!(
        most.z - least.z > 0.1,
        "the cloth has been pushed out of its plane"
    );
}

/// Between two ticks the mesh is between them.
#[test]
fn the_mesh_is_interpolated() {
    let mut app = app_that_draws(FixedUpdate);
    let cloth = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
    tick(&mut app, 20);
    let y = |app: &App| vertices(app, cloth, Mesh::ATTRIBUTE_POSITION)[40].y;
    let particle = |app: &App| position(app, cloth, (2, 8)).y;
    let earlier = particle(&app);
    tick(&mut app, 1);
    let later = particle(&app);
    assert!((y(&app) - earlier).abs() < 1e-6);
    for quarter in 1..4 {
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
            TICK / 4.0,
        )));
        app.update();
        let expected = earlier + (later - earlier) * quarter as f32 / 4.0;
        assert!((y(&app) - expected).abs() < 1e-6, "{quarter}");
    }
    assert_eq!(particle(&app), later, "no tick has passed");
}

/// Where a tick is a frame, the mesh shows that very tick.
#[test]
fn another_schedule_is_drawn_as_it_is() {
    let draw = |mut app: App| {
        let cloth = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
        tick(&mut app, 10);
        let drawn = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION);
        let positions: Vec<Vec3> = particles(&app, cloth).positions().collect();
        assert_eq!(drawn, positions);
    };
    draw(app_that_draws(Update));
    draw(app_that_draws(PostUpdate));
}

/// At rest the normal is +z, the UVs go from corner to corner, and another grid gets another mesh.
#[test]
fn a_new_grid_gets_a_new_mesh() {
    let mut app = app_that_draws(FixedUpdate);
    let still = ClothSettings {
        gravity: Some(Vec3::ZERO),
        ..default()
    };
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(3, 4, 0.2).flat(), still))
        .id();
    tick(&mut app, 2);
    let normals = vertices(&app, cloth, Mesh::ATTRIBUTE_NORMAL);
    assert_eq!(normals.len(), 12);
    assert!(normals.iter().all(|normal| normal.distance(Vec3::Z) < 1e-6));
    let handle = app.world().get::<Mesh3d>(cloth).expect("a mesh").0.clone();
    let mesh = app
        .world()
        .resource::<Assets<Mesh>>()
        .get(&handle)
        .expect("an asset");
    let Some(VertexAttributeValues::Float32x4(tangents)) = mesh.attribute(Mesh::ATTRIBUTE_TANGENT)
    else {
        panic!("no tangents");
    };
    assert!(
        tangents
            .iter()
            .all(|tangent| *tangent == [1.0, 0.0, 0.0, 1.0])
    );
    assert_eq!(mesh.indices().expect("indices").len(), 2 * 3 * 6);
    let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0) else {
        panic!("no UVs");
    };
    assert_eq!((uvs[0], uvs[11]), ([0.0, 0.0], [1.0, 1.0]));
    change::<Cloth>(&mut app, cloth, |cloth| *cloth = Cloth::new(5, 5, 0.2));
    tick(&mut app, 2);
    assert_eq!(vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION).len(), 25);
}

/// What sleeps is drawn where it sleeps, and no tick ago, and drawn again once it is woken.
#[test]
fn a_sleeping_cloth_is_drawn_where_it_is() {
    let mut app = app_that_draws(FixedUpdate);
    // Still swinging a little as it falls asleep.
    let place = Transform::from_rotation(Quat::from_rotation_x(0.02));
    let cloth = (Cloth::new(9, 9, 0.1), place, Visibility::default());
    let cloth = app.world_mut().spawn(cloth).id();
    let is_asleep = |app: &App| {
        let stats = app.world().get::<ClothStats>(cloth).expect("figures");
        stats.is_asleep
    };
    tick(&mut app, 1);
    for _ in 0..64 * 30 {
        if !is_asleep(&app) {
            tick(&mut app, 1);
        }
    }
    assert!(is_asleep(&app));
    tick(&mut app, 2);
    let drawn = vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    for (vertex, particle) in drawn.iter().zip(particles(&app, cloth).positions()) {
        assert!(vertex.distance(particle) < 1.0e-6, "{vertex} {particle}");
    }
    app.world_mut().resource_mut::<ClothGravity>().0.z = 5.0;
    tick(&mut app, 5);
    assert_ne!(vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION), drawn);
}
