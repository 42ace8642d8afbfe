//! Threads that work on a batch.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;

/// A pool of threads, or the caller's thread.
#[derive(Debug)]
pub(crate) struct Workers {
    pool: Option<rayon::ThreadPool>,
}

impl Workers {
    /// `threads` of them; 0 for one per core. If no threads can be created, the caller's thread does the work.
    pub(crate) fn new(threads: usize) -> Self {
        let pool = (threads != 1).then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok());
        Self { pool: pool.flatten() }
    }

    /// Applies `work` to each unit and returns the results in order; `scratch` makes the working memory of a thread.
    pub(crate) fn map<S: Send, T: Send>(
        &self,
        units: Range<usize>,
        scratch: impl Fn() -> S + Sync + Send,
        work: impl Fn(&mut S, usize) -> T + Sync + Send,
    ) -> Vec<T> {
        let Some(pool) = &self.pool else {
            let mut scratch = scratch();
            return units.map(|unit| work(&mut scratch, unit)).collect();
        };
        // Each thread makes one.
        let spare = Mutex::new(Vec::new());
        let one = |unit: usize| {
            let taken = lock(&spare).pop();
            let mut used = taken.unwrap_or_else(&scratch);
            let result = work(&mut used, unit);
            lock(&spare).push(used);
            result
        };
        pool.install(|| units.into_par_iter().with_max_len(1).map(one).collect())
    }
}

/// The list behind a lock; the pool propagates panics of other threads.
fn lock<T>(list: &Mutex<Vec<T>>) -> std::sync::MutexGuard<'_, Vec<T>> {
    list.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
