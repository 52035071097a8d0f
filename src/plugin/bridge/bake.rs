//! A cloth's motion as a glTF file with morph targets.

use bevy::{
    mesh::{PrimitiveTopology, VertexAttributeValues},
    prelude::{Mesh, Vec3},
};
use serde_json::{Value, json};
use thiserror::Error;

/// Morph targets that Bevy draws at most, one a frame but the first.
const MAX_TARGETS: usize = 256;

/// Farthest that a vertex may be (m): squares and differences are finite.
const FARTHEST: f32 = 1.0e12;

/// Numbers of the glTF 2.0 specification: types of components, uses of buffers, and marks of the file and its chunks.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const MAGIC: u32 = 0x4654_6C67;
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;

/// Records the mesh of a cloth frame by frame, for a file that plays its motion without simulating it: for cloth far away,
/// or on weak machines (feature `bake`).
///
/// It takes any mesh whose vertices move: that of a cloth, or one that a cloth drives by a
/// [`ClothRenderMesh`](crate::plugin::ClothRenderMesh). Vertices are in the entity's own frame, and the motion of the entity is
/// not recorded. Between frames vertices move in straight lines.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// #[derive(Resource, Default)]
/// struct Baking(ClothBake);
///
/// /// In `Last`, once the mesh is written.
/// fn record(
///     cloth: Single<&Mesh3d, With<Cloth>>,
///     meshes: Res<Assets<Mesh>>,
///     time: Res<Time>,
///     mut baking: ResMut<Baking>,
/// ) -> Result {
///     let bake = &mut baking.0;
///     if let Some(mesh) = meshes.get(*cloth) && bake.frames() < 128 {
///         bake.record(mesh, time.elapsed_secs())?;
///         if bake.frames() == 128 {
///             std::fs::write("flag.glb", bake.to_glb("flag")?)?;
///         }
///     }
///     Ok(())
/// }
/// # App::new().add_systems(Last, record);
/// ```
#[derive(Debug, Default, Clone)]
pub struct ClothBake {
    /// Corners of each triangle, and texture coordinates of the vertices, if there are any.
    indices: Vec<u32>,
    uvs: Vec<[f32; 2]>,
    frames: Vec<Frame>,
}

/// Positions (m) and normals of the vertices at a time (s).
#[derive(Debug, Clone)]
struct Frame {
    time: f32,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// The reason why a mesh cannot be recorded, or a recording not be written.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The mesh is no list of triangles with positions and normals, or it is only in the render world.
    #[error(
        "a mesh to record needs triangles, and a position and a normal for each vertex, in the main world"
    )]
    Unreadable,
    /// The mesh has other vertices or triangles than in the first frame.
    #[error("the mesh has other vertices or triangles than in the first frame")]
    OtherMesh,
    /// A vertex is not finite, or beyond 10¹² m.
    #[error("vertex {vertex} is not finite or is beyond 10¹² m")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// The time of a frame is not finite, or not later than that of the frame before.
    #[error("the time of a frame must be finite and later than the one before, not {time} s")]
    Time {
        /// The time (s).
        time: f32,
    },
    /// Fewer than two frames, or more than Bevy plays.
    #[error("{frames} frames were recorded: there must be 2 to 257")]
    Frames {
        /// Number of frames.
        frames: usize,
    },
    /// The file would be larger than glTF allows, which is 4 GB.
    #[error("a file of {bytes} bytes exceeds the 4 GB of glTF: record fewer frames")]
    TooLarge {
        /// Size of the file.
        bytes: usize,
    },
}

impl ClothBake {
    /// Adds a frame: the vertices as they are at this time (s).
    ///
    /// # Errors
    /// [`BakeError::Unreadable`], [`BakeError::OtherMesh`], [`BakeError::NotFinite`] or [`BakeError::Time`]; no frame is
    /// added then.
    pub fn record(&mut self, mesh: &Mesh, time: f32) -> Result<(), BakeError> {
        let vectors = |of| -> Option<Vec<Vec3>> {
            let values = mesh.try_attribute(of).ok()?.as_float3()?;
            Some(values.iter().map(|value| Vec3::from(*value)).collect())
        };
        let positions = vectors(Mesh::ATTRIBUTE_POSITION).ok_or(BakeError::Unreadable)?;
        let normals = vectors(Mesh::ATTRIBUTE_NORMAL).ok_or(BakeError::Unreadable)?;
        let indices = corners(mesh).ok_or(BakeError::Unreadable)?;
        if positions.len() != normals.len() {
            return Err(BakeError::Unreadable);
        }
        let is_near = |at: &Vec3| at.abs().max_element() <= FARTHEST && at.is_finite();
        let mut both = positions.iter().zip(&normals);
        if let Some(vertex) = both.position(|(at, normal)| !(is_near(at) && is_near(normal))) {
            return Err(BakeError::NotFinite { vertex });
        }
        let last = self.frames.last();
        if !time.is_finite() || last.is_some_and(|last| time <= last.time) {
            return Err(BakeError::Time { time });
        }
        if let Some(last) = last {
            if last.positions.len() != positions.len() || self.indices != indices {
                return Err(BakeError::OtherMesh);
            }
        } else {
            self.indices = indices;
            let uvs = mesh.try_attribute(Mesh::ATTRIBUTE_UV_0).ok();
            self.uvs = match uvs {
                Some(VertexAttributeValues::Float32x2(uvs)) if is_texture(uvs, positions.len()) => {
                    uvs.clone()
                }
                _ => Vec::new(),
            };
        }
        self.frames.push(Frame {
            time,
            positions,
            normals,
        });
        Ok(())
    }

    /// Number of frames recorded.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// A binary glTF file: a node and a mesh of this name, seen from both sides, and an animation `cloth` that begins at 0 s.
    /// Each vertex takes 24 bytes a frame.
    ///
    /// # Errors
    /// [`BakeError::Frames`] or [`BakeError::TooLarge`].
    pub fn to_glb(&self, name: &str) -> Result<Vec<u8>, BakeError> {
        let frames = self.frames.len();
        let [first, others @ ..] = &self.frames[..] else {
            return Err(BakeError::Frames { frames });
        };
        let targets = others.len();
        if !(1..=MAX_TARGETS).contains(&targets) {
            return Err(BakeError::Frames { frames });
        }
        let mut file = File::default();
        let mut attributes = file.add_shape(&first.positions, &first.normals);
        if !self.uvs.is_empty() {
            attributes["TEXCOORD_0"] = file.add_floats(&self.uvs, Some(ARRAY_BUFFER));
        }
        let indices = file.add_indices(&self.indices);
        let target = |frame: &Frame| {
            let offsets = |of: &[Vec3], from: &[Vec3]| -> Vec<Vec3> {
                of.iter().zip(from).map(|(to, from)| *to - *from).collect()
            };
            let moved = offsets(&frame.positions, &first.positions);
            file.add_shape(&moved, &offsets(&frame.normals, &first.normals))
        };
        let shapes: Vec<Value> = others.iter().map(target).collect();
        let times = self.frames.iter().map(|frame| [frame.time - first.time]);
        let times: Vec<[f32; 1]> = times.collect();
        // In each frame its own target counts alone; in the first, none.
        let weight = |at: usize| [f32::from(u8::from(at / targets == at % targets + 1))];
        let weights: Vec<[f32; 1]> = (0..frames * targets).map(weight).collect();
        let sampler = json!({
            "input": file.add_floats(&times, None),
            "output": file.add_floats(&weights, None),
            "interpolation": "LINEAR",
        });
        let primitive = json!({
            "attributes": attributes,
            "indices": indices,
            "material": 0,
            "targets": shapes,
        });
        let channel = json!({"sampler": 0, "target": {"node": 0, "path": "weights"}});
        file.finish(json!({
            "asset": {"version": "2.0", "generator": "bevy_drape"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": name, "mesh": 0}],
            "materials": [{"doubleSided": true}],
            "meshes": [{"name": name, "primitives": [primitive], "weights": vec![0.0; targets]}],
            "animations": [{"name": "cloth", "samplers": [sampler], "channels": [channel]}],
        }))
    }
}

/// The corners of a mesh's triangles, if it has any, and all of them exist.
fn corners(mesh: &Mesh) -> Option<Vec<u32>> {
    let is_list = mesh.primitive_topology() == PrimitiveTopology::TriangleList;
    let indices = mesh.try_indices().ok().filter(|_| is_list)?;
    let indices: Vec<u32> = indices.iter().map(|index| index as u32).collect();
    let vertices = mesh.count_vertices() as u32;
    let is_whole = !indices.is_empty() && indices.len().is_multiple_of(3);
    let exist = indices.iter().all(|index| *index < vertices);
    (is_whole && exist).then_some(indices)
}

/// Whether there are finite texture coordinates for each vertex.
fn is_texture(uvs: &[[f32; 2]], vertices: usize) -> bool {
    uvs.len() == vertices && uvs.as_flattened().iter().all(|at| at.is_finite())
}

/// A file's numbers, and where they are in it.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Adds positions and normals, and returns the accessors of both.
    fn add_shape(&mut self, positions: &[Vec3], normals: &[Vec3]) -> Value {
        let [positions, normals] =
            [positions, normals].map(|of| of.iter().map(Vec3::to_array).collect::<Vec<_>>());
        json!({
            "POSITION": self.add_floats(&positions, Some(ARRAY_BUFFER)),
            "NORMAL": self.add_floats(&normals, Some(ARRAY_BUFFER)),
        })
    }

    /// Adds values of N numbers each, for this use if for any, and returns the index of their accessor.
    fn add_floats<const N: usize>(&mut self, values: &[[f32; N]], target: Option<u32>) -> Value {
        let kind = ["", "SCALAR", "VEC2", "VEC3"][N];
        let fold = |start: f32, f: fn(f32, f32) -> f32| {
            let of = |at: usize| values.iter().map(move |value| value[at]).fold(start, f);
            Vec::from_iter((0..N).map(of))
        };
        let min = fold(f32::INFINITY, f32::min);
        let max = fold(f32::NEG_INFINITY, f32::max);
        let start = self.bytes.len();
        let numbers = values.as_flattened().iter();
        let bytes = numbers.flat_map(|number| number.to_le_bytes());
        self.bytes.extend(bytes);
        self.accessor(start, json!({"componentType": FLOAT, "count": values.len(), "type": kind, "min": min, "max": max}), target)
    }

    fn add_indices(&mut self, indices: &[u32]) -> Value {
        let start = self.bytes.len();
        let bytes = indices.iter().flat_map(|index| index.to_le_bytes());
        self.bytes.extend(bytes);
        let count = indices.len();
        let accessor = json!({"componentType": UNSIGNED_INT, "count": count, "type": "SCALAR"});
        self.accessor(start, accessor, Some(ELEMENT_ARRAY_BUFFER))
    }

    /// Describes the bytes from `start` on.
    fn accessor(&mut self, start: usize, mut accessor: Value, target: Option<u32>) -> Value {
        let length = self.bytes.len() - start;
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": length});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        json!(self.accessors.len() - 1)
    }

    /// The whole file: a header, the description and the numbers (glTF 2.0, section 4.4).
    fn finish(self, mut description: Value) -> Result<Vec<u8>, BakeError> {
        description["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        description["bufferViews"] = json!(self.views);
        description["accessors"] = json!(self.accessors);
        let mut text = description.to_string().into_bytes();
        // Each chunk is a multiple of four bytes; numbers are.
        text.resize(text.len().next_multiple_of(4), b' ');
        let bytes = 12 + 8 + text.len() + 8 + self.bytes.len();
        let size = u32::try_from(bytes).map_err(|_| BakeError::TooLarge { bytes })?;
        let mut file = Vec::with_capacity(bytes);
        let put = |file: &mut Vec<u8>, numbers: &[u32]| {
            file.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        };
        // Both chunks are smaller than the file.
        put(&mut file, &[MAGIC, 2, size, text.len() as u32, JSON_CHUNK]);
        file.extend(text);
        put(&mut file, &[self.bytes.len() as u32, BINARY_CHUNK]);
        file.extend(self.bytes);
        Ok(file)
    }
}
