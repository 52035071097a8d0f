//! Items, grouped by particle.

use std::ops::Range;

/// Items of each particle: in one list, with the place where those of each particle begin.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct ByParticle<T> {
    /// One more entry than particles.
    first: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy> ByParticle<T> {
    /// Groups items, each with its particle. Those of one particle stay in their order. `items` is called twice.
    pub fn new<I: Iterator<Item = (u32, T)>>(particles: usize, items: impl Fn() -> I) -> Self {
        let mut first = vec![0; particles + 1];
        for (particle, _) in items() {
            first[particle as usize + 1] += 1;
        }
        for particle in 0..particles {
            first[particle + 1] += first[particle];
        }
        let Some((_, some)) = items().next() else {
            return Self {
                first,
                items: Vec::new(),
            };
        };
        let mut next = first.clone();
        let mut grouped = vec![some; first[particles] as usize];
        for (particle, item) in items() {
            let next = &mut next[particle as usize];
            grouped[*next as usize] = item;
            *next += 1;
        }
        Self {
            first,
            items: grouped,
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// The places of a particle's items in the list.
    #[inline]
    pub fn range_of(&self, particle: u32) -> Range<usize> {
        let particle = particle as usize;
        self.first[particle] as usize..self.first[particle + 1] as usize
    }

    /// The items of a particle.
    #[inline]
    pub fn of(&self, particle: u32) -> &[T] {
        &self.items[self.range_of(particle)]
    }

    /// The items of a particle, to change.
    pub fn of_mut(&mut self, particle: u32) -> &mut [T] {
        let range = self.range_of(particle);
        &mut self.items[range]
    }
}
