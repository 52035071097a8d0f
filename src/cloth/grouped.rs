//! Items in groups.

use std::ops::Range;

/// Items in groups, such as one for each particle: in one list, with the place where each group begins.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Grouped<T> {
    /// One more entry than groups.
    first: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Grouped<T> {
    /// Groups items, each with the index of its group. Those of one group stay in their order. `items` is called twice.
    pub fn new<I: Iterator<Item = (u32, T)>>(groups: usize, items: impl Fn() -> I) -> Self {
        let mut first = vec![0; groups + 1];
        for (group, _) in items() {
            first[group as usize + 1] += 1;
        }
        for group in 0..groups {
            first[group + 1] += first[group];
        }
        let mut next = first.clone();
        let mut grouped = vec![T::default(); first[groups] as usize];
        for (group, item) in items() {
            let next = &mut next[group as usize];
            grouped[*next as usize] = item;
            *next += 1;
        }
        Self {
            first,
            items: grouped,
        }
    }

    /// Number of groups.
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// The items of all groups, one after the other.
    pub fn all(&self) -> &[T] {
        &self.items
    }

    /// The places of a group's items in the list.
    #[inline]
    pub fn range_of(&self, group: u32) -> Range<usize> {
        let group = group as usize;
        self.first[group] as usize..self.first[group + 1] as usize
    }

    /// The items of a group.
    #[inline]
    pub fn of(&self, group: u32) -> &[T] {
        &self.items[self.range_of(group)]
    }

    /// The items of a group, to change.
    pub fn of_mut(&mut self, group: u32) -> &mut [T] {
        let range = self.range_of(group);
        &mut self.items[range]
    }
}
