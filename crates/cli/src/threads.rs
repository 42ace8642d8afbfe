//! Threads of the program.

/// Has all work that names no threads of its own done by so many; 0 for one for each core. The first call decides for the whole process.
pub(crate) fn use_only(threads: usize) {
    if rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().is_err() {
        tracing::debug!("the threads of this process are chosen already");
    }
}
