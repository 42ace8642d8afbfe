//! `vis`: the visibility of a Quake map.

pub(crate) mod outcome;
mod sounds;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow, bail};
pub(crate) use outcome::Outcome;
pub(crate) use sounds::Sound;

use crate::clusters::warn_of_repeats;
use crate::input;
use crate::kept::{self, Keeping, Kept, ResumeArgs};
use crate::map_portals::{MapPortals, do_not_fit, portal_file, portals_for};
use crate::memory::MemoryArgs;
use crate::output;
use crate::progress::Bar;
use outcome::Wishes;
use sightlines::bake::quake::VisWishes;
use sightlines::bake::{PrtBakeError, PrtOptions, portals_need, vis_map};
use sightlines::checkpoint::{Identity, Inputs};
use sightlines::formats::InputKind;
use sightlines::formats::quake::overrides::parse_overrides;
use sightlines::formats::quake::vis_patch::{VisPatch, write_vis_patches};
use sightlines::formats::quake::visibility::check_portals;
use sightlines::formats::quake::{Bsp, Prt, VisibilityError, read_bsp};
use sightlines::stabtree::ConvexOptions;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, Default, clap::Args)]
pub(crate) struct VisArgs {
    /// The map, of Quake, Quake II or III, Half-Life, Hexen II, or one of their relatives that `info` names
    #[arg(value_name = "MAP.bsp")]
    pub(crate) map: PathBuf,
    /// The portal file that the compiler wrote [default: beside the map; made from the map if there is none]
    #[arg(long, help_heading = "Input", value_name = "MAP.prt")]
    prt: Option<PathBuf>,
    /// Compute only a coarse bound; fast, and reports much that is hidden as visible
    #[arg(long, help_heading = "Method")]
    pub(crate) fast: bool,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    pub(crate) threads: usize,
    #[command(flatten)]
    pub(crate) memory: MemoryArgs,
    #[command(flatten)]
    pub(crate) resume: ResumeArgs,
    /// Prove this many visible and as many hidden pairs, and check the proofs independently
    #[arg(long, help_heading = "Method", value_name = "N")]
    certify: Option<usize>,
    /// Hide leafs that are farther from each other than DIST, in map units, though they see each other: a wish, not visibility. The boxes count that the
    /// map states for them. What is nearer is shown as without it; the report counts the pairs
    #[arg(long, help_heading = "Output", value_name = "DIST", value_parser = crate::numbers::above_zero, allow_hyphen_values = true)]
    pub(crate) visdist: Option<f64>,
    /// Show and hide pairs of leafs, whatever is visible: a text with lines `show A B` and `hide A B`, with the numbers of leafs in the map. What
    /// is hidden is B from A alone, as by a one-way mirror; the report counts what was changed
    #[arg(long, help_heading = "Output", value_name = "FILE.txt")]
    overrides: Option<PathBuf>,
    /// Make no part of a Quake map sound of these nearby
    #[arg(long, help_heading = "Output", value_name = "SOUND,…", value_delimiter = ',')]
    pub(crate) silence: Vec<Sound>,
    /// The map to write; or, if the name ends in .vis, a VisPatch file with the visibility alone, for maps of Quake (BSP 29) that stay as they are
    /// [default: the input]
    #[arg(short, long, help_heading = "Output", value_name = "OUT.bsp|OUT.vis")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArg,
}

impl VisArgs {
    /// For a map with its portal file beside it, which is replaced.
    pub(crate) fn of_map(map: PathBuf) -> Self {
        Self { map, ..Self::default() }
    }
}

/// How to go about it, beside what the arguments say.
pub(crate) struct VisRun<'a, 'k> {
    pub(crate) show_progress: bool,
    /// Where results of units are kept.
    pub(crate) keeping: Keeping<'k>,
    /// Whether they are kept after the end.
    pub(crate) keep_after: bool,
    /// Called before the search.
    pub(crate) begin: &'a mut dyn FnMut(&Beginning<'_>) -> Result<()>,
}

/// What a search begins with.
pub(crate) struct Beginning<'a> {
    pub(crate) bsp: &'a Bsp,
    pub(crate) prt: &'a Prt,
    pub(crate) prt_path: &'a Path,
    /// Whether an earlier run is resumed.
    pub(crate) resumed: bool,
}

pub(crate) fn run(args: &VisArgs, Verbosity { show_progress, verbose }: Verbosity) -> Result<Done> {
    let mut outcome = make(args, Keeping::File(&args.resume), show_progress)?;
    outcome.verbose = verbose;
    Ok(Done::new(args.json, outcome))
}

/// Writes the map. Prints nothing but progress and warnings.
pub(crate) fn make(args: &VisArgs, keeping: Keeping<'_>, show_progress: bool) -> Result<Outcome> {
    compute(args, VisRun { show_progress, keeping, keep_after: false, begin: &mut |_| Ok(()) })
}

/// The same, in a run.
pub(crate) fn compute(args: &VisArgs, run: VisRun<'_, '_>) -> Result<Outcome> {
    crate::threads::use_only(args.threads);
    let start = Instant::now();
    args.memory.watch();
    if args.prt.is_none() && args.map.is_file() && input::kind_of(&args.map)? == Some(InputKind::Prt) {
        bail!(
            "{}: these are the portals of a map, and the map itself is needed: sightlines vis {} --prt {}",
            args.map.display(),
            args.map.with_extension("bsp").display(),
            args.map.display()
        );
    }
    let file = portal_file(&args.map, args.prt.as_deref());
    let out = args.output.as_ref().unwrap_or(&args.map);
    // The map may be replaced.
    output::check(&file.iter().chain(&args.overrides).map(PathBuf::as_path).collect::<Vec<_>>(), &[out])?;
    let wishes = args.wishes()?;
    let inputs = kept::look(run.keeping, [Some(&args.map), file.as_ref()].into_iter().flatten().map(PathBuf::as_path))?;
    let bsp = read_bsp(&args.map)?;
    let portals = portals_for(&bsp, &args.map, args.prt.as_deref())?;
    let format = portals.format();
    if run.show_progress {
        portals.announce();
    }
    let MapPortals { prt, path: prt_path, text, .. } = portals;
    let is_patch = output::has_ending(out, "vis");
    if is_patch {
        VisPatch::check(&name_of(&args.map), &bsp).in_file(&args.map)?;
    }
    check_portals(&bsp, &prt).map_err(|source| do_not_fit(&prt_path, &args.map, &source))?;
    warn_of_repeats(&prt_path, &prt);

    let too_large = |source| anyhow!("{}: {source}; allow more", args.map.display());
    let threads = args.memory.threads(args.threads, portals_need(&prt)).map_err(too_large)?;
    let kept = Kept::open(run.keeping, &inputs, &[out], || args.identity(&text, &inputs, run.keeping))?;
    drop(text);
    let resumed = kept.n_taken_up() > 0;
    (run.begin)(&Beginning { bsp: &bsp, prt: &prt, prt_path: &prt_path, resumed })?;
    let bar = Bar::new("visibility of clusters", run.show_progress);
    let sounds = sounds::all_but(&args.silence);
    let search = ConvexOptions { fast: args.fast, threads };
    let options = PrtOptions { search, progress: Some(&bar), units: kept.units(), sounds, wishes };
    let map = vis_map(&bsp, &prt, options);
    drop(bar);
    let map = match map {
        Ok(map) => map,
        Err(source) => {
            if let Some(interrupted) = kept.finish(false) {
                bail!("{interrupted}");
            }
            return Err(explained(source, args, &prt_path));
        }
    };
    kept.before_writing()?;
    // Before anything is written: a table that is proven wrong should not be.
    let certified = args.certify.map(|n| {
        let bar = Bar::new("proofs", run.show_progress);
        let proven = map.prove_some(n, args.fast, |done, all| bar.set(done, all));
        proven.map_err(|error| anyhow!("{}: {error}; nothing was written", prt_path.display()))
    });
    let certified = certified.transpose()?;
    let bytes = if is_patch { patch(&args.map, &map.bytes)? } else { map.bytes.clone() };
    if let Err(error) = output::save(out, &bytes) {
        kept.finish(false);
        return Err(error);
    }
    if run.keep_after {
        kept.leave();
    } else {
        kept.finish(true);
    }
    let mut outcome = Outcome::new((out, bytes.len()), &bsp, format, &map);
    outcome.wishes = Wishes::new(args.visdist, args.overrides.is_some(), &map.wished);
    (outcome.fast, outcome.resumed) = (args.fast, resumed);
    outcome.certified = certified;
    outcome.seconds = start.elapsed().as_secs_f64();
    Ok(outcome)
}

impl VisArgs {
    /// What the map is to say, whatever is visible.
    fn wishes(&self) -> Result<VisWishes> {
        let read = |path: &PathBuf| parse_overrides(&fs::read(path).in_file(path)?).in_file(path);
        let overrides = self.overrides.as_ref().map(read).transpose()?.unwrap_or_default();
        Ok(VisWishes { farthest: self.visdist, overrides })
    }

    /// What decides the results of units. A new argument does not compile until it is decided whether it is part of that.
    fn identity(&self, portals: &[u8], inputs: &Inputs, keeping: Keeping<'_>) -> Identity {
        #[rustfmt::skip]
        let Self {
            map: _, prt: _, fast, threads: _, memory: _, resume: _, certify: _, visdist: _, overrides: _, silence: _, output: _, json: _,
        } = self;
        // The search is of the portals alone: a map that was compiled again, or got its visibility, may have the same. A job is of its files.
        let mut identity = match keeping {
            Keeping::Job(_) => kept::identity("vis", inputs),
            Keeping::File(_) | Keeping::FileIfItFits(_) | Keeping::Nowhere => {
                Identity::apart_from((kept::PROGRAM, kept::UNITS), "vis", inputs)
            }
        };
        identity.debug("portals", &portals);
        identity.debug("options", fast);
        identity
    }
}

fn name_of(map: &Path) -> String {
    map.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn patch(path: &Path, map: &[u8]) -> Result<Vec<u8>> {
    let patch = || write_vis_patches(&[VisPatch::of_map(&name_of(path), &Bsp::parse(map.to_vec())?)?]);
    patch().in_file(path)
}

/// Puts the name of the file before what is wrong with it.
fn explained(source: PrtBakeError, args: &VisArgs, prt: &Path) -> anyhow::Error {
    let about = |path: &Path, source| anyhow!("{}: {source}", path.display());
    match source {
        PrtBakeError::NoLeaf { .. } | PrtBakeError::OneCluster { .. } => {
            about(args.overrides.as_deref().unwrap_or(&args.map), source)
        }
        PrtBakeError::Bsp(_) | PrtBakeError::Visibility(VisibilityError::Bsp(_) | VisibilityError::TooLarge { .. }) => {
            about(&args.map, source)
        }
        source => about(prt, source),
    }
}
