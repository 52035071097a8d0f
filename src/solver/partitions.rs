//! Partitions of rows on several threads.

use std::{
    hint,
    sync::atomic::{AtomicBool, AtomicUsize, Ordering},
    time::Duration,
};

use bevy::{
    platform::time::Instant,
    tasks::{ComputeTaskPool, TaskPool, futures_lite::future::yield_now},
};

/// The pool that partitions are tasks of.
pub(super) fn pool() -> &'static TaskPool {
    ComputeTaskPool::get_or_init(TaskPool::default)
}

/// More partitions than this find no work worth a task.
pub(super) const MAX_PARTITIONS: usize = 16;

/// So long a partition that is done looks out for the others before its thread may sleep, which would take as long to wake.
const PATIENCE: Duration = Duration::from_micros(100);

/// Does `work` on each part: the last on this thread, each of the others in a task of its own.
pub(super) fn in_partitions<T: Send>(parts: impl IntoIterator<Item = T>, work: impl Fn(T) + Sync) {
    let work = &work;
    let left = &AtomicUsize::new(0);
    pool().scope(|scope| {
        let mut parts = parts.into_iter().peekable();
        while let Some(part) = parts.next() {
            if parts.peek().is_some() {
                left.fetch_add(1, Ordering::Relaxed);
                scope.spawn(async move {
                    work(part);
                    left.fetch_sub(1, Ordering::Release);
                });
            } else {
                work(part);
            }
        }
        let since = Instant::now();
        while left.load(Ordering::Acquire) > 0 && since.elapsed() < PATIENCE {
            hint::spin_loop();
        }
    });
}

/// Runs `work` with a thread of the pool awake for each partition but the caller's own. A sub-step's partitions are ready
/// within microseconds of each other; a thread that fell asleep in between would take a hundred to come back.
pub(crate) fn with_threads_awake<R>(partitions: usize, work: impl FnOnce() -> R) -> R {
    if partitions <= 1 {
        return work();
    }
    let is_done = AtomicBool::new(false);
    let mut result = None;
    pool().scope(|scope| {
        for _ in 1..partitions {
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

/// Takes this many from the front of a slice.
pub(super) fn take<'a, T>(from: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    from.split_off_mut(..count).expect("as many")
}
