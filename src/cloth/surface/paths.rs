//! Shortest paths along edges, from one particle at a time.

use super::graph::Graph;

/// Number of buckets: more would be searched for nothing where edges are of alike lengths.
const BUCKETS: usize = 64;

/// Shortest paths along the edges of a graph, with reused memory. Particles wait in buckets by their distance (Dial 1969), which
/// is several times as fast as a heap. Within a bucket they are looked at again when their distance falls.
#[derive(Debug)]
pub(crate) struct ShortestPaths<'a> {
    graph: &'a Graph,
    reached: Vec<Reached>,
    /// For each particle, the search whose target it was last.
    wanted: Vec<u32>,
    search: u32,
    /// Buckets a metre: no edge reaches beyond the last of them. 0 if no edge has a length.
    density: f64,
    buckets: Vec<Vec<u32>>,
    /// The particles that were passed in the current bucket.
    passed: Vec<u32>,
}

/// How a particle was reached.
#[derive(Debug, Default, Clone, Copy)]
struct Reached {
    /// The last search that reached it.
    search: u32,
    /// Its distance in that search (m).
    distance: f64,
    /// The distance with which its neighbours were reached last (m).
    passed_on: f64,
}

impl<'a> ShortestPaths<'a> {
    pub fn new(graph: &'a Graph) -> Self {
        let edges = (0..graph.len() as u32).flat_map(|particle| graph.of(particle));
        let longest = edges.map(|(_, length)| *length).fold(0.0, f32::max);
        Self {
            graph,
            reached: vec![Reached::default(); graph.len()],
            wanted: vec![0; graph.len()],
            search: 0,
            density: match longest {
                0.0 => 0.0,
                longest => (BUCKETS - 2) as f64 / f64::from(longest),
            },
            buckets: vec![Vec::new(); BUCKETS],
            passed: Vec::new(),
        }
    }

    /// Finds the paths from `start` to all of `patch`. Returns the particle of it that is reached last and its distance (m), which is
    /// infinite if one is unreachable.
    fn search(&mut self, start: u32, patch: &[u32]) -> (u32, f64) {
        self.search += 1;
        let search = self.search;
        for &particle in patch {
            self.wanted[particle as usize] = search;
        }
        self.buckets.iter_mut().for_each(Vec::clear);
        self.reach(start, 0.0);
        let (mut left, mut last) = (patch.len(), (0.0, start));
        // After as many empty buckets in a row as there are, nothing waits.
        let (mut bucket, mut empty) = (0, 0);
        while left > 0 && empty < BUCKETS {
            self.pass_bucket(bucket);
            empty = if self.passed.is_empty() { empty + 1 } else { 0 };
            while let Some(particle) = self.passed.pop() {
                if self.wanted[particle as usize] != search {
                    continue;
                }
                self.wanted[particle as usize] = 0;
                left -= 1;
                let found = (self.reached[particle as usize].distance, particle);
                if found.0 > last.0 || found.0 == last.0 && found.1 > last.1 {
                    last = found;
                }
            }
            bucket += 1;
        }
        (last.1, if left == 0 { last.0 } else { f64::INFINITY })
    }

    /// Passes on all that waits in a bucket, until nothing in it changes.
    fn pass_bucket(&mut self, bucket: usize) {
        let (graph, search) = (self.graph, self.search);
        while let Some(particle) = self.buckets[bucket % BUCKETS].pop() {
            let known = &mut self.reached[particle as usize];
            let distance = known.distance;
            // It waited twice, or was passed in an earlier bucket.
            if known.passed_on == distance {
                continue;
            }
            known.passed_on = distance;
            self.passed.push(particle);
            for &(neighbour, length) in graph.of(particle) {
                let farther = distance + f64::from(length);
                let known = &self.reached[neighbour as usize];
                if known.search != search || farther < known.distance {
                    self.reach(neighbour, farther);
                }
            }
        }
    }

    fn reach(&mut self, particle: u32, distance: f64) {
        self.reached[particle as usize] = Reached {
            search: self.search,
            distance,
            passed_on: f64::NAN,
        };
        let bucket = (distance * self.density) as usize;
        self.buckets[bucket % BUCKETS].push(particle);
    }

    /// The distance from `start` to the farthest particle of `patch` (m), rounded up; infinite if one is unreachable.
    pub fn farthest(&mut self, start: u32, patch: &[u32]) -> f32 {
        match self.search(start, patch) {
            (_, distance) if distance > 0.0 => (distance as f32).next_up(),
            _ => 0.0,
        }
    }

    /// Writes the distance of each particle of `patch` from `start` (m), in order. Returns the farthest particle. `patch` is of one
    /// piece.
    pub fn distances(&mut self, start: u32, patch: &[u32], distances: &mut Vec<f64>) -> u32 {
        let (last, _) = self.search(start, patch);
        let distance = |particle: &u32| self.reached[*particle as usize].distance;
        distances.clear();
        distances.extend(patch.iter().map(distance));
        last
    }
}
