//! The window: orbit camera, panel, keys.

use std::process::ExitCode;

use bevy::prelude::*;
use bevy_drape::{plugin::ClothPanel, prelude::*};
use bevy_egui::{EguiContexts, EguiPrimaryContextPass, egui, input::EguiWantsInput};
use bevy_panorbit_camera::{PanOrbitCamera, PanOrbitCameraPlugin};

use crate::{
    scene::{self, ScenePlugin},
    view::View,
};

/// The keys, as they stand on screen.
const KEYS: [(&str, &str); 10] = [
    ("mouse", "orbit, pan, zoom"),
    ("Space", "pause, go on"),
    ("N", "single step, while paused"),
    ("L", "next level of the tree"),
    ("G", "springs on, off"),
    ("B", "next search: volume and rule"),
    ("M", "next material"),
    ("Up, Down", "faster, slower ball"),
    ("R", "new cloth"),
    ("P", "panel on, off"),
];

/// Runs the scene in a window until it is closed.
pub fn run() -> ExitCode {
    let exit = App::new()
        .add_plugins((
            View::Window.plugins(),
            ScenePlugin,
            ClothPanelPlugin,
            PanOrbitCameraPlugin,
        ))
        .add_systems(Startup, spawn_camera)
        .add_systems(
            Update,
            (
                free_mouse_for_panel,
                press_clock_keys,
                press_cloth_keys,
                press_ball_keys,
            ),
        )
        .add_systems(EguiPrimaryContextPass, show_keys)
        .run();
    match exit {
        AppExit::Success => ExitCode::SUCCESS,
        AppExit::Error(code) => ExitCode::from(code.get()),
    }
}

fn spawn_camera(mut commands: Commands) {
    commands.spawn((
        scene::camera(None),
        PanOrbitCamera {
            focus: scene::FOCUS,
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

fn press_cloth_keys(
    keys: Res<ButtonInput<KeyCode>>,
    mut cloths: Query<(
        &mut ShowClothGizmos,
        &mut SearchMethod,
        &mut ClothMaterial,
        &mut ClothParticles,
    )>,
) {
    for (mut show, mut method, mut material, mut particles) in &mut cloths {
        if keys.just_pressed(KeyCode::KeyL) {
            // The five levels of 16 × 16 particles, then none.
            show.levels = match show.levels.as_ref().map(|levels| *levels.start()) {
                None => Some(0..=0),
                Some(level) if level < 4 => Some(level + 1..=level + 1),
                Some(_) => None,
            };
        }
        if keys.just_pressed(KeyCode::KeyG) {
            show.springs = !show.springs;
        }
        if keys.just_pressed(KeyCode::KeyB) {
            let place = SearchMethod::ALL.iter().position(|each| *each == *method);
            *method =
                SearchMethod::ALL[place.map_or(0, |place| (place + 1) % SearchMethod::ALL.len())];
        }
        if keys.just_pressed(KeyCode::KeyM) {
            *material = next(&ClothMaterial::PRESETS, *material);
        }
        if keys.just_pressed(KeyCode::KeyR) {
            *particles = ClothParticles::default();
        }
    }
}

/// What comes after `now` among `named`, or the first of them.
fn next<T: Copy + PartialEq>(named: &[(&str, T)], now: T) -> T {
    let place = named.iter().position(|(_, each)| *each == now);
    named[place.map_or(0, |place| (place + 1) % named.len())].1
}

fn press_ball_keys(keys: Res<ButtonInput<KeyCode>>, mut speeds: Query<&mut ClothColliderSpeed>) {
    let pressed = |key| if keys.just_pressed(key) { 0.25 } else { 0.0 };
    let change = pressed(KeyCode::ArrowUp) - pressed(KeyCode::ArrowDown);
    if change != 0.0 {
        for mut speed in &mut speeds {
            speed.0 = (speed.0 + change).clamp(0.0, 10.0);
        }
    }
}

fn show_keys(mut contexts: EguiContexts) -> Result {
    let area = egui::Window::new("Keys").anchor(egui::Align2::RIGHT_BOTTOM, [-12.0, -12.0]);
    area.resizable(false).show(contexts.ctx_mut()?, |ui| {
        egui::Grid::new("keys").show(ui, |ui| {
            for (key, what) in KEYS {
                ui.strong(key);
                ui.label(what);
                ui.end_row();
            }
        });
    });
    Ok(())
}
