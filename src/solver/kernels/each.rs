//! Short arrays, number by number.
//!
//! `array::map` is a function of its own. At `opt-level = 2`, or without any link-time optimisation, rustc did not put it in line.
//! Sub-steps took 6 to 20 times as long with it.

/// Three of them, by index.
#[inline(always)]
pub(crate) fn three<T>(mut of: impl FnMut(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// Four of them, by index.
#[inline(always)]
pub(crate) fn four<T>(mut of: impl FnMut(usize) -> T) -> [T; 4] {
    [of(0), of(1), of(2), of(3)]
}
