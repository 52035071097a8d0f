//! A binary glTF file.

use serde_json::{Value, json};

/// What lies in its buffer, and what says so.
#[derive(Default)]
pub struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
}

impl File {
    fn add(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        while !self.bytes.len().is_multiple_of(4) {
            self.bytes.push(0);
        }
        self.views
            .push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }));
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": component, "type": kind, "count": count,
        }));
        self.accessors.len() - 1
    }

    /// Adds numbers, `N` to each element; returns which accessor they are.
    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = (values.as_flattened().iter())
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let kind = match N {
            1 => "SCALAR",
            3 => "VEC3",
            4 => "VEC4",
            16 => "MAT4",
            _ => "VEC2",
        };
        let accessor = self.add(&bytes, 5126, kind, values.len());
        // What positions and times have to say of themselves.
        let bound = |better: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..N)
                .map(|at| values.iter().map(|value| value[at]).reduce(better))
                .map(Option::unwrap_or_default)
                .collect()
        };
        self.accessors[accessor]["min"] = json!(bound(f32::min));
        self.accessors[accessor]["max"] = json!(bound(f32::max));
        accessor
    }

    pub fn joints(&mut self, values: &[[u16; 4]]) -> usize {
        let bytes: Vec<u8> = (values.as_flattened().iter())
            .flat_map(|value| value.to_le_bytes())
            .collect();
        self.add(&bytes, 5123, "VEC4", values.len())
    }

    pub fn indices(&mut self, triangles: &[[u16; 3]]) -> usize {
        let bytes: Vec<u8> = (triangles.as_flattened().iter())
            .flat_map(|index| index.to_le_bytes())
            .collect();
        self.add(&bytes, 5123, "SCALAR", 3 * triangles.len())
    }

    /// Adds a mesh of one primitive; returns which it is.
    pub fn mesh(&mut self, attributes: Value, indices: usize, material: usize) -> usize {
        self.meshes.push(json!({ "primitives": [{
            "attributes": attributes, "indices": indices, "material": material,
        }] }));
        self.meshes.len() - 1
    }

    /// The bytes of a file with the `rest` of what is to be said.
    pub fn finish(self, mut rest: Value) -> Vec<u8> {
        rest["asset"] = json!({ "version": "2.0" });
        rest["meshes"] = json!(self.meshes);
        rest["accessors"] = json!(self.accessors);
        rest["bufferViews"] = json!(self.views);
        rest["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        let mut text = rest.to_string().into_bytes();
        while !text.len().is_multiple_of(4) {
            text.push(b' ');
        }
        let word = |number: usize| (number as u32).to_le_bytes();
        let total = 12 + 8 + text.len() + 8 + self.bytes.len();
        let mut file = [*b"glTF", word(2), word(total), word(text.len()), *b"JSON"].concat();
        file.extend(&text);
        file.extend([word(self.bytes.len()), *b"BIN\0"].concat());
        file.extend(&self.bytes);
        file
    }
}
