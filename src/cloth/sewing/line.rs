//! Particles along a line of a surface.

use bevy::math::Vec3;

/// Fractions of a segment nearer to its end than this are the end.
const AT_END: f32 = 1.0e-4;

/// Particles one after the other: a part of a border, all of it, or any other line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    pub particles: Vec<u32>,
    /// Where each is along the line, as a fraction of its length at rest (0 to 1).
    pub at: Vec<f32>,
    /// Length at rest (m); of a ring, all around.
    pub length: f32,
    /// Whether its last particle is beside its first.
    pub is_ring: bool,
}

/// How positions along one line follow from those along another: `start + direction × at`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Alignment {
    start: f32,
    direction: f32,
}

impl Alignment {
    const SAME: Self = Self {
        start: 0.0,
        direction: 1.0,
    };

    pub fn of(self, at: f32) -> f32 {
        self.start + self.direction * at
    }

    pub fn inverse(self) -> Self {
        Self {
            start: -self.start * self.direction,
            direction: self.direction,
        }
    }
}

impl Line {
    pub fn new(particles: Vec<u32>, is_ring: bool, rest: &[Vec3]) -> Self {
        let place = |particle: &u32| rest[*particle as usize];
        let mut length = 0.0;
        let mut at = vec![0.0];
        for ends in particles.windows(2) {
            length += place(&ends[0]).distance(place(&ends[1]));
            at.push(length);
        }
        if let (true, Some(first), Some(last)) = (is_ring, particles.first(), particles.last()) {
            length += place(first).distance(place(last));
        }
        let shorten = |at: &mut f32| *at /= length.max(f32::MIN_POSITIVE);
        at.iter_mut().for_each(shorten);
        Self {
            particles,
            at,
            length,
            is_ring,
        }
    }

    /// The length of it that belongs to a particle (m).
    pub fn share(&self, index: usize) -> f32 {
        let last = self.at.len() - 1;
        let (before, after) = match (self.is_ring, index) {
            (true, 0) => (self.at[last] - 1.0, self.at[1.min(last)]),
            (true, _) if index == last => (self.at[last - 1], 1.0),
            _ => (
                self.at[index.saturating_sub(1)],
                self.at[(index + 1).min(last)],
            ),
        };
        0.5 * (after - before) * self.length
    }

    /// The two particles around a position along it, and the weight of the second (0 to 1).
    pub fn around(&self, at: f32) -> ([u32; 2], f32) {
        let at = match self.is_ring {
            true => at.rem_euclid(1.0),
            false => at.clamp(0.0, 1.0),
        };
        let count = self.particles.len();
        let next = self.at.partition_point(|&own| own <= at);
        let first = next.saturating_sub(1);
        let (second, end) = match (next < count, self.is_ring) {
            (true, _) => (next, self.at[next]),
            (false, true) => (0, 1.0),
            (false, false) => (first, 1.0),
        };
        let long = end - self.at[first];
        let part = ((at - self.at[first]) / long).clamp(0.0, 1.0);
        let is_side = second != first && long > 0.0;
        let weight = if is_side { part } else { 0.0 };
        let weight = match weight {
            near if near < AT_END => 0.0,
            far if far > 1.0 - AT_END => 1.0,
            weight => weight,
        };
        ([first, second].map(|index| self.particles[index]), weight)
    }

    /// A point along it, of particles at these places (m).
    fn point(&self, at: f32, places: &[Vec3]) -> Vec3 {
        let (around, weight) = self.around(at);
        let [a, b] = around.map(|particle| places[particle as usize]);
        a.lerp(b, weight)
    }

    /// The alignment of another line by which both are nearest, with particles at these places (m).
    pub(super) fn align(&self, other: &Self, [own, others]: [&[Vec3]; 2]) -> Alignment {
        // A ring is turned by steps of the finer one.
        if self.is_ring && (!other.is_ring || self.at.len() > other.at.len()) {
            return other.align(self, [others, own]).inverse();
        }
        let starts = match other.is_ring {
            true => &other.at[..],
            false => &[0.0],
        };
        let alignments = starts.iter().flat_map(|&start| {
            let back = if other.is_ring { start } else { 1.0 };
            [(start, 1.0), (back, -1.0)].map(|(start, direction)| Alignment { start, direction })
        });
        let mut best = (f32::INFINITY, Alignment::SAME);
        for alignment in alignments {
            let squares = self.particles.iter().zip(&self.at).map(|(&particle, &at)| {
                let there = other.point(alignment.of(at), others);
                own[particle as usize].distance_squared(there)
            });
            let sum = squares.sum();
            if sum < best.0 {
                best = (sum, alignment);
            }
        }
        best.1
    }

    /// The sum of the squares of the distances of two lines' first, middle and last points (m²).
    pub fn distance_squared(&self, other: &Self, [own, others]: [&[Vec3]; 2]) -> f32 {
        let alignment = self.align(other, [own, others]);
        let each = [0.0, 0.5, 1.0].map(|at| {
            let there = other.point(alignment.of(at), others);
            self.point(at, own).distance_squared(there)
        });
        each.iter().sum()
    }

    /// Its segments, the last particle of each twice.
    pub fn segments(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let ends = self.particles.windows(2).map(|ends| [ends[0], ends[1]]);
        let (first, last) = (self.particles[0], self.particles[self.particles.len() - 1]);
        let closing = (self.is_ring || first == last).then_some([last, first]);
        ends.chain(closing).map(|[a, b]| [a, b, b])
    }
}
