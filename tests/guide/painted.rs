use bevy::{mesh::PlaneMeshBuilder, prelude::*};
use bevy_drape::prelude::*;

fn apron(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    // 22 × 22 vertices, as red as they are near the upper edge.
    let sheet = PlaneMeshBuilder::new(Dir3::Z, Vec2::new(1.0, 2.0)).subdivisions(20).build();
    let red: Vec<[f32; 4]> = (0..22 * 22).map(|vertex| [1.0 - (vertex / 22) as f32 / 21.0, 0.0, 0.0, 1.0]).collect();
    let sheet = sheet.with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, red);
    let map = ClothMaterialMap {
        // Full red is eleven times as stiff against bending, and without red it is as stiff as the material.
        bending: ClothFactor::added(ClothPaint::color(0, 10.0)),
        // Elastic at the waist: a tenth of the stiffness.
        stretch: ClothFactor::of(ClothPaint::at_rest(|place| if place.y > 0.8 { 0.1 } else { 1.0 })),
        // Wet below: three times as heavy.
        density: ClothFactor::added(ClothPaint::at_rest(|place| if place.y < -0.5 { 2.0 } else { 0.0 })),
        ..default()
    };
    let pins = Pins::new([Pin::at_rest(|position| position.y > 0.99)]);
    commands.spawn((Name::new("apron"), Cloth::mesh(), Mesh3d(meshes.add(sheet)), pins, map));
}
