//! The window: orbit camera, panel, keys.

use std::process::ExitCode;

use bevy::{
    camera::{CameraOutputMode, Viewport, visibility::RenderLayers},
    prelude::*,
    render::render_resource::BlendState,
    window::PrimaryWindow,
};
use bevy_drape::{
    plugin::{ClothBuilt, ClothPanel},
    prelude::*,
};
use bevy_egui::{EguiGlobalSettings, PrimaryEguiContext, input::EguiWantsInput};
use bevy_panorbit_camera::{PanOrbitCamera, PanOrbitCameraPlugin};

use super::{
    preparing::PreparingPlugin,
    stage::{Grid, Shot},
    start::Example,
    view::View,
};

/// The keys of every example, as they stand in the panel.
const KEYS: [(&str, &str); 11] = [
    ("Drag on cloth", "pull it"),
    ("Mouse", "orbit, pan, zoom"),
    ("Space", "pause, resume"),
    ("N", "single step while paused"),
    ("M", "next fabric"),
    ("R", "reset the cloth"),
    ("P", "show, hide this panel"),
    ("G", "show, hide springs"),
    ("L", "show next level of volumes"),
    ("B", "next search method"),
    ("C", "next contact method"),
];

/// An example's own keys, as they stand in the panel above [`KEYS`].
pub struct Keys(pub &'static [(&'static str, &'static str)]);

impl Plugin for Keys {
    fn build(&self, _: &mut App) {}
}

/// Runs the example in a window beside the panel until it is closed.
pub fn run(example: Example, grid: Grid) -> ExitCode {
    let mut app = App::new();
    app.add_plugins(View::Window.plugins(example.title))
        .insert_resource(grid)
        .insert_resource(example.shot);
    (example.scene)(&mut app);
    let own = app.get_added_plugins().into_iter();
    let keys = own.flat_map(|Keys(keys)| *keys).chain(&KEYS);
    let panel = ClothPanel {
        keys: keys
            .map(|(key, what)| (key.to_string(), what.to_string()))
            .collect(),
        ..default()
    };
    app.add_plugins((ClothPanelPlugin, PreparingPlugin, PanOrbitCameraPlugin))
        // Meshes in front of a cloth hide it from the mouse.
        .add_plugins((ClothPickingPlugin::default(), MeshPickingPlugin))
        .insert_resource(panel)
        .add_systems(PreStartup, keep_egui_off_the_scene)
        .add_systems(Startup, spawn_cameras)
        .add_systems(
            Update,
            (
                draw_beside_panel,
                free_mouse,
                press_clock_keys,
                press_gizmo_keys,
                press_cloth_keys,
            ),
        );
    match app.run() {
        AppExit::Success => ExitCode::SUCCESS,
        AppExit::Error(code) => ExitCode::from(code.get()),
    }
}

/// It would take the scene's camera, and its viewport, for its own.
fn keep_egui_off_the_scene(mut egui: ResMut<EguiGlobalSettings>) {
    egui.auto_create_primary_context = false;
}

fn spawn_cameras(mut commands: Commands, shot: Res<Shot>) {
    commands.spawn((
        shot.camera(None),
        PanOrbitCamera {
            focus: shot.focus,
            use_real_time: true,
            ..default()
        },
    ));
    // Egui's, over the whole window: it draws nothing else, and over what the scene's has drawn.
    commands.spawn((
        PrimaryEguiContext,
        Camera2d,
        Camera {
            order: 1,
            output_mode: CameraOutputMode::Write {
                blend_state: Some(BlendState::ALPHA_BLENDING),
                clear_color: ClearColorConfig::None,
            },
            clear_color: Color::NONE.into(),
            ..default()
        },
        RenderLayers::none(),
        Msaa::Off,
    ));
}

/// As wide a picture as in a window of 16 : 9 without the panel, in whatever place the panel leaves.
fn draw_beside_panel(
    panel: Res<ClothPanel>,
    shot: Res<Shot>,
    window: Single<&Window, With<PrimaryWindow>>,
    camera: Single<(&mut Camera, &mut Projection), With<Camera3d>>,
) {
    let viewport = panel.viewport(window.physical_size(), window.scale_factor());
    let place = |of: &Option<_>| {
        of.as_ref()
            .map(|viewport: &Viewport| (viewport.physical_position, viewport.physical_size))
    };
    let (mut camera, mut projection) = camera.into_inner();
    if place(&camera.viewport) != place(&viewport) {
        camera.viewport = viewport;
    }
    let size = place(&camera.viewport).map_or(window.physical_size(), |(_, size)| size);
    // A window that is minimised has no size.
    let size = size.as_vec2().max(Vec2::ONE);
    let narrower = (16.0 / 9.0) / (size.x / size.y);
    let fov = 2.0 * ((shot.fov / 2.0).tan() * narrower.max(1.0)).atan();
    if let Projection::Perspective(perspective) = projection.bypass_change_detection()
        && perspective.fov != fov
    {
        perspective.fov = fov;
        projection.set_changed();
    }
}

/// The camera stays while the mouse is the panel's, or pulls at cloth.
fn free_mouse(
    mut cameras: Query<&mut PanOrbitCamera>,
    egui: Res<EguiWantsInput>,
    hands: Query<(), With<ClothGrab>>,
) {
    for mut camera in &mut cameras {
        camera.enabled = !egui.wants_any_pointer_input() && hands.is_empty();
    }
}

fn press_clock_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut running: ResMut<Time<Virtual>>,
    mut fixed: ResMut<Time<Fixed>>,
    mut panel: ResMut<ClothPanel>,
) {
    if keys.just_pressed(KeyCode::Space) {
        if running.is_paused() {
            running.unpause();
        } else {
            running.pause();
        }
    }
    if keys.just_pressed(KeyCode::KeyN) && running.is_paused() {
        let timestep = fixed.timestep();
        fixed.accumulate_overstep(timestep);
    }
    if keys.just_pressed(KeyCode::KeyP) {
        panel.visible = !panel.visible;
    }
}

fn press_gizmo_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut cloths: Query<(&mut ShowClothGizmos, &ClothBuilt)>,
) {
    for (mut show, built) in &mut cloths {
        let leaves = built.tree().levels().len().saturating_sub(1);
        if keys.just_pressed(KeyCode::KeyL) {
            // All levels, then none.
            show.levels = match show.levels.map(|[first, _]| first) {
                None => Some([0; 2]),
                Some(level) if level < leaves => Some([level + 1; 2]),
                Some(_) => None,
            };
        }
        if keys.just_pressed(KeyCode::KeyG) {
            show.springs = !show.springs;
        }
    }
}

fn press_cloth_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut commands: Commands,
    mut cloths: Query<(
        Entity,
        &mut SearchMethod,
        &mut NarrowPhase,
        &mut ClothMaterial,
        &mut ClothParticles,
    )>,
) {
    for (cloth, mut method, mut narrow_phase, mut material, mut particles) in &mut cloths {
        if keys.just_pressed(KeyCode::KeyB) {
            *method = next(SearchMethod::ALL, *method);
        }
        if keys.just_pressed(KeyCode::KeyC) {
            *narrow_phase = next(NarrowPhase::ALL.map(|(_, each)| each), *narrow_phase);
        }
        if keys.just_pressed(KeyCode::KeyM) {
            *material = next(ClothMaterial::PRESETS.map(|(_, each)| each), *material);
            // Some have a warp and a weft. A mesh without a texture has no direction for them.
            let grain = ClothGrain::along(Vec3::NEG_Y);
            commands.entity(cloth).insert_if_new(grain);
        }
        if keys.just_pressed(KeyCode::KeyR) {
            *particles = ClothParticles::default();
        }
    }
}

/// What comes after `now` among `all`, or the first of them.
fn next<T: Copy + PartialEq, const N: usize>(all: [T; N], now: T) -> T {
    let place = all.iter().position(|each| *each == now);
    all[place.map_or(0, |place| (place + 1) % N)]
}
