use bevy::prelude::*;
use bevy_drape::prelude::*;

fn flag(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    // It hangs limp until there is a `ClothWind`: here 8 m/s along x, with gusts.
    commands.insert_resource(ClothWind::gusty(Vec3::X * 8.0));
    let top = Transform::from_xyz(0.0, 2.0, 0.0);
    let pole = commands.spawn((Name::new("pole"), top)).id();
    // Its left column follows the pole wherever the pole moves.
    let attached = ClothAttachments::new([(Pin::Column(0), pole)]);
    let blue = MeshMaterial3d(materials.add(fabric(Color::srgb(0.1, 0.3, 0.7))));
    commands.spawn((Name::new("flag"), Cloth::new(30, 20, 0.04), Pins::none(), attached, blue, top));
}
