//! `job plan`: which shards a build has.

use super::absolute;
use super::task::Task;
use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use crate::kept::{Keeping, PROGRAM};
use crate::numbers::number;
use sightlines::checkpoint::report::Planned;
use sightlines::checkpoint::{Identity, Job, JobProgress, JobRole, JobSlot, JobStore, Manifest};
use std::path::PathBuf;
use std::time::Duration;

/// Shards of a phase, unless the number is given: 8 for each of eight workers, so that nobody waits long for the last one.
const SHARDS: usize = 64;

#[derive(Debug, clap::Args)]
#[command(
    override_usage = "sightlines job plan [OPTIONS] -o JOB build|vis|reject|tiles IN [OPTIONS OF THE COMMAND]..."
)]
pub(crate) struct PlanArgs {
    /// Shards that each phase of the work is cut into, at most; 8 to 32 for each worker let all end at about the same time
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = SHARDS, value_parser = shards)]
    shards: usize,
    /// The folder of the job, which is made
    #[arg(short, long, help_heading = "Output", value_name = "JOB")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
    /// The command, as it is without a job: what it writes, `job merge` writes
    #[arg(value_name = "COMMAND", trailing_var_arg = true, allow_hyphen_values = true, required = true)]
    command: Vec<String>,
}

fn shards(text: &str) -> Result<usize, String> {
    number(text, |n| (1..=100_000).contains(n), "a number from 1 to 100000")
}

pub(crate) fn run(args: &PlanArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let task = Task::parse(&args.command)?;
    let here = absolute(std::path::Path::new("."))?;
    let folder = absolute(&args.output)?;
    let slot = JobSlot::default();
    let open = |identity: &Identity| {
        Ok(slot.open(identity, || {
            let here = here.display().to_string();
            let mut manifest = Manifest::new(PROGRAM, identity.key(), args.command.clone(), here, args.shards);
            manifest.inputs.clone_from(&identity.inputs);
            JobStore::new(Job::create(&folder, manifest)?, JobRole::Merge, Duration::ZERO)
        })?)
    };
    let made = task.make(Keeping::Job(&open), show_progress, false);
    let job = args.output.display().to_string();
    let planned = match (slot.store().and_then(JobStore::outcome), slot.store()) {
        (Some(JobProgress::Planned { phase, .. } | JobProgress::Missing { phase, .. }), Some(store)) => {
            Planned::new(job, &store.job(), Some(phase), None)
        }
        (_, Some(store)) => {
            made?;
            Planned::new(job, &store.job(), None, Some(task.output()))
        }
        (_, None) => return made.map(|_| Done::silently()),
    };
    Ok(Done::new(args.json, planned))
}
