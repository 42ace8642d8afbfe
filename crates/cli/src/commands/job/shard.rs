//! `job shard`: the part of one shard.

use super::outcome::{ShardDone, ranges};
use super::task::Task;
use super::{Error, absolute, open};
use crate::kept::{Identity, JobSlot, Keeping};
use crate::memory::MemoryArgs;
use crate::output;
use crate::{Answer, interrupt};
use sightlines::checkpoint::{JobStore, Outcome, Role, ShardState};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Arguments of `job shard`.
#[derive(Debug, clap::Args)]
pub(crate) struct ShardArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    /// The number of the shard, from 0 on
    #[arg(value_name = "N")]
    shard: usize,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 1, value_parser = crate::numbers::threads)]
    threads: usize,
    #[command(flatten)]
    memory: MemoryArgs,
    /// Seconds after which results are kept for a later run of the same shard
    #[arg(long, help_heading = "Resuming", value_name = "SECONDS", default_value_t = 10)]
    save_after: u64,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &ShardArgs, show_progress: bool) -> Result<Answer, Error> {
    let start = Instant::now();
    let job = open(&absolute(&args.job)?)?;
    let (phase, plan) = job.shard(args.shard).map(|(phase, plan)| (phase, *plan))?;
    let mut done = ShardDone {
        job: args.job.display().to_string(),
        shard: args.shard,
        phase: job.manifest().phases[phase].name.clone(),
        begin: plan.begin,
        end: plan.end,
        was_done: job.state(args.shard)? == ShardState::Done,
        seconds: 0.0,
    };
    if !done.was_done {
        let task = Task::of(&job)?.with_threads(Some(args.threads)).with_memory(args.memory);
        let slot = JobSlot::default();
        let (role, after) = (Role::Shard(args.shard), Duration::from_secs(args.save_after));
        let open = |identity: &Identity| slot.open(identity, || Ok(JobStore::new(job.clone(), role, after)?));
        let made = task.make(Keeping::Job(&open), show_progress, false);
        match slot.store().and_then(JobStore::outcome) {
            Some(Outcome::Done) => {}
            Some(Outcome::Missing { shards, phase }) => {
                let shards: Vec<usize> = shards.iter().map(|(shard, _)| *shard).collect();
                let name = &job.manifest().phases[phase].name;
                return Err(Error::Command(format!(
                    "{}: shard {} needs all of phase {name} first: {} to be done",
                    args.job.display(),
                    args.shard,
                    ranges(&shards)
                )));
            }
            _ if interrupt::requested() => {
                return Err(interrupt::memory().map_or(Error::Interrupted, Error::Memory));
            }
            _ => {
                made?;
                return Err(Error::NeverBegun { path: args.job.clone(), shard: args.shard });
            }
        }
    }
    done.seconds = start.elapsed().as_secs_f64();
    output::print(args.json, &done)?;
    Ok(Answer::Yes)
}
