//! The command that a job shares.

use crate::commands::tiles::TilesCommand;
use crate::commands::{build, reject, tiles, vis};
use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::kept::Keeping;
use crate::memory::MemoryArgs;
use clap::{Parser, Subcommand};
use sightlines::checkpoint::Job;
use std::path::{Path, PathBuf};

/// A command line that a job can share. `-v` and `-q` may be in it, as in any other.
#[derive(Debug, Parser)]
#[command(name = "sightlines")]
struct Line {
    #[command(subcommand)]
    command: Command,
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
    #[arg(short, long, global = true)]
    quiet: bool,
}

/// The commands that can be shared.
#[derive(Debug, Subcommand)]
enum Command {
    Build(Box<build::BuildArgs>),
    Reject(reject::RejectArgs),
    Tiles(tiles::TilesArgs),
    Vis(vis::VisArgs),
}

const NAMES: [&str; 4] = ["build", "reject", "tiles", "vis"];

/// The command that a job shares, with its arguments.
#[derive(Debug)]
pub(super) enum Task {
    Build(Box<build::BuildArgs>),
    Reject(reject::RejectArgs),
    Tiles(Box<tiles::TilesBuildArgs>),
    Vis(vis::VisArgs),
}

impl Task {
    /// The command in words of a command line behind the name of the program. Refuses what cannot be shared.
    pub(super) fn parse(words: &[String]) -> Result<Self> {
        let name = words.first().map_or("", String::as_str);
        if !NAMES.contains(&name) {
            bail!("{name}: only build, vis, reject and tiles build can be shared");
        }
        let line = std::iter::once("sightlines").chain(words.iter().map(String::as_str));
        let parsed = Line::try_parse_from(line).map_err(|error| anyhow!("{}", plain(&error)))?;
        let refuse = |option: &str| Err(anyhow!("{option} means nothing for a job"));
        match parsed.command {
            Command::Build(args) if args.time_limit.is_some() => refuse("--time-limit"),
            Command::Build(args) if args.resume.is_given() => refuse("--resume or --state"),
            Command::Reject(args) if args.resume.is_given() => refuse("--resume or --state"),
            Command::Vis(args) if args.resume.is_given() => refuse("--resume or --state"),
            Command::Build(args) => Ok(Self::Build(args)),
            Command::Reject(args) => Ok(Self::Reject(args)),
            Command::Tiles(args) => match args.what {
                TilesCommand::Build(args) => Ok(Self::Tiles(args)),
                _ => Err(anyhow!("of tiles, only tiles build can be shared")),
            },
            Command::Vis(args) => Ok(Self::Vis(args)),
        }
    }

    /// The command of a job. From here on the program runs in the folder where the job was planned.
    ///
    /// Refuses files that have changed since.
    pub(super) fn of(job: &Job) -> Result<Self> {
        let manifest = job.manifest();
        let folder = PathBuf::from(&manifest.folder);
        std::env::set_current_dir(&folder).in_file(&folder)?;
        job.check_inputs()?;
        Self::parse(&manifest.command)
    }

    /// The same with another number of threads.
    pub(super) fn with_threads(mut self, threads: Option<usize>) -> Self {
        let own = match &mut self {
            Self::Build(args) => &mut args.bake.threads,
            Self::Reject(args) => &mut args.threads,
            Self::Tiles(args) => &mut args.threads,
            Self::Vis(args) => &mut args.threads,
        };
        *own = threads.unwrap_or(*own);
        self
    }

    /// The same with another budget of memory, if one is given.
    pub(super) fn with_memory(mut self, memory: MemoryArgs) -> Self {
        let own = match &mut self {
            Self::Build(args) => &mut args.memory,
            Self::Reject(args) => &mut args.memory,
            Self::Tiles(args) => &mut args.memory,
            Self::Vis(args) => &mut args.memory,
        };
        *own = memory.or(*own);
        self
    }

    /// The same with another output.
    pub(super) fn with_output(mut self, output: Option<&Path>) -> Self {
        if let Some(output) = output {
            match &mut self {
                Self::Build(args) => args.output = output.to_owned(),
                Self::Reject(args) => args.output = output.to_owned(),
                Self::Tiles(args) => args.output = output.to_owned(),
                Self::Vis(args) => args.output = Some(output.to_owned()),
            }
        }
        self
    }

    pub(super) fn output(&self) -> &Path {
        match self {
            Self::Build(args) => &args.output,
            Self::Reject(args) => &args.output,
            Self::Tiles(args) => &args.output,
            Self::Vis(args) => args.output.as_ref().unwrap_or(&args.map),
        }
    }

    /// Does it, with units in a store; returns what the command says of it.
    pub(super) fn make(&self, keeping: Keeping<'_>, show_progress: bool, verbose: bool) -> Result<String> {
        Ok(match self {
            Self::Build(args) => build::make(args, keeping, show_progress, verbose)?.to_string(),
            Self::Reject(args) => reject::make(args, keeping, show_progress)?.to_string(),
            Self::Tiles(args) => tiles::make(args, keeping, show_progress)?.to_string(),
            Self::Vis(args) => vis::make(args, keeping, show_progress)?.to_string(),
        })
    }
}

/// An error of arguments without colours, `error:` and usage.
fn plain(error: &clap::Error) -> String {
    let text = error.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    format!("the command of the job: {}", text.lines().next().unwrap_or_default())
}
