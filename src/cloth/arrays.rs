//! Arrays in code that runs for each particle, spring or pair.

/// Maps an array of up to 4, 6 or 8 elements as [`array::map`] does, by code that is inlined. That of the standard library is
/// made of several calls in Rust 1.95, which stay calls where a crate is compiled in several units. With 16 units, a flag
/// with layers takes 1.4 times as long.
pub(crate) trait MapInline<T, const N: usize> {
    /// The array of what `map` returns for each element, in order.
    fn map_inline<U>(self, map: impl FnMut(T) -> U) -> [U; N];
}

macro_rules! map_inline {
    ($count:literal: $($element:ident)+) => {
        impl<T> MapInline<T, $count> for [T; $count] {
            #[inline(always)]
            fn map_inline<U>(self, mut map: impl FnMut(T) -> U) -> [U; $count] {
                let [$($element),+] = self;
                [$(map($element)),+]
            }
        }
    };
}

map_inline!(1: a);
map_inline!(2: a b);
map_inline!(3: a b c);
map_inline!(4: a b c d);
map_inline!(6: a b c d e f);
map_inline!(8: a b c d e f g h);

/// The same numbers, ascending.
pub(crate) fn sorted<const N: usize>(mut of: [u32; N]) -> [u32; N] {
    of.sort_unstable();
    of
}

/// Each of some items once, in ascending order.
pub(super) fn distinct<T: Ord>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut all: Vec<T> = items.into_iter().collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The values with these indices.
pub(super) fn chosen<T: Copy>(values: &[T], indices: &[u32]) -> Vec<T> {
    indices.iter().map(|at| values[*at as usize]).collect()
}
