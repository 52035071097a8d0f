//! Uniform spatial hashes: of points, and of a cloth's vertices and edges.

use bevy::math::{IVec3, Vec3, Vec3A};
use bevy_drape::cloth::Surface;

/// Points in the cells of a grid without bounds, sorted by the hash of their cell (Teschner et al. 2003; counted as Müller does).
#[derive(Debug, Default)]
pub struct Hash {
    cells: Vec<IVec3>,
    /// Where each bucket begins among the entries, and, behind the last, where it ends.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Hash {
    /// Names all pairs of points that are nearer to each other than `reach` (m), each once.
    pub fn find(&mut self, points: &[Vec3A], reach: f32, mut found: impl FnMut(u32, u32)) {
        self.sort(points, reach);
        let squared = reach * reach;
        for (index, (point, cell)) in points.iter().zip(&self.cells).enumerate() {
            for (number, step) in AHEAD.iter().enumerate() {
                let other = *cell + *step;
                for near in self.of(other) {
                    // In the own cell each pair counts once.
                    let is_named = number > 0 || near < index as u32;
                    if is_named && points[near as usize].distance_squared(*point) < squared {
                        found(index as u32, near);
                    }
                }
            }
        }
    }

    /// Sorts points into cells of this size (m).
    fn sort(&mut self, points: &[Vec3A], size: f32) {
        self.cells.clear();
        let cells = points.iter().map(|point| cell_of(*point, size));
        self.cells.extend(cells);
        let buckets = (2 * points.len()).next_power_of_two();
        let Self {
            cells,
            starts,
            entries,
        } = self;
        starts.clear();
        starts.resize(buckets + 1, 0);
        for cell in &*cells {
            starts[hash(*cell, buckets)] += 1;
        }
        let mut end = 0;
        for start in &mut *starts {
            end += *start;
            *start = end;
        }
        entries.clear();
        entries.resize(cells.len(), 0);
        for (index, cell) in cells.iter().enumerate() {
            let start = &mut starts[hash(*cell, buckets)];
            *start -= 1;
            entries[*start as usize] = index as u32;
        }
    }

    /// The points of a cell: others with the same hash are left out.
    fn of(&self, cell: IVec3) -> impl Iterator<Item = u32> + '_ {
        let at = hash(cell, self.starts.len() - 1);
        let [from, to] = [self.starts[at], self.starts[at + 1]];
        let all = self.entries[from as usize..to as usize].iter().copied();
        all.filter(move |&point| self.cells[point as usize] == cell)
    }

    /// The points of all cells, of the size that they were sorted by (m), that a box meets.
    fn within(&self, [low, high]: [Vec3A; 2], size: f32) -> impl Iterator<Item = u32> + '_ {
        let [low, high] = [low, high].map(|corner| cell_of(corner, size));
        let cells = (low.z..=high.z).flat_map(move |z| {
            (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
        });
        cells.flat_map(|cell| self.of(cell))
    }
}

/// A cloth's vertices and edges in cells, searched once: what contact of vertices with faces and edges with edges would ask a hash for.
/// It only finds: nothing is done about the pairs.
#[derive(Debug)]
pub struct FeatureHash {
    faces: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    /// Of an edge at rest, the longest, and the shortest spacing (m).
    longest: f32,
    shortest: f32,
    places: Vec<Vec3A>,
    middles: Vec<Vec3A>,
    vertices_in: Hash,
    edges_in: Hash,
}

/// The margin of the search, as a part of the shortest spacing: the plugin's own, unless things are fast.
const MARGIN: f32 = 0.25;

impl FeatureHash {
    pub fn new(surface: &Surface) -> Self {
        let faces = surface.triangles().to_vec();
        let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        let mut edges: Vec<[u32; 2]> = faces
            .iter()
            .flat_map(sides)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let rest = surface.rest_positions();
        let lengths = edges
            .iter()
            .map(|edge| rest[edge[0] as usize].distance(rest[edge[1] as usize]));
        Self {
            longest: lengths.fold(0.0, f32::max),
            shortest: surface.spacing().shortest,
            faces,
            edges,
            places: Vec::new(),
            middles: Vec::new(),
            vertices_in: Hash::default(),
            edges_in: Hash::default(),
        }
    }

    /// How many pairs, of a vertex with a face and of two edges without a particle in common, have boxes that are nearer to each other
    /// than a thickness (m) and the margin of a search.
    pub fn search(&mut self, places: impl Iterator<Item = Vec3>, thickness: f32) -> usize {
        let reach = Vec3A::splat(thickness + MARGIN * self.shortest);
        self.places.clear();
        self.places.extend(places.map(Vec3A::from));
        let Self {
            places,
            middles,
            edges,
            ..
        } = self;
        let ends = |edge: [u32; 2]| edge.map(|end| places[end as usize]);
        middles.clear();
        middles.extend(edges.iter().map(|&edge| {
            let [a, b] = ends(edge);
            (a + b) / 2.0
        }));
        let size = self.longest + reach.x;
        self.vertices_in.sort(places, size);
        self.edges_in.sort(middles, size);
        let mut count = 0;
        for face in &self.faces {
            let [a, b, c] = face.map(|corner| places[corner as usize]);
            let (low, high) = (a.min(b).min(c) - reach, a.max(b).max(c) + reach);
            let near = self.vertices_in.within([low, high], size);
            count += near
                .filter(|vertex| {
                    let place = places[*vertex as usize];
                    place.cmpge(low).all() && place.cmple(high).all() && !face.contains(vertex)
                })
                .count();
        }
        // By as much an edge reaches beyond its middle.
        let half = Vec3A::splat(self.longest / 2.0);
        for (index, edge) in self.edges.iter().enumerate() {
            let [a, b] = ends(*edge);
            let (low, high) = (a.min(b) - reach, a.max(b) + reach);
            let near = self.edges_in.within([low - half, high + half], size);
            count += near
                .filter(|&other| (other as usize) < index)
                .filter(|&other| {
                    let other = self.edges[other as usize];
                    let [c, d] = ends(other);
                    c.max(d).cmpge(low).all()
                        && c.min(d).cmple(high).all()
                        && !other.iter().any(|end| edge.contains(end))
                })
                .count();
        }
        count
    }
}

/// A cell itself, and half of those beside it: the others have it beside them.
const AHEAD: [IVec3; 14] = [
    IVec3::new(0, 0, 0),
    IVec3::new(1, 0, 0),
    IVec3::new(-1, 1, 0),
    IVec3::new(0, 1, 0),
    IVec3::new(1, 1, 0),
    IVec3::new(-1, -1, 1),
    IVec3::new(0, -1, 1),
    IVec3::new(1, -1, 1),
    IVec3::new(-1, 0, 1),
    IVec3::new(0, 0, 1),
    IVec3::new(1, 0, 1),
    IVec3::new(-1, 1, 1),
    IVec3::new(0, 1, 1),
    IVec3::new(1, 1, 1),
];

fn cell_of(point: Vec3A, size: f32) -> IVec3 {
    (point / size).floor().as_ivec3()
}

fn hash(cell: IVec3, buckets: usize) -> usize {
    let mixed = cell.x.wrapping_mul(73_856_093)
        ^ cell.y.wrapping_mul(19_349_663)
        ^ cell.z.wrapping_mul(83_492_791);
    mixed as u32 as usize & (buckets - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Random;

    #[test]
    fn a_hash_finds_what_brute_force_finds() {
        let mut random = Random(7);
        let points: Vec<Vec3A> = (0..400)
            .map(|_| Vec3A::from_array(std::array::from_fn(|_| random.between(-1.0, 1.0))))
            .collect();
        for reach in [0.05, 0.2, 0.9] {
            let mut found = Vec::new();
            let mut hash = Hash::default();
            hash.find(&points, reach, |a, b| found.push([a.min(b), a.max(b)]));
            found.sort_unstable();
            let mut truth = Vec::new();
            for a in 0..400 {
                for b in a + 1..400 {
                    if points[a].distance_squared(points[b]) < reach * reach {
                        truth.push([a as u32, b as u32]);
                    }
                }
            }
            assert_eq!(found, truth);
        }
    }
}
