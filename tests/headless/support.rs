//! The app that the tests drive, and short ways to ask it.

use bevy::{
    asset::AssetPlugin,
    camera::visibility::VisibilityPlugin,
    ecs::schedule::{MultiThreadedExecutor, ScheduleLabel, SingleThreadedExecutor},
    gizmos::GizmoPlugin,
    mesh::MeshPlugin,
    prelude::*,
    time::TimeUpdateStrategy,
};
use bevy_drape::{
    plugin::{ClothBuilt, ClothGizmosPlugin, ClothPlugin, ClothSearch},
    prelude::*,
};
use bevy_transform_interpolation::prelude::TransformInterpolationPlugin;

/// Bevy's fixed tick (s).
pub const TICK: f32 = 1.0 / 64.0;

/// Standard gravity as the plugin has it (m/s²).
pub const GRAVITY: f32 = 9.81;

/// Whether tests are to run at their full length, which takes minutes: CI sets `BEVY_DRAPE_LONG`.
pub fn is_long() -> bool {
    std::env::var_os("BEVY_DRAPE_LONG").is_some()
}

/// An app in which every update is one tick, whose systems run one after the other on this thread: tests that run beside each other
/// share Bevy's threads, and would wait for each other's systems.
pub fn app() -> App {
    with_plugins(DrapePlugins::default())
}

/// The same with all that draws, short of a renderer, and the cloth in `schedule`.
pub fn app_that_draws(schedule: impl ScheduleLabel) -> App {
    with_plugins((
        AssetPlugin::default(),
        MeshPlugin,
        VisibilityPlugin,
        GizmoPlugin,
        DrapePlugins::new(schedule),
    ))
}

/// The same in which what has a `TransformInterpolation` is drawn between fixed ticks.
pub fn app_that_draws_smoothly() -> App {
    with_plugins((
        AssetPlugin::default(),
        MeshPlugin,
        VisibilityPlugin,
        TransformInterpolationPlugin::default(),
        DrapePlugins::default(),
    ))
}

/// One whose cloths have gizmos and no meshes: nothing hides them for want of a camera, and they are drawn.
pub fn app_with_gizmos() -> App {
    with_plugins((
        AssetPlugin::default(),
        MeshPlugin,
        GizmoPlugin,
        ClothPlugin::default(),
        ClothGizmosPlugin,
    ))
}

/// Loads from the assets of the plugin.
pub fn assets() -> AssetPlugin {
    AssetPlugin {
        // Asked at run time: checkouts may share a target folder.
        file_path: std::env::var("CARGO_MANIFEST_DIR").expect("cargo says where the tests are")
            + "/../../assets",
        ..default()
    }
}

/// An app with other plugins of ours.
pub fn with_plugins<M>(plugins: impl bevy::app::Plugins<M>) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, plugins))
        .init_resource::<Heard<ClothTouchStarted>>()
        .init_resource::<Heard<ClothTouchStopped>>()
        .init_resource::<Heard<ClothLimitExceeded>>()
        .init_resource::<Heard<ClothTorn>>()
        .add_systems(
            Last,
            (
                hear::<ClothTouchStarted>,
                hear::<ClothTouchStopped>,
                hear::<ClothLimitExceeded>,
                hear::<ClothTorn>,
            ),
        )
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    let mut schedules = app.world_mut().resource_mut::<Schedules>();
    for (_, schedule) in schedules.iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
    // The first update of an app has no time in it.
    app.update();
    assert_eq!(app.world().resource::<Time<Fixed>>().elapsed_secs(), 0.0);
    app
}

/// Has its cloth systems run on Bevy's threads, as in a game.
pub fn run_on_all_threads(app: &mut App) {
    app.edit_schedule(FixedUpdate, |schedule| {
        schedule.set_executor(MultiThreadedExecutor::new());
    });
}

/// Runs this many ticks.
pub fn tick(app: &mut App, ticks: usize) {
    let before = app.world().resource::<Time<Fixed>>().elapsed_secs_f64();
    (0..ticks).for_each(|_| app.update());
    let passed = app.world().resource::<Time<Fixed>>().elapsed_secs_f64() - before;
    assert!(
        (passed - ticks as f64 * f64::from(TICK)).abs() < 1e-9,
        "{passed} s in {ticks} ticks"
    );
}

/// An entity's particles.
pub fn particles(app: &App, cloth: Entity) -> &ClothParticles {
    app.world().get(cloth).expect("a cloth")
}

/// An entity's position of one particle.
pub fn position(app: &App, cloth: Entity, cell: (u32, u32)) -> Vec3 {
    particles(app, cloth).position(cell).expect("a particle")
}

/// A component of an entity, changed.
pub fn change<C: Component<Mutability = bevy::ecs::component::Mutable>>(
    app: &mut App,
    entity: Entity,
    change: impl FnOnce(&mut C),
) {
    change(&mut app.world_mut().get_mut::<C>(entity).expect("the component"));
}

/// Messages since they were last asked for: Bevy keeps its own for two frames only.
#[derive(Resource)]
struct Heard<M: Message>(Vec<M>);

impl<M: Message> Default for Heard<M> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

fn hear<M: Message + Clone>(messages: Option<ResMut<Messages<M>>>, mut heard: ResMut<Heard<M>>) {
    heard.0.extend(
        messages
            .into_iter()
            .flat_map(|mut messages| messages.drain().collect::<Vec<_>>()),
    );
}

/// All messages since the last call.
pub fn messages<M: Message>(app: &mut App) -> Vec<M> {
    std::mem::take(&mut app.world_mut().resource_mut::<Heard<M>>().0)
}

/// Metres a second, along z.
#[derive(Component)]
pub struct Moving(pub f32);

/// An app whose balls move at a speed of their own.
pub fn app_with_moving_balls() -> App {
    let mut app = app();
    app.add_systems(
        FixedUpdate,
        (|mut balls: Query<(&Moving, &mut Transform)>, time: Res<Time>| {
            for (moving, mut transform) in &mut balls {
                transform.translation.z += moving.0 * time.delta_secs();
            }
        })
        .before(ClothSystems::Prepare),
    );
    app
}

/// A cloth, and a ball that is on its way through it.
pub fn spawn_pass(app: &mut App) -> (Entity, Entity) {
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let place = Transform::from_xyz(0.75, -1.0, -2.2);
    let ball = app
        .world_mut()
        .spawn((ClothCollider::ball(0.4), Moving(2.2), place))
        .id();
    (cloth, ball)
}

/// Red nodes on each level.
pub fn red(app: &App, cloth: Entity) -> Vec<usize> {
    let built = app
        .world()
        .get::<ClothBuilt>(cloth)
        .expect("what was built");
    let query = app
        .world()
        .get::<ClothSearch>(cloth)
        .expect("a search")
        .query();
    let levels = 0..built.tree().levels().len();
    levels
        .map(|level| query.level(built.tree(), level).1)
        .collect()
}

/// A cloth's figures.
pub fn stats(app: &App, cloth: Entity) -> ClothStats {
    *app.world().get(cloth).expect("figures")
}

/// Cotton with a loss along its threads: they are solved once, and no more than that where something is left.
pub fn solved_once() -> ClothMaterial {
    ClothMaterial {
        stretch_damping: 1.0e-3,
        ..ClothMaterial::COTTON
    }
}
