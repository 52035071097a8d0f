use bevy::prelude::*;
use bevy_drape::prelude::*;

fn flag(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    let mesh = Mesh3d(meshes.add(Plane3d::new(Vec3::Z, Vec2::new(0.6, 0.4)).mesh().subdivisions(15)));
    // In bevy_silk: ClothBuilder::new().with_pinned_vertex_positions(|position| position.x < -0.59)
    let pins = Pins::new([Pin::at_rest(|position| position.x < -0.59)]);
    commands.spawn((Name::new("flag"), Cloth::mesh(), mesh, pins, Transform::from_xyz(0.0, 2.0, 0.0)));
}
