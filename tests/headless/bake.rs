//! Cloth that is recorded as a glTF file, and read back.

use std::{path::Path, thread, time::Duration};

use bevy::{
    animation::AnimationPlugin,
    asset::{
        AssetPlugin, RenderAssetUsages,
        io::{
            AssetSourceBuilder, AssetSourceId, ErasedAssetReader,
            memory::{Dir, MemoryAssetReader},
        },
    },
    camera::visibility::VisibilityPlugin,
    gltf::GltfPlugin,
    mesh::{
        Indices, MeshPlugin, PrimitiveTopology, VertexAttributeValues,
        morph::{MeshMorphWeights, MorphWeights},
    },
    prelude::*,
    world_serialization::WorldSerializationPlugin,
};
use bevy_drape::prelude::*;
use gltf::{Gltf, animation::util::ReadOutputs};

use crate::{
    meshes::{drawn::seamed, sheets::*},
    support::*,
};

/// A drawn mesh: positions, normals, texture coordinates and corners.
#[derive(Clone, PartialEq, Debug)]
struct Drawn {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

impl Drawn {
    fn of(mesh: &Mesh) -> Self {
        let vectors = |of| {
            let values = mesh
                .attribute(of)
                .and_then(VertexAttributeValues::as_float3);
            let values = values.expect("vectors").iter();
            values.map(|value| Vec3::from(*value)).collect()
        };
        let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0)
        else {
            panic!("it has texture coordinates");
        };
        Self {
            positions: vectors(Mesh::ATTRIBUTE_POSITION),
            normals: vectors(Mesh::ATTRIBUTE_NORMAL),
            uvs: uvs.clone(),
            indices: mesh
                .indices()
                .expect("corners")
                .iter()
                .map(|at| at as u32)
                .collect(),
        }
    }
}

/// Frames of a cloth in the wind, as they were drawn, and their file.
fn bake(spawn: fn(&mut App) -> Entity, frames: usize) -> (Vec<Drawn>, Vec<u8>) {
    let mut app = app_that_draws(FixedUpdate);
    app.insert_resource(ClothWind::gusty(Vec3::new(6.0, 0.0, 2.0)));
    let cloth = spawn(&mut app);
    tick(&mut app, 2);
    let (mut bake, mut drawn) = (ClothBake::default(), Vec::new());
    for frame in 0..frames {
        tick(&mut app, 1);
        let mesh = app.world().get::<Mesh3d>(cloth).expect("it is drawn");
        let meshes = app.world().resource::<Assets<Mesh>>();
        let mesh = meshes.get(mesh).expect("it is there");
        bake.record(mesh, 7.0 + frame as f32 * TICK)
            .expect("a mesh");
        drawn.push(Drawn::of(mesh));
    }
    assert_eq!(bake.frames(), frames);
    let file = bake.to_glb("banner").expect("some frames");
    (drawn, file)
}

/// A file as it is read, at a time: its base and its targets, each by its weight.
fn at_frame(file: &[u8], frame: usize) -> Drawn {
    let Gltf { document, blob } = Gltf::from_slice(file).expect("a valid file");
    let blob = blob.expect("its numbers");
    let mesh = document.meshes().next().expect("a mesh");
    assert_eq!(mesh.name(), Some("banner"));
    let primitive = mesh.primitives().next().expect("a primitive");
    assert!(primitive.material().double_sided());
    let reader = primitive.reader(|_| Some(&blob));
    let animation = document.animations().next().expect("an animation");
    let channel = animation.channels().next().expect("a channel");
    let reading = channel.reader(|_| Some(&blob));
    let times: Vec<f32> = reading.read_inputs().expect("times").collect();
    assert!((times[frame] - frame as f32 * TICK).abs() < 1.0e-6);
    let Some(ReadOutputs::MorphTargetWeights(weights)) = reading.read_outputs() else {
        panic!("it moves weights");
    };
    let weights: Vec<f32> = weights.into_f32().collect();
    let targets: Vec<_> = reader.read_morph_targets().collect();
    assert_eq!(weights.len(), times.len() * targets.len());
    let mut drawn = Drawn {
        positions: reader
            .read_positions()
            .expect("places")
            .map(Vec3::from)
            .collect(),
        normals: reader
            .read_normals()
            .expect("normals")
            .map(Vec3::from)
            .collect(),
        uvs: reader
            .read_tex_coords(0)
            .expect("a texture")
            .into_f32()
            .collect(),
        indices: reader.read_indices().expect("corners").into_u32().collect(),
    };
    let own = &weights[frame * targets.len()..][..targets.len()];
    for ((positions, normals, _), weight) in targets.into_iter().zip(own) {
        let moved = positions.expect("moved places").zip(&mut drawn.positions);
        moved.for_each(|(by, place)| *place += *weight * Vec3::from(by));
        let turned = normals.expect("turned normals").zip(&mut drawn.normals);
        turned.for_each(|(by, normal)| *normal += *weight * Vec3::from(by));
    }
    drawn
}

fn banner(app: &mut App) -> Entity {
    let cloth = (Cloth::new(12, 8, 0.1), Pins::new([Pin::Column(0)]));
    app.world_mut().spawn(cloth).id()
}

/// A mesh of twice the resolution of the cloth that drives it.
fn driven(app: &mut App) -> Entity {
    let coarse = (Cloth::new(7, 7, 0.1).lying(), Pins::new([Pin::Row(0)]));
    let cloth = app.world_mut().spawn(coarse).id();
    let (positions, triangles) = sheet(13, 13);
    let positions: Vec<Vec3> = positions.iter().map(|place| 0.5 * *place).collect();
    let uvs: Vec<[f32; 2]> = positions.iter().map(|place| [place.x, place.z]).collect();
    let mesh = asset(&positions, &triangles)
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_NORMAL,
            vec![[0.0, 1.0, 0.0]; positions.len()],
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    let mesh = add(app, mesh);
    let fine = (
        ClothRenderMesh { cloth },
        Mesh3d(mesh),
        Transform::default(),
        Visibility::default(),
    );
    app.world_mut().spawn(fine).id()
}

/// A file read back holds the drawn vertices: of a grid, of a mesh with a seam, and of a fine mesh that a cloth drives. A difference and a sum are rounded once each, at
/// some metres by 2·10⁻⁷ each.
#[test]
fn a_file_plays_what_was_drawn() {
    let seam = |app: &mut App| {
        let handle = add(app, seamed().0);
        spawn(app, &handle, by_its_edge())
    };
    for (drawn, file) in [bake(banner, 40), bake(seam, 40), bake(driven, 40)] {
        let moved = drawn[0].positions.iter().zip(&drawn[39].positions);
        let moved = moved.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(moved > 0.05, "{moved}");
        for (frame, drawn) in drawn.iter().enumerate() {
            let read = at_frame(&file, frame);
            assert_eq!((&read.uvs, &read.indices), (&drawn.uvs, &drawn.indices));
            let both = |of: fn(&Drawn) -> &Vec<Vec3>| {
                let each = of(&read).iter().zip(of(drawn));
                assert_eq!(of(&read).len(), of(drawn).len());
                each.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
            };
            let off = both(|drawn| &drawn.positions).max(both(|drawn| &drawn.normals));
            assert!(off < 1.0e-6, "frame {frame}: {off}");
        }
        // Whole chunks of four bytes, as the header says.
        let length = u32::from_le_bytes(file[8..12].try_into().expect("four bytes"));
        assert_eq!((length as usize, length % 4), (file.len(), 0));
    }
}

/// An app that loads this file as a game does, but for a renderer, and the scene's animation once it is there.
fn playing(file: Vec<u8>) -> (App, Entity, AnimationNodeIndex) {
    let mut app = App::new();
    let folder = Dir::default();
    folder.insert_asset(Path::new("banner.glb"), file);
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
            GltfPlugin::default(),
            AnimationPlugin,
        ))
        .init_asset::<StandardMaterial>();
    app.finish();
    app.cleanup();
    let server = app.world().resource::<AssetServer>();
    let scene = WorldAssetRoot(server.load("banner.glb#Scene0"));
    let (graph, clip) = AnimationGraph::from_clip(server.load("banner.glb#Animation0"));
    app.world_mut().spawn(scene);
    let graph = app
        .world_mut()
        .resource_mut::<Assets<AnimationGraph>>()
        .add(graph);
    let mut players = app
        .world_mut()
        .query_filtered::<Entity, With<AnimationPlayer>>();
    let mut found = None;
    for _ in 0..1000 {
        app.update();
        found = players.iter(app.world()).next();
        if found.is_some() {
            break;
        }
        thread::sleep(Duration::from_millis(5));
    }
    let player = found.expect("the scene was spawned");
    app.world_mut()
        .entity_mut(player)
        .insert(AnimationGraphHandle(graph));
    (app, player, clip)
}

/// The vertices that Bevy draws: those of the mesh, and of its targets each by its weight.
fn played(app: &mut App) -> Vec<Vec3> {
    let world = app.world_mut();
    let mut weights = world.query::<&MorphWeights>();
    let weights = weights.single(world).expect("weights").weights().to_vec();
    let mut drawn = world.query_filtered::<&Mesh3d, With<MeshMorphWeights>>();
    let mesh = drawn.single(world).expect("a mesh").0.clone();
    let mesh = world.resource::<Assets<Mesh>>().get(&mesh).expect("loaded");
    let mut places = Drawn::of(mesh).positions;
    let targets = mesh.morph_targets().expect("targets");
    assert_eq!(targets.len(), weights.len() * places.len());
    for (target, weight) in targets.chunks(places.len()).zip(weights) {
        for (place, moved) in places.iter_mut().zip(target) {
            *place += weight * moved.position;
        }
    }
    places
}

/// Bevy plays a file as it was drawn, and in straight lines between frames. The weights of a time are rounded by some 10⁻⁶, which is far
/// less than 0.1 mm of the way of a frame.
#[test]
fn bevy_plays_what_was_drawn() {
    let (drawn, file) = bake(banner, 12);
    let (mut app, player, clip) = playing(file);
    for part in [0.0, 0.3, 1.0, 4.5, 7.75, 10.9, 11.0] {
        let mut players = app.world_mut().query::<&mut AnimationPlayer>();
        let mut player = players.get_mut(app.world_mut(), player).expect("a player");
        player.play(clip).seek_to(part * TICK).pause();
        // Bevy takes a frame to see the graph.
        (0..3).for_each(|_| app.update());
        let before = (part as usize).min(drawn.len() - 2);
        let [from, to] = [before, before + 1].map(|frame| &drawn[frame].positions);
        let places = played(&mut app);
        assert_eq!(places.len(), from.len());
        for (place, (from, to)) in places.iter().zip(from.iter().zip(to)) {
            let off = place.distance(from.lerp(*to, part - before as f32));
            assert!(off < 1.0e-4, "frame {part}: {off} m");
        }
    }
    let moved = drawn[0].positions.iter().zip(&drawn[11].positions);
    let moved = moved.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(moved > 0.01, "{moved} m");
}

/// Meshes that cannot be recorded, and recordings that cannot be written, are refused by name, and change nothing.
#[test]
fn bad_recordings_are_refused() {
    let triangle = |places: Vec<[f32; 3]>| {
        let normals = vec![[0.0, 0.0, 1.0]; places.len()];
        Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_indices(Indices::U32(vec![0, 1, 2]))
    };
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let good = triangle(corners.clone());
    let mut bake = ClothBake::default();
    let frames = |frames| Err(BakeError::Frames { frames });
    assert_eq!(bake.to_glb("x"), frames(0));
    type Spoil = fn(&mut Mesh);
    let spoilt: [Spoil; 7] = [
        |mesh| drop(mesh.remove_attribute(Mesh::ATTRIBUTE_POSITION)),
        |mesh| drop(mesh.remove_attribute(Mesh::ATTRIBUTE_NORMAL)),
        |mesh| mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 2]),
        |mesh| drop(mesh.remove_indices()),
        |mesh| mesh.insert_indices(Indices::U32(vec![0, 1, 3])),
        |mesh| mesh.insert_indices(Indices::U32(vec![0, 1])),
        |mesh| mesh.insert_indices(Indices::U32(Vec::new())),
    ];
    for (number, spoil) in spoilt.into_iter().enumerate() {
        let mut mesh = good.clone();
        spoil(&mut mesh);
        assert_eq!(
            bake.record(&mesh, 0.0),
            Err(BakeError::Unreadable),
            "{number}"
        );
    }
    assert_eq!(bake.frames(), 0);
    bake.record(&good, 1.0).expect("a triangle");
    assert_eq!(bake.to_glb("x"), frames(1));
    let mut more = corners.clone();
    more.push([1.0; 3]);
    assert_eq!(bake.record(&triangle(more), 2.0), Err(BakeError::OtherMesh));
    let mut turned = good.clone();
    turned.insert_indices(Indices::U32(vec![0, 2, 1]));
    assert_eq!(bake.record(&turned, 2.0), Err(BakeError::OtherMesh));
    for bad in [f32::NAN, f32::INFINITY, -1.0e13] {
        let mut broken = corners.clone();
        broken[1][2] = bad;
        let refused = BakeError::NotFinite { vertex: 1 };
        assert_eq!(bake.record(&triangle(broken), 2.0), Err(refused));
    }
    for bad in [1.0, 0.0, f32::NAN, f32::INFINITY] {
        let refused = bake.record(&good, bad);
        assert!(matches!(refused, Err(BakeError::Time { .. })), "{bad}");
    }
    assert_eq!(bake.frames(), 1);
    bake.record(&good, 2.0).expect("the same triangle");
    // Any name is a valid string in the file.
    let file = bake.to_glb("a \"flag\"\n\\").expect("two frames");
    let read = Gltf::from_slice(&file).expect("a valid file");
    let name = read
        .document
        .nodes()
        .next()
        .expect("a node")
        .name()
        .map(str::to_owned);
    assert_eq!(name.as_deref(), Some("a \"flag\"\n\\"));
    for frame in 2..257 {
        bake.record(&good, 1.0 + frame as f32)
            .expect("the same triangle");
    }
    assert!(bake.to_glb("x").is_ok());
    bake.record(&good, 1.0e3).expect("one more");
    assert_eq!(bake.to_glb("x"), frames(258));
}
