//! Where the scene is drawn: in a window, into an image, or not at all.

use std::{
    env,
    process::{Command, Stdio},
};

use bevy::{
    app::PluginGroupBuilder,
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

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
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
        let plugins = DefaultPlugins.set(log);
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

    /// Builds the plugins: panics, or worse, where a display or an adapter is missing.
    pub fn try_out(self) {
        App::new().add_plugins(self.plugins("trying out"));
    }

    /// Whether [`try_out`](Self::try_out) goes well. Asked of another process, since neither winit nor wgpu
    /// nor a driver can be trusted to return an error.
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
        let probe = env::current_exe().and_then(|program| {
            Command::new(program)
                .args(["--probe", name])
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status()
        });
        probe.is_ok_and(|status| status.success())
    }
}
