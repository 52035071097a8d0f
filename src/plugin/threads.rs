//! The number of threads that work on a tick.

use bevy::tasks::{ComputeTaskPool, available_parallelism};

/// Threads that work on a tick: those of Bevy's compute pool, and the one that waits for them.
pub(super) fn threads() -> usize {
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    (pool + 1).min(available_parallelism())
}
