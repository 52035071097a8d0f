//! Where the scene is drawn: in a window, into an image, or not at all.

use std::{
    env,
    process::{Command, Stdio, exit},
};

use bevy::{
    app::PluginGroupBuilder,
    asset::AssetPlugin,
    gltf::GltfPlugin,
    log::LogPlugin,
    prelude::*,
    render::{
        RenderPlugin,
        pipelined_rendering::PipelinedRenderingPlugin,
        settings::{RenderCreation, WgpuSettings},
    },
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_drape::prelude::*;

use crate::top;

/// Says in a child process's environment which view it is to try out.
const TO_TRY: &str = "BEVY_DRAPE_TRY_VIEW";
/// The code that a process ends with that has tried a view out.
const TRIED_OUT: i32 = 42;

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum View {
    Window,
    Offscreen,
    Nothing,
}

impl View {
    /// Bevy's plugins for this view; a window has a title.
    pub fn plugins(self, title: &str) -> PluginGroupBuilder {
        let log = LogPlugin {
            // Without a renderer, Bevy's own plugins complain that there is none.
            filter: match self {
                Self::Nothing => "bevy_render=off,bevy_gizmos_render=off".into(),
                _ => "wgpu=error,bevy_render=error".into(),
            },
            level: bevy::log::Level::WARN,
            ..default()
        };
        // What artists paint on characters.
        let gltf = GltfPlugin::default()
            .add_custom_vertex_attribute("MAX_DISTANCE", ClothSkin::MAX_DISTANCE)
            .add_custom_vertex_attribute("BACKSTOP", ClothSkin::BACKSTOP);
        let assets = AssetPlugin {
            file_path: top().join("assets").to_string_lossy().into(),
            ..default()
        };
        let plugins = DefaultPlugins.set(log).set(gltf).set(assets);
        if self == Self::Window {
            let window = Window {
                title: format!("bevy_drape: {title}"),
                ..default()
            };
            return plugins.set(WindowPlugin {
                primary_window: Some(window),
                ..default()
            });
        }
        let settings = match self {
            Self::Nothing => WgpuSettings {
                backends: None,
                ..default()
            },
            _ => WgpuSettings::default(),
        };
        plugins
            .disable::<WinitPlugin>()
            .disable::<PipelinedRenderingPlugin>()
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                render_creation: RenderCreation::Automatic(Box::new(settings)),
                synchronous_pipeline_compilation: true,
                ..default()
            })
    }

    /// The best that can be had without a window.
    pub fn without_window() -> Self {
        if Self::Offscreen.can_be_had() {
            Self::Offscreen
        } else {
            Self::Nothing
        }
    }

    /// Tries a view out and ends the process, if it was started only for that. To be called before all else.
    pub fn try_out_if_asked() {
        let view = match env::var(TO_TRY).as_deref() {
            Ok("window") => Self::Window,
            Ok("offscreen") => Self::Offscreen,
            _ => return,
        };
        // Panics, or worse, where a display or an adapter is missing.
        App::new().add_plugins(view.plugins("trying out"));
        exit(TRIED_OUT);
    }

    /// Whether the plugins can be built. Asked of another process, which [is only started to try](Self::try_out_if_asked),
    /// since neither winit nor wgpu nor a driver can be trusted to return an error.
    pub fn can_be_had(self) -> bool {
        if self == Self::Window
            && cfg!(target_os = "linux")
            && env::var_os("DISPLAY").is_none_or(|name| name.is_empty())
        {
            return false;
        }
        let name = match self {
            Self::Window => "window",
            Self::Offscreen => "offscreen",
            Self::Nothing => return true,
        };
        let tried = env::current_exe().and_then(|program| {
            Command::new(program)
                // Of a program of tests, the one that tries the view out.
                .arg("a_view_is_tried_out_if_asked")
                .env(TO_TRY, name)
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status()
        });
        tried.is_ok_and(|status| status.code() == Some(TRIED_OUT))
    }
}
