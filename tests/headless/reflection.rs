//! Scenes, inspectors and Blender's exports author components by reflection.

use std::any::type_name;

use bevy::{
    ecs::{
        component::{ComponentId, ComponentInfo},
        entity::{EntityHashMap, SceneEntityMapper},
        reflect::{AppTypeRegistry, ReflectMapEntities},
    },
    prelude::*,
    reflect::{
        TypeRegistry,
        serde::{ReflectDeserializer, ReflectSerializer},
    },
};
use bevy_drape::{
    plugin::{ClothBuilt, ClothMesh, ClothScratch, ClothSearch, ClothState, ClothTarget},
    prelude::*,
};
use serde::de::DeserializeSeed;

use crate::support::*;

/// Every component of ours on an entity, with its name; those that nobody can name outside are none, nor are those
/// that a scene has no use for: what a cloth remembers, and its scratch memory.
fn components(app: &App, entity: Entity) -> Vec<(ComponentId, String)> {
    let world = app.world();
    let entity = world.entity(entity);
    let archetype = entity.archetype();
    let info = |id: &ComponentId| {
        let name = world.components().get_name(*id)?.to_string();
        let is_private = [
            "BroadPhaseBounds",
            "ColliderMotion",
            "MeshDrawing",
            "BoneColliders",
            "RootMotion",
        ]
        .iter()
        .any(|private| name.ends_with(private));
        let of_the_run = [
            type_name::<ClothState>(),
            type_name::<ClothScratch>(),
            type_name::<ClothBuilt>(),
            type_name::<ClothSearch>(),
        ];
        (name.starts_with("bevy_drape") && !is_private && !of_the_run.contains(&name.as_str()))
            .then_some((*id, name))
    };
    archetype.components().iter().filter_map(info).collect()
}

fn registry(app: &App) -> impl std::ops::Deref<Target = TypeRegistry> {
    app.world().resource::<AppTypeRegistry>().read()
}

/// A cloth and a collider with every component that they may have.
fn everything() -> (App, [Entity; 3]) {
    let mut app = app_that_draws(FixedUpdate);
    let pole = app.world_mut().spawn(Transform::default()).id();
    let cloth = (
        Cloth::default().lying(),
        Pins::new([
            Pin::Index(3),
            Pin::Cell(1, 2),
            Pin::Row(0),
            Pin::Column(2),
            Pin::Corner(Corner::BottomRight),
        ]),
        ClothAttachments::new([(Pin::Column(0), pole)]),
        ShowClothGizmos::default(),
        ClothLod::default(),
        Visibility::default(),
    );
    let cloth = app.world_mut().spawn(cloth).id();
    let bones = ClothBones::new([ClothBone::capsule("hips", "neck", 0.2)]);
    let skin = ClothSkin::default().with_backstop(0.1, 0.5);
    app.world_mut()
        .entity_mut(cloth)
        .insert((skin, ClothInertia::default(), bones));
    let ball = (ClothCollider::ball(0.3), RapierClothCollider);
    let ball = app
        .world_mut()
        .spawn((ball, Transform::from_xyz(0.7, 0.25, 0.7)))
        .id();
    let bad = app.world_mut().spawn(Cloth::new(1, 1, 0.1)).id();
    tick(&mut app, 5);
    app.world_mut().entity_mut(cloth).insert(ClothTeleport);
    app.world_mut()
        .entity_mut(bad)
        .insert(ClothRenderMesh { cloth });
    assert!(app.world().get::<ClothFault>(bad).is_some());
    assert!(stats(&app, cloth).contacts > 0);
    (app, [cloth, ball, bad])
}

/// What names assets travels as a value here: scene files have their own way to write them.
const AS_VALUES: [&str; 2] = ["ClothMesh", "RenderMeshState"];

/// Each component of a living cloth goes into text and back, and onto another entity.
#[test]
fn every_component_travels() {
    let (mut app, entities) = everything();
    let mut names = Vec::new();
    for entity in entities {
        for (id, name) in components(&app, entity) {
            let id = app
                .world()
                .components()
                .get_info(id)
                .and_then(ComponentInfo::type_id);
            let other = app.world_mut().spawn_empty().id();
            let app_registry = app.world().resource::<AppTypeRegistry>().clone();
            let registry = app_registry.read();
            let registration = id
                .and_then(|id| registry.get(id))
                .unwrap_or_else(|| panic!("{name} is not registered"));
            let component = registration
                .data::<ReflectComponent>()
                .unwrap_or_else(|| panic!("{name} is not reflected as a component"));
            let value = component
                .reflect(app.world().entity(entity))
                .expect("it is there");
            let back = if AS_VALUES.iter().any(|it| name.ends_with(it)) {
                value.as_partial_reflect().to_dynamic()
            } else {
                let serializer = ReflectSerializer::new(value.as_partial_reflect(), &registry);
                let text = serde_json::to_string(&serializer)
                    .unwrap_or_else(|error| panic!("{name}: {error}"));
                let mut deserializer = serde_json::Deserializer::from_str(&text);
                ReflectDeserializer::new(&registry)
                    .deserialize(&mut deserializer)
                    .unwrap_or_else(|error| panic!("{name}: {error}"))
            };
            let other_world = app.world_mut();
            component.insert(&mut other_world.entity_mut(other), &*back, &registry);
            let other = app.world().entity(other);
            assert!(component.contains(other), "{name}");
            names.push(name);
        }
    }
    for name in [
        type_name::<Cloth>(),
        type_name::<Pins>(),
        type_name::<ClothMaterial>(),
        type_name::<ClothParticles>(),
        type_name::<ClothSettings>(),
        type_name::<SearchMethod>(),
        type_name::<NarrowPhase>(),
        type_name::<ClothAttachments>(),
        type_name::<ClothTeleport>(),
        type_name::<ClothSkin>(),
        type_name::<ClothInertia>(),
        type_name::<ClothBones>(),
        type_name::<ClothContacts>(),
        type_name::<ClothFrame>(),
        type_name::<ClothStats>(),
        type_name::<ClothFault>(),
        type_name::<ClothMesh>(),
        type_name::<ClothCollider>(),
        type_name::<RapierClothCollider>(),
        type_name::<ShowClothGizmos>(),
        type_name::<ClothLod>(),
        type_name::<ClothRenderMesh>(),
    ] {
        assert!(names.iter().any(|known| known == name), "{name}");
    }
}

/// What a scene file says of pins pins the same; a predicate, which is code, pins nothing.
#[test]
fn pins_travel_but_for_predicates() {
    let app = app();
    let registry = registry(&app);
    let through_text = |pins: &Pins| -> Pins {
        let text = serde_json::to_string(&ReflectSerializer::new(pins, &registry));
        let text = text.expect("pins are text");
        let mut deserializer = serde_json::Deserializer::from_str(&text);
        let back = ReflectDeserializer::new(&registry).deserialize(&mut deserializer);
        Pins::from_reflect(&*back.expect("and back")).expect("pins")
    };
    let pins = Pins::new([Pin::Row(1), Pin::Corner(Corner::TopLeft), Pin::Cell(2, 3)]);
    assert_eq!(through_text(&pins), pins);
    let surface = Cloth::new(4, 4, 0.1).surface(Vec3::ONE).expect("a grid");
    let predicate = through_text(&Pins::filter(|_, _| true));
    assert_eq!(predicate.validate(&surface), Ok(()));
    let mut app = self::app();
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(4, 4, 0.1), predicate))
        .id();
    tick(&mut app, 1);
    assert!(particles(&app, cloth).inverse_masses().all(|w| w > 0.0));
}

/// Entities that a component names are mapped when a scene is spawned.
#[test]
fn named_entities_are_mapped() {
    let (mut app, [cloth, ball, _]) = everything();
    let old =
        |attachments: &ClothAttachments| attachments.iter().map(|each| each.target.clone()).next();
    let mut attachments = app
        .world()
        .get::<ClothAttachments>(cloth)
        .expect("attachments")
        .clone();
    let mut contacts = app
        .world()
        .get::<ClothContacts>(cloth)
        .expect("contacts")
        .clone();
    let mut driven = ClothRenderMesh { cloth: ball };
    let Some(ClothTarget::Entity(pole)) = old(&attachments) else {
        panic!("a pole");
    };
    let new = [(); 2].map(|()| app.world_mut().spawn_empty().id());
    let mut map = EntityHashMap::from_iter([(pole, new[0]), (ball, new[1])]);
    let app_registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = app_registry.read();
    let world = app.world_mut();
    SceneEntityMapper::world_scope(&mut map, world, |_, mapper| {
        let map_entities = |type_id| {
            registry
                .get_type_data::<ReflectMapEntities>(type_id)
                .expect("it names entities")
        };
        use std::any::TypeId;
        map_entities(TypeId::of::<ClothAttachments>()).map_entities(&mut attachments, mapper);
        map_entities(TypeId::of::<ClothContacts>()).map_entities(&mut contacts, mapper);
        map_entities(TypeId::of::<ClothRenderMesh>()).map_entities(&mut driven, mapper);
    });
    assert_eq!(old(&attachments), Some(new[0].into()));
    assert!(contacts.with(new[1]).is_some() && contacts.with(ball).is_none());
    assert_eq!(driven.cloth, new[1]);
}
