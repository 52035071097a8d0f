//! Neighbours on a surface.

use std::{cmp::Reverse, collections::BinaryHeap};

use crate::cloth::grouped::Grouped;

/// Neighbours of each particle, ascending, and their distances at rest (m).
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Graph(Grouped<(u32, f32)>);

impl Graph {
    /// The graph of edges between two particles, with their lengths (m); each edge once.
    pub fn new(particles: usize, edges: impl Iterator<Item = ([u32; 2], f32)> + Clone) -> Self {
        let both_ways = |([a, b], length): ([u32; 2], f32)| [(a, (b, length)), (b, (a, length))];
        let mut neighbours = Grouped::new(particles, || edges.clone().flat_map(both_ways));
        for particle in 0..particles as u32 {
            neighbours.of_mut(particle).sort_by_key(|near| near.0);
        }
        Self(neighbours)
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The neighbours of a particle, and their distances (m).
    #[inline]
    pub fn of(&self, particle: u32) -> &[(u32, f32)] {
        self.0.of(particle)
    }

    /// For each particle, the distance along edges to the nearest source (m), infinite without a path, and the index of
    /// that source (Dijkstra 1959).
    pub fn distances(&self, sources: impl Iterator<Item = u32>) -> Vec<(f32, u32)> {
        let mut found = vec![(f32::INFINITY, u32::MAX); self.len()];
        let mut heap = BinaryHeap::new();
        for (place, source) in sources.enumerate() {
            found[source as usize] = (0.0, place as u32);
            heap.push(Reverse((0, source)));
        }
        // Bits of non-negative floats sort like the floats.
        while let Some(Reverse((bits, particle))) = heap.pop() {
            let (distance, source) = found[particle as usize];
            if f32::from_bits(bits) > distance {
                continue;
            }
            for &(neighbour, length) in self.of(particle) {
                let farther = distance + length;
                if farther < found[neighbour as usize].0 {
                    found[neighbour as usize] = (farther, source);
                    heap.push(Reverse((farther.to_bits(), neighbour)));
                }
            }
        }
        found
    }

    /// An order in which neighbours are near each other in memory. Breadth first from a particle at the far end of its
    /// piece, particles with few neighbours first (Cuthill and `McKee` 1969).
    pub fn order(&self) -> Vec<u32> {
        let mut order: Vec<u32> = Vec::with_capacity(self.len());
        let mut is_placed = vec![false; self.len()];
        let mut last_seen = vec![u32::MAX; self.len()];
        let mut queue = Vec::new();
        for start in 0..self.len() as u32 {
            if is_placed[start as usize] {
                continue;
            }
            // The particle reached last is at the far end.
            queue.clear();
            queue.push(start);
            last_seen[start as usize] = start;
            let mut next = 0;
            while let Some(&particle) = queue.get(next) {
                next += 1;
                for &(neighbour, _) in self.of(particle) {
                    if last_seen[neighbour as usize] != start {
                        last_seen[neighbour as usize] = start;
                        queue.push(neighbour);
                    }
                }
            }
            let far = queue.last().copied().unwrap_or(start);
            let mut next = order.len();
            order.push(far);
            is_placed[far as usize] = true;
            while let Some(&particle) = order.get(next) {
                next += 1;
                let begin = order.len();
                for &(neighbour, _) in self.of(particle) {
                    if !std::mem::replace(&mut is_placed[neighbour as usize], true) {
                        order.push(neighbour);
                    }
                }
                order[begin..].sort_by_key(|neighbour| self.of(*neighbour).len());
            }
        }
        order
    }

    /// The connected piece of each particle, numbered from 0.
    pub fn pieces_of(&self) -> Vec<u32> {
        let mut pieces = vec![u32::MAX; self.len()];
        let (mut next, mut queue) = (0, Vec::new());
        for start in 0..self.len() as u32 {
            if pieces[start as usize] != u32::MAX {
                continue;
            }
            queue.push(start);
            pieces[start as usize] = next;
            while let Some(particle) = queue.pop() {
                for &(neighbour, _) in self.of(particle) {
                    if pieces[neighbour as usize] == u32::MAX {
                        pieces[neighbour as usize] = next;
                        queue.push(neighbour);
                    }
                }
            }
            next += 1;
        }
        pieces
    }

    /// Number of connected pieces of more than one particle.
    pub fn pieces(&self) -> usize {
        let alone = (0..self.len() as u32).filter(|particle| self.of(*particle).is_empty());
        let last = self.pieces_of().into_iter().max();
        last.map_or(0, |last| last as usize + 1) - alone.count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine columns and seven rows, 0.1 m apart, with both diagonals.
    fn grid() -> Graph {
        let edges: Vec<([u32; 2], f32)> = (0..63_u32)
            .flat_map(|at| {
                let (row, column) = (at / 9, at % 9);
                let steps = [(0, 1), (1, 0), (1, 1), (1, -1)].into_iter();
                steps.filter_map(move |(down, across): (u32, i32)| {
                    let (row, beside) = (row + down, column.checked_add_signed(across)?);
                    let length = 0.1 * ((down as f32).powi(2) + (across as f32).powi(2)).sqrt();
                    (row < 7 && beside < 9).then_some(([at, row * 9 + beside], length))
                })
            })
            .collect();
        Graph::new(63, edges.into_iter())
    }

    /// Along rows, columns and diagonals, from wherever the sources are.
    #[test]
    fn distances_are_those_of_the_nearest_source() {
        for sources in [&[0_u32][..], &[62], &[31], &[4, 40, 58]] {
            let found = grid().distances(sources.iter().copied());
            for (index, (found, source)) in found.into_iter().enumerate() {
                let path = |source: u32| {
                    let source = source as usize;
                    let (down, across) = (
                        (source / 9).abs_diff(index / 9),
                        (source % 9).abs_diff(index % 9),
                    );
                    let diagonal = down.min(across) as f32;
                    0.1 * ((down.max(across) as f32 - diagonal) + diagonal * 2.0_f32.sqrt())
                };
                let expected = sources.iter().map(|&source| path(source));
                let expected = expected.fold(f32::INFINITY, f32::min);
                assert!((found - expected).abs() < 1.0e-5, "{sources:?} {index}");
                assert!((path(sources[source as usize]) - expected).abs() < 1.0e-5);
            }
        }
        let alone = Graph::new(2, [].into_iter());
        assert_eq!(
            alone.distances([1].into_iter()),
            [(f32::INFINITY, u32::MAX), (0.0, 0)]
        );
    }

    /// Each particle once; neighbours are no farther apart than a column is long, a piece after the other.
    #[test]
    fn neighbours_are_near_each_other_in_the_order() {
        let graph = grid();
        let order = graph.order();
        let mut place = vec![usize::MAX; 63];
        for (index, &particle) in order.iter().enumerate() {
            assert_eq!(place[particle as usize], usize::MAX);
            place[particle as usize] = index;
        }
        let apart = |particle: u32| {
            let neighbours = graph.of(particle).iter();
            neighbours.map(move |near| (particle, near.0))
        };
        let widest = (0..63)
            .flat_map(apart)
            .map(|(a, b)| place[a as usize].abs_diff(place[b as usize]));
        assert!(widest.max() <= Some(18), "two rows or columns, at most");
    }
}
