//! Processes on this machine for the shards of a round, so many at once.

use super::process::{End, Processes};
use super::{EngineError, Host, Round, Shown};
use crate::job::in_words;
use std::process::Command;

/// How many ticks pass between two looks at the parts.
const TICKS: usize = 20;

/// Starts processes, `n` at once, each for as many shards as `size` says of how many are left, and waits for all.
///
/// After one that would fail again, no more are started.
pub(super) fn run(
    round: &Round<'_>,
    host: &Host<'_>,
    n: usize,
    size: impl Fn(usize) -> usize,
    command: impl Fn(&[usize]) -> Command,
) -> Result<(), EngineError> {
    let shown = Shown::new(*round, host);
    let (mut todo, mut hopeless, mut running) = (round.shards, None, Processes::new(host));
    for tick in 0_usize.. {
        while running.len() < n && !todo.is_empty() && hopeless.is_none() {
            let (shards, later) = todo.split_at(size(todo.len()).clamp(1, todo.len()));
            todo = later;
            running.start(in_words(shards), &mut command(shards))?;
        }
        if running.len() == 0 {
            break;
        }
        if tick % TICKS == 0 {
            shown.update();
        }
        for end in running.wait()? {
            if let End::Hopeless(error) = end {
                hopeless.get_or_insert(error);
            }
        }
    }
    shown.update();
    hopeless.map_or(Ok(()), Err)
}
