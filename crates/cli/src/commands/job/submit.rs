//! `job submit`: has all shards done, round by round, and merges them.

use super::merge::{Progress, merge, report};
use super::task::Task;
use super::{absolute, interrupted, open};
use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, bail};
use crate::interrupt;
use crate::kept::PROGRAM;
use crate::output::{JsonSchema, Serialize};
use crate::progress::Bar;
use sightlines::checkpoint::engine::{
    Did, Engine, EngineError, Host, Local, Merge, Round, Rounds, ShellCommand, Slurm, quoted, run_rounds,
};
use sightlines::checkpoint::report::Merged;
use sightlines::checkpoint::{Job, ShardRun};
use sightlines::progress::{Observer, memory::n_threads};
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Who does shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    /// Workers on this machine
    Local,
    /// An array job of Slurm for the shards, and a job that merges behind it
    Slurm,
    /// A command of yours for each shard
    Command,
}

#[derive(Debug, clap::Args)]
pub(crate) struct SubmitArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    /// Who does the shards
    #[arg(long, help_heading = "Method", value_name = "WHO", default_value = "local")]
    engine: Kind,
    /// local: workers; command: commands that run at once [default: as many as there are cores]
    #[arg(long, help_heading = "Method", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    workers: Option<u32>,
    /// command: what a shell runs for a shard; {shard} stands for its number, {shards} for those of several, {job} for the folder of the job,
    /// {program} for this program. It ends when they are done: 'ssh node2 {program} job shard {job} {shards}'
    #[arg(long, help_heading = "Method", value_name = "TEMPLATE", required_if_eq("engine", "command"))]
    command: Option<String>,
    /// slurm: an option for sbatch, such as --sbatch=--partition=long; may be given several times
    #[arg(long, help_heading = "Method", value_name = "OPTION", allow_hyphen_values = true)]
    sbatch: Vec<String>,
    /// slurm: shards that a task does, one after the other; it prepares once for all of them
    #[arg(long, help_heading = "Method", value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards_per_task: u32,
    /// How often a shard that failed is tried again; one that ended with exit code 2 is not
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(0..=100))]
    retries: u32,
    /// Write scripts for Slurm into the folder of the job, and start nothing
    #[arg(long, help_heading = "Method")]
    dry_run: bool,
    /// The file to write [default: the output of the command that was planned]
    #[arg(short, long, help_heading = "Output", value_name = "OUT")]
    output: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArg,
}

/// The files that would be given to Slurm.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Submitted {
    /// The folder of the job.
    job: String,
    /// With `--dry-run`: the files that were written.
    files: Vec<String>,
}

impl fmt::Display for Submitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.files.iter().try_for_each(|file| writeln!(f, "wrote {file}"))
    }
}

pub(crate) fn run(args: &SubmitArgs, Verbosity { show_progress, verbose }: Verbosity) -> Result<Done> {
    let (folder, out) = (absolute(&args.job)?, args.output.as_deref().map(absolute).transpose()?);
    let program = std::env::current_exe().in_file(&folder)?;
    let job = open(&folder)?;
    let [shards, merging] = slurm_lines(&program, &folder, out.as_deref());
    let per_task = args.shards_per_task as usize;
    let slurm = Slurm { shards: &shards, merge: &merging, options: &args.sbatch, per_task };
    if args.dry_run {
        let Some(phase) = job.manifest().phases.len().checked_sub(1) else {
            bail!("{}: the job has no shards", args.job.display());
        };
        let shards: Vec<usize> = job.manifest().shards_of(phase).collect();
        let files = slurm.write(&Round { job: &job, phase, shards: &shards }, 0)?;
        let files = files.iter().map(|file| file.display().to_string()).collect();
        return Ok(Done::new(args.json, Submitted { job: args.job.display().to_string(), files }));
    }
    let workers = n_threads(args.workers.unwrap_or(0) as usize);
    let worker = || {
        let mut command = Command::new(&program);
        command.args(["job", "work"]).arg(&folder).args(["--workers", &workers.to_string(), "--threads", "1", "-q"]);
        command.arg("--json").args(out.iter().flat_map(|out| [Path::new("-o"), out]));
        command
    };
    let shards = |shards: &[usize]| {
        let mut command = Command::new(&program);
        command.args(["job", "shard"]).arg(&folder).args(ShardRun::texts(shards)).args(["--threads", "1", "-q"]);
        command
    };
    let engine: Box<dyn Engine + '_> = match (args.engine, &args.command) {
        (Kind::Slurm, _) => Box::new(slurm),
        (Kind::Command, Some(template)) => Box::new(ShellCommand { template, program: &program, workers }),
        _ => Box::new(Local { workers, worker: &worker, shards: &shards, told: Merged::told }),
    };
    let engine = Watched(&*engine);
    let observe = || -> Box<dyn Observer> { Box::new(Bar::new("shards", show_progress)) };
    let warn = |text: &str| tracing::warn!("{text}");
    // Nothing is left to do if standard error is closed.
    let said = |said: &[u8]| _ = io::stderr().write_all(said);
    let host = Host { observe: &observe, stop: interrupt::requested, warn, said };
    let merge = || -> Result<_> {
        Ok(match merge(&folder, out.as_deref(), None, show_progress, verbose)? {
            Progress::Planned(..) => Merge::Planned,
            Progress::Missing { phase, shards, .. } => Merge::Missing { phase, shards },
            written => Merge::Written(written),
        })
    };
    let found = match run_rounds((&folder, PROGRAM), (&engine, args.retries), &host, merge) {
        Ok(Rounds::Merged(written)) => written,
        Ok(Rounds::Missing { phase, shards }) => Progress::Missing { job: open(&folder)?, phase, shards },
        Ok(Rounds::Elsewhere(told)) => Progress::Written(output_of(&open(&folder)?, out.as_deref())?, told),
        Err(error) if matches!(error.downcast_ref(), Some(EngineError::Stopped)) => return Err(interrupted()),
        Err(error) => return Err(error),
    };
    Ok(report(&args.job, found, args.json))
}

/// An engine whose rounds end by themselves when the program is interrupted.
struct Watched<'a>(&'a dyn Engine);

impl Engine for Watched<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32, host: &Host<'_>) -> Result<Did, EngineError> {
        let _watch = interrupt::watch();
        self.0.run(round, attempt, host)
    }
}

/// What Slurm runs for shards, and to merge them.
fn slurm_lines(program: &Path, job: &Path, output: Option<&Path>) -> [String; 2] {
    let ([program, job], threads) = ([program, job].map(quoted), "\"${SLURM_CPUS_PER_TASK:-1}\"");
    let out = output.map_or(String::new(), |out| format!(" -o {}", quoted(out)));
    [
        format!("{program} job shard {job} \"$first-$last\" --threads {threads}"),
        format!("{program} job merge {job}{out} --threads {threads}"),
    ]
}

/// What the command of a job writes, or what was given in place of it.
fn output_of(job: &Job, given: Option<&Path>) -> Result<PathBuf> {
    let planned = || Ok(Path::new(&job.manifest().folder).join(Task::parse(&job.manifest().command)?.output()));
    given.map_or_else(planned, |given| Ok(given.to_owned()))
}
