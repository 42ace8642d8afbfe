//! Who does the shards of a job.
//!
//! An [`Engine`] has shards done by processes: on this machine ([`Local`]), by Slurm ([`Slurm`]), or by a command for a shell
//! ([`ShellCommand`]). [`run_rounds`] has all of a job done, phase by phase, and merged. How a process is told its shards is up to the program,
//! which gives its command lines.

mod command;
mod local;
mod pool;
mod process;
mod rounds;
mod slurm;

pub use command::ShellCommand;
pub use local::Local;
pub use rounds::{Merge, Rounds, run_rounds};
pub use slurm::Slurm;

use crate::job::{Job, JobError};
use sightlines_progress::{Observer, Progress};
use std::io;
use std::path::Path;

/// Shards of a phase that are to be done.
#[derive(Debug, Clone, Copy)]
pub struct Round<'a> {
    /// The job.
    pub job: &'a Job,
    /// The place of the phase.
    pub phase: usize,
    /// The shards, ascending.
    pub shards: &'a [usize],
}

/// What an engine has done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Did {
    /// Shards, those of the round at least; the ones without a part have failed.
    Shards,
    /// All of the job, and the output is written; what the process had to tell that wrote it.
    Output(Option<String>),
}

/// Who does shards.
pub trait Engine {
    /// Has the shards of a round done, for the `attempt`th time, from 1 on. Returns once nobody is at them any more.
    ///
    /// # Errors
    /// [`EngineError`] if nothing can be started at all, if it would fail again, or if the work is to end.
    fn run(&self, round: &Round<'_>, attempt: u32, host: &Host<'_>) -> Result<Did, EngineError>;
}

/// Whom an engine asks and tells while it waits.
#[derive(Clone, Copy)]
pub struct Host<'a> {
    /// Makes an observer of a round, which hears how much of it is done, by cost. That it cancels changes nothing.
    pub observe: &'a dyn Fn() -> Box<dyn Observer>,
    /// Whether to end: processes are ended, and what they have kept stays.
    pub stop: fn() -> bool,
    /// Takes what went wrong and is tried again.
    pub warn: fn(&str),
    /// Takes what a process has said on its standard error.
    pub said: fn(&[u8]),
}

impl std::fmt::Debug for Host<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Host").finish_non_exhaustive()
    }
}

/// Why shards are not done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EngineError {
    /// [`Host::stop`] ended it.
    #[error("the work was to end; what is done stays")]
    Stopped,
    /// A program cannot be started.
    #[error("{program}: cannot be started: {source}")]
    Start {
        /// The program.
        program: String,
        /// The error of the system.
        source: io::Error,
    },
    /// A process has failed, and would again.
    #[error("{name}: {message}")]
    Failed {
        /// What it was at, or its program.
        name: String,
        /// What it said.
        message: String,
    },
    /// The folder of the job.
    #[error(transparent)]
    Job(#[from] JobError),
}

impl EngineError {
    fn failed(name: impl Into<String>, said: &str) -> Self {
        let said = said.trim();
        Self::Failed { name: name.into(), message: said.strip_prefix("error: ").unwrap_or(said).to_owned() }
    }

    fn start(program: impl Into<String>, source: io::Error) -> Self {
        Self::Start { program: program.into(), source }
    }
}

/// Tells how much of a round is done, by cost.
struct Shown<'a> {
    observer: Box<dyn Observer>,
    round: Round<'a>,
}

impl<'a> Shown<'a> {
    fn new(round: Round<'a>, host: &Host<'_>) -> Self {
        Self { observer: (host.observe)(), round }
    }

    /// Tells which shards have a part.
    fn update(&self) {
        let Round { job, shards, .. } = self.round;
        let (mut n_done, mut done, mut all) = (0, 0.0, 0.0);
        for &shard in shards {
            let cost = job.shard(shard).map_or(0.0, |(_, plan)| plan.cost);
            all += cost;
            if job.part_path(shard).is_file() {
                done += cost;
                n_done += 1;
            }
        }
        let progress = Progress::new("", n_done, shards.len() as u64);
        let _ = self.observer.report(if all > 0.0 { progress.with_share(done / all) } else { progress });
    }
}

/// A path between quotes, for a shell of Unix.
pub fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', "'\\''"))
}
