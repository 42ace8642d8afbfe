//! Ctrl-C: the first one ends the work so that it can go on later, a second one ends the program.

use std::io::Write;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};

/// The exit code of a program that was interrupted: 128 and the number of the signal.
pub(crate) const EXIT_CODE: u8 = 130;

/// Whether the program was interrupted.
static REQUESTED: AtomicBool = AtomicBool::new(false);
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
                std::process::exit(i32::from(EXIT_CODE));
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
