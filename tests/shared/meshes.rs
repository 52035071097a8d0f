//! Meshes for tests and benchmarks. Whoever includes this file calls the crate `library`, as its own tests cannot name it
//! otherwise.

use bevy::{
    math::{Vec2, Vec3},
    platform::collections::HashMap,
};

use super::library::cloth::TriangleMesh;

/// An irregular mesh of a rectangle, `width` × `height` m, from (0, 0, 0) to (width, −height, 0). Its points are about
/// `spacing` m apart, each moved from its place in a grid by up to `jitter` spacings, with a Delaunay triangulation
/// (1934).
pub fn irregular(width: f32, height: f32, spacing: f32, jitter: f32) -> TriangleMesh {
    let [columns, rows] = [width, height].map(|side| (side / spacing).round().max(1.0) as u32);
    let mut random = Random(1);
    let mut positions = Vec::new();
    let mut uvs = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            let mut off = || jitter * random.next();
            // What is on a border stays there.
            let x = if column == 0 || column == columns {
                0.0
            } else {
                off()
            };
            let y = if row == 0 || row == rows { 0.0 } else { off() };
            let place = Vec2::new(
                (column as f32 + x) / columns as f32,
                (row as f32 + y) / rows as f32,
            );
            positions.push(Vec3::new(place.x * width, -place.y * height, 0.0));
            uvs.push(place);
        }
    }
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    while flip(&mut triangles, &positions) {}
    TriangleMesh {
        normals: vec![Vec3::Z; positions.len()],
        positions,
        triangles,
        uvs,
        attributes: Vec::new(),
    }
}

/// The mesh of a grid, two triangles a cell with the same diagonal everywhere: from (0, 0, 0) to (width, −height, 0).
pub fn regular(columns: u32, rows: u32, spacing: f32) -> TriangleMesh {
    let [width, height] = [columns, rows].map(|count| (count - 1) as f32 * spacing);
    let mut mesh = irregular(width, height, spacing, 0.0);
    mesh.triangles.clear();
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let a = row * columns + column;
            let (b, c, d) = (a + 1, a + columns, a + columns + 1);
            mesh.triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    mesh
}

/// Turns the edges whose two opposite angles are more than π together (Lawson 1977). Returns whether there were any.
fn flip(triangles: &mut [[u32; 3]], positions: &[Vec3]) -> bool {
    let mut sides: HashMap<[u32; 2], (usize, u32)> = HashMap::default();
    let mut is_changed = vec![false; triangles.len()];
    let mut flips = Vec::new();
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        for (edge, opposite) in [([a, b], c), ([b, c], a), ([c, a], b)] {
            sides.insert(edge, (index, opposite));
        }
    }
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        for ([a, b], c) in [([a, b], c), ([b, c], a), ([c, a], b)] {
            let Some(&(other, d)) = sides.get(&[b, a]) else {
                continue;
            };
            let at = |corner: u32| positions[corner as usize];
            let angle = |corner: u32| (at(a) - at(corner)).angle_between(at(b) - at(corner));
            let is_free = index < other && !is_changed[index] && !is_changed[other];
            if is_free && angle(c) + angle(d) > std::f32::consts::PI + 1.0e-4 {
                (is_changed[index], is_changed[other]) = (true, true);
                flips.push((index, [c, a, d]));
                flips.push((other, [d, b, c]));
            }
        }
    }
    for (index, triangle) in &flips {
        triangles[*index] = *triangle;
    }
    !flips.is_empty()
}

/// Numbers that look random, the same each time (Marsaglia 2003, `xorshift`).
struct Random(u32);

impl Random {
    /// From −1 to 1.
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(2_654_435_761).wrapping_add(97);
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}
