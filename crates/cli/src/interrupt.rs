//! Ctrl-C: the first one ends the work so that it can go on later, a second one ends the program. Too much memory in use ends the work in the same way.

use crate::output::bytes;
use std::io::Write;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering::SeqCst};

/// The exit code of a program that was interrupted: 128 and the number of the signal.
const BY_CTRL_C: u8 = 130;
/// The exit code of a program that used too much memory.
const BY_MEMORY: u8 = 4;

/// Whether the program was interrupted.
static REQUESTED: AtomicBool = AtomicBool::new(false);
/// The memory that was in use when that was too much, and that was allowed; 0 otherwise.
static USED: AtomicU64 = AtomicU64::new(0);
static ALLOWED: AtomicU64 = AtomicU64::new(0);
/// How much work is under way that ends by itself once that is so.
static N_WATCHING: AtomicUsize = AtomicUsize::new(0);

/// Work that asks now and then whether it is to end.
#[derive(Debug)]
pub(crate) struct Watch(());

impl Drop for Watch {
    fn drop(&mut self) {
        N_WATCHING.fetch_sub(1, SeqCst);
    }
}

/// From now on, until the result is dropped, the first Ctrl-C is only noted. Before and after that, it ends the program.
pub(crate) fn watch() -> Watch {
    static ONCE: Once = Once::new();
    N_WATCHING.fetch_add(1, SeqCst);
    ONCE.call_once(|| {
        let set = ctrlc::set_handler(|| {
            if REQUESTED.swap(true, SeqCst) || N_WATCHING.load(SeqCst) == 0 {
                std::process::exit(i32::from(BY_CTRL_C));
            }
            // Nothing is left to do if standard error is closed.
            let _ = writeln!(
                std::io::stderr(),
                "interrupted: ending as soon as it can go on later; once more ends at once"
            );
        });
        if let Err(error) = set {
            tracing::debug!("Ctrl-C ends the program at once: {error}");
        }
    });
    Watch(())
}

/// Whether the program was interrupted while it was [watching](watch).
pub(crate) fn requested() -> bool {
    REQUESTED.load(SeqCst)
}

/// Ends the work that is watched, or will be: so many bytes are in use, and fewer are allowed.
pub(crate) fn request_for_memory(used: u64, allowed: u64) {
    ALLOWED.store(allowed, SeqCst);
    USED.store(used, SeqCst);
    REQUESTED.store(true, SeqCst);
}

/// Takes a [request for memory](request_for_memory) back: the work has not begun, and is refused.
pub(crate) fn forget_memory() {
    if USED.swap(0, SeqCst) > 0 {
        REQUESTED.store(false, SeqCst);
    }
}

/// Why the program was interrupted, if it used too much memory.
pub(crate) fn memory() -> Option<String> {
    let [used, allowed] = [&USED, &ALLOWED].map(|n| n.load(SeqCst));
    (used > 0).then(|| format!("{} of memory are in use, and --memory allows {}", bytes(used), bytes(allowed)))
}

/// The exit code of a program that was interrupted.
pub(crate) fn exit_code() -> u8 {
    if memory().is_some() { BY_MEMORY } else { BY_CTRL_C }
}
