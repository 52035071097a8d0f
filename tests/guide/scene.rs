use bevy::prelude::*;

fn scene(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn(DynamicWorldRoot(assets.load("scenes/flag.scn.ron")));
}
