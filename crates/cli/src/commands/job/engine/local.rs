//! Processes of this program on this machine.

use super::{Engine, Round, pool};
use crate::commands::job::Error;
use crate::commands::job::numbers::Run;
use std::path::Path;
use std::process::{Command, Stdio};

/// So many processes with a thread each.
///
/// What a process prepares, the input and its cells, takes time that is lost. So each has a share of the shards that are left, which falls towards the end: few prepare,
/// and all end at about the same time (Polychronopoulos and Kuck, "Guided self-scheduling", 1987).
pub(in crate::commands::job) struct Local<'a> {
    pub(in crate::commands::job) program: &'a Path,
    pub(in crate::commands::job) workers: usize,
    pub(in crate::commands::job) show_progress: bool,
}

/// How many shards a process does, of so many that are left of `n` in all.
pub(super) fn batch(left: usize, n: usize, workers: usize) -> usize {
    // The last batches are as small as a sixteenth of what a worker has in all.
    left.div_ceil(2 * workers).max(n / (16 * workers)).max(1)
}

impl Engine for Local<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32) -> Result<bool, Error> {
        // A shard that fails takes those behind it along, so they are alone when they are tried again.
        let size = |left| if attempt > 1 { 1 } else { batch(left, round.shards.len(), self.workers) };
        pool::run(round, self.workers, self.show_progress, size, |shards| {
            let mut command = Command::new(self.program);
            command.args(["job", "shard"]).arg(round.job.folder());
            command.args(Run::all(shards).into_iter().map(Run::text)).args(["--threads", "1", "-q"]);
            command.stdin(Stdio::null()).stdout(Stdio::null());
            command
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_shrink_and_are_few() {
        let batches = |n: usize, workers: usize| {
            let (mut left, mut all) = (n, Vec::new());
            while left > 0 {
                all.push(batch(left, n, workers).min(left));
                left -= all[all.len() - 1];
            }
            all
        };
        assert_eq!(batches(64, 2), [16, 12, 9, 7, 5, 4, 3, 2, 2, 2, 2]);
        assert_eq!(batches(5, 8), [1; 5]);
        assert_eq!(batches(0, 1), [0; 0]);
        // However many shards there are, a worker prepares a few times.
        for n in [32, 64, 1000, 100_000] {
            for workers in [1, 2, 8] {
                let n_batches = batches(n, workers).len();
                assert!(n_batches <= 12 * workers, "{n} by {workers}: {n_batches}");
            }
        }
    }
}
