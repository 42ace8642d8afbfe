//! `job submit`: has all shards done, round by round, and merges them.

use super::engine::{Command, Did, Engine, Local, Round, Slurm};
use super::merge::{Progress, merge, report};
use super::outcome::{Missing, Submitted};
use super::task::Task;
use super::{absolute, open};
use crate::command::{Done, Manner};
use crate::commands::job::interrupted;
use crate::error::{ErrorAbout, Result, bail};
use crate::interrupt;
use crate::named::one_of;
use sightlines::checkpoint::{Job, ShardState};
use std::path::{Path, PathBuf};

/// Who does shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Local,
    Slurm,
    Command,
}

impl Kind {
    const ALL: [Self; 3] = [Self::Local, Self::Slurm, Self::Command];

    const fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Slurm => "slurm",
            Self::Command => "command",
        }
    }

    const fn about(self) -> &'static str {
        match self {
            Self::Local => "Workers on this machine",
            Self::Slurm => "An array job of Slurm for the shards, and a job that merges behind it",
            Self::Command => "A command of yours for each shard",
        }
    }
}

/// Arguments of `job submit`.
#[derive(Debug, clap::Args)]
pub(crate) struct SubmitArgs {
    /// The folder of the job
    #[arg(value_name = "JOB")]
    job: PathBuf,
    /// Who does the shards
    #[arg(long, help_heading = "Method", value_name = "WHO", default_value = "local", value_parser = one_of(&Kind::ALL, Kind::name, Kind::about))]
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
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &SubmitArgs, Manner { show_progress, verbose }: Manner) -> Result<Done> {
    let (folder, out) = (absolute(&args.job)?, args.output.as_deref().map(absolute).transpose()?);
    let program = std::env::current_exe().in_file(&folder)?;
    let job = open(&folder)?;
    let (options, per_task) = (&args.sbatch[..], args.shards_per_task as usize);
    let slurm = Slurm { program: &program, options, per_task, output: out.as_deref(), show_progress };
    if args.dry_run {
        let Some(phase) = job.manifest().phases.len().checked_sub(1) else {
            bail!("{}: the job has no shards", args.job.display());
        };
        let shards: Vec<usize> = job.manifest().shards_of(phase).collect();
        let files = slurm.write(&Round { job: &job, phase, shards: &shards }, 0)?;
        let files = files.iter().map(|file| file.display().to_string()).collect();
        return Ok(Done::new(args.json, Submitted { job: args.job.display().to_string(), files }));
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let workers = args.workers.map_or(cores, |n| n as usize);
    let engine: Box<dyn Engine + '_> = match (args.engine, &args.command) {
        (Kind::Slurm, _) => Box::new(slurm),
        (Kind::Command, Some(template)) => Box::new(Command { program: &program, template, workers, show_progress }),
        _ => Box::new(Local { program: &program, workers, output: out.as_deref(), show_progress }),
    };
    let mut tries = Tries { phase: None, n: 0 };
    let found = loop {
        let job = open(&folder)?;
        // Parts of earlier tries count.
        if let Some(round) = undone(&job)? {
            if tries.count(round.0) > args.retries + 1 {
                let missing = Missing::new(&job, round.0, states(&job, &round.1)?);
                break Progress::Missing(job, missing);
            }
            if let Did::Output(said) = engine.run(&Round { job: &job, phase: round.0, shards: &round.1 }, tries.n)? {
                let out = match &out {
                    Some(out) => out.clone(),
                    None => Path::new(&job.manifest().folder).join(Task::parse(&job.manifest().command)?.output()),
                };
                break Progress::Elsewhere(out, said);
            }
        }
        if interrupt::requested() {
            return Err(interrupted());
        }
        if undone(&open(&folder)?)?.is_some() {
            continue;
        }
        match merge(&folder, out.as_deref(), None, show_progress, verbose)? {
            Progress::Planned(..) => {}
            // Broken parts, which look like parts: they are removed so that they are done again.
            Progress::Missing(job, missing) => {
                remove(&job, &missing);
                if tries.n > args.retries {
                    break Progress::Missing(job, missing);
                }
            }
            written => break written,
        }
    };
    Ok(report(&args.job, found, args.json))
}

/// How often the shards of a phase were tried.
struct Tries {
    phase: Option<usize>,
    n: u32,
}

impl Tries {
    /// Counts a try, and returns how many there were of this phase.
    fn count(&mut self, phase: usize) -> u32 {
        if self.phase.replace(phase) != Some(phase) {
            self.n = 0;
        }
        self.n += 1;
        self.n
    }
}

/// The first phase with shards that have no sound part, and these shards.
fn undone(job: &Job) -> Result<Option<(usize, Vec<usize>)>> {
    for phase in 0..job.manifest().phases.len() {
        let mut shards = Vec::new();
        for shard in job.manifest().shards_of(phase) {
            if job.state(shard)? != ShardState::Done {
                shards.push(shard);
            }
        }
        if !shards.is_empty() {
            return Ok(Some((phase, shards)));
        }
    }
    Ok(None)
}

fn states(job: &Job, shards: &[usize]) -> Result<Vec<(usize, ShardState)>> {
    shards.iter().map(|&shard| Ok((shard, job.state(shard)?))).collect()
}

fn remove(job: &Job, missing: &Missing) {
    // What cannot be read now may be sound, and what was not there may have been written meanwhile.
    let damaged =
        missing.shards().into_iter().filter(|&shard| job.has_damaged_part(shard).is_ok_and(|damaged| damaged));
    for path in damaged.map(|shard| job.part_path(shard)) {
        // If it cannot be removed, it is found to be broken again.
        let _: Result<(), _> = std::fs::remove_file::<&Path>(&path);
    }
}
