//! Light, sky, floor and the camera's place.

use bevy::{
    camera::RenderTarget, core_pipeline::tonemapping::Tonemapping,
    ecs::schedule::SingleThreadedExecutor, prelude::*,
};

/// Light and sky, and a floor to cast shadows on if there is to be one.
#[derive(Resource, Clone, Copy)]
pub struct StagePlugin {
    /// Where the light comes from.
    pub light_from: Vec3,
    pub has_floor: bool,
}

impl Plugin for StagePlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(*self)
            .insert_resource(ClearColor(Color::srgb(0.87, 0.91, 0.95)))
            .insert_resource(GlobalAmbientLight {
                brightness: 700.0,
                ..default()
            })
            // A tick is one chain of short systems: waking threads for each would cost as much as they do.
            .edit_schedule(FixedUpdate, |schedule| {
                schedule.set_executor(SingleThreadedExecutor::new());
            })
            .add_systems(Startup, spawn_light);
        if self.has_floor {
            app.add_systems(Startup, spawn_floor);
        }
    }
}

fn spawn_light(mut commands: Commands, stage: Res<StagePlugin>) {
    commands.spawn((
        DirectionalLight {
            illuminance: 7_000.0,
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_translation(stage.light_from).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn spawn_floor(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(40.0, 40.0))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::srgb(0.36, 0.38, 0.42),
            perceptual_roughness: 0.95,
            ..default()
        })),
    ));
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
            target,
            Projection::from(PerspectiveProjection {
                fov: self.fov,
                ..default()
            }),
            // Needs no look-up table, unlike Bevy's default.
            Tonemapping::AcesFitted,
            Transform::from_translation(self.from).looking_at(self.focus, Vec3::Y),
        )
    }
}
