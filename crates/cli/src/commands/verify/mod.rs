//! `verify`: is a table true to its scene?

mod drawing;
mod outcome;
mod proofs;
mod truth;

use crate::Answer;
use crate::commands::draw::PictureKind;
use crate::error::CliError;
use crate::input::{self, Kind};
use crate::{output, tables};
use outcome::Outcome;
use sightlines::pvs::Table;
use sightlines::verify::{VerifyOptions, verify};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `verify`.
#[derive(Debug, clap::Args)]
pub(crate) struct VerifyArgs {
    /// The table, plain or packed
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    /// What it was built from: a WAD, a floor plan as GeoJSON, a scene in space as GLB, glTF or OBJ, a Quake map, or its
    /// portal file alone
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Which map of the WAD; not needed if there is only one
    #[arg(long, value_name = "NAME")]
    map: Option<String>,
    /// Quake maps only: the portal file; beside the map if not given
    #[arg(long, value_name = "MAP.prt")]
    prt: Option<PathBuf>,
    /// Rays in random directions from random places
    #[arg(long, value_name = "N", default_value_t = VerifyOptions::default().rays)]
    rays: u64,
    /// Hidden pairs, of cells or of a cell and an object, that rays are aimed at, the most suspicious first
    #[arg(long, value_name = "N", default_value_t = VerifyOptions::default().pairs)]
    pairs: u64,
    /// Rays aimed at each of these pairs; eight times as many at those with nothing but visible pairs around
    #[arg(long, value_name = "N", default_value_t = VerifyOptions::default().tries)]
    tries: u32,
    /// What the random numbers begin with; the same seed gives the same answer
    #[arg(long, value_name = "N", default_value_t = VerifyOptions::default().seed)]
    seed: u64,
    /// Number of threads; 0 for one for each core. Changes nothing but the time
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = crate::args::threads)]
    threads: usize,
    /// Draw the first ray that shows a violation, on the plan or on the floor where it begins
    #[arg(long, value_name = "OUT.svg|OUT.png")]
    draw: Option<PathBuf>,
    #[command(flatten)]
    proofs: proofs::ProofArgs,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Bytes of blocks of a packed table that are kept while it is unpacked.
const CACHE: usize = 64 << 20;

pub(crate) fn run(args: &VerifyArgs) -> Result<Answer, CliError> {
    if let Some(picture) = &args.draw {
        PictureKind::of(picture)?;
        output::refuse_same(&args.table, picture)?;
        output::refuse_same(&args.scene, picture)?;
    }
    let table = read_table(&args.table)?;
    let scene = truth::Real::read(&args.scene, args.map.as_deref(), args.prt.as_deref())?;
    if args.draw.is_some() {
        input::refuse_without_places(&table, &args.table, "no ray can be drawn")?;
    }
    let VerifyArgs { rays, pairs, tries, seed, threads, .. } = *args;
    let start = Instant::now();
    let findings = verify(&table, &scene.truth(), &VerifyOptions { rays, pairs, tries, seed, threads });
    let findings =
        findings.map_err(|source| CliError::Verify { table: args.table.clone(), scene: args.scene.clone(), source })?;
    let time = start.elapsed();
    // All that may be refused comes before a file is written.
    let proofs = proofs::check(&args.proofs, &args.table, &table, &scene.truth())?;
    let drawn = match &args.draw {
        Some(out) => drawing::draw(&args.table, &table, &findings, out)?,
        None => None,
    };
    let is_true = findings.is_true() && proofs.as_ref().is_none_or(|proofs| proofs.is_true);
    let outcome = Outcome::new(&args.table, &args.scene, &findings, is_true, time, drawn);
    output::print(args.json, &proofs::With { outcome, proofs })?;
    Ok(if is_true { Answer::Yes } else { Answer::No })
}

/// Reads a table of either kind.
fn read_table(path: &Path) -> Result<Table, CliError> {
    if input::kind_of(path)? != Some(Kind::Packed) {
        return input::table(path);
    }
    let failed = |source| CliError::Packed { path: path.to_owned(), source };
    tables::packed(path, CACHE)?.to_table().map_err(failed)
}
