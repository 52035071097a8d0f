//! The number of threads that work on a tick.

use bevy::{
    ecs::{
        query::{IterQueryData, QueryFilter},
        system::Query,
    },
    tasks::{ComputeTaskPool, available_parallelism},
};

/// A cloth of fewer particles is solved by one task: two gain nothing at 128², and a factor of 1.3 at 256², 1.4 at 512².
pub(crate) const MIN_TO_SPLIT: usize = 256 * 256;

/// Threads that work on a tick: those of Bevy's compute pool, and the one that waits for them.
pub(crate) fn threads() -> usize {
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    (pool + 1).min(available_parallelism())
}

/// Runs a function on each item of a query, of several at once if that is asked for and there are threads for it.
pub(crate) fn for_each<'w, 's, D: IterQueryData, F: QueryFilter>(
    query: &'w mut Query<'_, 's, D, F>,
    at_once: bool,
    run: impl Fn(D::Item<'w, 's>) + Send + Sync + Clone,
) {
    if at_once && threads() > 1 {
        query.par_iter_mut().for_each(run);
    } else {
        query.iter_mut().for_each(run);
    }
}

/// The threads that do a piece of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Threads {
    /// Those of Bevy's compute pool. A thread that waits for them runs other tasks of the pool meanwhile: whole systems, too.
    Compute,
    /// The current one. A tick may wait for such work. On the compute pool, the work could run the very system that waits for it.
    This,
}

/// Runs two functions, at the same time if there are threads for it.
pub(crate) fn join<A: Send + 'static, B>(
    threads: Threads,
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B,
) -> (A, B) {
    let pool = ComputeTaskPool::try_get().filter(|_| threads == Threads::Compute);
    let Some(pool) = pool else {
        return (one(), other());
    };
    let mut of_other = None;
    let of_one = pool.scope(|scope| {
        scope.spawn(async { one() });
        of_other = Some(other());
    });
    let of_one = of_one.into_iter().next();
    (
        of_one.expect("it was spawned"),
        of_other.expect("the scope has run it"),
    )
}
