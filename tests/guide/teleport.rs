use bevy::prelude::*;
use bevy_drape::prelude::*;

#[derive(Component)]
struct Pole;

fn respawn(mut commands: Commands, flag: Single<Entity, With<Cloth>>, mut pole: Single<&mut Transform, With<Pole>>) {
    pole.translation.x += 100.0;
    commands.entity(*flag).insert(ClothTeleport);
}
