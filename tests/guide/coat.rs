use bevy::prelude::*;
use bevy_drape::prelude::*;

/// For an observer of `WorldInstanceReady`, or wherever a game finds the meshes of its characters.
fn make_cloth(name: &Name, mesh: Entity, commands: &mut Commands) {
    if name.as_str() == "coat" {
        commands.entity(mesh).insert((
            Cloth::mesh(),
            // Only vertices painted with a max distance of 0 m are pinned.
            Pins::none(),
            // Red, 0 to 1, sets a max distance of 0 to 0.3 m. The backstop, a ball of 0.5 m, begins 2 cm behind the pose.
            ClothSkin::within(ClothPaint::color(0, 0.3)).with_backstop(0.02, 0.5),
            ClothMaterial::DENIM,
        ));
    }
    if name.as_str() == "body" {
        // Its triangles follow the bones.
        commands.entity(mesh).insert(ClothCollider::mesh());
    }
}

fn hero(mut commands: Commands) {
    commands.spawn((
        Name::new("hero"),
        Transform::default(),
        // The cloth feels a third of the hero's motion. A move of more than 2 m in one tick is a teleport.
        ClothInertia::share(0.3),
        // Colliders on bones, by the bones' names.
        ClothBones::new([
            ClothBone::ball("head", 0.12),
            ClothBone::capsule("hips", "neck", 0.16),
            ClothBone::capsule("thigh.L", "shin.L", 0.09),
        ]),
    ));
}
