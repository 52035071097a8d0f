use bevy::prelude::*;
use bevy_drape::prelude::*;

fn beach_ball(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    let ball = Mesh3d(meshes.add(Sphere::new(0.15).mesh().ico(8).unwrap()));
    // The ball's volume is 4/3 π r³ = 0.0141 m³. At sea-level pressure the gas would fill nine tenths of it.
    let gas = ClothPressure::gas(0.9 * 0.0141);
    let place = Transform::from_xyz(0.0, 0.5, 0.0);
    // Pressure stretches the springs of a mesh: sub-steps hold them.
    let cloth = (Cloth::mesh(), Pins::none(), ClothMaterial::CANVAS, ClothSettings::substeps(48));
    commands.spawn((Name::new("beach ball"), cloth, ball, gas, place));
    commands.spawn(ClothCollider::plane());
}
