//! The scene file in the assets, as a game loads it; whole worlds as scenes; and lists that are applied.

use std::{path::Path, thread, time::Duration};

use bevy::{
    camera::visibility::{VisibilityClass, VisibilityPlugin},
    ecs::reflect::ReflectComponent,
    mesh::MeshPlugin,
    prelude::*,
    reflect::PartialReflect,
    time::TimeUpdateStrategy,
    world_serialization::WorldSerializationPlugin,
};
use bevy_drape::{plugin::ClothTarget, prelude::*};

use crate::support::*;

/// An app with scenes and the assets of this crate.
pub fn app_with_assets() -> App {
    with_plugins((
        assets(),
        MeshPlugin,
        VisibilityPlugin,
        WorldSerializationPlugin,
        DrapePlugins::default(),
    ))
}

/// What the file in the assets holds: a flag with two grommets pinned and one attached to its pole, a ball beside it, and wind.
fn spawn_flag(world: &mut World) -> Vec<Entity> {
    world.insert_resource(ClothWind::gusty(Vec3::new(4.0, 0.0, 1.0)));
    let top = Transform::from_xyz(0.0, 2.0, 0.0);
    let pole = (
        Name::new("pole"),
        ClothCollider::cylinder(0.02, 2.2),
        Transform::from_xyz(-0.04, 1.1, 0.0),
    );
    let flag = (
        Name::new("flag"),
        Cloth::new(25, 17, 0.05),
        ClothMaterial::SILK,
        Pins::new([
            Pin::Corner(Corner::TopLeft),
            Pin::Corner(Corner::BottomLeft),
        ]),
        ClothAttachments::new([(Pin::Cell(8, 0), "pole")]),
        ClothAir::default(),
        ClothSelfCollision::default(),
        top,
    );
    let ball = (
        Name::new("ball"),
        ClothCollider::ball(0.2),
        Transform::from_xyz(0.7, 1.6, 0.3),
    );
    vec![
        world.spawn(pole).id(),
        world.spawn(flag).id(),
        world.spawn(ball).id(),
    ]
}

/// Scene files are what Bevy writes of the components that an author says.
fn flag_text() -> String {
    let mut app = app_with_assets();
    let entities = spawn_flag(app.world_mut());
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let scene = DynamicWorldBuilder::from_world(app.world(), &registry)
        .deny_all()
        .allow_component::<Name>()
        .allow_component::<Transform>()
        .allow_component::<Cloth>()
        .allow_component::<ClothMaterial>()
        .allow_component::<Pins>()
        .allow_component::<ClothAttachments>()
        .allow_component::<ClothAir>()
        .allow_component::<ClothSelfCollision>()
        .allow_component::<ClothCollider>()
        .allow_resource::<ClothWind>()
        .extract_resources()
        .extract_entities(entities.into_iter())
        .build();
    let text = scene.serialize(&registry).expect("all of it is text");
    // Entities by small numbers.
    let mut lines: Vec<String> = text.lines().map(str::to_string).collect();
    let mut number = 0;
    for line in &mut lines {
        let is_entity = line.strip_suffix(": (").is_some_and(|key| {
            !key.trim().is_empty() && key.trim().bytes().all(|byte| byte.is_ascii_digit())
        });
        if is_entity {
            number += 1;
            *line = format!("    {number}: (");
        }
    }
    lines.join("\n") + "\n"
}

/// It is to the letter what the crate writes. If it is meant to differ, copy the new one there.
#[test]
fn the_file_is_what_is_written() {
    let file = Path::new(&assets().file_path).join("scenes/flag.scn.ron");
    let written = flag_text();
    let known = std::fs::read_to_string(&file).unwrap_or_default();
    if known != written {
        let new = Path::new(env!("CARGO_TARGET_TMPDIR")).join("flag.scn.ron");
        std::fs::write(&new, &written).expect("a writable folder");
        panic!("{} is not {}", file.display(), new.display());
    }
}

fn named(app: &mut App, name: &str) -> Option<Entity> {
    let world = app.world_mut();
    let mut names = world.query::<(Entity, &Name)>();
    let mut found = names.iter(world).filter(|(_, its)| its.as_str() == name);
    found.next().map(|(entity, _)| entity)
}

/// Waits for a scene with something of a name in it, while the time stands still.
fn spawn_scene(app: &mut App, scene: Handle<DynamicWorld>, name: &str) -> Entity {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    app.world_mut().spawn(DynamicWorldRoot(scene));
    for _ in 0..2000 {
        app.update();
        if named(app, name).is_some() {
            break;
        }
        thread::sleep(Duration::from_millis(5));
    }
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    named(app, name).expect("the scene is there")
}

/// As a game does it. The flag stands out from its pole, where it is held, and touches the ball.
#[test]
fn the_flag_of_the_assets_flies() {
    let mut app = app_with_assets();
    let server = app.world().resource::<AssetServer>();
    let scene = server.load("scenes/flag.scn.ron");
    let flag = spawn_scene(&mut app, scene, "flag");
    let mut touched = false;
    for _ in 0..256 {
        tick(&mut app, 1);
        assert!(app.world().get::<ClothFault>(flag).is_none());
        touched |= stats(&app, flag).contacts > 0;
        let places = particles(&app, flag).positions();
        assert!(places.into_iter().all(Vec3::is_finite));
    }
    assert!(touched);
    let wind = app.world().resource::<ClothWind>();
    assert_eq!(wind.velocity, Vec3::new(4.0, 0.0, 1.0));
    let material = app.world().get::<ClothMaterial>(flag);
    assert_eq!(material, Some(&ClothMaterial::SILK));
    // Its three grommets are where they were, to the rounding of a frame; all between them is cloth.
    for (row, y) in [(0, 0.0), (8, -0.4), (16, -0.8)] {
        let place = position(&app, flag, (row, 0));
        assert!(place.distance(Vec3::Y * y) < 1.0e-5, "{row}: {place}");
    }
    let middle = position(&app, flag, (8, 24));
    assert!(middle.x > 0.5, "wind of 4 m/s carries silk: {middle}");
}

/// All that is reflected of a living world, as a debugger or a saved game might write it, goes on in another app as it was.
#[test]
fn a_whole_living_world_is_a_scene() {
    let mut app = app_with_assets();
    spawn_flag(app.world_mut());
    let gizmos = ShowClothGizmos::levels(1..=3);
    let flag = named(&mut app, "flag").expect("a flag");
    let bad = (Name::new("bad"), Cloth::new(1, 1, 0.1));
    let bad = app.world_mut().spawn(bad).id();
    let sheet = app.world_mut().spawn(ClothCollider::trimesh(
        [Vec3::ZERO, Vec3::X, Vec3::Z],
        [[0, 1, 2]],
    ));
    let _ = sheet.id();
    app.world_mut().entity_mut(flag).insert((
        gizmos,
        ClothPressure::default(),
        ClothLod::default(),
        ClothBones::new([ClothBone::default()]),
        ClothSkin::default(),
    ));
    app.world_mut()
        .entity_mut(flag)
        .remove::<(ClothPressure, ClothBones, ClothSkin)>();
    tick(&mut app, 40);
    assert!(app.world().get::<ClothFault>(bad).is_some());
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let text = {
        let registry = registry.read();
        let all = app.world().iter_entities().map(|entity| entity.id());
        let all: Vec<Entity> = all.collect();
        let ours = all
            .into_iter()
            .filter(|it| app.world().get::<Transform>(*it).is_some());
        let scene = DynamicWorldBuilder::from_world(app.world(), &registry)
            // Bevy's own, which is not text.
            .deny_component::<VisibilityClass>()
            .extract_entities(ours);
        scene.build().serialize(&registry).expect("it is text")
    };
    for internal in ["ClothBuilt", "ClothSearch", "ClothState", "ClothScratch"] {
        assert!(!text.contains(internal), "{internal}");
    }
    let mut other = app_with_assets();
    other.insert_resource(*app.world().resource::<ClothWind>());
    let scene = {
        use serde::de::DeserializeSeed;
        let registry = registry.read();
        let mut server = other.world().resource::<AssetServer>();
        let mut text = ron::de::Deserializer::from_str(&text).expect("RON");
        bevy::world_serialization::serde::WorldDeserializer {
            type_registry: &registry,
            load_from_path: &mut server,
        }
        .deserialize(&mut text)
        .expect("a scene")
    };
    let mut map = default();
    scene
        .write_to_world(other.world_mut(), &mut map)
        .expect("it is spawned");
    let (read, bad) = (map[&flag], map[&bad]);
    let places = |app: &App, cloth| -> Vec<Vec3> { particles(app, cloth).positions().collect() };
    assert_eq!(places(&other, read), places(&app, flag));
    tick(&mut app, 30);
    tick(&mut other, 30);
    assert!(other.world().get::<ClothFault>(read).is_none());
    assert!(other.world().get::<ClothFault>(bad).is_some());
    // Another part of the wind, and no memory of the last sub-step: near, and not the same.
    let apart = places(&app, flag).into_iter().zip(places(&other, read));
    let apart = apart.map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
    assert!(apart < 0.5, "{apart}");
    // It draws a mesh of its own.
    let mesh = |app: &App, cloth| app.world().get::<Mesh3d>(cloth).cloned().expect("a mesh");
    let meshes = other.world().resource::<Assets<Mesh>>();
    assert!(meshes.contains(&mesh(&other, read).0));
}

fn apply<C: Component>(app: &mut App, entity: Entity, value: &dyn PartialReflect) {
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let component = registry.get_type_data::<ReflectComponent>(std::any::TypeId::of::<C>());
    let component = component.expect("a reflected component");
    component.apply(app.world_mut().entity_mut(entity), value);
}

/// Where a scene says `Pins([])`, nothing is pinned, whatever was pinned before: also if a file names the cloth first.
#[test]
fn lists_are_applied_whole() {
    let mut app = app();
    let cloth = (Cloth::new(6, 6, 0.1), ClothLod::default());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 4);
    assert!(
        particles(&app, cloth)
            .inverse_masses()
            .take(6)
            .all(|w| w == 0.0)
    );
    apply::<Pins>(&mut app, cloth, &*Pins::none().to_dynamic());
    assert_eq!(app.world().get(cloth), Some(&Pins::none()));
    tick(&mut app, 4);
    assert!(particles(&app, cloth).inverse_masses().all(|w| w > 0.0));
    let two = Pins::new([Pin::Row(2), Pin::Cell(0, 1)]);
    apply::<Pins>(&mut app, cloth, &*two.to_dynamic());
    assert_eq!(app.world().get(cloth), Some(&two));
    // With what text can't hold, as long as it is not text.
    let code = Pins::filter(|row, _| row == 3);
    apply::<Pins>(&mut app, cloth, &code);
    assert_eq!(app.world().get(cloth), Some(&code));
    // A part of a component leaves the others.
    let mut part = bevy::reflect::structs::DynamicStruct::default();
    part.insert("distances", vec![(7.0_f32, ClothLodLevel::Frozen)]);
    apply::<ClothLod>(&mut app, cloth, &part);
    let lod = app.world().get::<ClothLod>(cloth).expect("levels");
    let wanted = ClothLod::by_distance([(7.0, ClothLodLevel::Frozen)]);
    assert_eq!(lod, &wanted);
    let kite = |corners: &[Vec3], triangles: &[[u32; 3]]| {
        Cloth::triangles(corners.to_vec(), triangles.to_vec())
    };
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE];
    let large = kite(&corners, &[[0, 1, 2], [1, 3, 2]]);
    let small = kite(&corners[..3], &[[0, 1, 2]]);
    app.world_mut().entity_mut(cloth).insert(large);
    apply::<Cloth>(&mut app, cloth, &*small.to_dynamic());
    assert_eq!(app.world().get(cloth), Some(&small));
    let hands = ClothAttachments::new([(Pin::Top, "left"), (Pin::Top, "right")]);
    let hand = ClothAttachments::new([(Pin::Top, ClothTarget::from("left"))]);
    app.world_mut().entity_mut(cloth).insert(hands);
    apply::<ClothAttachments>(&mut app, cloth, &*hand.to_dynamic());
    assert_eq!(app.world().get(cloth), Some(&hand));
}
