//! `reject`: the REJECT lumps of a WAD, or of all WADs in a folder.

mod folder;
pub(crate) mod outcome;

pub(crate) use outcome::Outcome;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{Result, anyhow};
use crate::kept::{self, Keeping, Kept, ResumeArgs};
use crate::memory::MemoryArgs;
use crate::named::one_of;
use crate::output::{self, count};
use crate::progress::Bar;
use outcome::{Map, WadOutcome};
use sightlines::bake::{MapOutcome, MapStatus, RejectError, RejectOptions, RejectSummary, reject_wad};
use sightlines::checkpoint::{Identity, Inputs};
use sightlines::formats::Wad;
use sightlines::formats::doom::{Game, RmbFile};
use sightlines::progress::memory;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Of a folder, all files in it whose names end in .wad, in any case, are done in the order of their names, but for hidden ones; not those in \
                  folders below. Each is written under its name into the other folder once the tables of all are there. A WAD without maps is skipped. One \
                  that cannot be done, or is no WAD, is named and left out, and the others are done; with --strict nothing is written."
)]
pub(crate) struct RejectArgs {
    /// The WAD to read, or a folder of WADs
    #[arg(value_name = "IN.wad")]
    input: PathBuf,
    /// Process only this map; repeatable. Of a folder, those maps of these names that its WADs have
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    map: Vec<String>,
    /// Also replace tables with hand-made effects (asymmetric, or a sector rejected from itself)
    #[arg(long, help_heading = "Method")]
    force: bool,
    /// Make the effects of this option file of RMB: BLIND and SAFE 0 and 1, INCLUDE, EXCLUDE; not for a folder
    #[arg(long, help_heading = "Method", value_name = "FILE.rej")]
    rmb: Option<PathBuf>,
    /// The game whose engines read the tables. Those of Heretic and Hexen look through every line with a left side, those of Doom only if it is flagged as two-sided.
    /// Without it tables are right for all; Hexen's format and a UDMF namespace of either game count more
    #[arg(long, help_heading = "Method", value_name = "GAME", value_parser = one_of(&GAMES, game_name, |_| ""))]
    game: Option<Game>,
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
    /// The WAD to write; may be the input. Of a folder, another folder, which is made if it is not there: files of other names in it stay
    #[arg(short, long, help_heading = "Output", value_name = "OUT.wad")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

/// Values of `--game`.
const GAMES: [Game; 3] = [Game::Doom, Game::Heretic, Game::Hexen];

fn game_name(game: Game) -> &'static str {
    ["doom", "heretic", "hexen"][game as usize]
}

pub(crate) fn run(args: &RejectArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let outcome = make(args, Keeping::File(&args.resume), show_progress)?;
    Ok(Done::new(args.json, outcome))
}

/// Reads, builds and writes. Prints nothing but progress and warnings.
pub(crate) fn make(args: &RejectArgs, keeping: Keeping<'_>, show_progress: bool) -> Result<Outcome> {
    crate::threads::use_only(args.threads);
    args.memory.watch();
    if args.input.is_dir() {
        return folder::make(args, keeping, show_progress).map(Outcome::Folder);
    }
    make_wad(args, keeping, show_progress).map(Outcome::Wad)
}

fn make_wad(args: &RejectArgs, keeping: Keeping<'_>, show_progress: bool) -> Result<WadOutcome> {
    // It may be the WAD that is read.
    output::check(&[], &[&args.output])?;
    let files = std::iter::once(&args.input).chain(&args.rmb).map(PathBuf::as_path);
    let inputs = kept::look(keeping, files)?;
    let wad = Wad::read(&args.input)?;
    warn_of_lost(&args.input, &wad);
    let rmb = args.rmb.as_ref().map(RmbFile::read).transpose()?;
    let kept = Kept::open(keeping, &inputs, &[&args.output], || args.identity(&inputs, &[]))?;
    let made = || -> Result<WadOutcome> {
        let bar = Bar::new(BAR, show_progress);
        let options = RejectOptions { rmb: rmb.as_ref(), ..args.options(&bar, &kept) };
        let outcome = reject_wad(&wad, &options);
        drop(bar);
        let outcome = outcome.map_err(|source| {
            let path = match (&source, &args.rmb) {
                (RejectError::Rmb(_), Some(options)) => options,
                _ => &args.input,
            };
            anyhow!("{}: {source}", path.display())
        })?;
        kept.before_writing()?;
        output::save(&args.output, &outcome.bytes)?;
        warn(&args.input, &outcome.maps);
        let maps = outcome.maps.iter().map(Map::from).collect();
        Ok(WadOutcome { out: args.output.display().to_string(), maps, peak_bytes: memory::peak_bytes() })
    };
    let made = made();
    kept.end(made)
}

/// What the bar is of.
const BAR: &str = "visibility of sectors";

impl RejectArgs {
    /// Those of the bake, without effects.
    fn options<'a>(&self, bar: &'a Bar, kept: &'a Kept<'_>) -> RejectOptions<'a> {
        RejectOptions {
            maps: self.map.clone(),
            force: self.force,
            strict: self.strict,
            rmb: None,
            game: self.game,
            threads: self.threads,
            progress: Some(bar),
            units: kept.units(),
        }
    }

    /// What decides the results of units. A new argument does not compile until it is decided whether it is part of that.
    ///
    /// * `names`: those of the WADs of a folder
    fn identity(&self, inputs: &Inputs, names: &[&OsStr]) -> Identity {
        let Self { input: _, map, force, rmb: _, game, strict, threads: _, memory: _, resume: _, output: _, json: _ } =
            self;
        let mut identity = kept::identity("reject", inputs);
        identity.debug("options", &(map, force, strict));
        game.iter().for_each(|game| identity.debug("game", game));
        names.iter().for_each(|name| identity.debug("name", name));
        identity
    }
}

fn warn_of_lost(path: &Path, wad: &Wad) {
    for (index, lump) in wad.lumps().iter().enumerate().filter(|(_, lump)| lump.is_lost()) {
        let (path, name) = (path.display(), lump.name);
        tracing::warn!("{path}: lump {index} ({name}) is not inside the file, and counts as empty");
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
