use bevy::prelude::*;
use bevy_drape::prelude::*;

fn far_away(mut commands: Commands) {
    // Beyond 15 m it runs every second tick, beyond 60 m not at all.
    commands.insert_resource(GlobalClothLod(ClothLod::by_distance([
        (15.0, ClothLodLevel::Every(2)),
        (60.0, ClothLodLevel::Frozen),
    ])));
}
