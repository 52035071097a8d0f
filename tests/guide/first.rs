use bevy::prelude::*;
use bevy_drape::prelude::*;

fn main() {
    App::new().add_plugins((DefaultPlugins, DrapePlugins::default())).add_systems(Startup, setup).run();
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    // A cloth of 32 × 32 particles, 4 cm apart, that nothing holds.
    let red = MeshMaterial3d(materials.add(fabric(Color::srgb(0.7, 0.1, 0.15))));
    let cloth = (Cloth::new(32, 32, 0.04).lying().centred(), Pins::none(), red);
    commands.spawn((Name::new("cloth"), cloth, Transform::from_xyz(0.0, 1.1, 0.0)));

    // It falls on a ball and a floor.
    let ball = (Mesh3d(meshes.add(Sphere::new(0.4))), MeshMaterial3d(materials.add(Color::srgb(0.95, 0.75, 0.35))));
    commands.spawn((ClothCollider::ball(0.4), ball, Transform::from_xyz(0.0, 0.5, 0.0)));
    let floor = (Mesh3d(meshes.add(Circle::new(3.0))), MeshMaterial3d(materials.add(Color::srgb(0.4, 0.45, 0.5))));
    commands.spawn((floor, Transform::from_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2))));
    commands.spawn(ClothCollider::plane());

    let light = DirectionalLight { shadow_maps_enabled: true, illuminance: 6_000.0, ..default() };
    commands.spawn((light, Transform::from_xyz(-3.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.insert_resource(GlobalAmbientLight { brightness: 600.0, ..default() });
    commands.spawn((Camera3d::default(), Transform::from_xyz(1.0, 1.2, 1.9).looking_at(Vec3::Y * 0.45, Vec3::Y)));
}
