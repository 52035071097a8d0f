//! The hero and the cape.

use std::f32::consts::PI;

use bevy::{
    gltf::GltfAssetLabel, math::Affine2, mesh::skinning::SkinnedMesh, prelude::*,
    world_serialization::WorldInstanceReady,
};
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;
use examples_shared::stage::{Grid, StagePlugin};
use examples_shared::workshop::{Weave, Workshop};
use examples_shared::{arrows::up_down, headless::TickByTick, window::Keys};

use crate::hero::{Hero, animate, go, load_moves, prepare_player};

/// What `model/` writes: metres, y up, the ground at 0.
pub const HERO: &str = "models/hero.glb";

/// Particles down the cape, as it is modelled.
pub const PARTICLES: u32 = 27;

/// The scene, without a camera.
pub fn build(app: &mut App) {
    app.add_plugins((
        StagePlugin::lit_from(-3.0, 5.0, 4.5),
        DrapePlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    // Still air: what blows the cape is the hero's own speed.
    .init_resource::<ClothWind>()
    // The skeleton moves from frame to frame.
    .init_resource::<TickByTick>()
    .add_plugins(Keys(&[
        ("W", "run, stand still"),
        ("J", "jump"),
        ("T", "teleport"),
        ("Up, Down", "stronger, weaker wind"),
    ]))
    .add_systems(Startup, (load_moves, spawn_hero).chain())
    .add_systems(FixedUpdate, go.before(ClothSystems::Prepare))
    .add_systems(Update, (animate, press_keys))
    .add_observer(prepare_player)
    .add_observer(dress);
}

fn press_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut heroes: Query<&mut Hero>,
    mut wind: ResMut<ClothWind>,
) {
    for mut hero in &mut heroes {
        hero.runs ^= keys.just_pressed(KeyCode::KeyW);
        hero.jumps |= keys.just_pressed(KeyCode::KeyJ);
        hero.teleports |= keys.just_pressed(KeyCode::KeyT);
    }
    wind.velocity.x = (wind.velocity.x + 2.0 * up_down(&keys)).clamp(-20.0, 20.0);
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
    mut shop: Workshop,
) {
    let below = children.iter_descendants(ready.entity);
    for cape in below.filter(|entity| skinned.contains(*entity)) {
        // Red wool with a border of gold along the hem.
        let wool = shop.weave(Weave::Twill, 1, |runs_down, yarn| match (runs_down, yarn) {
            (false, 59..62) => Color::srgb(0.86, 0.66, 0.26),
            (false, _) => Color::srgb(0.56, 0.05, 0.08),
            (true, _) => Color::srgb(0.74, 0.09, 0.11),
        });
        let wool = shop.paint(StandardMaterial {
            uv_transform: Affine2::from_scale(Vec2::new(2.0, 1.0)),
            ..wool
        });
        shop.commands.entity(cape).insert((
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
            wool,
        ));
    }
}
