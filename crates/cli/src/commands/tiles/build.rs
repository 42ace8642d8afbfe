//! `tiles build`: bakes the tiles of a world that are not baked yet.

use super::outcome::Outcome;
use crate::buffers::method_failed;
use crate::command::{Done, JsonArg, Verbosity};
use crate::commands::build::region::RegionArgs;
use crate::error::{Result, anyhow, bail};
use crate::input::no_occluder;
use crate::interrupt;
use crate::kept::{self, Keeping, Kept, PROGRAM, UNITS};
use crate::memory::MemoryArgs;
use crate::output::{self, cannot_be_made};
use crate::progress::Bar;
use crate::surfaces::SurfaceArgs;
use sightlines::bake::world::{WorldBake, WorldBakeError, WorldRun, world_files};
use sightlines::bake::{BakeError, BakeRequest, Runtime};
use sightlines::progress::{Observer, Progress};
use sightlines::tiles::INDEX_NAME;
use std::fs;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The plan of a world: {\"sightlines_world\": 1, \"border\": 20, \"tiles\": [{\"name\": \"market\", \
                  \"scene\": \"market.glb\", \"at\": [100, 0, 0], \"viewers\": {\"min\": [100, 0, 0], \"max\": [200, 30, 100]}}]}. \
                  Files are beside the plan. `at` moves a scene to its place; `viewers` is where eyes can be, or `cells` a file of \
                  view cells. Tiles at most `border` away from a tile's viewers hide for it, and what they see of it is told apart; of \
                  others is only known whether anything is seen of them; none are seen beyond \"reach\", if the plan has one. A tile is baked again if something in it or nearby has changed."
)]
pub(crate) struct TilesBuildArgs {
    /// The plan of the world, as JSON
    #[arg(value_name = "WORLD.json")]
    pub(crate) world: PathBuf,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    #[command(flatten, next_help_heading = "Method")]
    region: RegionArgs,
    /// Objects smaller than this in every direction, in scene units, are not used as occluders by sightlines [default: chosen from
    /// the scene]
    #[arg(long, help_heading = "Method", value_name = "SIZE", value_parser = crate::numbers::size, allow_hyphen_values = true)]
    detail_below: Option<f64>,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    pub(crate) threads: usize,
    #[command(flatten)]
    pub(crate) memory: MemoryArgs,
    /// The folder of the world: a new one, or that of an earlier bake, from which tiles that have not changed are kept
    #[arg(short, long, help_heading = "Output", value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &TilesBuildArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let outcome = make(args, Keeping::Nowhere, show_progress)?;
    Ok(Done::new(args.json, outcome))
}

/// Ends what is under way once the program is interrupted.
struct Quiet;

impl Observer for Quiet {
    fn report(&self, _: Progress) -> ControlFlow<()> {
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Reads, bakes and writes. Prints nothing but progress and warnings.
pub(crate) fn make(args: &TilesBuildArgs, keeping: Keeping<'_>, show_progress: bool) -> Result<Outcome> {
    let start = Instant::now();
    crate::threads::use_only(args.threads);
    args.memory.watch();
    let (world, out) = (&*args.world, &*args.output);
    if args.region.names_a_file() {
        bail!("{}: --cells is not for worlds: their plan names the cells of each tile", world.display());
    }
    let mut request = BakeRequest { detail_below: args.detail_below, ..BakeRequest::default() };
    args.region.put_into(&mut request)?;
    let (threads, warn, reading) = (args.threads, crate::buffers::warn as fn(&str), args.surfaces.options());
    let runtime = Runtime { threads, progress: Some(&Quiet), warn, ..Runtime::default() };
    let files = world_files(world).map_err(failed)?;
    let inputs = kept::look(keeping, files.iter().map(PathBuf::as_path))?;
    let bake = WorldBake::read((world, &files), (&request, &reading), (PROGRAM, UNITS), &runtime).map_err(failed)?;
    let kept = Kept::open(keeping, &inputs, &[out], || {
        let mut identity = kept::identity("tiles", &inputs);
        bake.keys().for_each(|[key, far_key]| identity.debug("tile", &(key, far_key)));
        identity
    })?;
    fs::create_dir_all(out).map_err(|error| cannot_be_made(out, error))?;
    output::check_writable(&out.join(INDEX_NAME))?;
    let bar = Bar::new("tiles", show_progress);
    let made = bake.run(
        out,
        &WorldRun {
            runtime: Runtime { units: kept.units(), ..runtime },
            tiles: Some(&bar),
            before_writing: &|| kept.before_writing(),
            took: &|tile, time| tracing::info!("tile {tile}: {:.3} s", time.as_secs_f64()),
        },
    );
    drop(bar);
    if kept.finish(made.is_ok()).is_some() {
        let n = bake.n_tiles();
        let n_done = n - bake.n_missing(out);
        let why = interrupt::memory().map_or_else(|| "interrupted".to_owned(), |why| format!("stopped: {why}"));
        bail!("{why}; the same command goes on from the {n_done} of {n} tiles that are done");
    }
    Ok(Outcome::new(world, out, made.map_err(failed)?, start.elapsed()))
}

/// Why a world is not baked, with advice.
fn failed(error: WorldBakeError) -> anyhow::Error {
    match error {
        WorldBakeError::Occluder(path) => no_occluder(&path),
        WorldBakeError::Bake { path, source } => match *source {
            BakeError::Method(source) => method_failed(&path, source),
            source => anyhow!("{}: {source}", path.display()),
        },
        error => error.into(),
    }
}
