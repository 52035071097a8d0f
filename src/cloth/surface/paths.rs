//! Shortest paths along edges, from one particle at a time.

use std::{cmp::Reverse, collections::BinaryHeap};

use super::graph::Graph;

/// Shortest paths along the edges of a graph (Dijkstra 1959), with reused memory.
#[derive(Debug)]
pub(crate) struct ShortestPaths<'a> {
    graph: &'a Graph,
    /// For each particle, the search that reached it last, and its distance (m).
    reached: Vec<(u32, f64)>,
    /// For each particle, the search whose target it was last.
    wanted: Vec<u32>,
    search: u32,
    heap: BinaryHeap<Reverse<(u64, u32)>>,
}

impl<'a> ShortestPaths<'a> {
    pub fn new(graph: &'a Graph) -> Self {
        Self {
            graph,
            reached: vec![(0, 0.0); graph.len()],
            wanted: vec![0; graph.len()],
            search: 0,
            heap: BinaryHeap::new(),
        }
    }

    /// Finds the paths from `start` to all of `patch`. Returns the particle of it that is reached last and its distance
    /// (m); `None` if one is unreachable.
    fn search(&mut self, start: u32, patch: &[u32]) -> Option<(u32, f64)> {
        self.search += 1;
        let search = self.search;
        for &particle in patch {
            self.wanted[particle as usize] = search;
        }
        let mut left = patch.len();
        self.heap.clear();
        self.heap.push(Reverse((0, start)));
        self.reached[start as usize] = (search, 0.0);
        // Bits of non-negative floats sort like the floats.
        while let Some(Reverse((bits, particle))) = self.heap.pop() {
            let distance = f64::from_bits(bits);
            let at = particle as usize;
            if distance > self.reached[at].1 {
                continue;
            }
            if self.wanted[at] == search {
                self.wanted[at] = 0;
                left -= 1;
                if left == 0 {
                    return Some((particle, distance));
                }
            }
            for &(neighbour, length) in self.graph.of(particle) {
                let farther = distance + f64::from(length);
                let known = &mut self.reached[neighbour as usize];
                if known.0 != search || farther < known.1 {
                    *known = (search, farther);
                    self.heap.push(Reverse((farther.to_bits(), neighbour)));
                }
            }
        }
        None
    }

    /// The distance from `start` to the farthest particle of `patch` (m), rounded up; infinite if one is unreachable.
    pub fn farthest(&mut self, start: u32, patch: &[u32]) -> f32 {
        match self.search(start, patch) {
            Some((_, distance)) if distance > 0.0 => (distance as f32).next_up(),
            Some(_) => 0.0,
            None => f32::INFINITY,
        }
    }

    /// Writes the distance of each particle of `patch` from `start` (m), in order, infinite if unreachable. Returns the
    /// farthest particle; unreachable ones count as farthest.
    pub fn distances(&mut self, start: u32, patch: &[u32], distances: &mut Vec<f64>) -> u32 {
        let last = self.search(start, patch);
        let (reached, search) = (&self.reached, self.search);
        let distance = |particle: u32| match reached[particle as usize] {
            (in_search, distance) if in_search == search => distance,
            _ => f64::INFINITY,
        };
        distances.clear();
        distances.extend(patch.iter().map(|&particle| distance(particle)));
        let beyond = || {
            patch
                .iter()
                .copied()
                .find(|&particle| distance(particle).is_infinite())
        };
        last.map(|(particle, _)| particle)
            .or_else(beyond)
            .unwrap_or(start)
    }
}
