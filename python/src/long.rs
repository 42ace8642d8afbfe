//! Calls that take long: without the lock of the interpreter, with progress, and stopped by Ctrl-C.

use crate::arrays::bug;
use pyo3::prelude::*;
use sightlines_progress::{Observer, Progress};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;
use std::time::Duration;

/// How often the calling thread looks for signals, and tells how far the work is.
const TICK: Duration = Duration::from_millis(50);

/// What workers get at in chains of portals goes deep: as much as the main thread of a program has.
const STACK: usize = 16 << 20;

/// What the worker last said, and whether it has to stop.
#[derive(Default)]
struct Desk {
    latest: Mutex<Option<Progress>>,
    stop: AtomicBool,
}

impl Observer for Desk {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
        if self.stop.load(Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Does `work` on another thread, while this one waits without the lock of the interpreter, looks for signals, and calls `progress`
/// with a word, the units done, and all of them.
///
/// What a signal handler or `progress` raises stops the work at its next report, and is raised then.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&dyn Observer) -> T + Send,
) -> PyResult<T> {
    let desk = Desk::default();
    thread::scope(|scope| {
        let (done, wait) = mpsc::sync_channel(1);
        let desk = &desk;
        let spawned =
            thread::Builder::new().name("sightlines".into()).stack_size(STACK).spawn_scoped(scope, move || {
                let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| work(desk)));
                // The receiver waits until this comes.
                let _ = done.send(result);
            });
        spawned.map_err(|failure| crate::error::error(format!("no thread could be started: {failure}")))?;
        let mut failed = None;
        let wait = Mutex::new(wait);
        loop {
            let answer = py.detach(|| wait.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK));
            match answer {
                Ok(Ok(result)) => {
                    return match failed {
                        Some(raised) => Err(raised),
                        None => Ok(result),
                    };
                }
                Ok(Err(panic)) => return Err(bug(&*panic)),
                Err(mpsc::RecvTimeoutError::Disconnected) => return Err(crate::error::error("the work was lost")),
                Err(mpsc::RecvTimeoutError::Timeout) => {}
            }
            let ticked = py.check_signals().and_then(|()| tell(py, progress.filter(|_| failed.is_none()), desk));
            if let Err(raised) = ticked {
                desk.stop.store(true, Relaxed);
                failed.get_or_insert(raised);
            }
        }
    })
}

fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, desk: &Desk) -> PyResult<()> {
    let latest = *desk.latest.lock().unwrap_or_else(PoisonError::into_inner);
    match (progress, latest) {
        (Some(progress), Some(p)) => progress.call1(py, (p.phase, p.done, p.total)).map(drop),
        _ => Ok(()),
    }
}
