//! A cloth's motion as a glTF file with morph targets.

use bevy::{
    math::Vec3,
    mesh::{Mesh, PrimitiveTopology, VertexAttributeValues},
};
use serde_json::{Value, json};
use thiserror::Error;

/// Morph targets that Bevy draws at most, one a frame but the first.
const MAX_TARGETS: usize = 256;

/// Numbers of the glTF 2.0 specification: types of components, uses of buffers, and marks of the file and its chunks.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const MAGIC: usize = 0x4654_6C67;
const JSON_CHUNK: usize = 0x4E4F_534A;
const BINARY_CHUNK: usize = 0x004E_4942;

/// Records the mesh of a cloth frame by frame, for a file that plays its motion without simulating it: for cloth far away,
/// or on weak machines (feature `bake`).
///
/// It takes any mesh whose vertices move: that of a cloth, or one that a cloth drives by a
/// [`ClothRenderMesh`](crate::plugin::ClothRenderMesh). Vertices are in the entity's own frame, so whoever plays the file moves the
/// entity. Between frames they move in straight lines.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// #[derive(Resource, Default)]
/// struct Baking(ClothBake);
///
/// /// In `Last`, once the mesh is written.
/// fn record(cloth: Single<&Mesh3d, With<Cloth>>, meshes: Res<Assets<Mesh>>, mut baking: ResMut<Baking>) -> Result {
///     let Some(mesh) = meshes.get(*cloth) else { return Ok(()) };
///     baking.0.record(mesh)?;
///     if baking.0.frames() == 128 {
///         std::fs::write("flag.glb", baking.0.to_glb("flag", 1.0 / 64.0)?)?;
///     }
///     Ok(())
/// }
/// # bevy::ecs::system::assert_is_system(record);
/// ```
#[derive(Debug, Default, Clone)]
pub struct ClothBake {
    /// Corners of each triangle, and texture coordinates of the vertices, if there are any.
    indices: Vec<u32>,
    uvs: Vec<[f32; 2]>,
    frames: Vec<Frame>,
}

/// Positions (m) and normals of the vertices.
#[derive(Debug, Clone)]
struct Frame {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// The reason why a mesh cannot be recorded, or a recording not be written.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The mesh is no list of triangles with positions and normals, or only in the render world.
    #[error("a mesh to record needs triangles, positions and normals in the main world")]
    Unreadable,
    /// The mesh has not as many vertices as in the first frame.
    #[error("the mesh has {found} vertices, and had {expected} in the first frame")]
    OtherMesh {
        /// Number of vertices of the first frame.
        expected: usize,
        /// Number of vertices found.
        found: usize,
    },
    /// A vertex is not finite.
    #[error("vertex {vertex} is not finite")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// Fewer than two frames, or more than Bevy plays.
    #[error("{frames} frames were recorded: there must be 2 to 257")]
    Frames {
        /// Number of frames.
        frames: usize,
    },
    /// The time from one frame to the next is not positive and finite.
    #[error("the time from frame to frame must be positive and finite, not {seconds} s")]
    Interval {
        /// The time (s).
        seconds: f32,
    },
}

impl ClothBake {
    /// Adds a frame: the vertices as they are now.
    ///
    /// # Errors
    /// [`BakeError::Unreadable`], [`BakeError::OtherMesh`] or [`BakeError::NotFinite`]; no frame is added then.
    pub fn record(&mut self, mesh: &Mesh) -> Result<(), BakeError> {
        let vectors = |of| -> Option<Vec<Vec3>> {
            let values = mesh.try_attribute(of).ok()?.as_float3()?;
            Some(values.iter().map(|value| Vec3::from(*value)).collect())
        };
        let frame = vectors(Mesh::ATTRIBUTE_POSITION).zip(vectors(Mesh::ATTRIBUTE_NORMAL));
        let Some((positions, normals)) = frame else {
            return Err(BakeError::Unreadable);
        };
        let found = positions.len();
        let both = positions.iter().zip(&normals);
        if let Some(vertex) = both
            .clone()
            .position(|(a, b)| !(a.is_finite() && b.is_finite()))
        {
            return Err(BakeError::NotFinite { vertex });
        }
        match self.frames.first().map(|first| first.positions.len()) {
            Some(expected) if expected != found => {
                return Err(BakeError::OtherMesh { expected, found });
            }
            Some(_) => {}
            None => {
                let indices = mesh.try_indices().ok();
                let indices = indices
                    .filter(|_| mesh.primitive_topology() == PrimitiveTopology::TriangleList);
                let indices = indices.ok_or(BakeError::Unreadable)?;
                self.indices = indices.iter().map(|index| index as u32).collect();
                self.uvs = match mesh.try_attribute(Mesh::ATTRIBUTE_UV_0) {
                    Ok(VertexAttributeValues::Float32x2(uvs)) => uvs.clone(),
                    _ => Vec::new(),
                };
            }
        }
        self.frames.push(Frame { positions, normals });
        Ok(())
    }

    /// Number of frames recorded.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// A binary glTF file: a node and a mesh of this name, and an animation `cloth` with `seconds` from frame to frame. It
    /// holds 24 bytes for each vertex and frame.
    ///
    /// # Errors
    /// [`BakeError::Frames`] or [`BakeError::Interval`].
    pub fn to_glb(&self, name: &str, seconds: f32) -> Result<Vec<u8>, BakeError> {
        let frames = self.frames.len();
        if !(seconds > 0.0 && seconds.is_finite()) {
            return Err(BakeError::Interval { seconds });
        }
        let Some(first) = self.frames.first() else {
            return Err(BakeError::Frames { frames });
        };
        if !(2..=MAX_TARGETS + 1).contains(&frames) {
            return Err(BakeError::Frames { frames });
        }
        let mut file = File::default();
        let mut attributes = file.shape(&first.positions, &first.normals);
        if !self.uvs.is_empty() {
            attributes["TEXCOORD_0"] = file.add(&self.uvs, Some(ARRAY_BUFFER));
        }
        let indices = file.add_indices(&self.indices);
        let targets: Vec<Value> = self.frames[1..]
            .iter()
            .map(|frame| {
                let offsets = |of: &[Vec3], from: &[Vec3]| -> Vec<Vec3> {
                    of.iter().zip(from).map(|(to, from)| *to - *from).collect()
                };
                let moved = offsets(&frame.positions, &first.positions);
                file.shape(&moved, &offsets(&frame.normals, &first.normals))
            })
            .collect();
        let times: Vec<[f32; 1]> = (0..frames).map(|frame| [frame as f32 * seconds]).collect();
        // In each frame its own target counts alone; in the first, none.
        let weight = |at: usize| {
            [f32::from(u8::from(
                at / targets.len() == at % targets.len() + 1,
            ))]
        };
        let weights: Vec<[f32; 1]> = (0..frames * targets.len()).map(weight).collect();
        let sampler = json!({
            "input": file.add(&times, None),
            "output": file.add(&weights, None),
            "interpolation": "LINEAR",
        });
        let weights = vec![0.0; targets.len()];
        let primitive = json!({"attributes": attributes, "indices": indices, "targets": targets});
        let channel = json!({"sampler": 0, "target": {"node": 0, "path": "weights"}});
        Ok(file.finish(json!({
            "asset": {"version": "2.0", "generator": "bevy_drape"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": name, "mesh": 0}],
            "meshes": [{"name": name, "primitives": [primitive], "weights": weights}],
            "animations": [{"name": "cloth", "samplers": [sampler], "channels": [channel]}],
        })))
    }
}

/// A file's numbers, and where they are in it.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Adds positions and normals, and returns the names of both.
    fn shape(&mut self, positions: &[Vec3], normals: &[Vec3]) -> Value {
        let [positions, normals] =
            [positions, normals].map(|of| of.iter().map(Vec3::to_array).collect::<Vec<_>>());
        json!({
            "POSITION": self.add(&positions, Some(ARRAY_BUFFER)),
            "NORMAL": self.add(&normals, Some(ARRAY_BUFFER)),
        })
    }

    /// Adds values of N numbers each, for this use if for any, and returns the index of their accessor.
    fn add<const N: usize>(&mut self, values: &[[f32; N]], target: Option<u32>) -> Value {
        let kind = ["", "SCALAR", "VEC2", "VEC3"][N];
        let fold = |start: f32, f: fn(f32, f32) -> f32| {
            let each = values.iter();
            each.fold([start; N], |best, value| {
                std::array::from_fn(|at| f(best[at], value[at]))
            })
            .to_vec()
        };
        let (min, max) = (
            fold(f32::INFINITY, f32::min),
            fold(f32::NEG_INFINITY, f32::max),
        );
        let start = self.bytes.len();
        let numbers = values.as_flattened().iter();
        self.bytes
            .extend(numbers.flat_map(|number| number.to_le_bytes()));
        self.accessor(start, json!({"componentType": FLOAT, "count": values.len(), "type": kind, "min": min, "max": max}), target)
    }

    fn add_indices(&mut self, indices: &[u32]) -> Value {
        let start = self.bytes.len();
        self.bytes
            .extend(indices.iter().flat_map(|index| index.to_le_bytes()));
        let accessor =
            json!({"componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR"});
        self.accessor(start, accessor, Some(ELEMENT_ARRAY_BUFFER))
    }

    /// Describes the bytes from `start` on.
    fn accessor(&mut self, start: usize, mut accessor: Value, target: Option<u32>) -> Value {
        let mut view =
            json!({"buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        json!(self.accessors.len() - 1)
    }

    /// The whole file: a header, the description and the numbers (glTF 2.0, section 4.4).
    fn finish(self, mut description: Value) -> Vec<u8> {
        description["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        description["bufferViews"] = json!(self.views);
        description["accessors"] = json!(self.accessors);
        let mut text = description.to_string().into_bytes();
        // Each chunk is a multiple of four bytes; numbers are.
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut file = Vec::new();
        let mut put = |number: usize| file.extend((number as u32).to_le_bytes());
        put(MAGIC);
        put(2);
        put(12 + 8 + text.len() + 8 + self.bytes.len());
        put(text.len());
        put(JSON_CHUNK);
        file.extend(text);
        let mut put = |number: usize| file.extend((number as u32).to_le_bytes());
        put(self.bytes.len());
        put(BINARY_CHUNK);
        file.extend(self.bytes);
        file
    }
}
