//! Threads for all of a bake.

/// As much stack as the first thread of a program has, mostly.
const STACK: usize = 8 << 20;

/// Runs something on so many threads; 0 for one for each core. Whoever is on so many already stays there, so that what a bake is made of may ask again.
///
/// If no threads can be started, those that all share do the work.
pub(crate) fn on<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    let n = sightlines_progress::memory::n_threads(threads);
    if rayon::current_thread_index().is_some() && rayon::current_num_threads() == n {
        return run();
    }
    match rayon::ThreadPoolBuilder::new().num_threads(n).stack_size(STACK).build() {
        Ok(pool) => pool.install(run),
        Err(_) => run(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_asks_twice_stays_on_the_same_threads() {
        let on_two = on(2, || {
            let pool = std::thread::current().id();
            let inside = || std::thread::current().id() == pool;
            // The impostor: another number needs other threads.
            (rayon::current_num_threads(), on(2, inside), on(3, || (rayon::current_num_threads(), inside())))
        });
        assert_eq!(on_two, (2, true, (3, false)));
    }
}
