//! The programs of README and the guide: each stands there as it stands here, and does what its text says.
#![expect(
    dead_code,
    reason = "a program's `main` opens a window: its systems are run without"
)]

mod chapters;

use bevy::{
    asset::AssetPlugin, camera::visibility::VisibilityPlugin, ecs::system::RunSystemOnce,
    mesh::MeshPlugin, prelude::*, time::TimeUpdateStrategy,
};
use bevy_drape::prelude::*;

/// Each program with the document that shows it.
const PROGRAMS: [(&str, &str); 19] = [
    (include_str!("first.rs"), "README.md"),
    (include_str!("flag.rs"), "README.md"),
    (include_str!("sheet.rs"), "src/guide/first_cloth.md"),
    (include_str!("banner.rs"), "src/guide/own_model.md"),
    (include_str!("model.rs"), "src/guide/own_model.md"),
    (include_str!("painted.rs"), "src/guide/own_model.md"),
    (include_str!("scene.rs"), "src/guide/own_model.md"),
    (include_str!("coat.rs"), "src/guide/characters.md"),
    (include_str!("far_away.rs"), "src/guide/characters.md"),
    (include_str!("fan.rs"), "src/guide/wind.md"),
    (include_str!("beach_ball.rs"), "src/guide/wind.md"),
    (include_str!("table.rs"), "src/guide/contact.md"),
    (include_str!("rapier.rs"), "src/guide/contact.md"),
    (include_str!("interpolated.rs"), "src/guide/schedule.md"),
    (include_str!("teleport.rs"), "src/guide/schedule.md"),
    (include_str!("executor.rs"), "src/guide/schedule.md"),
    (include_str!("stats.rs"), "src/guide/tuning.md"),
    (include_str!("faults.rs"), "src/guide/when_it_fails.md"),
    (
        include_str!("silk_flag.rs"),
        "src/guide/migrating_from_bevy_silk.md",
    ),
];

/// An app without a window in which every update is a tick, as set up by a program.
fn app<M>(setup: impl IntoSystem<(), (), M>, plugins: impl Plugin) -> App {
    let mut app = App::new();
    let drawing = (AssetPlugin::default(), MeshPlugin, VisibilityPlugin);
    app.add_plugins((MinimalPlugins, TransformPlugin, drawing))
        .init_asset::<StandardMaterial>()
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .init_resource::<Reports>()
        .add_plugins((plugins, DrapePlugins::default()))
        .add_systems(Last, remember_reports);
    app.finish();
    app.cleanup();
    app.world_mut()
        .run_system_once(setup)
        .expect("its own systems run");
    // The first update of an app has no time in it.
    app.update();
    app
}

/// Limits of the envelope that were left, and touches that began.
#[derive(Resource, Default)]
struct Reports(Vec<ClothLimitExceeded>, usize);

fn remember_reports(
    mut limits: MessageReader<ClothLimitExceeded>,
    mut touches: MessageReader<ClothTouchStarted>,
    mut reports: ResMut<Reports>,
) {
    reports.0.extend(limits.read());
    reports.1 += touches.read().count();
}

/// Runs for some seconds, in which nothing is at fault and no limit is left.
fn run(app: &mut App, seconds: f32) {
    for _ in 0..(seconds * 64.0) as usize {
        app.update();
    }
    let mut faults = app.world_mut().query::<&ClothFault>();
    let faults: Vec<String> = faults
        .iter(app.world())
        .map(|fault| fault.error.to_string())
        .collect();
    assert!(faults.is_empty(), "{faults:?}");
    assert_eq!(app.world().resource::<Reports>().0, []);
}

/// The only cloth, with where its particles are in the world and whether it has a mesh and a fabric.
fn cloth(app: &mut App) -> (Entity, Vec<Vec3>) {
    let mut cloths = app.world_mut().query_filtered::<(
        Entity,
        &ClothParticles,
        &ClothFrame,
        &Mesh3d,
        &MeshMaterial3d<StandardMaterial>,
    ), With<Cloth>>();
    let (entity, particles, frame, mesh, material) = cloths
        .single(app.world())
        .expect("one cloth, with a mesh and a material");
    let material = app
        .world()
        .resource::<Assets<StandardMaterial>>()
        .get(material);
    assert!(material.is_some_and(|material| material.double_sided));
    assert!(app.world().resource::<Assets<Mesh>>().contains(mesh));
    (
        entity,
        particles.positions().map(|at| frame.to_world(at)).collect(),
    )
}

#[test]
fn documents_show_these_programs() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").expect("cargo says where the crate is");
    let read =
        |file: &str| std::fs::read_to_string(format!("{folder}/{file}")).expect("a document");
    for (program, file) in PROGRAMS {
        let document = read(file);
        let shown = ["```rust", "```rust,no_run"]
            .iter()
            .any(|fence| document.contains(&format!("{fence}\n{program}```")));
        assert!(shown, "{file} shows another text than\n{program}");
        let here = PROGRAMS.iter().filter(|(_, other)| *other == file).count();
        let shown = document.matches("```rust").count();
        assert_eq!(shown, here, "each program of {file} is here");
    }
}

mod first {
    include!("first.rs");

    /// The cloth falls onto the ball and stays there, its hems beside it; light, camera, ball and floor can be seen.
    #[test]
    fn fabric_lies_on_a_ball_in_the_light() {
        let mut app = super::app(setup, |_: &mut App| {});
        super::run(&mut app, 6.0);
        let (_, places) = super::cloth(&mut app);
        let centre = Vec3::new(0.0, 0.5, 0.0);
        let nearest = places
            .iter()
            .map(|at| at.distance(centre))
            .fold(f32::MAX, f32::min);
        assert!((0.4..0.42).contains(&nearest), "{nearest}");
        let top = places.iter().map(|at| at.y).fold(f32::MIN, f32::max);
        let hem = places.iter().map(|at| at.y).fold(f32::MAX, f32::min);
        assert!(
            (0.9..0.95).contains(&top) && (0.0..0.5).contains(&hem),
            "{top} {hem}"
        );
        let world = app.world_mut();
        assert_eq!(
            world
                .query::<(&DirectionalLight, &Transform)>()
                .iter(world)
                .count(),
            1
        );
        assert_eq!(
            world.query::<(&Camera3d, &Transform)>().iter(world).count(),
            1
        );
        let mut seen =
            world.query::<(&ClothCollider, &Mesh3d, &MeshMaterial3d<StandardMaterial>)>();
        assert_eq!(seen.iter(world).count(), 1);
    }
}

mod flag {
    include!("flag.rs");

    const WIDTH: f32 = 29.0 * 0.04;

    /// It flies in the wind; without wind it hangs from its pole, limp, not as a board, stretched by less than a tenth.
    #[test]
    fn the_flag_flies_and_hangs_limp_without_wind() {
        let mut app = super::app(flag, |_: &mut App| {});
        super::run(&mut app, 4.0);
        let (_, places) = super::cloth(&mut app);
        assert!(places[29].x > 0.5 * WIDTH, "it flies: {}", places[29]);
        app.world_mut().remove_resource::<ClothWind>();
        super::run(&mut app, 8.0);
        let (cloth, places) = super::cloth(&mut app);
        for row in 0..20 {
            let expected = Vec3::new(0.0, 2.0 - 0.04 * row as f32, 0.0);
            assert!(places[row * 30].distance(expected) < 1.0e-5);
        }
        let fly = &places[29];
        assert!(fly.y < 2.0 - 0.6 * WIDTH, "its free end hangs down: {fly}");
        let depth = |of: fn(f32, f32) -> f32, from| places.iter().map(|at| at.z).fold(from, of);
        assert!(depth(f32::max, f32::MIN) - depth(f32::min, f32::MAX) > 0.1);
        let stats = app.world().get::<ClothStats>(cloth).expect("figures");
        assert!(stats.stretch.structural < 0.1, "{:?}", stats.stretch);
    }

    mod teleport {
        include!("teleport.rs");
        use super::flag;
        use bevy::ecs::system::RunSystemOnce;

        /// Respawned it is with its pole in the next tick, as it was, no faster than before, with a camera in the scene.
        #[test]
        fn the_respawned_flag_arrives() {
            let mut app = crate::app(flag, |_: &mut App| {});
            app.world_mut().remove_resource::<ClothWind>();
            app.world_mut()
                .spawn((Camera3d::default(), Transform::default()));
            let mut names = app.world_mut().query::<(Entity, &Name)>();
            let pole = names
                .iter(app.world())
                .find(|(_, name)| name.as_str() == "pole");
            let pole = pole.expect("a pole").0;
            app.world_mut().entity_mut(pole).insert(Pole);
            crate::run(&mut app, 2.0);
            let (cloth, before) = crate::cloth(&mut app);
            let speed = |app: &App| {
                let particles = app.world().get::<ClothParticles>(cloth).expect("particles");
                particles.largest_speed()
            };
            let speed_before = speed(&app);
            app.world_mut()
                .run_system_once(respawn)
                .expect("its parameters are there");
            app.update();
            let (_, after) = crate::cloth(&mut app);
            for (before, after) in before.iter().zip(&after) {
                // A tick's own way, and a rounding at 100 m.
                let moved = (*after - *before - Vec3::X * 100.0).length();
                assert!(moved < 1.5 * speed_before / 64.0 + 1.0e-4, "{moved}");
            }
            assert!(speed(&app) < 1.5 * speed_before);
            crate::run(&mut app, 1.0);
        }
    }
}

mod interpolated {
    include!("interpolated.rs");

    #[test]
    fn the_body_is_a_collider() {
        let mut app = super::app(body, |app: &mut App| {
            app.add_plugins(TransformInterpolationPlugin::default());
        });
        super::run(&mut app, 0.1);
        let world = app.world_mut();
        let mut bodies = world.query::<(&ClothCollider, &TransformInterpolation)>();
        assert_eq!(bodies.iter(world).count(), 1);
    }
}

mod table {
    include!("table.rs");

    /// Over the table it lies on it; beside it its hems hang, above the floor.
    #[test]
    fn the_tablecloth_lies_on_the_table() {
        let mut app = super::app(table, |_: &mut App| {});
        super::run(&mut app, 4.0);
        let (_, places) = super::cloth(&mut app);
        let (on, beside): (Vec<Vec3>, Vec<Vec3>) = places
            .iter()
            .partition(|at| at.x.abs().max(at.z.abs()) < 0.45);
        assert!(on.len() > 400, "{}", on.len());
        assert!(
            on.iter().all(|at| (0.759..0.78).contains(&at.y)),
            "on the table"
        );
        let hem = beside.iter().map(|at| at.y).fold(f32::MAX, f32::min);
        assert!((0.3..0.7).contains(&hem), "{hem}");
    }
}

mod model {
    include!("model.rs");

    use bevy::{
        gltf::GltfPlugin, image::ImagePlugin, world_serialization::WorldSerializationPlugin,
    };
    use std::{thread::sleep, time::Duration};

    /// The tent comes from its file, stands on its pegs and hangs from its ridge.
    #[test]
    fn the_tent_stands() {
        let loading = |app: &mut App| {
            app.add_plugins((
                ImagePlugin::default(),
                WorldSerializationPlugin,
                GltfPlugin::default(),
            ));
        };
        let mut app = super::app(tent, loading);
        let mut waits = app.world_mut().query::<&ClothParticles>();
        for _ in 0..1000 {
            let particles = waits.single(app.world()).expect("one cloth");
            if !particles.is_empty() {
                break;
            }
            sleep(Duration::from_millis(10));
            app.update();
        }
        super::run(&mut app, 3.0);
        let particles = waits.single(app.world()).expect("one cloth");
        let heights = || particles.positions().map(|at| at.y);
        let pinned = particles.inverse_masses().filter(|mass| *mass == 0.0);
        assert_eq!((particles.len(), pinned.count()), (2025, 55));
        assert!(
            (heights().fold(0.0, f32::max) - 1.3).abs() < 0.01,
            "its ridge"
        );
        assert!(heights().fold(0.0, f32::min) > -0.1, "its hem");
    }
}

mod rapier {
    include!("rapier.rs");

    /// Rapier throws the ball, and it pushes the curtain aside.
    #[test]
    fn a_thrown_ball_pushes_the_curtain() {
        let physics = |app: &mut App| {
            app.insert_resource(TimestepMode::Fixed {
                dt: 1.0 / 64.0,
                substeps: 1,
            })
            .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule());
        };
        let mut app = super::app(setup, physics);
        super::run(&mut app, 1.0);
        assert_eq!(app.world().resource::<super::Reports>().1, 1, "a touch");
        let (_, places) = super::cloth(&mut app);
        let pushed = places.iter().map(|at| at.z).fold(0.0, f32::min);
        assert!(pushed < -0.2, "{pushed}");
    }
}

mod executor {
    include!("executor.rs");

    use std::thread::{ThreadId, current};

    #[derive(Resource, Default)]
    struct RanOn(Vec<ThreadId>);

    /// On this very thread: Bevy's default executor takes those of its pool.
    #[test]
    fn ticks_run_on_one_thread() {
        let note = |mut ran_on: ResMut<RanOn>| ran_on.0.push(current().id());
        let noting = move |app: &mut App| {
            app.init_resource::<RanOn>()
                .add_systems(FixedUpdate, (note, note));
            tick_on_one_thread(app);
        };
        let mut app = super::app(|| {}, noting);
        super::run(&mut app, 1.0);
        let ran_on = &app.world().resource::<RanOn>().0;
        assert_eq!(ran_on.len(), 128);
        assert!(ran_on.iter().all(|thread| *thread == current().id()));
    }
}
