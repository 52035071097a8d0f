//! The width of a cut.

use bevy::math::Vec3;

use crate::cloth::Surface;

/// How far a cut moves its sides apart, each at most, as a fraction of the way to the middles of the faces around.
const HALF_WIDTH: f32 = 0.02;

/// A corner of a face, at an end of one of its two edges.
#[derive(Clone, Copy)]
struct Corner {
    /// The parent of this particle, and what the edge's other end was before anything was torn.
    edge: [u32; 2],
    particle: u32,
    /// Direction across the edge, into the face.
    inward: Vec3,
    /// The way to the middle of the face (m).
    middle: Vec3,
}

impl Surface {
    /// The places of all particles (m), with a little room between those that have one parent: a cut has a width. So contact of
    /// cloth with cloth knows which side each is on. Those of one parent are at one place before.
    ///
    /// Let a and b be the directions across a torn edge into its two faces. The faces pass each other only if a's moves against b's along
    /// a direction between b and −a. All of these are at a right angle or more to a − b, along which the edge opens. A side between two
    /// torn edges moves along the sum of both, which opens both.
    pub(crate) fn parted(&self, places: &[Vec3], parent: impl Fn(u32) -> u32) -> Vec<Vec3> {
        let mut parted = places.to_vec();
        let corners = self.corners_of_split(places, parent);
        for around in corners.chunk_by(|a, b| a.edge[0] == b.edge[0]) {
            let sizes = around.iter().map(|corner| corner.middle.length());
            let size = sizes.sum::<f32>() / around.len() as f32;
            let mut moves: Vec<(u32, Vec3)> = Vec::new();
            let edges = around.chunk_by(|a, b| a.edge == b.edge);
            for sides in edges.flat_map(|faces| faces.windows(2)) {
                let [a, b] = [sides[0], sides[1]];
                let away = (a.inward - b.inward).normalize_or_zero();
                if a.particle != b.particle && away != Vec3::ZERO {
                    moves.extend([(a.particle, away), (b.particle, -away)]);
                }
            }
            // A side that met the others in a point alone, or is folded onto them, moves to the middles of its faces.
            let is_alone = |corner: &&Corner| moves.iter().all(|(of, _)| *of != corner.particle);
            let to_middle = |corner: &Corner| (corner.particle, corner.middle.normalize_or_zero());
            let alone: Vec<_> = around.iter().filter(is_alone).map(to_middle).collect();
            moves.extend(alone);
            moves.sort_by_key(|(of, _)| *of);
            let each = moves.chunk_by(|a, b| a.0 == b.0);
            let each = each.map(|of| (of[0].0, of.iter().map(|(_, by)| by).sum::<Vec3>()));
            let farthest = each.clone().map(|(_, by)| by.length()).fold(0.0, f32::max);
            for (particle, by) in each.filter(|_| farthest > 0.0) {
                parted[particle as usize] += by * (HALF_WIDTH * size / farthest);
            }
        }
        parted
    }

    /// The corners of faces at particles that have a parent in common with others, by edge.
    fn corners_of_split(&self, places: &[Vec3], parent: impl Fn(u32) -> u32) -> Vec<Corner> {
        // A surface that is mended has fewer particles than their parents were.
        let parents = || (0..self.len() as u32).map(|child| parent(child) as usize);
        let mut children = vec![0_u32; parents().max().map_or(0, |last| last + 1)];
        parents().for_each(|parent| children[parent] += 1);
        let across = |way: Vec3, along: Vec3| {
            let way = way.reject_from_normalized(along.normalize_or_zero());
            way.normalize_or_zero()
        };
        let mut corners = Vec::new();
        for face in self.triangles() {
            for at in 0..3 {
                let particle = face[at];
                if children[parent(particle) as usize] < 2 {
                    continue;
                }
                let others = [face[(at + 1) % 3], face[(at + 2) % 3]];
                let ways = others.map(|other| places[other as usize] - places[particle as usize]);
                corners.extend([[0, 1], [1, 0]].map(|[along, third]| Corner {
                    edge: [parent(particle), self.origin_of(others[along])],
                    particle,
                    inward: across(ways[third], ways[along]),
                    middle: (ways[0] + ways[1]) / 3.0,
                }));
            }
        }
        corners.sort_by_key(|corner| (corner.edge, corner.particle));
        corners
    }
}
