//! The paper's scene as an app, the ball example's without shadows and floor: drawn into an image where that can be, and not
//! at all elsewhere.

use std::{
    any::TypeId,
    ops::RangeInclusive,
    sync::atomic::{AtomicBool, Ordering},
};

use bevy::{
    camera::Hdr,
    core_pipeline::core_3d::Transparent3d,
    gizmos::{GizmoAsset, GizmoHandles},
    log::LogPlugin,
    prelude::*,
    render::{
        Render, RenderApp, RenderSystems,
        render_phase::ViewSortedRenderPhases,
        render_resource::{PollType, TextureFormat},
        renderer::{RenderAdapterInfo, RenderDevice},
    },
    time::TimeUpdateStrategy,
};
use bevy_drape::{
    hierarchy::{BoundRule, BoundingVolume},
    prelude::*,
};
use examples_shared::view::View;

use crate::scene::{SHOT, ScenePlugin, moment_beyond};

/// Every level of the tree.
pub const WHOLE: RangeInclusive<usize> = 0..=usize::MAX;

/// Pixels of an image of which next to nothing is what filling it costs.
pub const SMALL: [u32; 2] = [64, 36];

/// Nodes of each level of the scene's tree, from the root down.
pub const NODES: [usize; 5] = [1, 4, 16, 64, 256];

/// The scene, with a cloth that is searched and drawn as asked.
pub struct Drawn {
    app: App,
    cloth: Entity,
}

/// What the gizmos of one frame hand to the renderer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lines {
    /// Ends and corners of lines.
    pub vertices: usize,
    /// Positions and colours together, with what separates strips.
    pub bytes: usize,
    /// Strips of lines that hang together.
    pub strips: usize,
    /// Whether there are single lines, too.
    pub has_pairs: bool,
}

impl Drawn {
    /// In an image of this size, where `view` has one; a little after its start, with all that a frame needs ready.
    pub fn new(view: View, [width, height]: [u32; 2]) -> Self {
        // The first app's logger is that of the process.
        static HAS_LOGGER: AtomicBool = AtomicBool::new(false);
        let mut plugins = view.plugins("the lab");
        if HAS_LOGGER.swap(true, Ordering::Relaxed) {
            plugins = plugins.disable::<LogPlugin>();
        }
        let mut app = App::new();
        app.add_plugins((plugins, ScenePlugin));
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            render_app.add_systems(Render, finish_drawing.in_set(RenderSystems::Cleanup));
        }
        app.finish();
        app.cleanup();
        let target = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(target);
        app.world_mut().spawn(SHOT.camera(Some(target)));
        app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
        app.update();
        let mut cloths = app.world_mut().query_filtered::<Entity, With<Cloth>>();
        let cloth = cloths.single(app.world()).expect("the scene has one cloth");
        make_plain(app.world_mut());
        let mut drawn = Self { app, cloth };
        // Assets, pipelines and shadows take a few frames, drawing lines a few more.
        for levels in [None, Some(WHOLE)] {
            drawn.show(BoundingVolume::Sphere, levels);
            (0..8).for_each(|_| drawn.tick());
        }
        drawn
    }

    /// What draws, if anything does.
    pub fn adapter(&self) -> Option<String> {
        let info = self.app.world().get_resource::<RenderAdapterInfo>()?;
        let is_software = format!("{:?}", info.device_type) == "Cpu";
        let how = if is_software {
            "in software"
        } else {
            "in hardware"
        };
        Some(format!("{}, {how}, by {}", info.name, info.backend))
    }

    /// From the next tick on, the cloth is searched by this volume, refitted, and these levels of it are drawn.
    pub fn show(&mut self, volume: BoundingVolume, levels: Option<RangeInclusive<usize>>) {
        let mut cloth = self.app.world_mut().entity_mut(self.cloth);
        let show = ShowClothGizmos {
            levels: levels.map(|levels| [*levels.start(), *levels.end()]),
            ..ShowClothGizmos::nothing()
        };
        cloth.insert((SearchMethod::Tree(volume, BoundRule::Refit), show));
    }

    /// One tick of the scene, and a frame that is drawn to its end.
    pub fn tick(&mut self) {
        self.app.update();
    }

    /// As many ticks as wall time asks for from now on, and a frame.
    pub fn follow_the_clock(&mut self) {
        self.app.insert_resource(TimeUpdateStrategy::Automatic);
    }

    /// Goes on, with few frames, until the ball's centre is 0.45 m past the cloth's plane.
    pub fn go_to_best_moment(&mut self) {
        let until = moment_beyond(0.45, 4.0);
        self.app
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(8));
        while self.seconds() < until {
            self.app.update();
        }
        self.app
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    }

    /// How far the scene has come (s).
    pub fn seconds(&self) -> f64 {
        self.app
            .world()
            .resource::<Time<Fixed>>()
            .elapsed_secs_f64()
    }

    /// What the cloth's gizmos handed over in the last frame.
    pub fn lines(&self) -> Lines {
        let world = self.app.world();
        let handles = world.resource::<GizmoHandles>().handles();
        let handle = handles.get(&TypeId::of::<ClothGizmos>());
        let asset = handle
            .and_then(Option::as_ref)
            .and_then(|handle| world.resource::<Assets<GizmoAsset>>().get(handle));
        let buffer = asset.map(|asset| asset.buffer().buffer());
        buffer.map_or(Lines::NONE, |buffer| {
            let colours = buffer.list_colors.len() + buffer.strip_colors.len();
            let positions = buffer.list_positions.len() + buffer.strip_positions.len();
            // A strip ends where a position is NaN.
            let ends = buffer.strip_positions.iter().filter(|end| end.is_nan());
            let strips = ends.count();
            Lines {
                vertices: positions - strips,
                bytes: positions * size_of::<Vec3>() + colours * size_of::<LinearRgba>(),
                strips,
                has_pairs: !buffer.list_positions.is_empty(),
            }
        })
    }

    /// How many draws the pass that gizmos are drawn in had in the last frame, if it was drawn.
    pub fn draw_calls(&self) -> Option<usize> {
        let world = self.app.get_sub_app(RenderApp)?.world();
        let phases = world.get_resource::<ViewSortedRenderPhases<Transparent3d>>()?;
        Some(phases.values().map(|phase| phase.items.len()).sum())
    }
}

impl Lines {
    const NONE: Self = Self {
        vertices: 0,
        bytes: 0,
        strips: 0,
        has_pairs: false,
    };
}

/// As plain as the paper's scene: what is to be seen is what the hierarchy costs, not what shadows, sky and a floor do.
fn make_plain(world: &mut World) {
    let mut cameras = world.query_filtered::<Entity, With<Camera3d>>();
    // Without a renderer Bevy's hooks on these do not find what they need, and nobody sees them.
    let is_drawn = world.contains_resource::<RenderDevice>();
    for camera in cameras.iter(world).filter(|_| is_drawn).collect::<Vec<_>>() {
        world
            .entity_mut(camera)
            .remove::<(DistanceFog, EnvironmentMapLight, Hdr)>();
    }
    let mut lights = world.query::<&mut DirectionalLight>();
    for mut light in lights.iter_mut(world) {
        light.shadow_maps_enabled = false;
    }
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    for (_, material) in materials.iter_mut() {
        material.unlit = true;
    }
    let mut floors =
        world.query_filtered::<&mut Visibility, (With<Mesh3d>, Without<Cloth>, Without<ChildOf>)>();
    for mut floor in floors.iter_mut(world) {
        *floor = Visibility::Hidden;
    }
}

/// A frame ends when the adapter has drawn it.
fn finish_drawing(device: Res<RenderDevice>) {
    // Fails where the device is lost: then nothing is left to wait for.
    let _ = device.poll(PollType::wait_indefinitely());
}
