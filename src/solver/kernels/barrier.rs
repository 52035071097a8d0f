//! Keeps the compiler to one block.

/// Keeps the compiler from gathering the lanes of several blocks: a block's own are side by side.
#[inline(always)]
pub(crate) fn one_block_at_a_time() {
    std::hint::black_box(());
}
