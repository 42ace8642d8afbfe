//! Processes of a program on this machine.

use super::process::{End, Processes};
use super::{Did, Engine, EngineError, Host, Round, Shown, pool};
use crate::job::Job;
use std::process::Command;

/// How many ticks pass between two looks at how far the job is.
const TICKS: usize = 50;

/// So many workers, which go through all of the job. What they have not done is tried again shard by shard, each by a process of its own: a
/// shard that ends its process takes others along.
pub struct Local<'a> {
    /// How many run at once.
    pub workers: usize,
    /// Starts a worker ([`JobRole::Worker`](crate::JobRole::Worker)).
    pub worker: &'a dyn Fn() -> Command,
    /// Starts a process for shards ([`JobRole::Shards`](crate::JobRole::Shards)).
    pub shards: &'a dyn Fn(&[usize]) -> Command,
    /// What a worker had to tell that has written the output, from what it printed; `None` for others.
    pub told: fn(&[u8]) -> Option<String>,
}

impl std::fmt::Debug for Local<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Local").field("workers", &self.workers).finish_non_exhaustive()
    }
}

impl Engine for Local<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32, host: &Host<'_>) -> Result<Did, EngineError> {
        if attempt == 1 {
            return self.work(round.job.clone(), host);
        }
        pool::run(round, host, self.workers, |_| 1, self.shards)?;
        Ok(Did::Shards)
    }
}

impl Local<'_> {
    /// Starts workers, and waits for all.
    fn work(&self, mut job: Job, host: &Host<'_>) -> Result<Did, EngineError> {
        let mut running = Processes::new(host);
        for k in 0..self.workers {
            running.start(format!("worker {k}"), &mut (self.worker)())?;
        }
        let mut did = Did::Shards;
        while running.len() > 0 {
            let phase = job.manifest().phases.len().saturating_sub(1);
            let shards: Vec<usize> = job.manifest().shards_of(phase).collect();
            let shown = Shown::new(Round { job: &job, phase, shards: &shards }, host);
            let mut next = None;
            for tick in 0_usize.. {
                if tick.is_multiple_of(TICKS) {
                    shown.update();
                    next = with_more_phases(&job);
                }
                if next.is_some() || running.len() == 0 {
                    break;
                }
                for end in running.wait()? {
                    match end {
                        // The others would wait for what it had to do.
                        End::Hopeless(error) => return Err(error),
                        End::Passed(printed) => {
                            if let Some(told) = (self.told)(&printed) {
                                did = Did::Output(Some(told));
                            }
                        }
                    }
                }
            }
            shown.update();
            drop(shown);
            job = next.unwrap_or(job);
        }
        Ok(did)
    }
}

/// The job as it is now, if workers have planned another phase.
fn with_more_phases(job: &Job) -> Option<Job> {
    // What cannot be read is said by the workers.
    let now = Job::open(job.folder(), &job.manifest().program).ok();
    now.filter(|now| now.manifest().phases.len() > job.manifest().phases.len())
}
