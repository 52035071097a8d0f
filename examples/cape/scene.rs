//! The hero and the cape.

use std::f32::consts::PI;

use bevy::{
    gltf::GltfAssetLabel, math::Affine2, mesh::skinning::SkinnedMesh, prelude::*,
    world_serialization::WorldInstanceReady,
};
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;

use crate::{
    hero::{Hero, animate, go, load_moves, prepare_player},
    shared::{
        headless::TickByTick,
        stage::{Grid, Shot, StagePlugin},
        woven::{Weave, woven},
    },
};

/// What `model/` writes: metres, y up, the ground at 0.
pub const HERO: &str = "models/hero.glb";

/// Particles down the cape, as it is modelled.
pub const PARTICLES: u32 = 27;

/// When the cape flies (s).
pub const DRAWN_AT: f64 = 2.95;

/// All of the circle that the hero runs around, with room for a jump where it is nearest.
pub const SHOT: Shot = Shot {
    from: Vec3::new(-2.1, 2.2, 7.7),
    focus: Vec3::new(0.0, 1.08, 0.0),
    fov: 0.52,
};

/// The scene, without a camera.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        let stage = StagePlugin {
            has_floor: true,
            light_from: Vec3::new(-3.0, 5.0, 4.5),
        };
        app.add_plugins((
            stage,
            DrapePlugins::default(),
            TransformInterpolationPlugin::default(),
        ))
        // Still air: what blows the cape is the hero's own speed.
        .init_resource::<ClothWind>()
        // The skeleton moves from frame to frame.
        .init_resource::<TickByTick>()
        .add_systems(Startup, (load_moves, spawn_hero).chain())
        .add_systems(FixedUpdate, go.before(ClothSystems::Prepare))
        .add_systems(Update, animate)
        .add_observer(prepare_player)
        .add_observer(dress);
    }
}

fn spawn_hero(mut commands: Commands, assets: Res<AssetServer>, grid: Res<Grid>) {
    if grid.0 != PARTICLES {
        eprintln!("The cape has the particles that it is modelled with.");
    }
    let scene = GltfAssetLabel::Scene(0).from_asset(HERO);
    // glTF's models look along +z, what Bevy moves along −z.
    let model = (
        WorldAssetRoot(assets.load(scene)),
        Transform::from_rotation(Quat::from_rotation_y(PI)),
    );
    let hero = Hero::default();
    commands.spawn((
        Name::new("hero"),
        hero.place(),
        hero,
        Visibility::default(),
        TransformInterpolation,
        // Of a sprint and of a turn the cape feels a part: the rest carries it along.
        ClothInertia::share(0.5),
        ClothBones::new([
            ClothBone::ball("head", 0.12),
            ClothBone::capsule("chest", "neck", 0.125),
            ClothBone::capsule("hips", "chest", 0.125),
            ClothBone::capsule("thigh.L", "shin.L", 0.085),
            ClothBone::capsule("thigh.R", "shin.R", 0.085),
            ClothBone::capsule("shin.L", "foot.L", 0.07),
            ClothBone::capsule("shin.R", "foot.R", 0.07),
        ]),
        children![model],
    ));
}

/// Makes cloth of the cape, as soon as the file's scene is there.
fn dress(
    ready: On<WorldInstanceReady>,
    children: Query<&Children>,
    skinned: Query<(), With<SkinnedMesh>>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    let below = children.iter_descendants(ready.entity);
    for cape in below.filter(|entity| skinned.contains(*entity)) {
        // Red wool with a border of gold along the hem.
        let wool = woven(Weave::Twill, &mut images, 1, |runs_down, yarn| {
            match (runs_down, yarn) {
                (false, 59..62) => Color::srgb(0.86, 0.66, 0.26),
                (false, _) => Color::srgb(0.56, 0.05, 0.08),
                (true, _) => Color::srgb(0.74, 0.09, 0.11),
            }
        });
        commands.entity(cape).insert((
            Cloth::mesh(),
            Pins::none(),
            ClothSkin::painted(),
            ClothMaterial {
                damping: 0.02,
                ..ClothMaterial::COTTON
            },
            ClothSettings {
                tethers: true,
                ..ClothSettings::substeps(24)
            },
            ClothSelfCollision::default(),
            ShowClothGizmos::nothing(),
            MeshMaterial3d(materials.add(StandardMaterial {
                uv_transform: Affine2::from_scale(Vec2::new(2.0, 1.0)),
                ..wool
            })),
        ));
    }
}
