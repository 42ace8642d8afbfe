//! `job`: a build that processes share, on one machine or on many.

mod merge;
mod plan;
mod shard;
mod status;
pub(crate) mod submit;
mod task;
mod work;

use crate::command::{Done, Verbosity, commands};
use crate::error::{ErrorAbout, Result, anyhow};
use crate::interrupt;
use sightlines::checkpoint::Job;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Exit codes: 0 done; 2 bad input or usage; 3 shards are to be done, first or again; 130 interrupted.\n\
                        The folder of a job has to be one that all machines see under the same name."
)]
pub(crate) struct JobArgs {
    #[command(subcommand)]
    what: JobCommand,
}

commands! {
    enum JobCommand:
    /// Cut a build into shards of about the same cost: put `job plan -o JOB` before the command
    Plan(plan::PlanArgs) => plan::run,
    /// Do some shards, and write the part of each
    Shard(shard::ShardArgs) => shard::run,
    /// Do all of a job together with other workers, which prepare once: shards that nobody has claimed, phase by phase, and what the command writes
    Work(work::WorkArgs) => work::run,
    /// Put all parts together: writes what the command writes without a job, or plans the shards that come next
    Merge(merge::MergeArgs) => merge::run,
    /// Have all shards done and merged: by processes on this machine, by Slurm, or by a command of yours
    Submit(submit::SubmitArgs) => submit::run,
    /// Print what is done, missing and broken
    Status(status::StatusArgs) => status::run,
}

pub(crate) fn run(args: &JobArgs, verbosity: Verbosity) -> Result<Done> {
    args.what.run(verbosity)
}

/// The command was interrupted.
fn interrupted() -> anyhow::Error {
    anyhow!("interrupted; parts that are written stay: the same command goes on from there")
}

/// The same, or that it used too much memory.
fn stopped() -> anyhow::Error {
    match interrupt::memory() {
        Some(why) => anyhow!(
            "stopped: {why}; what is done stays: the same command with a larger --memory or fewer --threads goes on from there"
        ),
        None => interrupted(),
    }
}

fn open(folder: &Path) -> Result<Job> {
    Ok(Job::open(folder, crate::kept::PROGRAM)?)
}

/// The path of a folder that does not depend on where the program runs.
fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).in_file(path)
}
