//! Arrays of three and four, made by index, for what a kernel does in each lane.
//!
//! `array::map` is a function of its own. At `opt-level = 2`, or without any link-time optimisation, rustc did not put it in line.
//! Sub-steps took 6 to 20 times as long with it.

/// The array `[of(0), of(1), of(2)]`.
#[inline(always)]
pub(crate) fn three<T>(mut of: impl FnMut(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// The array `[of(0), of(1), of(2), of(3)]`.
#[inline(always)]
pub(crate) fn four<T>(mut of: impl FnMut(usize) -> T) -> [T; 4] {
    [of(0), of(1), of(2), of(3)]
}
