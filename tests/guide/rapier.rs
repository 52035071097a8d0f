use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::*;

fn main() {
    App::new()
        .insert_resource(TimestepMode::Fixed { dt: 1.0 / 64.0, substeps: 1 })
        .add_plugins((DefaultPlugins, RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule()))
        .add_plugins(DrapePlugins::default())
        .add_systems(Startup, setup)
        .run();
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let green = MeshMaterial3d(materials.add(fabric(Color::srgb(0.2, 0.5, 0.3))));
    commands.spawn((Name::new("curtain"), Cloth::new(32, 32, 0.05).centred(), green));

    let look = (Mesh3d(meshes.add(Sphere::new(0.3))), MeshMaterial3d(materials.add(Color::srgb(0.95, 0.75, 0.3))));
    let thrown = (RigidBody::Dynamic, Velocity::linear(Vec3::new(0.0, 3.0, -3.0)), Collider::ball(0.3));
    commands.spawn((thrown, RapierClothCollider, look, Transform::from_xyz(0.0, -0.8, 1.8)));

    commands.spawn((DirectionalLight::default(), Transform::from_xyz(2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((Camera3d::default(), Transform::from_xyz(2.5, 0.5, 3.5).looking_at(Vec3::ZERO, Vec3::Y)));
}
