//! The arm, and its sleeve.

use std::f32::consts::TAU;

use bevy::{
    ecs::system::SystemParam,
    math::Affine2,
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_drape::prelude::*;
use examples_shared::stage::StagePlugin;
use examples_shared::window::Keys;
use examples_shared::workshop::{Weave, Workshop};
use examples_shared::{arrows::up_down, headless::TickByTick, surfaces::turned};

/// Height of the shoulder above the floor, and how far below it the elbow is (m).
const SHOULDER: f32 = 1.3;
const ELBOW: f32 = 0.3;
/// Radii of the arm at heights above the shoulder (m), from the top.
const ARM: [[f32; 2]; 17] = [
    [0.0, 0.07],
    [0.045, 0.06],
    [0.068, 0.02],
    [0.070, -0.04],
    [0.062, -0.10],
    [0.058, -0.16],
    [0.052, -0.22],
    [0.045, -0.26],
    [0.043, -0.30],
    [0.045, -0.34],
    [0.050, -0.38],
    [0.046, -0.44],
    [0.036, -0.52],
    [0.029, -0.57],
    [0.042, -0.62],
    [0.036, -0.68],
    [0.0, -0.70],
];
/// How far above and below the elbow the skin follows both bones (m).
const BLEND: f32 = 0.05;
/// Heights at which the sleeve begins and ends above the shoulder, and its radii there (m).
const SLEEVE: [[f32; 2]; 2] = [[0.085, -0.04], [0.13, -0.54]];
/// How far the elbow bends (rad), and how often (rad/s).
const BEND: f32 = 1.7;
const SPEED: f32 = 2.0;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(3.0, 4.5, 3.0),
        DrapePlugins::default(),
    ))
    // The bones move in ticks.
    .init_resource::<TickByTick>()
    .add_plugins(Keys(&[
        ("T", "bend, hold still"),
        ("Up, Down", "bend faster, slower"),
    ]))
    .add_systems(Startup, spawn_arm)
    .add_systems(FixedUpdate, bend.before(ClothSystems::Prepare))
    .add_systems(Update, press_keys);
}

/// A bone that bends.
#[derive(Component)]
struct Elbow {
    /// How often it does (rad/s).
    speed: f32,
    bends: bool,
    /// Where in that it is (rad).
    phase: f32,
}

fn press_keys(keys: Res<ButtonInput<KeyCode>>, mut elbows: Query<&mut Elbow>) {
    for mut elbow in &mut elbows {
        elbow.bends ^= keys.just_pressed(KeyCode::KeyT);
        elbow.speed = (elbow.speed + 0.5 * up_down(&keys)).clamp(0.0, 8.0);
    }
}

fn bend(mut elbows: Query<(&mut Elbow, &mut Transform)>, time: Res<Time>) {
    for (mut elbow, mut place) in &mut elbows {
        if elbow.bends {
            elbow.phase += elbow.speed * time.delta_secs();
        }
        let angle = BEND / 2.0 * (1.0 - elbow.phase.cos());
        place.rotation = Quat::from_rotation_z(angle);
    }
}

/// Where a skinned mesh's bones are bound.
#[derive(SystemParam)]
struct BindPoses<'w>(ResMut<'w, Assets<SkinnedMeshInverseBindposes>>);

/// The arm's mesh, bound to shoulder and elbow.
fn arm() -> Mesh {
    let mesh = turned(&ARM, 32, TAU);
    let positions = mesh.attribute(Mesh::ATTRIBUTE_POSITION);
    let positions = positions.and_then(VertexAttributeValues::as_float3);
    let heights = positions.unwrap_or_default().iter().map(|at| at[1]);
    let weights: Vec<[f32; 4]> = heights
        .map(|height| {
            let below = ((-height - ELBOW) / (2.0 * BLEND) + 0.5).clamp(0.0, 1.0);
            [1.0 - below, below, 0.0, 0.0]
        })
        .collect();
    let joints = vec![[0, 1, 0, 0]; weights.len()];
    mesh.with_inserted_attribute(
        Mesh::ATTRIBUTE_JOINT_INDEX,
        VertexAttributeValues::Uint16x4(joints),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
}

fn spawn_arm(mut shop: Workshop, mut bind_poses: BindPoses) {
    let shoulder = Transform::from_xyz(0.0, SHOULDER, 0.0);
    let elbow = Transform::from_xyz(0.0, -ELBOW, 0.0);
    let bends = Elbow {
        speed: SPEED,
        bends: true,
        phase: 0.0,
    };
    let upper = (Name::new("shoulder"), shoulder, Visibility::default());
    let upper = shop.commands.spawn(upper).id();
    let fore = (Name::new("elbow"), elbow, bends, ChildOf(upper));
    let fore = shop.commands.spawn((fore, Visibility::default())).id();
    let inverse_bindposes = vec![Mat4::IDENTITY, elbow.to_matrix().inverse()];
    let skin = SkinnedMesh {
        inverse_bindposes: bind_poses.0.add(inverse_bindposes),
        joints: vec![upper, fore],
    };
    let arm = (
        Name::new("arm"),
        shop.mesh(arm()),
        shop.rough(Color::srgb(0.80, 0.62, 0.50), 0.6),
        skin,
        // Its triangles follow the joints.
        ClothCollider::mesh(),
    );
    shop.commands.spawn((arm, shoulder));
    let stand = (
        shop.mesh(Cylinder::new(0.015, 0.3)),
        shop.brass(0.35),
        Transform::from_xyz(0.0, SHOULDER + 0.2, 0.0),
    );
    shop.commands.spawn(stand);
    sew(&mut shop, upper, shoulder);
}

/// The sleeve, held where it begins.
fn sew(shop: &mut Workshop, upper: Entity, place: Transform) {
    let rings = shop.grid.0;
    let [from, to] = SLEEVE.map(Vec2::from);
    let profile = |ring: u32| from.lerp(to, ring as f32 / rings as f32).to_array();
    let profile: Vec<[f32; 2]> = (0..=rings).map(profile).collect();
    let linen = shop.weave(Weave::Plain, 1, |runs_down, yarn| match (runs_down, yarn) {
        (true, 52..56) => Color::srgb(0.80, 0.60, 0.20),
        (true, _) => Color::srgb(0.16, 0.42, 0.44),
        (false, _) => Color::srgb(0.12, 0.34, 0.38),
    });
    let linen = shop.paint(StandardMaterial {
        uv_transform: Affine2::from_scale(Vec2::new(1.0, 2.0)),
        double_sided: true,
        ..linen
    });
    let top = from.y - 1.0e-3;
    let held = Pin::at_rest(move |at| at.y > top);
    let mesh = shop.mesh(turned(&profile, rings, TAU));
    shop.commands.spawn((
        Name::new("sleeve"),
        Cloth::mesh(),
        mesh,
        Pins::none(),
        ClothAttachments::new([(held, upper)]),
        ClothMaterial::COTTON,
        ClothSettings::substeps(28),
        ShowClothGizmos::nothing(),
        linen,
        place,
    ));
}
