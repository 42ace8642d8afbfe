//! Who does shards.

mod command;
mod local;
mod pool;
mod process;
mod slurm;

pub(super) use command::Command;
pub(super) use local::Local;
pub(super) use slurm::Slurm;

use crate::error::Result;
use crate::progress::Bar;
use sightlines::checkpoint::Job;
use sightlines::progress::{Observer, Progress};
use std::path::Path;

/// Shards of a phase that are to be done.
#[derive(Debug, Clone, Copy)]
pub(super) struct Round<'a> {
    pub(super) job: &'a Job,
    pub(super) phase: usize,
    pub(super) shards: &'a [usize],
}

/// What an engine has done.
#[derive(Debug)]
pub(super) enum Did {
    /// Shards, those of the round at least; the ones without a part have failed.
    Shards,
    /// All of the job, and the output is written; what the process has printed that wrote it.
    Output(Option<String>),
}

/// Who does shards.
pub(super) trait Engine {
    /// Has the shards of a round done, for the `attempt`th time, from 1 on. Returns once nobody is at them any more.
    ///
    /// # Errors
    /// [`Error`] if nothing can be started at all, or would fail again.
    fn run(&self, round: &Round<'_>, attempt: u32) -> Result<Did>;
}

/// Shows how much of a round is done, by cost.
pub(super) struct Shown<'a> {
    bar: Bar,
    round: &'a Round<'a>,
}

impl<'a> Shown<'a> {
    pub(super) fn new(round: &'a Round<'a>, show: bool) -> Self {
        Self { bar: Bar::new("shards", show), round }
    }

    /// Shows which shards have a part. Returns how many have.
    pub(super) fn update(&self) -> usize {
        let Round { job, shards, .. } = self.round;
        let (mut n_done, mut done, mut all) = (0, 0.0, 0.0);
        for &shard in *shards {
            let cost = job.shard(shard).map_or(0.0, |(_, plan)| plan.cost);
            let is_done = job.part_path(shard).is_file();
            all += cost;
            done += if is_done { cost } else { 0.0 };
            n_done += usize::from(is_done);
        }
        let progress = Progress::new("", n_done as u64, shards.len() as u64);
        // Whether to end is asked elsewhere.
        let _ = self.bar.report(if all > 0.0 { progress.with_share(done / all) } else { progress });
        n_done
    }
}

/// A path between quotes, for a shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', "'\\''"))
}
