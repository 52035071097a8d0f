//! The window: orbit camera, panel, keys.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::{
    plugin::{ClothPanel, ClothTopology},
    prelude::*,
};
use bevy_egui::{EguiContexts, EguiPrimaryContextPass, egui, input::EguiWantsInput};
use bevy_panorbit_camera::{PanOrbitCamera, PanOrbitCameraPlugin};

use super::{stage::Shot, view::View};

/// The keys of every example, as they stand on screen.
const KEYS: [(&str, &str); 10] = [
    ("mouse", "orbit, pan, zoom"),
    ("Space", "pause, go on"),
    ("N", "single step, while paused"),
    ("L", "next level of the tree"),
    ("G", "springs on, off"),
    ("B", "next search: volume and rule"),
    ("C", "contact by particles, triangles"),
    ("M", "next material"),
    ("R", "new cloth"),
    ("P", "panel on, off"),
];

/// Keys of one example, and what they do.
#[derive(Resource)]
struct MoreKeys(&'static [(&'static str, &'static str)]);

/// An app that runs a scene in a window, with keys of its own to be told of.
pub fn app(
    title: &str,
    scene: impl Plugin,
    shot: Shot,
    more_keys: &'static [(&'static str, &'static str)],
) -> App {
    let mut app = App::new();
    app.add_plugins((
        View::Window.plugins(title),
        scene,
        ClothPanelPlugin,
        PanOrbitCameraPlugin,
    ))
    .insert_resource(MoreKeys(more_keys))
    .insert_resource(shot)
    .add_systems(Startup, spawn_camera)
    .add_systems(
        Update,
        (
            free_mouse_for_panel,
            press_clock_keys,
            press_gizmo_keys,
            press_cloth_keys,
        ),
    )
    .add_systems(EguiPrimaryContextPass, show_keys);
    app
}

/// Runs it until it is closed.
pub fn run(mut app: App) -> ExitCode {
    match app.run() {
        AppExit::Success => ExitCode::SUCCESS,
        AppExit::Error(code) => ExitCode::from(code.get()),
    }
}

fn spawn_camera(mut commands: Commands, shot: Res<Shot>) {
    commands.spawn((
        shot.camera(None),
        PanOrbitCamera {
            focus: shot.focus,
            use_real_time: true,
            ..default()
        },
    ));
}

fn free_mouse_for_panel(mut cameras: Query<&mut PanOrbitCamera>, egui: Res<EguiWantsInput>) {
    for mut camera in &mut cameras {
        camera.enabled = !egui.wants_any_pointer_input();
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
    mut cloths: Query<(&mut ShowClothGizmos, &ClothTopology)>,
) {
    for (mut show, topology) in &mut cloths {
        let leaves = topology.tree().levels().len().saturating_sub(1);
        if keys.just_pressed(KeyCode::KeyL) {
            // All levels, then none.
            show.levels = match show.levels.as_ref().map(|levels| *levels.start()) {
                None => Some(0..=0),
                Some(level) if level < leaves => Some(level + 1..=level + 1),
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
    mut cloths: Query<(
        &mut SearchMethod,
        &mut NarrowPhase,
        &mut ClothMaterial,
        &mut ClothParticles,
    )>,
) {
    for (mut method, mut narrow_phase, mut material, mut particles) in &mut cloths {
        if keys.just_pressed(KeyCode::KeyB) {
            *method = next(SearchMethod::ALL, *method);
        }
        if keys.just_pressed(KeyCode::KeyC) {
            *narrow_phase = next(NarrowPhase::ALL.map(|(_, each)| each), *narrow_phase);
        }
        if keys.just_pressed(KeyCode::KeyM) {
            *material = next(ClothMaterial::PRESETS.map(|(_, each)| each), *material);
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

fn show_keys(mut contexts: EguiContexts, more: Res<MoreKeys>) -> Result {
    let area = egui::Window::new("Keys").anchor(egui::Align2::RIGHT_BOTTOM, [-12.0, -12.0]);
    area.resizable(false).show(contexts.ctx_mut()?, |ui| {
        egui::Grid::new("keys").show(ui, |ui| {
            for (key, what) in KEYS.iter().chain(more.0) {
                ui.strong(*key);
                ui.label(*what);
                ui.end_row();
            }
        });
    });
    Ok(())
}
