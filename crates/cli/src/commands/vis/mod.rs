//! `vis`: the visibility of a Quake map.

mod certify;
mod error;
mod outcome;
mod saved;

use crate::Answer;
use crate::clusters::warn_of_repeats;
use crate::error::InputError;
use crate::input;
use crate::output;
use crate::progress::Bar;
use certify::certify;
use error::Error;
use outcome::Outcome;
use saved::Saved;
use sightlines::bake::quake::StateKey;
use sightlines::bake::{PrtBakeError, PrtOptions, vis_map};
use sightlines::formats::InputKind;
use sightlines::formats::quake::visibility::check_portals;
use sightlines::formats::quake::{VisibilityError, graph_of_prt, prt, read_bsp};
use sightlines::formats::{Prt, ReadError};
use sightlines::stabtree::{ConvexOptions, ConvexSearch};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Arguments of `vis`.
#[derive(Debug, clap::Args)]
pub(crate) struct VisArgs {
    /// The map, of Quake, Quake II or III, Half-Life, Hexen II, or one of their relatives that `info` names
    #[arg(value_name = "MAP.bsp")]
    map: PathBuf,
    /// The portal file that the compiler wrote [default: beside the map]
    #[arg(long, help_heading = "Input", value_name = "MAP.prt")]
    prt: Option<PathBuf>,
    /// Compute only a coarse bound; fast, and reports much that is hidden as visible
    #[arg(long, help_heading = "Method")]
    fast: bool,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    threads: usize,
    /// Resume an interrupted run with the same portals and options
    #[arg(long, help_heading = "Resuming")]
    resume: bool,
    /// File for the state of the run [default: beside the output, with the extension .vis-state]
    #[arg(long, help_heading = "Resuming", value_name = "FILE")]
    state: Option<PathBuf>,
    /// Seconds between two savings of the state
    #[arg(long, help_heading = "Resuming", hide = true, value_name = "SECONDS", default_value_t = 30)]
    save_every: u64,
    /// Prove this many visible and as many hidden pairs, and check the proofs independently
    #[arg(long, help_heading = "Method", value_name = "N")]
    certify: Option<usize>,
    /// The map to write [default: the input]
    #[arg(short, long, help_heading = "Output", value_name = "OUT.bsp")]
    output: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &VisArgs, show_progress: bool, verbose: bool) -> Result<Answer, Error> {
    let start = Instant::now();
    if args.prt.is_none() && args.map.is_file() && input::kind_of(&args.map)? == Some(InputKind::Prt) {
        return Err(Error::PortalsForMap { path: args.map.clone(), command: "sightlines vis" });
    }
    let prt_path = args.prt.clone().unwrap_or_else(|| args.map.with_extension("prt"));
    let out = args.output.as_ref().unwrap_or(&args.map);
    let state_path = args.state.clone().unwrap_or_else(|| out.with_extension("vis-state"));
    // The map may be replaced. A state that cannot be written is reported when it is needed: the search goes on
    // without.
    output::check(&[&prt_path, &state_path], &[out])?;
    let bsp = read_bsp(&args.map)?;
    if args.prt.is_none() && !prt_path.exists() {
        return Err(InputError::MapWithoutPortals(args.map.clone()).into());
    }
    let (prt, text) = read_portals(&prt_path)?;
    check_portals(&bsp, &prt).map_err(|source| InputError::of_portals(&prt_path, &args.map, Box::new(source)))?;
    warn_of_repeats(&prt_path, &prt);

    let key = StateKey::new(&text, args.fast);
    drop(text);
    let every = Duration::from_secs(args.save_every);
    let (mut saved, from) = Saved::open(state_path, every, key, &graph_of_prt(&prt), args.resume)?;
    let resumed = from.is_some();
    let bar = Bar::new("visibility of clusters", show_progress);
    let mut save = |search: &ConvexSearch| saved.save(search.state());
    let search = ConvexOptions { fast: args.fast, threads: args.threads };
    let map = vis_map(&bsp, &prt, PrtOptions { search, from, progress: Some(&bar), after_step: Some(&mut save) });
    drop(bar);
    let map = map.map_err(|source| explained(source, args, &prt_path, &saved))?;
    // Before anything is written: a table that is proven wrong should not be.
    let certified = args.certify.map(|n| {
        let bar = Bar::new("proofs", show_progress);
        certify(&prt_path, &map.graph, &map.clusters.seen, n, args.fast, &bar)
    });
    let certified = certified.transpose()?;
    output::save(out, &map.bytes)?;
    saved.remove();
    let mut outcome = Outcome::new(out, &bsp, &prt, &map);
    (outcome.fast, outcome.resumed, outcome.verbose) = (args.fast, resumed, verbose);
    outcome.certified = certified;
    outcome.seconds = start.elapsed().as_secs_f64();
    output::print(args.json, &outcome)?;
    Ok(Answer::Yes)
}

/// The portals, and the bytes of their file.
fn read_portals(path: &Path) -> Result<(Prt, Vec<u8>), Error> {
    let text = std::fs::read(path).map_err(|error| ReadError::new(path, error))?;
    let prt = prt::parse_prt(&text).map_err(|error| ReadError::new(path, error))?;
    Ok((prt, text))
}

/// Puts the name of the file before what is wrong with it.
fn explained(source: PrtBakeError, args: &VisArgs, prt: &Path, saved: &Saved) -> Error {
    let about = |path: &Path, source| Error::BakePrt { path: path.to_owned(), source };
    match source {
        PrtBakeError::State(source) => Error::State { path: saved.path().to_owned(), source },
        PrtBakeError::Bsp(_) | PrtBakeError::Visibility(VisibilityError::Bsp(_) | VisibilityError::TooLarge { .. }) => {
            about(&args.map, source)
        }
        source => about(prt, source),
    }
}
