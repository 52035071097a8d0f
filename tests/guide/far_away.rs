use bevy::prelude::*;
use bevy_drape::prelude::*;

fn far_away(mut commands: Commands) {
    // From 15 m on every second tick, from 60 m on not at all.
    commands.insert_resource(GlobalClothLod(ClothLod::by_distance([
        (15.0, ClothLodLevel::Every(2)),
        (60.0, ClothLodLevel::Frozen),
    ])));
}
