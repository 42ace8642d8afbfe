//! Processes on this machine, so many at once.

use super::{Round, Shown};
use crate::commands::job::Error;
use crate::interrupt;
use std::io;
use std::process::{Child, Command};
use std::time::Duration;

/// How long it takes until the end of a process is noticed, at most.
const TICK: Duration = Duration::from_millis(10);
/// How many of these pass between two looks at the parts.
const TICKS: usize = 20;

/// Starts a process for each shard, `n` at once, and waits for all. Why processes fail, they print themselves.
pub(super) fn run(
    round: &Round<'_>,
    n: usize,
    show_progress: bool,
    start: impl Fn(usize) -> Command,
) -> Result<bool, Error> {
    let _watch = interrupt::watch();
    let shown = Shown::new(round, show_progress);
    let mut todo = round.shards.iter().copied();
    let mut running: Vec<(usize, Child)> = Vec::new();
    for tick in 0_usize.. {
        if interrupt::requested() {
            end(running);
            return Err(Error::Interrupted);
        }
        while running.len() < n {
            let Some(shard) = todo.next() else { break };
            let mut command = start(shard);
            match command.spawn() {
                Ok(child) => running.push((shard, child)),
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
        for (shard, mut child) in running {
            match child.try_wait() {
                Ok(None) => still.push((shard, child)),
                Ok(Some(status)) if status.success() => {}
                Ok(Some(status)) => tracing::warn!("shard {shard}: {status}"),
                Err(error) => tracing::warn!("shard {shard}: {error}"),
            }
        }
        running = still;
    }
    shown.update();
    Ok(false)
}

/// Ends processes. What they have computed for long is in their journals.
fn end(running: Vec<(usize, Child)>) {
    for (_, mut child) in running {
        let ended: io::Result<()> = child.kill().and_then(|()| child.wait().map(drop));
        if let Err(error) = ended {
            tracing::debug!("a process cannot be ended: {error}");
        }
    }
}
