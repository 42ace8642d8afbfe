//! `verify`: is a table true to its scene?

mod drawing;
mod own;
mod proofs;
mod truth;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{Result, anyhow};
use crate::input;
use crate::input::refuse;
use crate::picture::PictureKind;
use crate::plans::PlanArgs;
use crate::progress::Bar;
use crate::surfaces::SurfaceArgs;
use crate::{output, tables};
use sightlines::verify::report::{Unproven, VerifyReport, Violations};
use sightlines::verify::{VerifyOptions, verify};
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub(crate) struct VerifyArgs {
    /// The table (plain or packed), or a Quake map or WAD whose own visibility or REJECT lump is checked, or a VisPatch file with the visibility of
    /// the map
    #[arg(value_name = "FILE.pvs|MAP.bsp|MAP.vis|FILE.wad")]
    table: PathBuf,
    #[arg(value_name = "SCENE", help = crate::input::with_formats(
        "The input it was built from: a WAD, a {plans} floor plan, a scene as {scenes}, a Quake map, or its portal file alone"
    ))]
    scene: PathBuf,
    /// The map of the WAD; optional if there is only one
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    map: Option<String>,
    /// Quake maps: the portal file [default: beside the map]
    #[arg(long, help_heading = "Input", value_name = "MAP.prt")]
    prt: Option<PathBuf>,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    #[command(flatten)]
    plans: PlanArgs,
    /// Number of rays from random places in random directions
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = VerifyOptions::default().rays)]
    rays: u64,
    /// Number of hidden pairs (two cells, or a cell and an object) to aim rays at, the most suspicious first
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = VerifyOptions::default().pairs)]
    pairs: u64,
    /// Number of rays aimed at each of these pairs; eight times as many where all neighbouring pairs are visible
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = VerifyOptions::default().tries)]
    tries: u32,
    /// Number of random segments for each hidden pair next to a visible one, or for all where cells leave gaps; fewer if there are very many
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = VerifyOptions::default().segments)]
    segments: u32,
    /// Seed of the random numbers; the same seed gives the same result
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = VerifyOptions::default().seed)]
    seed: u64,
    /// Number of threads; 0 uses every core. Does not change the result
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    threads: usize,
    #[command(flatten, next_help_heading = "Proofs")]
    proofs: proofs::ProofArgs,
    /// Draw the first violating ray, on the plan or on the floor where it starts
    #[arg(long, help_heading = "Output", value_name = "OUT.svg|OUT.png")]
    draw: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &VerifyArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    if let Some(picture) = &args.draw {
        PictureKind::of(picture)?;
        output::check(&[&args.table, &args.scene], &[picture])?;
    }
    let own = own::read(&args.table, &args.scene, args.map.as_deref(), args.prt.as_deref())?;
    let table = match &own {
        Some(own) => &own.table,
        None => &tables::read(&args.table)?,
    };
    // What the table was built with holds without being said again.
    let options = args.surfaces.options_with(table.info());
    let plan = args.plans.options_with(&args.scene, table)?;
    let scene = truth::Real::read(&args.scene, args.map.as_deref(), args.prt.as_deref(), (&options, &plan))?;
    let scene = match own {
        Some(_) => scene.for_every_engine(&args.scene, args.map.as_deref())?.without_objects(),
        None => scene.joined_for(&args.scene, table)?,
    };
    if own.is_some() {
        let found = "a map with its own";
        refuse(&args.table, &[("--proofs or --strict", args.proofs.is_given())], "tables", found)?;
        refuse(&args.table, &[("--draw", args.draw.is_some() && table.dimension() == 3)], "tables and WADs", found)?;
    } else if args.draw.is_some() {
        input::refuse_without_places(table, &args.table, "no ray can be drawn")?;
    }
    let failed = |source| anyhow!("{}: is no table of {}: {source}", args.table.display(), args.scene.display());
    let VerifyArgs { rays, pairs, tries, segments, seed, threads, .. } = *args;
    let start = Instant::now();
    let bar = Bar::new("rays", show_progress);
    let left_out = scene.left_out();
    let options = VerifyOptions { rays, pairs, tries, segments, left_out, seed, threads, progress: Some(&bar) };
    let findings = verify(table, &scene.truth(), &options);
    drop(bar);
    let findings = findings.map_err(failed)?;
    let time = start.elapsed();
    let has_digests = table.digest().is_some();
    // Places in the findings, and proofs, are along the frame.
    let frame = table.frame().copied();
    let along = scene.along(table).map_err(failed)?;
    let (table, scene) = along.as_ref().map_or((table, &scene), |(table, scene)| (table, scene));
    // All that may be refused comes before a file is written.
    let proofs = match own {
        Some(_) => None,
        None => proofs::check(&args.proofs, &args.table, table, &scene.truth())?,
    };
    let unproven = Unproven::without_proofs(table).filter(|_| own.is_none());
    let drawn = match &args.draw {
        Some(out) => drawing::draw(&args.table, table, &findings, out)?,
        None => None,
    };
    let violations = own.as_ref().map_or_else(|| Violations::from(&findings), |own| Violations::of_own(&findings, own));
    let about = own.as_ref().map(|own| own.about.clone());
    let files = [args.table.as_path(), &args.scene];
    let wide_gap = frame.and_then(|frame| scene.times_too_wide(frame.gap()));
    let outcome = VerifyReport::new(files, has_digests, &findings, violations, about, proofs, time)
        .with_picture(drawn)
        .with_gap(scene.gap())
        .in_frame(frame.as_ref(), wide_gap)
        .with_unproven(unproven, args.proofs.is_strict());
    let is_true = outcome.is_true();
    Ok(Done::new(args.json, outcome).answering_whether(is_true))
}
