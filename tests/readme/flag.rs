use bevy::prelude::*;
use bevy_drape::prelude::*;

#[derive(Component)]
struct Pole;

fn flag(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    let top = Transform::from_xyz(0.0, 2.0, 0.0);
    let pole = commands.spawn((Pole, top)).id();
    // Its left column follows the pole, smoothly over the sub-steps of a tick, wherever that goes and turns.
    let attached = ClothAttachments::new([(Pin::Column(0), pole)]);
    let blue = MeshMaterial3d(materials.add(fabric(Color::srgb(0.1, 0.3, 0.7))));
    let cloth = (Cloth::new(30, 20, 0.04), Pins::none(), attached, ClothSettings::substeps(40), blue);
    commands.spawn((Name::new("flag"), cloth, top));
}

fn respawn(mut commands: Commands, flag: Single<Entity, With<Cloth>>, mut pole: Single<&mut Transform, With<Pole>>) {
    pole.translation.x += 100.0;
    // There at once with its pole, with its shape and no speed from the jump.
    commands.entity(*flag).insert(ClothTeleport);
}
