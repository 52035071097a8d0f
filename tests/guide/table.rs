use bevy::prelude::*;
use bevy_drape::prelude::*;

fn table(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    // A table, the floor (everything below y = 0), and a cloth that falls on them.
    commands.spawn((ClothCollider::cuboid(1.0, 0.1, 1.0), Transform::from_xyz(0.0, 0.7, 0.0)));
    commands.spawn(ClothCollider::plane());
    let white = MeshMaterial3d(materials.add(fabric(Color::srgb(0.9, 0.9, 0.85))));
    let cloth = (Cloth::new(40, 40, 0.04).lying().centred(), Pins::none(), white);
    commands.spawn((Name::new("tablecloth"), cloth, Transform::from_xyz(0.0, 1.0, 0.0)));
}
