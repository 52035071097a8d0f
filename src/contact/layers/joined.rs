//! Particles that are sewn together, which do not touch.

/// Pairs of particles of all cloths that are sewn together. Features of two sides at such a pair are like neighbours: they
/// neither touch nor cross.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Joined {
    /// In both orders, sorted.
    pairs: Vec<[u32; 2]>,
    /// Those before them: their memory is used again.
    #[cfg_attr(feature = "serialize", serde(skip))]
    before: Vec<[u32; 2]>,
}

impl Joined {
    /// Takes over other pairs. Returns whether they differ.
    pub fn set(&mut self, pairs: impl Iterator<Item = [u32; 2]>) -> bool {
        std::mem::swap(&mut self.pairs, &mut self.before);
        self.pairs.clear();
        (self.pairs).extend(pairs.flat_map(|[a, b]| [[a, b], [b, a]]));
        self.pairs.sort_unstable();
        self.pairs.dedup();
        self.pairs != self.before
    }

    /// Whether a particle of one feature is sewn to one of the other.
    #[inline]
    pub fn join(&self, own: &[u32], other: &[u32]) -> bool {
        !self.pairs.is_empty()
            && own.iter().any(|&own| {
                let first = self.pairs.partition_point(|pair| pair[0] < own);
                let with = self.pairs[first..].iter();
                with.take_while(|pair| pair[0] == own)
                    .any(|pair| other.contains(&pair[1]))
            })
    }
}
