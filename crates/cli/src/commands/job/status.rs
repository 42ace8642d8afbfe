//! `job status`: what is done.

use super::outcome::{Missing, PhaseFacts, PhaseStatus, Status};
use super::{absolute, open};
use crate::command::{Done, Manner};
use crate::error::Result;
use sightlines::checkpoint::{Job, ShardState};
use std::path::PathBuf;

/// Arguments of `job status`.
#[derive(Debug, clap::Args)]
pub(crate) struct StatusArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &StatusArgs, _: Manner) -> Result<Done> {
    let job = open(&absolute(&args.job)?)?;
    let manifest = job.manifest();
    let phases = (0..manifest.phases.len()).map(|phase| of_phase(&job, phase)).collect::<Result<Vec<_>>>()?;
    let status = Status { job: args.job.display().to_string(), command: manifest.command.clone(), phases };
    Ok(Done::new(args.json, status))
}

fn of_phase(job: &Job, phase: usize) -> Result<PhaseStatus> {
    let shards = job.manifest().shards_of(phase);
    let states: Vec<(usize, ShardState)> = shards.map(|shard| Ok((shard, job.state(shard)?))).collect::<Result<_>>()?;
    let (mut all, mut done) = (0.0, 0.0);
    for ((_, state), plan) in states.iter().zip(&job.manifest().phases[phase].shards) {
        all += plan.cost;
        done += if *state == ShardState::Done { plan.cost } else { 0.0 };
    }
    let begun = states.iter().filter(|(_, state)| matches!(state, ShardState::Partial(_))).map(|(shard, _)| *shard);
    let n_done = states.iter().filter(|(_, state)| *state == ShardState::Done).count();
    let is_done = n_done == states.len();
    let done_share = if is_done { 1.0 } else { done / f64::max(all, f64::MIN_POSITIVE) };
    // The manifest was written last when the last phase was planned.
    let planned = std::fs::metadata(job.folder().join("job.json")).and_then(|found| found.modified()).ok();
    let since = planned.and_then(|planned| planned.elapsed().ok()).map(|since| since.as_secs_f64());
    let left = since.filter(|_| done > 0.0).map(|since| since * (all - done) / done);
    Ok(PhaseStatus {
        facts: PhaseFacts::new(job, phase),
        n_done,
        done_share,
        begun: begun.collect(),
        undone: Missing::new(job, phase, states).into(),
        seconds_left: if is_done { Some(0.0) } else { left },
    })
}
