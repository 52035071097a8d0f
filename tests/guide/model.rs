use bevy::prelude::*;
use bevy_drape::prelude::*;

fn tent(mut commands: Commands, assets: Res<AssetServer>) {
    let mesh = Mesh3d(assets.load("models/tent.glb#Mesh0/Primitive0"));
    let canvas = MeshMaterial3d::<StandardMaterial>(assets.load("models/tent.glb#Material0/std"));
    // The artist painted the pins in alpha, channel 3 of the vertex colours.
    let pins = Pins::new([Pin::color(3, 0.5)]);
    commands.spawn((Name::new("tent"), Cloth::mesh(), mesh, canvas, pins, ClothMaterial::CANVAS));
}
