//! `reject`: the REJECT lumps of a WAD.

use crate::Answer;
use crate::file_error::{FileError, from_file_error};
use crate::kept::{Identity, Inputs, Interrupted, Keeping, Kept, KeptError, ResumeArgs};
use crate::memory::{self, MemoryArgs};
use crate::output::{self, count, percent, seconds};
use crate::progress::Bar;
use serde::Serialize;
use sightlines::bake::{MapOutcome, MapStatus, RejectError, RejectOptions, RejectSummary, reject_wad};
use sightlines::formats::Wad;
use sightlines::formats::doom::RmbFile;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Why `reject` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// The REJECT lumps of a WAD cannot be built.
    #[error("{}: {source}", path.display())]
    Reject { path: PathBuf, source: Box<RejectError> },
    /// Results cannot be kept, or taken up.
    #[error(transparent)]
    Kept(#[from] KeptError),
    /// The program was interrupted.
    #[error("{0}")]
    Interrupted(Interrupted),
}

from_file_error!(Error);

/// Arguments of `reject`.
#[derive(Debug, clap::Args)]
pub(crate) struct RejectArgs {
    /// The WAD to read
    #[arg(value_name = "IN.wad")]
    input: PathBuf,
    /// Process only this map; repeatable
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    map: Vec<String>,
    /// Also replace tables with hand-made effects (asymmetric, or a sector rejected from itself)
    #[arg(long, help_heading = "Method")]
    force: bool,
    /// Make the effects of this option file of RMB: BLIND and SAFE 0 and 1, INCLUDE, EXCLUDE
    #[arg(long, help_heading = "Method", value_name = "FILE.rej")]
    rmb: Option<PathBuf>,
    /// Stop at a map that cannot be done and write nothing, instead of doing the others
    #[arg(long, help_heading = "Method")]
    strict: bool,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    pub(crate) threads: usize,
    #[command(flatten)]
    pub(crate) memory: MemoryArgs,
    #[command(flatten)]
    pub(crate) resume: ResumeArgs,
    /// The WAD to write; may be the input
    #[arg(short, long, help_heading = "Output", value_name = "OUT.wad")]
    pub(crate) output: PathBuf,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &RejectArgs, show_progress: bool) -> Result<Answer, Error> {
    let outcome = make(args, Keeping::File(&args.resume), show_progress)?;
    output::print(args.json, &outcome)?;
    Ok(Answer::Yes)
}

/// Reads, builds and writes. Prints nothing but progress and warnings.
pub(crate) fn make(args: &RejectArgs, keeping: Keeping<'_>, show_progress: bool) -> Result<Outcome, Error> {
    crate::threads::use_only(args.threads);
    args.memory.watch();
    // It may be the WAD that is read.
    output::check(&[], &[&args.output])?;
    let files = std::iter::once(&args.input).chain(&args.rmb).map(PathBuf::as_path);
    let inputs = Inputs::look(keeping, files)?;
    let wad = Wad::read(&args.input)?;
    let rmb = args.rmb.as_ref().map(RmbFile::read).transpose()?;
    let kept = Kept::open(keeping, &inputs, &[&args.output], || args.identity(&inputs))?;
    let made = || -> Result<Outcome, Error> {
        let bar = Bar::new("visibility of sectors", show_progress);
        let options = RejectOptions {
            maps: args.map.clone(),
            force: args.force,
            strict: args.strict,
            rmb: rmb.as_ref(),
            threads: args.threads,
            progress: Some(&bar),
            units: kept.units(),
        };
        let outcome = reject_wad(&wad, &options);
        drop(bar);
        let outcome = outcome.map_err(|source| {
            let path = match (&source, &args.rmb) {
                (RejectError::Rmb(_), Some(options)) => options,
                _ => &args.input,
            };
            Error::Reject { path: path.clone(), source: Box::new(source) }
        })?;
        kept.before_writing()?;
        output::save(&args.output, &outcome.bytes)?;
        warn(&args.input, &outcome.maps);
        let maps = outcome.maps.iter().map(Map::from).collect();
        Ok(Outcome { out: args.output.display().to_string(), maps, peak_bytes: memory::peak_bytes() })
    };
    let made = made();
    match kept.finish(made.is_ok()) {
        Some(interrupted) => Err(Error::Interrupted(interrupted)),
        None => made,
    }
}

impl RejectArgs {
    /// What decides the results of units. A new argument does not compile until it is decided whether it is part of that.
    fn identity(&self, inputs: &Inputs) -> Identity {
        let Self { input: _, map, force, rmb: _, strict, threads: _, memory: _, resume: _, output: _, json: _ } = self;
        let mut identity = Identity::new("reject", inputs);
        identity.debug("options", &(map, force, strict));
        identity
    }
}

/// Names the maps that could not be done, and those that had lines without length.
fn warn(path: &Path, maps: &[MapOutcome]) {
    for map in maps {
        match &map.status {
            MapStatus::Failed(reason) => tracing::warn!("{}: not done: {reason}", path.display()),
            MapStatus::Written(RejectSummary { n_lines_without_length: n @ 1.., .. }) => {
                let lines = count(*n as u64, "line");
                tracing::warn!("{}: map {}: {lines} without length left out", path.display(), map.name);
            }
            _ => {}
        }
    }
}

/// What became of a WAD.
#[derive(Debug, Serialize)]
pub(crate) struct Outcome {
    out: String,
    maps: Vec<Map>,
    /// The most memory that was in use at once; null where the system does not report it.
    peak_bytes: Option<u64>,
}

/// What became of a map.
#[derive(Debug, Serialize)]
struct Map {
    name: String,
    /// `written`, `kept` (effects made by hand), `skipped` (a format that is not read) or `failed`.
    status: &'static str,
    /// Why it failed; null unless it did.
    reason: Option<String>,
    n_sectors: u32,
    /// Ordered pairs; null unless written.
    n_rejected: Option<u64>,
    n_effects: Option<u64>,
    n_disputed_cells: Option<usize>,
    n_lines_without_length: Option<usize>,
    n_rounded_crossings: Option<usize>,
    n_dropped_pieces: Option<usize>,
    seconds: f64,
}

impl From<&MapOutcome> for Map {
    fn from(outcome: &MapOutcome) -> Self {
        let (status, did) = match &outcome.status {
            MapStatus::Written(did) => ("written", Some(did)),
            MapStatus::KeptHandMade => ("kept", None),
            MapStatus::Failed(_) => ("failed", None),
            _ => ("skipped", None),
        };
        let reason = match &outcome.status {
            MapStatus::Failed(reason) => Some(reason.to_string()),
            _ => None,
        };
        Self {
            name: outcome.name.to_string(),
            status,
            reason,
            n_sectors: outcome.n_sectors,
            n_rejected: did.map(|d| d.n_rejected),
            n_effects: did.map(|d| d.n_effects),
            n_disputed_cells: did.map(|d| d.n_disputed_cells),
            n_lines_without_length: did.map(|d| d.n_lines_without_length),
            n_rounded_crossings: did.map(|d| d.n_rounded_crossings),
            n_dropped_pieces: did.map(|d| d.n_dropped_pieces),
            seconds: outcome.time.as_secs_f64(),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for map in &self.maps {
            writeln!(f, "{map}")?;
        }
        let written = self.maps.iter().filter(|map| map.status == "written").count();
        writeln!(f, "wrote {}: {} of {} built", self.out, written, count(self.maps.len() as u64, "map"))
    }
}

impl fmt::Display for Map {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:<8} ", self.name)?;
        match (self.status, self.n_rejected) {
            (_, Some(n)) => {
                let pairs = (f64::from(self.n_sectors) * f64::from(self.n_sectors)).max(1.0);
                let time = seconds(Duration::from_secs_f64(self.seconds));
                write!(f, "{:>5} sectors, {:>7} of pairs rejected, {time}", self.n_sectors, percent(n as f64 / pairs))?;
                match self.n_effects {
                    Some(n @ 1..) => write!(f, ", {} changed by effects", count(n, "pair")),
                    _ => Ok(()),
                }
            }
            ("failed", _) => write!(f, "failed: {}", self.reason.as_deref().unwrap_or_default()),
            ("kept", _) => f.write_str("kept: its table has effects made by hand (--force replaces it)"),
            _ => f.write_str("skipped: its format is not supported"),
        }
    }
}
