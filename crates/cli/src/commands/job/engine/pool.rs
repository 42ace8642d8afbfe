//! Processes on this machine, so many at once.

use super::{Round, Shown};
use crate::commands::job::Error;
use crate::commands::job::outcome::ranges;
use crate::interrupt;
use std::io::{self, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long it takes until the end of a process is noticed, at most.
const TICK: Duration = Duration::from_millis(10);
/// How many of these pass between two looks at the parts.
const TICKS: usize = 20;

/// The exit code of a process that would fail again: bad input, or a disk that is full.
const HOPELESS: i32 = 2;

/// A process, and what it prints on standard error.
struct Worker {
    shards: Vec<usize>,
    child: Child,
    said: Option<JoinHandle<String>>,
}

/// Starts processes, `n` at once, each for as many shards as `size` says of how many are left, and waits for all. Passes on what they print.
///
/// After one that would fail again, no more are started.
pub(super) fn run(
    round: &Round<'_>,
    n: usize,
    show_progress: bool,
    size: impl Fn(usize) -> usize,
    start: impl Fn(&[usize]) -> Command,
) -> Result<bool, Error> {
    let _watch = interrupt::watch();
    let shown = Shown::new(round, show_progress);
    let (mut todo, mut hopeless) = (round.shards, None);
    let mut running: Vec<Worker> = Vec::new();
    for tick in 0_usize.. {
        if interrupt::requested() {
            end(running);
            return Err(Error::Interrupted);
        }
        while running.len() < n && !todo.is_empty() && hopeless.is_none() {
            let (shards, later) = todo.split_at(size(todo.len()).clamp(1, todo.len()));
            todo = later;
            let mut command = start(shards);
            match command.stderr(Stdio::piped()).spawn() {
                Ok(child) => running.push(Worker::new(shards, child)),
                Err(source) => {
                    end(running);
                    let program = command.get_program().to_string_lossy().into_owned();
                    return Err(Error::Start { program, source });
                }
            }
        }
        if running.is_empty() {
            break;
        }
        if tick % TICKS == 0 {
            shown.update();
        }
        std::thread::sleep(TICK);
        let mut still = Vec::new();
        for mut worker in running {
            match worker.child.try_wait() {
                Ok(None) => still.push(worker),
                Ok(Some(status)) => {
                    if let Some(error) = worker.ended(status) {
                        hopeless.get_or_insert(error);
                    }
                }
                Err(error) => tracing::warn!("{}: {error}", ranges(&worker.shards)),
            }
        }
        running = still;
    }
    shown.update();
    hopeless.map_or(Ok(false), Err)
}

impl Worker {
    fn new(shards: &[usize], mut child: Child) -> Self {
        let read = |mut from: std::process::ChildStderr| {
            let mut said = Vec::new();
            // What cannot be read is not passed on.
            let _: io::Result<usize> = from.read_to_end(&mut said);
            String::from_utf8_lossy(&said).into_owned()
        };
        let said = child.stderr.take().map(|from| std::thread::spawn(move || read(from)));
        Self { shards: shards.to_vec(), child, said }
    }

    /// Passes on what an ended process has printed; an error if it would fail again.
    fn ended(self, status: ExitStatus) -> Option<Error> {
        let said = self.said.and_then(|said| said.join().ok()).unwrap_or_default();
        let shards = ranges(&self.shards);
        if status.code() == Some(HOPELESS) {
            let said = said.trim();
            let message = said.strip_prefix("error: ").unwrap_or(said);
            let message = if message.is_empty() { status.to_string() } else { message.to_owned() };
            return Some(Error::Shard { shards, message });
        }
        // Nothing is left to do if standard error is closed.
        let _ = io::stderr().write_all(said.as_bytes());
        if !status.success() {
            tracing::warn!("{shards}: {status}");
        }
        None
    }
}

/// Ends processes. What they have computed for long is in their journals.
fn end(running: Vec<Worker>) {
    for mut worker in running {
        let ended: io::Result<()> = worker.child.kill().and_then(|()| worker.child.wait().map(drop));
        if let Err(error) = ended {
            tracing::debug!("a process cannot be ended: {error}");
        }
    }
}
