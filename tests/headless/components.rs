//! All components of the crate, as its registry has them: for scenes, inspectors and clones.

use bevy::{
    ecs::reflect::{ReflectComponent, ReflectFromWorld, ReflectResource},
    prelude::*,
    reflect::{
        TypeRegistration, TypeRegistry,
        serde::{ReflectDeserializer, ReflectSerializer},
    },
};
use bevy_drape::{plugin::ClothSkeleton, prelude::*};
use serde::de::DeserializeSeed;

use crate::support::*;

/// What games and artists put on entities.
fn of_users() -> Vec<&'static str> {
    vec![
        Cloth::type_path(),
        ClothAir::type_path(),
        ClothAttachments::type_path(),
        ClothBody::type_path(),
        ClothBones::type_path(),
        ClothCollider::type_path(),
        ClothCreasing::type_path(),
        ClothInertia::type_path(),
        ClothLayers::type_path(),
        ClothLod::type_path(),
        ClothMaterial::type_path(),
        ClothParticles::type_path(),
        ClothPressure::type_path(),
        ClothPushBack::type_path(),
        ClothRenderMesh::type_path(),
        ClothSelfCollision::type_path(),
        ClothSettings::type_path(),
        ClothSkin::type_path(),
        ClothTeleport::type_path(),
        ClothWindZone::type_path(),
        NarrowPhase::type_path(),
        Pins::type_path(),
        RapierClothCollider::type_path(),
        SearchMethod::type_path(),
        ShowClothGizmos::type_path(),
    ]
}

/// Those whose values name assets, which only scene files have a way to write.
const WITH_ASSETS: [&str; 3] = ["ClothMesh", "RenderMeshState", "ClothSkeleton"];

/// What is made by the plugin alone, and not by default.
const MADE: [&str; 2] = ["ClothFault", "BoneColliderOf"];

/// Written by the plugin and of one entity: a clone has its own.
const OWN: [&str; 3] = ["ClothContacts", "ClothFault", "ClothOrder"];

fn ends_with(name: &str, any: &[&str]) -> bool {
    any.iter().any(|end| name.ends_with(&format!("::{end}")))
}

fn default_of(of: &TypeRegistration, world: &mut World) -> Option<Box<dyn Reflect>> {
    let by_default = of.data::<ReflectDefault>().map(ReflectDefault::default);
    by_default.or_else(|| {
        let from_world = of.data::<ReflectFromWorld>()?;
        Some(from_world.from_world(world))
    })
}

fn through_text(value: &dyn Reflect, registry: &TypeRegistry) -> Box<dyn PartialReflect> {
    let serializer = ReflectSerializer::new(value.as_partial_reflect(), registry);
    let text = serde_json::to_string(&serializer).expect("it is text");
    let mut deserializer = serde_json::Deserializer::from_str(&text);
    let back = ReflectDeserializer::new(registry).deserialize(&mut deserializer);
    back.unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// Each has a default, goes into text and back, is applied to a living cloth, which goes on, and is cloned.
#[test]
fn every_registered_component_is_for_scenes_inspectors_and_clones() {
    let mut app = app_that_draws(FixedUpdate);
    let shared = app.world().resource::<AppTypeRegistry>().clone();
    let registry = shared.read();
    let mut names = Vec::new();
    let ours = |of: &&TypeRegistration| of.type_info().type_path().starts_with("bevy_drape");
    for of in registry.iter().filter(ours) {
        let Some(component) = of.data::<ReflectComponent>() else {
            continue;
        };
        let name = of.type_info().type_path();
        if of.data::<ReflectResource>().is_some() {
            assert!(of.data::<ReflectDefault>().is_some(), "{name}");
            continue;
        }
        // A scene file names no module: what lies where inside of the crate may change.
        assert_eq!(name.matches("::").count(), 1, "{name}");
        names.push(name);
        let Some(value) = default_of(of, app.world_mut()) else {
            assert!(ends_with(name, &MADE), "{name} has no default");
            continue;
        };
        let value = if ends_with(name, &WITH_ASSETS) {
            value.into_partial_reflect()
        } else {
            through_text(&*value, &registry)
        };
        let cloth = app.world_mut().spawn(Cloth::new(5, 5, 0.1)).id();
        tick(&mut app, 2);
        let world = app.world_mut();
        component.insert(&mut world.entity_mut(cloth), &*value, &registry);
        component.apply(world.entity_mut(cloth), &*value);
        let reflected = component.reflect(app.world().entity(cloth));
        let reflected = reflected.unwrap_or_else(|| panic!("{name} is not there"));
        let is_same = reflected.reflect_partial_eq(&*value);
        assert_ne!(is_same, Some(false), "{name}: {reflected:?}");
        let clone = app.world_mut().entity_mut(cloth).clone_and_spawn();
        let cloned = component.reflect(app.world().entity(clone));
        if !ends_with(name, &OWN) {
            let cloned = cloned.unwrap_or_else(|| panic!("{name} is not cloned"));
            let is_same = cloned.reflect_partial_eq(&*value);
            assert_ne!(is_same, Some(false), "{name}: {cloned:?}");
        }
        tick(&mut app, 2);
        for each in [cloth, clone] {
            // Which the one is a part of.
            if app.world().get::<ClothParticles>(each).is_some() {
                let places = particles(&app, each).positions();
                assert!(places.into_iter().all(Vec3::is_finite), "{name}");
            }
        }
        app.world_mut().despawn(cloth);
        app.world_mut().despawn(clone);
    }
    for name in of_users() {
        assert!(names.contains(&name), "{name} is not registered");
    }
    assert!(names.contains(&ClothSkeleton::type_path()));
    for internal in ["ClothBuilt", "ClothSearch", "ClothState", "ClothScratch"] {
        assert!(!names.iter().any(|name| ends_with(name, &[internal])));
    }
}

/// What an inspector writes into a field is followed by the cloth.
#[test]
fn fields_that_are_written_by_reflection_are_followed() {
    let mut app = app();
    let cloth = Cloth::new(8, 8, 0.1).flat();
    let cloth = app.world_mut().spawn((cloth, ClothAir::default())).id();
    tick(&mut app, 8);
    let write = |app: &mut App, component: &str, path: &str, value: Box<dyn PartialReflect>| {
        let registry = app.world().resource::<AppTypeRegistry>().clone();
        let registry = registry.read();
        let of = registry.get_with_short_type_path(component);
        let of = of.and_then(|of| of.data::<ReflectComponent>());
        let of = of.expect("a reflected component");
        let entity = app.world_mut().entity_mut(cloth);
        let mut component = of.reflect_mut(entity).expect("it is there");
        let field = component.reflect_path_mut(path).expect("a field");
        field.apply(&*value);
    };
    let mass = |app: &App| {
        let lightest = particles(app, cloth).inverse_masses();
        let free = lightest.into_iter().filter(|w| *w > 0.0);
        free.fold(f32::MAX, f32::min).recip()
    };
    let before = mass(&app);
    write(
        &mut app,
        "ClothMaterial",
        ".areal_density",
        Box::new(0.3_f32),
    );
    tick(&mut app, 1);
    assert!((mass(&app) / before - 2.0).abs() < 1.0e-5);
    write(&mut app, "ClothSettings", ".gravity", {
        Box::new(Some(Vec3::new(0.0, 0.0, 4.0)))
    });
    let z = |app: &App| position(app, cloth, (7, 3)).z;
    let before = z(&app);
    tick(&mut app, 16);
    assert!(z(&app) > before + 0.02);
    // The top row is let go, and falls by that gravity.
    write(&mut app, "Pins", ".0[0]", Box::new(Pin::Row(7)));
    tick(&mut app, 16);
    let weights: Vec<f32> = particles(&app, cloth).inverse_masses().collect();
    assert!(weights[..56].iter().all(|w| *w > 0.0));
    assert!(weights[56..].iter().all(|w| *w == 0.0));
    write(&mut app, "ClothAir", ".drag", Box::new(f32::NAN));
    tick(&mut app, 1);
    assert!(app.world().get::<ClothFault>(cloth).is_some());
    write(&mut app, "ClothAir", ".drag", Box::new(1.0_f32));
    tick(&mut app, 1);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    write(&mut app, "Cloth", ".shape.0.columns", Box::new(12_u32));
    tick(&mut app, 1);
    assert_eq!(particles(&app, cloth).columns(), 12);
}
