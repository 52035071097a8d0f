//! Triangle meshes: a sheet, a skirt and a sphere.

use std::{collections::BTreeMap, f32::consts::TAU};

use bevy::math::Vec3;

/// Places of vertices (m), and triangles with normals to one side: up, or outwards.
pub struct Mesh {
    pub places: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// A level square of `side`² vertices, `width` m wide, around the y axis. The diagonals alternate.
pub fn sheet(side: u32, width: f32) -> Mesh {
    let along = |index: u32| width * (index as f32 / (side - 1) as f32 - 0.5);
    strips([side, side], side - 1, |row, column| {
        Vec3::new(along(column), 0.0, along(row))
    })
}

/// A skirt of `down` rings of `around` vertices each, whose pleats grow towards its hem. Its waist is at y = 0.
pub fn skirt(around: u32, down: u32) -> Mesh {
    strips([down, around], around, |ring, column| {
        let low = ring as f32 / (down - 1) as f32;
        let angle = TAU * column as f32 / around as f32;
        let radius = 0.165 + 0.19 * low + 0.02 * low * (12.0 * angle).cos();
        Vec3::new(radius * angle.cos(), -0.55 * low, radius * angle.sin())
    })
}

/// Vertices in rows, and squares between them, so many in each row: as many as it has vertices if it is closed.
fn strips([rows, columns]: [u32; 2], squares: u32, at: impl Fn(u32, u32) -> Vec3) -> Mesh {
    let all = |rows: u32, columns: u32| {
        (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
    };
    let places = all(rows, columns).map(|(row, column)| at(row, column));
    let index = |row: u32, column: u32| row * columns + column % columns;
    let triangles = all(rows - 1, squares).flat_map(|(row, column)| {
        let [a, b] = [0, 1].map(|right| index(row, column + right));
        let [c, d] = [0, 1].map(|right| index(row + 1, column + right));
        if (row + column) % 2 == 0 {
            [[a, c, b], [b, c, d]]
        } else {
            [[a, c, d], [a, d, b]]
        }
    });
    Mesh {
        places: places.collect(),
        triangles: triangles.collect(),
    }
}

/// A sphere from an icosahedron, each edge of which is cut into so many: 10 × parts² + 2 vertices.
pub fn sphere(parts: u32, radius: f32) -> Mesh {
    let (corners, faces) = icosahedron();
    let mut mesh = Mesh {
        places: Vec::new(),
        triangles: Vec::new(),
    };
    // A vertex is known by how much of each corner is in it.
    let mut known: BTreeMap<Vec<(usize, u32)>, u32> = BTreeMap::new();
    for face in faces {
        let mut vertex = |row: u32, column: u32| {
            let amounts = [parts - row, row - column, column];
            let mut parted: Vec<(usize, u32)> = face.into_iter().zip(amounts).collect();
            parted.retain(|(_, amount)| *amount > 0);
            parted.sort_unstable();
            *known.entry(parted).or_insert_with_key(|parted| {
                let sum: Vec3 = parted
                    .iter()
                    .map(|(corner, amount)| corners[*corner] * *amount as f32)
                    .sum();
                mesh.places.push(radius * sum.normalize());
                mesh.places.len() as u32 - 1
            })
        };
        let mut triangles = Vec::new();
        for row in 0..parts {
            for column in 0..=row {
                let [a, b] = [vertex(row, column), vertex(row + 1, column)];
                let c = vertex(row + 1, column + 1);
                triangles.push([a, b, c]);
                if column < row {
                    triangles.push([a, c, vertex(row, column + 1)]);
                }
            }
        }
        mesh.triangles.extend(triangles);
    }
    mesh
}

/// Corners, and faces with normals outwards.
fn icosahedron() -> ([Vec3; 12], Vec<[usize; 3]>) {
    let golden = f32::midpoint(1.0, 5.0_f32.sqrt());
    let mut corners = [Vec3::ZERO; 12];
    for (index, corner) in corners.iter_mut().enumerate() {
        let sign = |bit: usize| if index & bit == 0 { 1.0 } else { -1.0 };
        let [one, long] = [sign(1), golden * sign(2)];
        *corner = match index / 4 {
            0 => Vec3::new(0.0, one, long),
            1 => Vec3::new(one, long, 0.0),
            _ => Vec3::new(long, 0.0, one),
        };
    }
    // Neighbours are 2 apart.
    let is_edge = |a: usize, b: usize| (corners[a].distance(corners[b]) - 2.0).abs() < 0.1;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if is_edge(a, b) && is_edge(b, c) && is_edge(a, c) {
                    let normal = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
                    let is_outwards = normal.dot(corners[a]) > 0.0;
                    faces.push(if is_outwards { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    (corners, faces)
}

/// The volume (m³) that a closed mesh encloses, by its flat triangles.
pub fn volume(places: &[[f32; 3]], triangles: &[[u32; 3]]) -> f64 {
    let place = |vertex: u32| Vec3::from_array(places[vertex as usize]).as_dvec3();
    let each = triangles.iter().map(|corners| {
        let [a, b, c] = corners.map(place);
        a.dot(b.cross(c)) / 6.0
    });
    each.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    /// How often each edge is run through, in one direction and in the other.
    fn edges(mesh: &Mesh) -> BTreeMap<[u32; 2], [u32; 2]> {
        let mut edges: BTreeMap<[u32; 2], [u32; 2]> = BTreeMap::new();
        for &[a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let sides = edges.entry([from.min(to), from.max(to)]).or_default();
                sides[usize::from(from > to)] += 1;
            }
        }
        edges
    }

    fn area(mesh: &Mesh) -> f32 {
        let each = mesh.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| mesh.places[corner as usize].as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        });
        each.sum::<f64>() as f32
    }

    /// Edges with one triangle, after a check that no other is twisted or has three.
    fn border(mesh: &Mesh) -> usize {
        let edges = edges(mesh);
        assert!(edges.values().flatten().all(|count| *count <= 1));
        let single = |sides: &&[u32; 2]| sides[0] + sides[1] == 1;
        edges.values().filter(single).count()
    }

    #[test]
    fn a_sheet_is_flat_and_faces_up() {
        let mesh = sheet(64, 2.0);
        assert_eq!([mesh.places.len(), mesh.triangles.len()], [4096, 7938]);
        assert!((area(&mesh) - 4.0).abs() < 1.0e-4);
        assert_eq!(border(&mesh), 4 * 63);
        assert!(mesh.triangles.iter().all(|corners| {
            let [a, b, c] = corners.map(|corner| mesh.places[corner as usize]);
            (b - a).cross(c - a).y > 0.0
        }));
    }

    #[test]
    fn a_skirt_is_open_above_and_below() {
        let mesh = skirt(96, 32);
        assert_eq!(
            [mesh.places.len(), mesh.triangles.len()],
            [3072, 2 * 96 * 31]
        );
        assert_eq!(border(&mesh), 2 * 96);
        // A cone of the same rings without pleats: they only add.
        let (top, low, slant) = (0.165, 0.355, 0.55_f32.hypot(0.19));
        let cone = PI * (top + low) * slant;
        let area = area(&mesh);
        assert!(area > cone && area < 1.2 * cone, "{area} {cone}");
    }

    #[test]
    fn a_sphere_is_closed_and_faces_outwards() {
        let mesh = sphere(13, 0.3);
        assert_eq!([mesh.places.len(), mesh.triangles.len()], [1692, 3380]);
        assert_eq!(border(&mesh), 0);
        assert!(
            mesh.places
                .iter()
                .all(|place| (place.length() - 0.3).abs() < 1.0e-6)
        );
        // Flat triangles are a little smaller than the sphere.
        let places: Vec<[f32; 3]> = mesh.places.iter().map(Vec3::to_array).collect();
        let part = volume(&places, &mesh.triangles) as f32 / (4.0 / 3.0 * PI * 0.3_f32.powi(3));
        assert!(part < 1.0 && part > 0.99, "{part}");
        let part = area(&mesh) / (4.0 * PI * 0.3 * 0.3);
        assert!(part < 1.0 && part > 0.99, "{part}");
    }

    #[test]
    fn a_volume_does_not_depend_on_the_place() {
        let mesh = sphere(2, 1.0);
        let moved = |by: Vec3| -> Vec<[f32; 3]> {
            let places = mesh.places.iter();
            places.map(|place| (*place + by).to_array()).collect()
        };
        let [here, there] =
            [Vec3::ZERO, Vec3::new(3.0, -2.0, 5.0)].map(|by| volume(&moved(by), &mesh.triangles));
        assert!((here - there).abs() < 1.0e-5, "{here} {there}");
    }
}
