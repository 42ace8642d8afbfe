//! Threads and observers of long work.

use rayon::prelude::*;
use sightlines_progress::{Cancelled, Counter, Observer};

/// How long work is done: by how many threads, and who is told. Neither changes a result.
#[derive(Clone, Copy, Default)]
pub struct Effort<'a> {
    /// Number of threads; 0 for one per core.
    pub threads: usize,
    /// Is told how far the work is, and may cancel it.
    pub observer: Option<&'a dyn Observer>,
}

impl std::fmt::Debug for Effort<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Effort").field("threads", &self.threads).field("observer", &self.observer.is_some()).finish()
    }
}

impl Effort<'_> {
    /// Applies `unit` to the numbers below `n`, each with a state that `state` makes once for some of them, and returns the results in
    /// order.
    pub(crate) fn each<S, R: Send>(
        &self,
        phase: &'static str,
        n: usize,
        state: impl Fn() -> S + Sync + Send,
        unit: impl Fn(&mut S, usize) -> R + Sync + Send,
    ) -> Result<Vec<R>, Cancelled> {
        let counter = Counter::new(self.observer, phase, n);
        let all = || {
            let step = |state: &mut S, k: usize| {
                counter.check()?;
                let result = unit(state, k);
                counter.step()?;
                Ok(result)
            };
            (0..n).into_par_iter().map_init(&state, step).collect()
        };
        match rayon::ThreadPoolBuilder::new().num_threads(self.threads).build() {
            Ok(pool) => pool.install(all),
            // The system has no threads left: the shared ones do it.
            Err(_) => all(),
        }
    }
}
