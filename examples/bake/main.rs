//! Records a flag in the wind as a glTF file, which plays its motion without simulating it.
//!
//! `ClothBake` records the mesh that the plugin writes, after each tick, and makes the file. The example reads the file back,
//! and compares every vertex of every frame with what was drawn. It needs no window.
//!
//! ```sh
//! cargo run --example bake -- flag.glb               # two seconds, 32 frames a second
//! cargo run --example bake -- flag.glb --seconds 4
//! ```

use std::{fs, path::PathBuf, process::ExitCode, time::Instant};

use bevy::{
    asset::AssetPlugin, camera::visibility::VisibilityPlugin, mesh::MeshPlugin, prelude::*,
    time::TimeUpdateStrategy,
};
use bevy_drape::prelude::*;
use clap::Parser;
use gltf::{Gltf, animation::util::ReadOutputs};

/// Ticks from frame to frame, of which there are 64 a second.
const TICKS_A_FRAME: u32 = 2;
const INTERVAL: f32 = TICKS_A_FRAME as f32 / 64.0;

/// How long the flag blows before it is recorded (ticks).
const BEFORE: u32 = 128;

/// Records a flag in the wind as a glTF file.
#[derive(Parser)]
#[command(name = "bake")]
struct Options {
    /// The file, which is written anew
    file: PathBuf,
    /// How long to record (s)
    #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = seconds)]
    seconds: f32,
}

fn seconds(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(seconds) if (0.1..=8.0).contains(&seconds) => Ok(seconds),
        _ => {
            Err("expected a number of seconds from 0.1 to 8: Bevy plays 257 frames at most".into())
        }
    }
}

fn main() -> ExitCode {
    match bake(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

fn bake(options: &Options) -> Result {
    let mut app = app_with_flag();
    (0..BEFORE).for_each(|_| app.update());
    let (mut bake, mut drawn) = (ClothBake::default(), Vec::new());
    let frames = (options.seconds / INTERVAL) as usize + 1;
    let begun = Instant::now();
    for frame in 0..frames {
        (0..TICKS_A_FRAME).for_each(|_| app.update());
        let mut cloths = app.world_mut().query_filtered::<&Mesh3d, With<Cloth>>();
        let cloth = cloths.single(app.world())?.clone();
        let meshes = app.world().resource::<Assets<Mesh>>();
        let mesh = meshes.get(&cloth).ok_or("the flag is not drawn")?;
        bake.record(mesh, frame as f32 * INTERVAL)?;
        drawn.push(positions(mesh));
    }
    let simulated = begun.elapsed().as_secs_f64();
    let file = bake.to_glb("flag")?;
    fs::write(&options.file, &file)?;
    let (off, vertices) = compare(&fs::read(&options.file)?, &drawn)?;
    println!("A flag in the wind, recorded");
    println!("  frames           {frames}, {INTERVAL} s apart, of {vertices} vertices");
    println!("  simulated in     {:.2} s", simulated);
    println!(
        "  file             {}, {} kB",
        options.file.display(),
        file.len() / 1000
    );
    println!("  read back        {:.5} mm off at most", 1.0e3 * off);
    // A difference and a sum are rounded, at some metres.
    if off < 1.0e-6 {
        Ok(())
    } else {
        Err("the file is not what was drawn".into())
    }
}

fn app_with_flag() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        MeshPlugin,
        VisibilityPlugin,
        DrapePlugins::default(),
    ))
    .insert_resource(ClothWind::gusty(Vec3::new(7.0, 0.0, 1.0)))
    .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    let flag = Cloth::new(32, 22, 0.05);
    app.world_mut().spawn((flag, Pins::new([Pin::Column(0)])));
    app.finish();
    app.cleanup();
    app
}

fn positions(mesh: &Mesh) -> Vec<Vec3> {
    let values = mesh.attribute(Mesh::ATTRIBUTE_POSITION);
    let values = values.and_then(|values| values.as_float3());
    values
        .unwrap_or_default()
        .iter()
        .map(|place| Vec3::from(*place))
        .collect()
}

/// The largest distance of a vertex of the file from where it was drawn (m), and the number of vertices.
fn compare(file: &[u8], drawn: &[Vec<Vec3>]) -> Result<(f32, usize)> {
    let Gltf { document, blob } = Gltf::from_slice(file)?;
    let blob = blob.ok_or("the file holds no numbers")?;
    let mut primitives = document.meshes().flat_map(|mesh| mesh.primitives());
    let primitive = primitives.next().ok_or("the file holds no mesh")?;
    let reader = primitive.reader(|_| Some(&blob));
    let base: Vec<Vec3> = reader
        .read_positions()
        .ok_or("no positions")?
        .map(Vec3::from)
        .collect();
    let targets = reader.read_morph_targets().map(|(positions, ..)| {
        positions.map_or_else(Vec::new, |each| each.map(Vec3::from).collect())
    });
    let targets: Vec<Vec<Vec3>> = targets.collect();
    let mut channels = document
        .animations()
        .flat_map(|animation| animation.channels());
    let channel = channels.next().ok_or("the file holds no animation")?;
    let weights = channel.reader(|_| Some(&blob)).read_outputs();
    let Some(ReadOutputs::MorphTargetWeights(weights)) = weights else {
        return Err("the animation moves no weights".into());
    };
    let weights: Vec<f32> = weights.into_f32().collect();
    let is_whole = targets.len() + 1 == drawn.len() && weights.len() == targets.len() * drawn.len();
    if !is_whole || drawn.iter().any(|drawn| drawn.len() != base.len()) {
        return Err("the file has other frames or vertices".into());
    }
    let mut off = 0.0_f32;
    for (drawn, weights) in drawn.iter().zip(weights.chunks_exact(targets.len())) {
        for (vertex, drawn) in drawn.iter().enumerate() {
            let moved = targets
                .iter()
                .zip(weights)
                .filter(|(_, weight)| **weight != 0.0);
            let moved: Vec3 = moved.map(|(target, weight)| target[vertex] * *weight).sum();
            off = off.max((base[vertex] + moved).distance(*drawn));
        }
    }
    Ok((off, base.len()))
}
