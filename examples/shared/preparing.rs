//! Until the scene can be drawn, the window says so: drivers take seconds to compile its shaders.

use bevy::{
    prelude::*,
    render::{
        ExtractSchedule, MainWorld, RenderApp,
        render_resource::{CachedPipelineState, PipelineCache, PipelineDescriptor},
    },
};
use bevy_drape::plugin::ClothPanel;
use bevy_egui::{
    EguiContexts, EguiPrimaryContextPass,
    egui::{Align2, Color32, FontId, LayerId},
};

/// Frames in a row in which every mesh can be drawn: a new mesh asks for its pipeline a frame later.
const FRAMES: u32 = 4;
/// The text goes after this time in any case (s).
const PATIENCE: f32 = 60.0;

/// There until the scene can be drawn.
#[derive(Resource, Default)]
struct Preparing {
    /// Whether all pipelines that draw meshes are compiled. Others may wait for good, for a shader that no scene needs.
    draws_meshes: bool,
    /// Frames in a row in which that was so.
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
        let mut of_meshes = pipelines
            .pipelines()
            .filter(|pipeline| match &pipeline.descriptor {
                PipelineDescriptor::RenderPipelineDescriptor(descriptor) => descriptor
                    .label
                    .as_deref()
                    .is_some_and(|label| label.ends_with("mesh_pipeline")),
                PipelineDescriptor::ComputePipelineDescriptor(_) => false,
            })
            .map(|pipeline| matches!(pipeline.state, CachedPipelineState::Ok(_)))
            .peekable();
        preparing.draws_meshes = of_meshes.peek().is_some() && of_meshes.all(|is_there| is_there);
    }
}

fn wait_for_scene(mut preparing: ResMut<Preparing>, time: Res<Time<Real>>, mut commands: Commands) {
    preparing.ready = match preparing.draws_meshes {
        true => preparing.ready + 1,
        false => 0,
    };
    if preparing.ready == FRAMES || time.elapsed_secs() > PATIENCE {
        commands.remove_resource::<Preparing>();
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
