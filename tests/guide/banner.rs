use bevy::{mesh::PlaneMeshBuilder, prelude::*};
use bevy_drape::prelude::*;

fn banner(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    // An upright sheet of 1 m by 2 m with 22 × 22 vertices.
    let sheet = PlaneMeshBuilder::new(Dir3::Z, Vec2::new(1.0, 2.0)).subdivisions(20).build();
    // Vertices above y = 0.99 m, in the model's own metres, hold still.
    let pins = Pins::new([Pin::at_rest(|position| position.y > 0.99)]);
    commands.spawn((Name::new("banner"), Cloth::mesh(), Mesh3d(meshes.add(sheet)), pins, ClothMaterial::SILK));
}
