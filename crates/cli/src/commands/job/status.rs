//! `job status`: what is done.

use super::outcome::{Missing, PhaseFacts, PhaseStatus, Status};
use super::{absolute, open};
use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use sightlines::checkpoint::{Job, ShardState};
use std::path::PathBuf;

/// Arguments of `job status`.
#[derive(Debug, clap::Args)]
pub(crate) struct StatusArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &StatusArgs, _: Verbosity) -> Result<Done> {
    let job = open(&absolute(&args.job)?)?;
    let manifest = job.manifest();
    let phases = (0..manifest.phases.len()).map(|phase| of_phase(&job, phase)).collect::<Result<Vec<_>>>()?;
    let status = Status { job: args.job.display().to_string(), command: manifest.command.clone(), phases };
    Ok(Done::new(args.json, status))
}

fn of_phase(job: &Job, phase: usize) -> Result<PhaseStatus> {
    let status = job.status(phase)?;
    let begun = status.shards.iter().filter(|(_, state)| matches!(state, ShardState::Partial(_)));
    Ok(PhaseStatus {
        facts: PhaseFacts::new(job, phase),
        n_done: status.n_done,
        done_share: status.done_share,
        begun: begun.map(|(shard, _)| *shard).collect(),
        undone: Missing::new(job, phase, status.shards).into(),
        seconds_left: status.seconds_left,
    })
}
