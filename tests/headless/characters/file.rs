//! A character from a glTF file, as a modelling program writes it.

use std::{path::Path, thread, time::Duration};

use bevy::{
    asset::{
        AssetPlugin,
        io::{
            AssetSourceBuilder, AssetSourceId, ErasedAssetReader,
            memory::{Dir, MemoryAssetReader},
        },
    },
    camera::visibility::VisibilityPlugin,
    gltf::GltfPlugin,
    mesh::{MeshPlugin, skinning::SkinnedMesh},
    prelude::*,
    world_serialization::WorldSerializationPlugin,
};
use bevy_drape::prelude::*;
use serde_json::{Value, json};

use crate::{meshes::sheets::*, support::*};

const SIDE: u32 = 6;

/// A glTF file in parts: what lies in its buffer, and what says so.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Adds numbers; returns which accessor they are.
    fn add(&mut self, bytes: Vec<u8>, component: u32, kind: &str, count: usize) -> usize {
        let length = bytes.len();
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.views
            .push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": length }));
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": component, "type": kind, "count": count,
            "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0],
        }));
        if kind != "VEC3" {
            let accessor = self.accessors.last_mut().and_then(Value::as_object_mut);
            let accessor = accessor.expect("an object");
            accessor.retain(|key, _| !["min", "max"].contains(&key.as_str()));
        }
        self.accessors.len() - 1
    }

    fn floats(&mut self, values: impl IntoIterator<Item = f32>, kind: &str, size: usize) -> usize {
        let bytes: Vec<u8> = values.into_iter().flat_map(f32::to_le_bytes).collect();
        let count = bytes.len() / 4 / size;
        self.add(bytes, 5126, kind, count)
    }
}

/// A sheet whose row r may be 0.04 r m from a skeleton of two bones, as a binary glTF file.
fn character() -> Vec<u8> {
    let (places, triangles) = sheet(SIDE, SIDE);
    let count = places.len();
    let row = |vertex: usize| (vertex as u32 / SIDE) as f32;
    let mut file = File::default();
    let positions = file.floats(places.iter().flat_map(Vec3::to_array), "VEC3", 3);
    let normals = file.floats([0.0, 1.0, 0.0].repeat(count), "VEC3", 3);
    let joints: Vec<u8> = [0_u16, 1, 0, 0]
        .repeat(count)
        .into_iter()
        .flat_map(u16::to_le_bytes)
        .collect();
    let joints = file.add(joints, 5123, "VEC4", count);
    let weights = (0..count).flat_map(|vertex| {
        let part = row(vertex) / (SIDE - 1) as f32;
        [1.0 - part, part, 0.0, 0.0]
    });
    let weights = file.floats(weights, "VEC4", 4);
    let distances = file.floats((0..count).map(|vertex| 0.04 * row(vertex)), "SCALAR", 1);
    let backstops = file.floats(vec![0.01; count], "SCALAR", 1);
    let indices = triangles
        .as_flattened()
        .iter()
        .flat_map(|index| index.to_le_bytes());
    let indices = file.add(indices.collect(), 5125, "SCALAR", 3 * triangles.len());
    let second = Mat4::from_translation(Vec3::Z * -0.2).to_cols_array();
    let inverse = Mat4::IDENTITY.to_cols_array().into_iter().chain(second);
    let inverse = file.floats(inverse, "MAT4", 16);
    while !file.bytes.len().is_multiple_of(4) {
        file.bytes.push(0);
    }
    let text = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "hero", "children": [1, 3] },
            { "name": "hips", "children": [2] },
            { "name": "chest", "translation": [0.0, 0.0, 0.2] },
            { "name": "cape", "mesh": 0, "skin": 0 },
        ],
        "skins": [{ "joints": [1, 2], "inverseBindMatrices": inverse }],
        "meshes": [{ "primitives": [{
            "attributes": {
                "POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights,
                "_MAX_DISTANCE": distances, "_BACKSTOP": backstops,
            },
            "indices": indices,
        }] }],
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{ "byteLength": file.bytes.len() }],
    });
    let mut text = text.to_string().into_bytes();
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    let word = |number: usize| (number as u32).to_le_bytes();
    let total = 12 + 8 + text.len() + 8 + file.bytes.len();
    let mut binary = [*b"glTF", word(2), word(total), word(text.len()), *b"JSON"].concat();
    binary.extend(&text);
    binary.extend([word(file.bytes.len()), *b"BIN\0"].concat());
    binary.extend(&file.bytes);
    binary
}

/// The cape becomes cloth as the scene is spawned, and does what was painted; its bones carry colliders by their names.
#[test]
fn a_character_of_a_file_is_dressed() {
    let mut app = App::new();
    let folder = Dir::default();
    folder.insert_asset(Path::new("hero.glb"), character());
    let reader = move || -> Box<dyn ErasedAssetReader> {
        Box::new(MemoryAssetReader {
            root: folder.clone(),
        })
    };
    app.register_asset_source(AssetSourceId::Default, AssetSourceBuilder::new(reader))
        .add_plugins((MinimalPlugins, TransformPlugin))
        .add_plugins((
            AssetPlugin::default(),
            MeshPlugin,
            ImagePlugin::default(),
            VisibilityPlugin,
            WorldSerializationPlugin,
            GltfPlugin::default()
                .add_custom_vertex_attribute("MAX_DISTANCE", ClothSkin::MAX_DISTANCE)
                .add_custom_vertex_attribute("BACKSTOP", ClothSkin::BACKSTOP),
            DrapePlugins::default(),
        ))
        .init_asset::<StandardMaterial>()
        .insert_resource(bevy::time::TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    let server = app.world().resource::<AssetServer>();
    let scene = WorldAssetRoot(server.load("hero.glb#Scene0"));
    let hero = app.world_mut().spawn(scene).id();
    let mut skins = app
        .world_mut()
        .query_filtered::<(Entity, &SkinnedMesh), Without<Cloth>>();
    let mut found = None;
    for _ in 0..1000 {
        app.update();
        found = skins.iter(app.world()).next();
        if found.is_some() {
            break;
        }
        thread::sleep(Duration::from_millis(5));
    }
    let (cape, skin) = found.expect("the scene was spawned");
    let [hips, chest] = [skin.joints[0], skin.joints[1]];
    let painted = ClothSkin::painted().with_painted_backstop(0.5);
    app.world_mut()
        .entity_mut(cape)
        .insert((Cloth::mesh(), painted));
    for count in 0..64 {
        let swing = (0.2 * count as f32).sin();
        change::<Transform>(&mut app, hips, |hips| hips.translation.x = 0.3 * swing);
        change::<Transform>(&mut app, chest, |chest| {
            chest.rotation = Quat::from_rotation_x(0.5 * swing);
        });
        app.update();
        assert_eq!(fault(&app, cape), None);
        let places = by_vertex(&app, cape);
        let frame = app.world().get::<ClothFrame>(cape).expect("a frame");
        let (rest, _) = sheet(SIDE, SIDE);
        let hips = Vec3::X * 0.3 * swing;
        let chest = hips + Vec3::Z * 0.2;
        for (vertex, (place, rest)) in places.iter().zip(rest).enumerate() {
            let row = (vertex as u32 / SIDE) as f32;
            let part = row / (SIDE - 1) as f32;
            let turned = chest + Quat::from_rotation_x(0.5 * swing) * (rest - Vec3::Z * 0.2);
            let truth = (hips + rest).lerp(turned, part);
            let off = frame.to_world(place.expect("a particle")).distance(truth);
            assert!(off <= 0.04 * row + 5.0e-6, "{vertex}: {off}");
        }
    }
    // Not before: it would push the cape out of its limits.
    let bones = ClothBones::new([ClothBone::ball("chest", 0.05)]);
    app.world_mut().entity_mut(hero).insert(bones);
    (0..2).for_each(|_| app.update());
    assert_eq!(fault(&app, hero), None);
    let chest = app.world().get::<Children>(chest).expect("a collider");
    assert!(
        chest
            .iter()
            .any(|child| app.world().get::<ClothCollider>(child).is_some())
    );
}
