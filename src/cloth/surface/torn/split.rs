//! Splits particles into parts.

use std::sync::Arc;

use crate::cloth::surface::{Surface, Torn};

impl Torn {
    /// Splits the particles of a whole surface along edges.
    pub fn new(whole: &Arc<Surface>, edges: &[[u32; 2]]) -> Self {
        let mut torn = Self {
            whole: whole.clone(),
            corners: whole.triangles().to_vec(),
            origin: (0..whole.len() as u32).collect(),
        };
        let mut ends: Vec<(u32, usize, u32)> = Vec::with_capacity(2 * edges.len());
        for (time, [a, b]) in edges.iter().enumerate() {
            ends.extend([(*a, time, *b), (*b, time, *a)]);
        }
        ends.sort_unstable();
        let mut parts = Vec::new();
        for at in ends.chunk_by(|a, b| a.0 == b.0) {
            torn.split(at, &mut parts);
        }
        // As they came off.
        parts.sort_unstable();
        for Part { particle, face, .. } in &parts {
            let copy = torn.origin.len() as u32;
            torn.origin.push(*particle);
            let of = ends.partition_point(|(end, ..)| end < particle)..;
            let edges = ends[of].iter().take_while(|(end, ..)| end == particle);
            let others: Vec<u32> = edges.map(|(.., other)| *other).collect();
            for (own, at) in pieces(whole, *particle, &others) {
                if at == *face {
                    let corners = torn.corners[own as usize].iter_mut();
                    (corners.filter(|corner| **corner == *particle))
                        .for_each(|corner| *corner = copy);
                }
            }
        }
        torn
    }

    /// Finds the parts that come off a particle with one torn edge after the other.
    fn split(&self, edges: &[(u32, usize, u32)], parts: &mut Vec<Part>) {
        let particle = edges[0].0;
        let mut known: Vec<u32> = (pieces(&self.whole, particle, &[]).into_iter())
            .map(|(_, piece)| piece)
            .collect();
        for count in 1..=edges.len() {
            let others: Vec<u32> = edges[..count].iter().map(|(.., other)| *other).collect();
            for (_, face) in pieces(&self.whole, particle, &others) {
                if !known.contains(&face) {
                    known.push(face);
                    parts.push(Part {
                        time: edges[count - 1].1,
                        particle,
                        face,
                    });
                }
            }
        }
    }
}

/// A part of a particle that came off.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Part {
    /// The edge whose tear took it off.
    time: usize,
    particle: u32,
    /// The first of its faces.
    face: u32,
}

/// The faces at a particle, each with the first face of its piece: faces hang together at edges that are not torn, which
/// lead to `others`.
fn pieces(surface: &Surface, particle: u32, others: &[u32]) -> Vec<(u32, u32)> {
    let around = surface.incidence().around(particle);
    let faces = surface.triangles();
    let mut pieces: Vec<(u32, u32)> = around.iter().map(|face| (*face, *face)).collect();
    for one in 0..around.len() {
        for two in 0..one {
            let corners = faces[around[one] as usize];
            let shares = |corner: &u32| faces[around[two] as usize].contains(corner);
            let holds = |corner: &u32| *corner != particle && !others.contains(corner);
            if corners.iter().any(|corner| holds(corner) && shares(corner)) {
                let (a, b) = (pieces[one].1, pieces[two].1);
                let joined = a.min(b);
                for (_, piece) in &mut pieces {
                    if *piece == a || *piece == b {
                        *piece = joined;
                    }
                }
            }
        }
    }
    pieces
}
