//! `job shard`: the parts of some shards.

use super::task::Task;
use super::{absolute, open, stopped};
use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{Result, anyhow};
use crate::interrupt;
use crate::kept::Keeping;
use crate::memory::MemoryArgs;
use sightlines::checkpoint::report::{ShardDone, ShardsDone};
use sightlines::checkpoint::{Identity, Job, JobProgress, JobRole, JobSlot, JobStore, ShardRun, ShardState, in_words};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(Debug, clap::Args)]
pub(crate) struct ShardArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    /// Numbers of shards, from 0 on, and runs of them such as 3-9; one process prepares once and then does one after the other
    #[arg(value_name = "N", required = true)]
    shards: Vec<ShardRun>,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 1, value_parser = crate::numbers::threads)]
    threads: usize,
    #[command(flatten)]
    memory: MemoryArgs,
    /// Seconds after which results are kept for a later run of the same shard
    #[arg(long, help_heading = "Resuming", value_name = "SECONDS", default_value_t = 10)]
    save_after: u64,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &ShardArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let start = Instant::now();
    let job = open(&absolute(&args.job)?)?;
    let mut shards = Vec::new();
    for run in &args.shards {
        // A run that is too long is refused before it is written out.
        job.shard(run.last)?;
        shards.extend(run.first..=run.last);
    }
    shards.sort_unstable();
    shards.dedup();
    let mut done = ShardsDone { job: args.job.display().to_string(), shards: Vec::new(), seconds: 0.0 };
    let mut todo: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for shard in shards {
        let (phase, plan) = job.shard(shard)?;
        let was_done = job.state(shard)? == ShardState::Done;
        let name = job.manifest().phases[phase].name.clone();
        done.shards.push(ShardDone { shard, phase: name, begin: plan.begin, end: plan.end, was_done });
        if !was_done {
            todo.entry(phase).or_default().push(shard);
        }
    }
    for shards in todo.into_values() {
        compute(&job, &args.job, shards, args, show_progress)?;
    }
    done.seconds = start.elapsed().as_secs_f64();
    Ok(Done::new(args.json, done))
}

fn compute(job: &Job, name: &Path, shards: Vec<usize>, args: &ShardArgs, show_progress: bool) -> Result<()> {
    let task = Task::of(job)?.with_threads(Some(args.threads)).with_memory(args.memory);
    let slot = JobSlot::default();
    let after = Duration::from_secs(args.save_after);
    let open = |identity: &Identity| {
        Ok(slot.open(identity, || JobStore::new(job.clone(), JobRole::Shards(shards.clone()), after))?)
    };
    let made = task.make(Keeping::Job(&open), show_progress, false);
    match slot.store().and_then(JobStore::outcome) {
        Some(JobProgress::Done) => Ok(()),
        Some(JobProgress::Missing { shards: missing, phase }) => {
            let missing: Vec<usize> = missing.iter().map(|(shard, _)| *shard).collect();
            let phase = &job.manifest().phases[phase].name;
            let verb = if shards.len() == 1 { "needs" } else { "need" };
            Err(anyhow!(
                "{}: {} {verb} all of phase {phase} first: {} to be done",
                name.display(),
                in_words(&shards),
                in_words(&missing)
            ))
        }
        _ if interrupt::requested() => Err(stopped()),
        _ => {
            made?;
            Err(anyhow!(
                "{}: the bake came to its end without shard {shard}; plan the job anew",
                name.display(),
                shard = shards[0]
            ))
        }
    }
}
