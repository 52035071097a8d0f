//! Bands of rows on several threads.

use std::sync::atomic::{AtomicBool, Ordering};

use bevy::tasks::{ComputeTaskPool, TaskPool, futures_lite::future::yield_now};

/// The pool that bands are tasks of.
pub(super) fn pool() -> &'static TaskPool {
    ComputeTaskPool::get_or_init(TaskPool::default)
}

/// Runs `work` with a thread of the pool awake for each band but the caller's own. A sub-step's bands are ready
/// within microseconds of each other; a thread that fell asleep in between would take a hundred to come back.
pub(super) fn with_threads_awake<R>(bands: usize, work: impl FnOnce() -> R) -> R {
    if bands <= 1 {
        return work();
    }
    let is_done = AtomicBool::new(false);
    let mut result = None;
    pool().scope(|scope| {
        for _ in 1..bands {
            scope.spawn(async {
                while !is_done.load(Ordering::Acquire) {
                    // Lets the thread do what else there is.
                    yield_now().await;
                }
            });
        }
        let _release = Release(&is_done);
        result = Some(work());
    });
    result.expect("the scope has run its closure")
}

/// Ends the waiting even if the work panics.
struct Release<'a>(&'a AtomicBool);

impl Drop for Release<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}
