//! Light, sky, floor and the camera's place.

use bevy::{
    camera::{Hdr, RenderTarget},
    core_pipeline::tonemapping::Tonemapping,
    ecs::schedule::SingleThreadedExecutor,
    light::{CascadeShadowConfigBuilder, NotShadowCaster, NotShadowReceiver},
    mesh::VertexAttributeValues,
    prelude::*,
};

/// Colour of the sky at the horizon, where the floor ends in it, and further up.
const HORIZON: Color = Color::srgb(0.85, 0.88, 0.90);
const SKY: Color = Color::srgb(0.36, 0.55, 0.74);
/// How high above the horizon the sky has its second colour (rad).
const SKY_FROM: f32 = 0.55;
/// How far away the sky is (m).
const SKY_RADIUS: f32 = 500.0;
/// Of the sun, shared by its lamps, and of the fill light from the other side (lux).
const SUN: f32 = 5_200.0;
const FILL: f32 = 900.0;
/// Of the sky (cd/m²).
const SKYLIGHT: f32 = 520.0;
/// Lamps of the sun: shadows with a soft edge are what several hard ones make together.
const LAMPS: u32 = 8;
/// How far the outermost are from the sun's middle, as seen from the scene (rad).
const SUN_RADIUS: f32 = 0.05;
/// From one lamp to the next around the middle (rad), as in a sunflower: evenly spread, none behind another.
const GOLDEN_ANGLE: f32 = 2.399_963;

/// Particles along either side of a cloth.
#[derive(Resource, Clone, Copy)]
pub struct Grid(pub u32);

impl Default for Grid {
    /// As in the paper.
    fn default() -> Self {
        Self(16)
    }
}

/// Light from two sides, and a floor below a sky if there is to be one.
#[derive(Resource, Clone, Copy)]
pub struct StagePlugin {
    /// Where the light comes from.
    pub light_from: Vec3,
    pub has_floor: bool,
}

impl StagePlugin {
    /// With a floor.
    pub fn lit_from(x: f32, y: f32, z: f32) -> Self {
        Self {
            light_from: Vec3::new(x, y, z),
            has_floor: true,
        }
    }
}

impl Plugin for StagePlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(*self)
            .insert_resource(ClearColor(HORIZON))
            // A tick is one chain of short systems: waking threads for each would cost as much as they do.
            .edit_schedule(FixedUpdate, |schedule| {
                schedule.set_executor(SingleThreadedExecutor::new());
            })
            .add_systems(Startup, (spawn_sun, spawn_fill))
            .add_observer(give_camera_its_light);
        if self.has_floor {
            app.add_systems(Startup, (spawn_floor, spawn_sky))
                .add_observer(give_camera_its_fog);
        }
    }
}

fn spawn_sun(mut commands: Commands, stage: Res<StagePlugin>) {
    let sun = Transform::from_translation(stage.light_from).looking_at(Vec3::ZERO, Vec3::Y);
    for lamp in 0..LAMPS {
        let around = Quat::from_rotation_z(GOLDEN_ANGLE * lamp as f32);
        let outwards = ((lamp as f32 + 0.5) / LAMPS as f32).sqrt();
        let aside = Quat::from_rotation_x(SUN_RADIUS * outwards);
        commands.spawn((
            DirectionalLight {
                color: Color::srgb(1.0, 0.94, 0.85),
                illuminance: SUN / LAMPS as f32,
                shadow_maps_enabled: true,
                ..default()
            },
            // One map for each lamp, over the scene alone.
            CascadeShadowConfigBuilder {
                num_cascades: 1,
                maximum_distance: 2.0 * stage.light_from.length(),
                ..default()
            }
            .build(),
            sun.with_rotation(sun.rotation * around * aside),
        ));
    }
}

/// From the other side and lower, without shadows: folds that the sun does not reach keep their shape.
fn spawn_fill(mut commands: Commands, stage: Res<StagePlugin>) {
    let from = stage.light_from * Vec3::new(-1.0, 0.45, 0.6);
    commands.spawn((
        DirectionalLight {
            color: Color::srgb(0.80, 0.90, 1.0),
            illuminance: FILL,
            ..default()
        },
        Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// Paler at the horizon than above, as skies are.
fn spawn_sky(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let dome: Mesh = Sphere::new(SKY_RADIUS).mesh().uv(16, 128);
    let colors = dome
        .attribute(Mesh::ATTRIBUTE_POSITION)
        .and_then(VertexAttributeValues::as_float3)
        .map(|places| {
            let color = |place: &[f32; 3]| {
                let height = (place[1] / SKY_RADIUS).asin() / SKY_FROM;
                let part = height.clamp(0.0, 1.0);
                let eased = part * part * (3.0 - 2.0 * part);
                HORIZON
                    .to_linear()
                    .mix(&SKY.to_linear(), eased)
                    .to_f32_array()
            };
            places.iter().map(color).collect::<Vec<_>>()
        })
        .unwrap_or_default();
    commands.spawn((
        Mesh3d(meshes.add(dome.with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors))),
        MeshMaterial3d(materials.add(StandardMaterial {
            unlit: true,
            fog_enabled: false,
            cull_mode: None,
            ..default()
        })),
        NotShadowCaster,
        NotShadowReceiver,
    ));
}

/// So large, and so much in the fog, that its edge is not seen.
fn spawn_floor(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(400.0, 400.0))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::srgb(0.61, 0.60, 0.585),
            perceptual_roughness: 0.95,
            reflectance: 0.1,
            ..default()
        })),
    ));
}

/// Light from all sides: the sky from above, what the floor throws back from below.
fn give_camera_its_light(
    added: On<Add, Camera3d>,
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
) {
    let sky = EnvironmentMapLight {
        intensity: SKYLIGHT,
        ..EnvironmentMapLight::hemispherical_gradient(
            &mut images,
            Color::srgb(0.93, 0.96, 1.0),
            Color::srgb(0.80, 0.83, 0.87),
            Color::srgb(0.55, 0.53, 0.50),
        )
    };
    commands.entity(added.entity).insert(sky);
}

/// The floor becomes the sky.
fn give_camera_its_fog(
    added: On<Add, Camera3d>,
    cameras: Query<&Transform>,
    mut commands: Commands,
) {
    let distance = cameras
        .get(added.entity)
        .map_or(5.0, |camera| camera.translation.length());
    commands.entity(added.entity).insert(DistanceFog {
        color: HORIZON,
        falloff: FogFalloff::Linear {
            start: 1.2 * distance,
            end: 5.0 * distance,
        },
        ..default()
    });
}

/// Where the camera is, and what it looks at.
#[derive(Resource, Clone, Copy)]
pub struct Shot {
    pub from: Vec3,
    pub focus: Vec3,
    /// Angle from the lower to the upper edge of the picture (rad).
    pub fov: f32,
}

impl Shot {
    /// The camera of either view, with its image if it has one.
    pub fn camera(self, target: Option<Handle<Image>>) -> impl Bundle {
        let target = target.map_or_else(RenderTarget::default, |image| {
            RenderTarget::Image(image.into())
        });
        (
            Camera3d::default(),
            // So that the sky behind takes the same way to the screen as the fog before it.
            Hdr,
            target,
            Projection::from(PerspectiveProjection {
                fov: self.fov,
                ..default()
            }),
            // Needs no look-up table, unlike Bevy's default.
            Tonemapping::KhronosPbrNeutral,
            Transform::from_translation(self.from).looking_at(self.focus, Vec3::Y),
        )
    }
}
