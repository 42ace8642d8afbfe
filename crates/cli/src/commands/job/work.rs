//! `job work`: all of a job, together with other workers.

use super::absolute;
use super::merge::{report, through};
use super::task::Task;
use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use crate::interrupt;
use crate::memory::MemoryArgs;
use sightlines::checkpoint::JobRole;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, clap::Args)]
pub(crate) struct WorkArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    /// How many workers there are, about: each takes a share of what is left at once
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    workers: u32,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 1, value_parser = crate::numbers::threads)]
    threads: usize,
    #[command(flatten)]
    memory: MemoryArgs,
    /// Seconds after which results are kept for the worker that takes over
    #[arg(long, help_heading = "Resuming", value_name = "SECONDS", default_value_t = 10)]
    save_after: u64,
    /// The file to write [default: the output of the command that was planned]
    #[arg(short, long, help_heading = "Output", value_name = "OUT")]
    output: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &WorkArgs, Verbosity { verbose, .. }: Verbosity) -> Result<Done> {
    let (folder, out) = (absolute(&args.job)?, args.output.as_deref().map(absolute).transpose()?);
    let role = JobRole::Worker { n_workers: args.workers as usize, stop: interrupt::requested };
    let after = Duration::from_secs(args.save_after);
    let _watch = interrupt::watch();
    let adjust =
        |task: Task| task.with_threads(Some(args.threads)).with_memory(args.memory).with_output(out.as_deref());
    // It goes through phases more than once, which its bars would show.
    let found = through((&folder, role, after), adjust, false, verbose)?;
    Ok(report(&args.job, found, args.json))
}
