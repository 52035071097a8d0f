//! Chains of a mesh: paths along its edges that go straight on, like the rows, columns and diagonals of a grid.
//!
//! The springs of a chain are solved together, so that the pull of one reaches the others at once. At each particle,
//! the pairs of edges that best continue each other are joined first. Edges that remain are on no chain.
//!
//! "Straight on" is meant on the surface: edges are projected along the normal at their particle, so that a line around
//! a cylinder is straight.

#[cfg(test)]
mod tests;

use bevy::math::{Vec2, Vec3};

use crate::cloth::grouped::Grouped;

/// The cosine of the smallest angle between two edges that continue each other: 135°.
const STRAIGHT: f32 = -std::f32::consts::FRAC_1_SQRT_2;

/// Number of bits in a particle's mask.
const MAX_COLOURS: u32 = 64;

/// Marks the absence of an edge.
const NONE: u32 = u32::MAX;

/// A path along edges that visits no particle twice.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Chain {
    /// Its first particle.
    pub first: u32,
    /// Two or more edges, or the springs along them.
    pub edges: Vec<u32>,
}

/// The chains of a surface, sorted by colour. No two of one colour share a particle, so that they are solved in
/// parallel. Within a colour, longer chains come first.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub(crate) struct Chains {
    /// The chains of each colour.
    pub colours: Vec<Vec<Chain>>,
}

impl Chains {
    /// Finds the chains along `edges`, between particles with these positions at rest (m) and normals of length 1. No
    /// two edges have the same ends.
    pub fn trace(edges: &[[u32; 2]], rest: &[Vec3], normals: impl Fn(u32) -> Vec3) -> Self {
        let next = continuations(edges, rest, normals);
        let mut walk = Walk {
            edges,
            next: &next,
            is_passed: vec![false; edges.len()],
            seen: vec![NONE; rest.len()],
            chains: Vec::new(),
        };
        // First open paths, from their ends; the remaining paths are closed.
        for (edge, ends) in next.iter().enumerate() {
            for (end, &after) in ends.iter().enumerate() {
                if after == NONE {
                    walk.from(edge as u32, end);
                }
            }
        }
        for edge in 0..edges.len() {
            walk.from(edge as u32, 0);
        }
        let mut chains = walk.chains;
        chains.retain(|chain| chain.edges.len() > 1);
        let colours = colours(chains, edges, rest.len());
        Self { colours }
    }

    /// All chains.
    pub fn iter(&self) -> impl Iterator<Item = &Chain> {
        self.colours.iter().flatten()
    }

    /// The same chains with other edge indices.
    pub fn renamed(&self, name: impl Fn(u32) -> u32) -> Self {
        let mut chains = self.clone();
        for chain in chains.colours.iter_mut().flatten() {
            for edge in &mut chain.edges {
                *edge = name(*edge);
            }
        }
        chains
    }
}

/// The edge that continues each edge beyond its first and its second end.
fn continuations(
    edges: &[[u32; 2]],
    rest: &[Vec3],
    normals: impl Fn(u32) -> Vec3,
) -> Vec<[u32; 2]> {
    // Edges, and which of their ends is there.
    let ends = Grouped::new(rest.len(), || {
        let edges = (0_u32..).zip(edges);
        edges.flat_map(|(edge, [a, b])| [(*a, (edge, 0_usize)), (*b, (edge, 1))])
    });
    let mut next = vec![[NONE; 2]; edges.len()];
    let mut directions = Vec::new();
    let mut pairs = Vec::new();
    for particle in 0..rest.len() as u32 {
        let around = ends.of(particle);
        if around.len() < 2 {
            continue;
        }
        let (u, v) = normals(particle).any_orthonormal_pair();
        directions.clear();
        directions.extend(around.iter().map(|&(edge, end)| {
            let other = edges[edge as usize][1 - end];
            let span = rest[other as usize] - rest[particle as usize];
            Vec2::new(span.dot(u), span.dot(v)).normalize_or_zero()
        }));
        pairs.clear();
        for (i, a) in directions.iter().enumerate() {
            for (j, b) in directions.iter().enumerate().skip(i + 1) {
                let cosine = a.dot(*b);
                if cosine <= STRAIGHT {
                    pairs.push((cosine, i, j));
                }
            }
        }
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        for &(_, i, j) in &pairs {
            let [(a, end_a), (b, end_b)] = [around[i], around[j]];
            if next[a as usize][end_a] == NONE && next[b as usize][end_b] == NONE {
                next[a as usize][end_a] = b;
                next[b as usize][end_b] = a;
            }
        }
    }
    next
}

/// State of the walk along edges.
struct Walk<'a> {
    edges: &'a [[u32; 2]],
    next: &'a [[u32; 2]],
    is_passed: Vec<bool>,
    /// The last chain that visited each particle.
    seen: Vec<u32>,
    chains: Vec<Chain>,
}

impl Walk<'_> {
    /// Walks from one end of an edge to the other, and on, until no unvisited edge follows. Where the path meets
    /// itself, a new chain begins.
    fn from(&mut self, mut edge: u32, mut end: usize) {
        let mut chain = NONE;
        while edge != NONE && !std::mem::replace(&mut self.is_passed[edge as usize], true) {
            let ends = self.edges[edge as usize];
            let [from, to] = [ends[end], ends[1 - end]];
            if chain == NONE || self.seen[to as usize] == chain {
                chain = self.chains.len() as u32;
                self.chains.push(Chain {
                    first: from,
                    edges: Vec::new(),
                });
                self.seen[from as usize] = chain;
            }
            self.chains[chain as usize].edges.push(edge);
            self.seen[to as usize] = chain;
            let following = self.next[edge as usize][1 - end];
            if following != NONE {
                end = usize::from(self.edges[following as usize][0] != to);
            }
            edge = following;
        }
    }
}

/// Gives each chain, longest first, the first colour that is free at all of its particles. Without a free colour, its
/// edges are on no chain.
fn colours(mut chains: Vec<Chain>, edges: &[[u32; 2]], particles: usize) -> Vec<Vec<Chain>> {
    chains.sort_by_key(|chain| std::cmp::Reverse(chain.edges.len()));
    let mut taken: Vec<u64> = vec![0; particles];
    let mut colours: Vec<Vec<Chain>> = Vec::new();
    for chain in chains {
        let ends = || chain.edges.iter().flat_map(|edge| edges[*edge as usize]);
        let all = ends().fold(0, |all, end| all | taken[end as usize]);
        let free = (!all).trailing_zeros();
        if free == MAX_COLOURS {
            continue;
        }
        ends().for_each(|end| taken[end as usize] |= 1 << free);
        colours.resize_with(colours.len().max(free as usize + 1), Vec::new);
        colours[free as usize].push(chain);
    }
    colours
}
