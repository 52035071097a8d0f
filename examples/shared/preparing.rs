//! Until the scene can be drawn, the window says so and time stands still: drivers take seconds to compile its shaders.

use bevy::{
    prelude::*,
    render::{ExtractSchedule, MainWorld, RenderApp, render_resource::PipelineCache},
};
use bevy_drape::{plugin::ClothPanel, prelude::*};
use bevy_egui::{
    EguiContexts, EguiPrimaryContextPass,
    egui::{Align2, Color32, FontId, LayerId},
};

/// Frames in a row in which nothing is left to compile: what is new in one frame is asked for in the next.
const FRAMES: u32 = 4;

/// There until the scene can be drawn.
#[derive(Resource, Default)]
struct Preparing {
    is_compiling: bool,
    /// Frames in a row in which all was there.
    ready: u32,
}

pub struct PreparingPlugin;

impl Plugin for PreparingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Preparing>()
            .add_systems(Update, wait_for_scene.run_if(resource_exists::<Preparing>))
            .add_systems(
                EguiPrimaryContextPass,
                say_so.run_if(resource_exists::<Preparing>),
            );
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            render_app.add_systems(ExtractSchedule, note_compilation);
        }
    }
}

fn note_compilation(mut world: ResMut<MainWorld>, pipelines: Res<PipelineCache>) {
    if let Some(mut preparing) = world.get_resource_mut::<Preparing>() {
        preparing.is_compiling = pipelines.waiting_pipelines().next().is_some();
    }
}

/// Time stands still once each cloth has had the tick that makes its mesh.
fn wait_for_scene(
    mut preparing: ResMut<Preparing>,
    cloths: Query<Has<Mesh3d>, With<Cloth>>,
    mut time: ResMut<Time<Virtual>>,
    mut commands: Commands,
) {
    let has_meshes = !cloths.is_empty() && cloths.iter().all(|has_mesh| has_mesh);
    if !has_meshes || preparing.is_compiling {
        preparing.ready = 0;
    } else {
        preparing.ready += 1;
    }
    if preparing.ready == FRAMES {
        commands.remove_resource::<Preparing>();
        time.set_relative_speed(1.0);
    } else if has_meshes {
        time.set_relative_speed(0.0);
    }
}

/// In the middle of what the panel leaves.
fn say_so(mut contexts: EguiContexts, panel: Res<ClothPanel>) -> Result {
    let context = contexts.ctx_mut()?;
    let mut place = context.content_rect();
    if panel.visible {
        place.min.x += ClothPanel::WIDTH;
    }
    context.layer_painter(LayerId::background()).text(
        place.center(),
        Align2::CENTER_CENTER,
        "preparing the scene …",
        FontId::proportional(20.0),
        Color32::from_gray(90),
    );
    Ok(())
}
