//! Processes on this machine, so many at once.

use super::process::{End, Process, TICK};
use super::{Round, Shown};
use crate::commands::job::interrupted;
use crate::commands::job::outcome::ranges;
use crate::error::Result;
use crate::interrupt;
use std::process::Command;

/// How many ticks pass between two looks at the parts.
const TICKS: usize = 20;

/// Starts processes, `n` at once, each for as many shards as `size` says of how many are left, and waits for all. Passes on what they say.
///
/// After one that would fail again, no more are started.
pub(super) fn run(
    round: &Round<'_>,
    n: usize,
    show_progress: bool,
    size: impl Fn(usize) -> usize,
    start: impl Fn(&[usize]) -> Command,
) -> Result<()> {
    let _watch = interrupt::watch();
    let shown = Shown::new(round, show_progress);
    let (mut todo, mut hopeless) = (round.shards, None);
    let mut running: Vec<Process> = Vec::new();
    for tick in 0_usize.. {
        if interrupt::requested() {
            running.into_iter().for_each(Process::kill);
            return Err(interrupted());
        }
        while running.len() < n && !todo.is_empty() && hopeless.is_none() {
            let (shards, later) = todo.split_at(size(todo.len()).clamp(1, todo.len()));
            todo = later;
            match Process::start(ranges(shards), &mut start(shards)) {
                Ok(process) => running.push(process),
                Err(error) => {
                    running.into_iter().for_each(Process::kill);
                    return Err(error);
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
        running.retain_mut(|process| match process.look() {
            None => true,
            Some(end) => {
                if let End::Hopeless(error) = end {
                    hopeless.get_or_insert(error);
                }
                false
            }
        });
    }
    shown.update();
    hopeless.map_or(Ok(()), Err)
}
