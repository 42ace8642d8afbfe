//! `job merge`: the output, from all parts.

use super::task::Task;
use super::{absolute, open, stopped};
use crate::command::{Answer, Done, JsonArg, Verbosity};
use crate::error::Result;
use crate::interrupt;
use crate::kept::Keeping;
use sightlines::checkpoint::report::{Merged, Missing};
use sightlines::checkpoint::{Identity, Job, JobProgress, JobRole, JobSlot, JobStore, ShardState};
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Debug, clap::Args)]
pub(crate) struct MergeArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    /// Number of threads [default: as planned]
    #[arg(long, help_heading = "Method", value_name = "N", value_parser = crate::numbers::threads)]
    threads: Option<usize>,
    /// The file to write [default: the output of the command that was planned]
    #[arg(short, long, help_heading = "Output", value_name = "OUT")]
    output: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArg,
}

/// How far a merge came.
pub(super) enum Progress {
    /// The output is written, and what the process printed that wrote it, if it is known.
    Written(PathBuf, Option<String>),
    /// All is done, and another worker has written the output.
    Shared(PathBuf),
    /// The next phase is known, and its shards are to be done.
    Planned(Job, usize),
    /// Shards of a phase are not done.
    Missing { job: Job, phase: usize, shards: Vec<(usize, ShardState)> },
}

/// Puts the parts of the job in a folder together, as far as there are any. Goes to the folder where the job was planned.
pub(super) fn merge(
    folder: &Path,
    output: Option<&Path>,
    threads: Option<usize>,
    show_progress: bool,
    verbose: bool,
) -> Result<Progress> {
    let adjust = |task: Task| task.with_threads(threads).with_output(output);
    through((folder, JobRole::Merge, Duration::ZERO), adjust, show_progress, verbose)
}

/// Goes through all of a job in a role that is not told its shards.
///
/// * The time is how long results are only in memory.
pub(super) fn through(
    (folder, role, after): (&Path, JobRole, Duration),
    adjust: impl FnOnce(Task) -> Task,
    show_progress: bool,
    verbose: bool,
) -> Result<Progress> {
    let job = open(folder)?;
    let task = adjust(Task::of(&job)?);
    let slot = JobSlot::default();
    let open = |identity: &Identity| Ok(slot.open(identity, || JobStore::new(job.clone(), role.clone(), after))?);
    let made = task.make(Keeping::Job(&open), show_progress, verbose);
    let made = match made {
        Ok(made) => return Ok(Progress::Written(task.output().to_owned(), Some(made))),
        Err(error) => error,
    };
    if interrupt::requested() {
        return Err(stopped());
    }
    match slot.store().and_then(|store| Some((store.outcome()?, store.job()))) {
        Some((JobProgress::Planned { phase, .. }, job)) => Ok(Progress::Planned(job, phase)),
        Some((JobProgress::Missing { phase, shards }, job)) => Ok(Progress::Missing { job, phase, shards }),
        Some((JobProgress::Done, _)) => Ok(Progress::Shared(task.output().to_owned())),
        _ => Err(made),
    }
}

pub(crate) fn run(args: &MergeArgs, Verbosity { show_progress, verbose }: Verbosity) -> Result<Done> {
    let (folder, out) = (absolute(&args.job)?, args.output.as_deref().map(absolute).transpose()?);
    let found = merge(&folder, out.as_deref(), args.threads, show_progress, verbose)?;
    Ok(report(&args.job, found, args.json))
}

/// How far a merge came.
pub(super) fn report(job: &Path, found: Progress, json: JsonArg) -> Done {
    let name = job.display().to_string();
    let (merged, answer) = match found {
        Progress::Written(out, said) => (Merged::written(name, &out, said), Answer::Yes),
        Progress::Shared(out) => (Merged::shared(name, &out), Answer::Yes),
        Progress::Planned(job, phase) => (Merged::planned(name, &job, phase), Answer::Incomplete),
        Progress::Missing { job, phase, shards } => {
            (Merged::missing(name, Missing::new(&job, phase, shards)), Answer::Incomplete)
        }
    };
    Done::new(json, merged).answering(answer)
}
