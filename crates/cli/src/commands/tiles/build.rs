//! `tiles build`: bakes the tiles of a world that are not baked yet.

use super::bake::{Files, TileKeys, bake, keys};
use super::input::{self, TileInput};
use super::outcome::Outcome;
use super::scenes::Scenes;
use crate::commands::build::region::RegionArgs;
use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::folder::cannot_be_made;
use crate::kept::{self, Keeping, Kept, PROGRAM, UNITS};
use crate::memory::MemoryArgs;
use crate::output;
use crate::progress::Bar;
use crate::surfaces::SurfaceArgs;
use crate::{Answer, interrupt};
use sightlines::bake::{BakeRequest, Runtime};
use sightlines::checkpoint::KeyHasher;
use sightlines::checkpoint::{Identity, Inputs};
use sightlines::formats::scene::SceneReadOptions;
use sightlines::geometry::{Aabb, BoxTree};
use sightlines::packed::Packed;
use sightlines::progress::{Cancelled, Counter, Halt, Observer, Phase, Progress, Work, shares_of};
use sightlines::tiles::{INDEX_NAME, TileEntry, TilePart, WorldIndex, near_tiles};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

/// Arguments of `tiles build`.
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
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &TilesBuildArgs, show_progress: bool) -> Result<Answer> {
    let outcome = make(args, Keeping::Nowhere, show_progress)?;
    output::print(args.json, &outcome)?;
    Ok(Answer::Yes)
}

/// The phase of units of work: one for each tile.
const PHASE: &str = "tiles";

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
    if args.region.names_a_file() {
        bail!("{}: --cells is not for worlds: their plan names the cells of each tile", args.world.display());
    }
    let mut request = BakeRequest { detail_below: args.detail_below, ..BakeRequest::default() };
    args.region.put_into(&mut request)?;
    let runtime = Runtime { progress: Some(&Quiet), warn: crate::buffers::warn, ..Runtime::default() };
    let reading = args.surfaces.options();
    let files = input::files(&args.world, &input::plan(&args.world)?);
    let looked_at = kept::look(keeping, files.iter().map(PathBuf::as_path))?;
    // As it was looked at.
    let plan = input::plan(&args.world)?;
    if files != input::files(&args.world, &plan) {
        bail!("{}: the file was changed while the world was baked; bake it again", args.world.display());
    }
    let threads = if args.threads == 0 { thread::available_parallelism().map_or(1, usize::from) } else { args.threads };
    let looked = on_threads(threads, plan.tiles.len(), |tile| {
        if interrupt::requested() {
            return Err(Cancelled.into());
        }
        input::look(&args.world, (tile, plan.tiles[tile].clone()), &reading)
    });
    let inputs: Vec<TileInput> = looked.into_iter().collect::<Result<_, _>>()?;
    check_axes(&inputs)?;
    let bounds: Vec<_> = inputs.iter().map(|tile| tile.bounds).collect();
    let mut hasher = KeyHasher::new(PROGRAM);
    hasher.value("units", &UNITS.to_le_bytes());
    hasher.debug("request", &request);
    let reached = plan.reach.map(|reach| near_tiles(&bounds, reach));
    let keys = keys(&inputs, near_tiles(&bounds, plan.border), reached, &hasher);
    let kept = Kept::open(keeping, &looked_at, &[&args.output], || identity(&looked_at, &keys))?;
    let mut world =
        World { args, distances: (plan.border, plan.reach), inputs: &inputs, keys: &keys, missing: Vec::new() };
    world.find()?;
    let made = world.bake((&request, runtime), (&reading, threads), &kept, show_progress);
    let made = made.and_then(|()| world.finish(start));
    match kept.finish(made.is_ok()) {
        Some(_) => {
            world.find()?;
            let n = inputs.len();
            let n_done = n - world.missing.iter().flatten().count();
            let why = interrupt::memory().map_or_else(|| "interrupted".to_owned(), |why| format!("stopped: {why}"));
            Err(anyhow!("{why}; the same command goes on from the {n_done} of {n} tiles that are done"))
        }
        None => made,
    }
}

/// What decides the results of units.
fn identity(inputs: &Inputs, keys: &[TileKeys]) -> Identity {
    let mut identity = kept::identity("tiles", inputs);
    keys.iter().for_each(|keys| identity.debug("tile", &(keys.key, keys.far_key)));
    identity
}

/// Refuses scenes with other axes or units than the first.
fn check_axes(inputs: &[TileInput]) -> Result<()> {
    let first = &inputs[0];
    match inputs.iter().find(|tile| tile.axes != first.axes) {
        None => Ok(()),
        Some(other) => Err(anyhow!(
            "{}: up is {found}, and in {} it is {expected}: all scenes of a world have the same axes and units",
            other.scene.display(),
            first.scene.display(),
            found = other.axes,
            expected = first.axes
        )),
    }
}

/// Calls `make` for each number below `n`, on so many threads; the results in order.
fn on_threads<T: Send>(threads: usize, n: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::with_capacity(n)));
    thread::scope(|scope| {
        for _ in 0..threads.min(n).max(1) {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Relaxed);
                    if k >= n {
                        return;
                    }
                    let made = make(k);
                    done.lock().unwrap_or_else(PoisonError::into_inner).push((k, made));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, made)| made).collect()
}

/// What is missing of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Missing {
    All,
    Far,
}

/// A world that is baked.
struct World<'a> {
    args: &'a TilesBuildArgs,
    /// The border, and how far viewers see.
    distances: (f64, Option<f64>),
    inputs: &'a [TileInput],
    keys: &'a [TileKeys],
    /// What is to be made of each tile.
    missing: Vec<Option<Missing>>,
}

impl World<'_> {
    fn path(&self, tile: usize, part: TilePart) -> PathBuf {
        let TileKeys { key, far_key, .. } = self.keys[tile];
        let key = if part == TilePart::Far { far_key } else { key };
        self.args.output.join(TileEntry::file_name_of(&self.inputs[tile].plan.name, part, key))
    }

    /// Finds which tiles have their files.
    fn find(&mut self) -> Result<()> {
        let out = &self.args.output;
        let failed = |error| cannot_be_made(out, error);
        fs::create_dir_all(out).map_err(failed)?;
        output::check_writable(&out.join(INDEX_NAME))?;
        let has = |tile: usize, part: TilePart| self.path(tile, part).is_file();
        let missing = |tile: usize| {
            let is_whole = has(tile, TilePart::Table) && has(tile, TilePart::Near);
            if !is_whole {
                Some(Missing::All)
            } else if has(tile, TilePart::Far) {
                None
            } else {
                Some(Missing::Far)
            }
        };
        self.missing = (0..self.inputs.len()).map(missing).collect();
        Ok(())
    }

    /// Bakes what is missing, and writes it.
    fn bake(
        &self,
        (request, runtime): (&BakeRequest, Runtime<'_>),
        (reading, threads): (&SceneReadOptions, usize),
        kept: &Kept<'_>,
        show_progress: bool,
    ) -> Result<()> {
        let units = kept.units();
        // Tiles that are near each other need the same scenes, so they follow each other.
        let viewers: Vec<Aabb<3>> = self.inputs.iter().map(|tile| tile.bounds.viewers).collect();
        let order: Vec<usize> = BoxTree::build(&viewers, 1).order().iter().map(|&tile| tile as usize).collect();
        let n_to_do = self.missing.iter().flatten().count();
        // A few tiles have all threads for each; of many, each has one.
        let (at_once, threads) = if n_to_do >= 2 * threads { (threads, 1) } else { (1, threads) };
        let runtime = Runtime { threads, ..runtime };
        let most_near = self.keys.iter().map(|keys| keys.near.len()).max().unwrap_or(0);
        let scenes = Scenes::new(self.inputs, reading, (request, runtime), 2 * (most_near + 1) * at_once + 32);
        let n_triangles = |tile: usize| self.inputs[tile].n_triangles as f64;
        let cost = |&tile: &usize| match self.missing[tile] {
            None => 0.0,
            // A tenth of the rest, about.
            Some(missing) => {
                let near: f64 = self.keys[tile].near.iter().map(|&near| n_triangles(near as usize)).sum();
                let share = if missing == Missing::Far { 0.1 } else { 1.0 };
                share * (1.0 + n_triangles(tile)) * (1000.0 + n_triangles(tile) + near).sqrt()
            }
        };
        let costs: Vec<f64> = order.iter().map(cost).collect();
        let shares = shares_of(&costs);
        let bar = Bar::new("tiles", show_progress);
        let counter = Counter::new(Some(&bar), PHASE, order.len()).of(Work::Deciding);
        let one = |unit: usize| -> Result<()> {
            let tile = order[unit];
            counter.check()?;
            let mut is_made = false;
            let result = units.get(PHASE, unit, || -> Result<Vec<u8>> {
                let Some(missing) = self.missing[tile] else { return Ok(Vec::new()) };
                is_made = true;
                let begin = Instant::now();
                let files =
                    bake(tile, (self.inputs, &self.keys[tile]), &scenes, (request, &runtime), missing == Missing::Far)?;
                tracing::info!("tile {}: {:.3} s", self.inputs[tile].plan.name, begin.elapsed().as_secs_f64());
                if units.are_kept() {
                    return Ok(files.to_bytes());
                }
                self.save(tile, &files)?;
                Ok(Vec::new())
            });
            // What comes from a store is of a job, or of a shard that goes on.
            if let Some(bytes) = result?.filter(|_| units.are_kept() && !is_made && units.has_all(PHASE)) {
                let files = Files::from_bytes(&bytes);
                let files = files.ok_or_else(|| Halt::Store(format!("the kept result of tile {tile} does not fit")))?;
                self.save(tile, &files)?;
            }
            Ok(counter.step_by(shares[unit], !is_made)?)
        };
        // If others have tiles to do, this may end the bake.
        units.through(&Phase::new(PHASE, &costs), || {
            if units.has_all(PHASE) {
                kept.before_writing()?;
            }
            let is_failed = AtomicBool::new(false);
            let done = on_threads(at_once, order.len(), |unit| {
                if is_failed.load(Relaxed) {
                    return Ok(());
                }
                one(unit).inspect_err(|_| is_failed.store(true, Relaxed))
            });
            done.into_iter().collect::<Result<()>>()
        })
    }

    fn save(&self, tile: usize, files: &Files) -> Result<()> {
        files.iter().try_for_each(|(part, bytes)| output::save(&self.path(tile, part), bytes))
    }

    /// Writes the index, and removes files of tiles that are no longer in it.
    fn finish(&self, start: Instant) -> Result<Outcome> {
        let out = &self.args.output;
        let mut outcome = Outcome::new(&self.args.world, out);
        let (border, reach) = self.distances;
        let mut index = WorldIndex { border, reach, tiles: Vec::new() };
        for (tile, (input, keys)) in self.inputs.iter().zip(self.keys).enumerate() {
            let path = self.path(tile, TilePart::Table);
            let open = |error| anyhow!("{}: {error}", path.display());
            let table = Packed::open(File::open(&path).map_err(open)?, 0);
            let table = table.in_file(&path)?;
            let TileKeys { key, far_key, .. } = *keys;
            index.tiles.push(TileEntry {
                name: input.plan.name.clone(),
                bounds: input.bounds,
                key,
                far_key,
                n_cells: table.n_cells() as u32,
                n_objects: table.n_objects() as u32,
            });
            outcome
                .count(self.missing[tile].map(|missing| missing == Missing::All), (table.n_cells(), table.n_objects()));
            for part in TilePart::ALL {
                let path = self.path(tile, part);
                outcome.n_bytes += fs::metadata(&path).in_file(&path)?.len();
            }
        }
        let index_path = out.join(INDEX_NAME);
        let old = fs::read(&index_path).ok().and_then(|text| WorldIndex::parse(&text).ok());
        output::save(&index_path, index.to_json().as_bytes())?;
        outcome.n_removed = remove_others(out, &index, old.as_ref());
        outcome.seconds = start.elapsed().as_secs_f64();
        Ok(outcome)
    }
}

/// Removes files in a folder that were of tiles, and are not any more; returns of how many tables. What cannot be removed stays.
fn remove_others(folder: &Path, index: &WorldIndex, old: Option<&WorldIndex>) -> usize {
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    let current: BTreeSet<String> =
        index.tiles.iter().flat_map(|tile| TilePart::ALL.map(|part| tile.file_name(part))).collect();
    let names: BTreeSet<&str> =
        old.into_iter().chain([index]).flat_map(|index| &index.tiles).map(|tile| &*tile.name).collect();
    let mut n_removed = 0;
    for entry in entries.flatten() {
        let Ok(name) = entry.file_name().into_string() else { continue };
        // A key and an end behind the name of the tile.
        let of_tile = name.rsplit_once('-').map(|(tile, _)| tile).filter(|tile| names.contains(tile));
        let is_ours = of_tile.is_some_and(|tile| TileEntry::is_file_of(tile, &name));
        if is_ours && !current.contains(&name) && fs::remove_file(entry.path()).is_ok() && name.ends_with(".pvz") {
            n_removed += 1;
        }
    }
    n_removed
}
