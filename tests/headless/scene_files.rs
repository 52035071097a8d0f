//! Cloth that is written into Bevy's scene files, and read from them by another app.

use std::{path::Path, thread, time::Duration};

use bevy::{
    asset::{
        AssetPlugin,
        io::{
            AssetSourceBuilder, AssetSourceId,
            memory::{Dir, MemoryAssetReader},
        },
    },
    camera::visibility::VisibilityPlugin,
    mesh::MeshPlugin,
    prelude::*,
    time::TimeUpdateStrategy,
    world_serialization::WorldSerializationPlugin,
};
use bevy_drape::{plugin::ClothTarget, prelude::*};

use crate::support::*;

/// An app with scenes, whose files are in `files`.
fn app_with_scenes(files: &Dir) -> App {
    let files = files.clone();
    let memory = move |app: &mut App| {
        let root = files.clone();
        let reader = move || Box::new(MemoryAssetReader { root: root.clone() }) as _;
        app.register_asset_source(AssetSourceId::Default, AssetSourceBuilder::new(reader));
    };
    with_plugins((
        memory,
        AssetPlugin::default(),
        MeshPlugin,
        VisibilityPlugin,
        WorldSerializationPlugin,
        DrapePlugins::default(),
    ))
}

const TICKS: usize = 32;

/// A kite of triangles that is pinned in several ways, and hangs at a pole by its name and at a hand by its entity; a
/// grid; a ball in the way of each; and a rope along a path.
fn spawn_all(world: &mut World) -> Vec<Entity> {
    let hand = world.spawn(Transform::from_xyz(0.3, 1.0, 0.2)).id();
    let pole = (Name::new("pole"), Transform::from_xyz(-2.0, 0.0, 0.0));
    let pole = world.spawn(pole).id();
    let place = |index: u32| Vec3::new((index % 7) as f32, (index / 7) as f32 * -0.9, 0.0) * 0.1;
    let triangles = (0..35_u32).filter(|a| a % 7 < 6).flat_map(|a| {
        let (b, c, d) = (a + 1, a + 7, a + 8);
        [[a, c, b], [b, c, d]]
    });
    let positions: Vec<Vec3> = (0..42).map(place).collect();
    let pins = Pins::new([
        Pin::Vertex(3),
        Pin::Index(5),
        Pin::Near {
            point: Vec3::new(0.6, 0.0, 0.0),
            radius: 0.01,
        },
    ]);
    let attached = ClothAttachments::new([
        (Pin::Vertex(0), ClothTarget::from("pole")),
        (Pin::Vertex(41), ClothTarget::from(hand)),
    ]);
    let material = ClothMaterial {
        stretch_compliance: 1.0e-3 / 3.0,
        shear_compliance: f32::INFINITY,
        ..ClothMaterial::RUBBER
    };
    let settings = ClothSettings {
        particle_radius: 0.011,
        gravity: Some(Vec3::new(0.1, -9.0, 0.7)),
        ..ClothSettings::tolerance(0.04)
    };
    let kite = (
        Name::new("kite"),
        Cloth::triangles(positions, triangles).welded(2.0e-5),
        pins,
        attached,
        material,
        settings,
        SearchMethod::Scan,
        NarrowPhase::Triangles,
        Transform::from_xyz(0.1, 1.7, -0.3).with_rotation(Quat::from_rotation_y(0.3)),
    );
    let kite = world.spawn(kite).id();
    let grid = (
        Name::new("grid"),
        Cloth::new(9, 7, 0.1),
        Pins::new([Pin::Corner(Corner::TopLeft), Pin::Cell(0, 5)]),
        Transform::from_xyz(0.0, 1.7, 0.3),
    );
    let grid = world.spawn(grid).id();
    let path = [
        Vec3::ZERO,
        Vec3::new(0.1, 0.7, 0.0),
        Vec3::new(1.0 / 3.0, 0.7, -0.2),
        Vec3::new(0.6, 0.1, 0.0),
    ];
    let rope = (
        Name::new("rope"),
        Cloth::rope_along(path, 0.07, 0.013),
        Pins::new([Pin::Index(0), Pin::Index(9)]),
        Transform::from_xyz(3.0, 0.5, 0.0).with_rotation(Quat::from_rotation_x(0.4)),
    );
    let rope = world.spawn(rope).id();
    let balls = [-0.15, 0.15].map(|z| {
        let place = Transform::from_xyz(0.35, 1.4, z);
        world.spawn((ClothCollider::ball(0.25), place)).id()
    });
    let mut all = vec![hand, pole, kite, grid, rope];
    all.extend(balls);
    all
}

/// What a game would write of its cloths.
fn write(app: &App, entities: Vec<Entity>) -> String {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let scene = DynamicWorldBuilder::from_world(app.world(), &registry)
        .deny_all()
        .allow_component::<Name>()
        .allow_component::<Transform>()
        .allow_component::<Cloth>()
        .allow_component::<Pins>()
        .allow_component::<ClothAttachments>()
        .allow_component::<ClothMaterial>()
        .allow_component::<ClothSettings>()
        .allow_component::<SearchMethod>()
        .allow_component::<NarrowPhase>()
        .allow_component::<ClothCollider>()
        .extract_entities(entities.into_iter())
        .build();
    scene.serialize(&registry).expect("all of it is text")
}

fn named(app: &mut App, name: &str) -> Option<Entity> {
    let world = app.world_mut();
    let mut names = world.query::<(Entity, &Name)>();
    let mut found = names.iter(world).filter(|(_, its)| its.as_str() == name);
    found.next().map(|(entity, _)| entity)
}

/// Spawns a scene file in an app whose time stands still until it is there.
fn read(text: &str) -> App {
    let files = Dir::default();
    files.insert_asset_text(Path::new("cloth.scn.ron"), text);
    let mut app = app_with_scenes(&files);
    // So that the scene's are others than where they came from.
    for _ in 0..50 {
        app.world_mut().spawn_empty();
    }
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    let server = app.world().resource::<AssetServer>();
    let scene = server.load::<DynamicWorld>("cloth.scn.ron");
    app.world_mut().spawn(DynamicWorldRoot(scene));
    for _ in 0..2000 {
        app.update();
        if named(&mut app, "kite").is_some() {
            break;
        }
        thread::sleep(Duration::from_millis(5));
    }
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app
}

/// To the last bit the same cloths, whatever entities they are in the other app.
#[test]
fn what_is_read_moves_as_what_was_written() {
    let mut original = app_with_scenes(&Dir::default());
    let entities = spawn_all(original.world_mut());
    let text = write(&original, entities);
    assert!(text.contains("pole") && text.contains("inf"), "{text}");
    let mut other = read(&text);
    // Other entities than in the first app.
    let names = ["kite", "grid", "rope"];
    let cloths = names.map(|name| {
        let cloth = named(&mut original, name).expect("it was spawned");
        let read = named(&mut other, name).expect("it was read");
        (cloth, read)
    });
    assert!(cloths.iter().all(|(cloth, read)| cloth != read));
    let mut touched = [false; 3];
    for _ in 0..TICKS {
        tick(&mut original, 1);
        tick(&mut other, 1);
        for (touched, (cloth, read)) in touched.iter_mut().zip(cloths) {
            assert!(particles(&original, cloth) == particles(&other, read));
            *touched |= stats(&other, read).contacts > 0;
        }
    }
    assert_eq!(touched, [true, true, false]);
    // Its path: 0.71, 0.31 and 0.69 m in parts of 0.07 m.
    let [.., (_, rope)] = cloths;
    assert_eq!(surface(&other, rope).len(), 1 + 24);
    assert!(surface(&other, rope).rope_radius().is_some());
    for (cloth, read) in cloths {
        assert!(other.world().get::<ClothFault>(read).is_none());
        let component = original.world().get::<Cloth>(cloth);
        assert_eq!(component, other.world().get::<Cloth>(read));
        assert_eq!(
            original.world().get::<ClothMaterial>(cloth),
            other.world().get(read)
        );
    }
    // The hand is another entity now, and is followed.
    let (_, kite) = cloths[0];
    let attachments = other.world().get::<ClothAttachments>(kite);
    let targets: Vec<_> = attachments
        .expect("attachments")
        .iter()
        .map(|each| each.target.clone())
        .collect();
    let [ClothTarget::Named(pole), ClothTarget::Entity(hand)] = &targets[..] else {
        panic!("{targets:?}");
    };
    assert_eq!(pole, "pole");
    let hand = *hand;
    let corner = surface(&other, kite)
        .particle_of_vertex(41)
        .expect("a particle");
    let before = position_in_world(&other, kite, corner);
    change::<Transform>(&mut other, hand, |place| place.translation.y += 0.03);
    tick(&mut other, 1);
    let moved = position_in_world(&other, kite, corner) - before;
    assert!(moved.distance(Vec3::Y * 0.03) < 1.0e-6, "{moved}");
}

fn surface(app: &App, cloth: Entity) -> &Surface {
    let built = app.world().get::<ClothBuilt>(cloth);
    built.expect("what was built").surface()
}

fn position_in_world(app: &App, cloth: Entity, particle: usize) -> Vec3 {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let place = particles(app, cloth).position(particle);
    frame.to_world(place.expect("a particle"))
}
