//! A world that is too large for one table: all of its [tiles](crate::tile), from a plan to a folder.
//!
//! ```no_run
//! use sightlines_bake::BakeRequest;
//! use sightlines_bake::world::{WorldBake, WorldRun, world_files};
//! use std::path::Path;
//!
//! let (plan, run) = (Path::new("city/world.json"), WorldRun::default());
//! let (request, reading) = (BakeRequest::default(), Default::default());
//! let bake = WorldBake::read((plan, &world_files(plan)?), (&request, &reading), ("1.0", 1), &run.runtime)?;
//! let report = bake.run(Path::new("out"), &run)?; // of an earlier bake in the folder, what has not changed is kept
//! println!("{} of {} tiles were baked", report.n_baked, report.n_tiles);
//! # Ok::<(), sightlines_bake::world::WorldBakeError>(())
//! ```

mod error;
mod input;
mod one;
mod scenes;

pub use error::WorldBakeError;

use crate::request::{BakeRequest, Runtime};
use crate::stopwatch::Stopwatch;
use input::TileInput;
use one::{Files, TileKeys, keys};
use scenes::Scenes;
use sightlines_checkpoint::KeyHasher;
use sightlines_formats::atomic_write;
use sightlines_formats::scene::SceneReadOptions;
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_packed::Packed;
use sightlines_progress::memory::n_threads;
use sightlines_progress::{Counter, Halt, Observer, Phase, Units, Work, shares_of};
use sightlines_tiles::{INDEX_NAME, TileEntry, TilePart, WorldIndex, near_tiles};
use std::collections::BTreeSet;
use std::fmt;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// The phase of units of work: one for each tile.
const PHASE: &str = "tiles";

/// The plan of a world, and all files that it names.
///
/// # Errors
/// [`WorldBakeError::File`].
pub fn world_files(world: &Path) -> Result<Vec<PathBuf>, WorldBakeError> {
    Ok(input::files(world, &input::plan(world)?))
}

/// A world that is to be baked: what is known of its tiles, and what decides each of them.
#[derive(Debug)]
pub struct WorldBake<'a> {
    request: &'a BakeRequest,
    reading: &'a SceneReadOptions,
    border: f64,
    reach: Option<f64>,
    inputs: Vec<TileInput>,
    keys: Vec<TileKeys>,
}

/// On what a world is baked, and who hears of it. Nothing of it changes the files.
#[derive(Clone, Copy)]
pub struct WorldRun<'a> {
    /// For all tiles. Its observer hears of the work within tiles, several at once; the store of units has a result for each tile, and those within tiles have
    /// none.
    pub runtime: Runtime<'a>,
    /// Hears of tiles that are done, and may cancel.
    pub tiles: Option<&'a dyn Observer>,
    /// Called before files are written, if this process has the results of all tiles: an error if another one has written them.
    pub before_writing: &'a (dyn Fn() -> Result<(), Halt> + Sync),
    /// Hears how long a tile took, by its name.
    pub took: &'a (dyn Fn(&str, Duration) + Sync),
}

impl Default for WorldRun<'_> {
    fn default() -> Self {
        Self { runtime: Runtime::default(), tiles: None, before_writing: &|| Ok(()), took: &|_, _| {} }
    }
}

impl fmt::Debug for WorldRun<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WorldRun").field("runtime", &self.runtime).finish_non_exhaustive()
    }
}

/// What became of the tiles of a world.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct WorldReport {
    /// Tiles.
    pub n_tiles: usize,
    /// Tiles that were baked.
    pub n_baked: usize,
    /// Tiles of which only was decided what they see of those farther away.
    pub n_far_only: usize,
    /// Tiles that were kept from an earlier bake.
    pub n_kept: usize,
    /// Tables of earlier bakes that were removed.
    pub n_removed: usize,
    /// Cells of all tiles.
    pub n_cells: usize,
    /// Objects of all tiles.
    pub n_objects: usize,
    /// Bytes of all files of tiles.
    pub n_bytes: u64,
}

/// What is missing of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Missing {
    All,
    Far,
}

impl<'a> WorldBake<'a> {
    /// Reads a plan and looks at all of its scenes: one for each thread is in memory. Warns of what a user should hear of a file.
    ///
    /// * `world`: the plan, and the files that it named before ([`world_files`])
    /// * `program`: its version, and the number of its units: part of all keys
    ///
    /// # Errors
    /// [`WorldBakeError`]: files that cannot be read or do not go together, and a plan that names others by now.
    pub fn read(
        (world, files): (&Path, &[PathBuf]),
        (request, reading): (&'a BakeRequest, &'a SceneReadOptions),
        (program, units): (&str, u32),
        runtime: &Runtime<'_>,
    ) -> Result<Self, WorldBakeError> {
        let plan = input::plan(world)?;
        if files != input::files(world, &plan) {
            return Err(WorldBakeError::Changed(world.to_owned()));
        }
        let counter = Counter::new(runtime.progress, "scenes", plan.tiles.len());
        let looked = on_threads(n_threads(runtime.threads), plan.tiles.len(), |tile| {
            counter.step()?;
            input::look(world, (tile, &plan.tiles[tile]), reading, runtime.warn)
        });
        let inputs: Vec<TileInput> = looked.into_iter().collect::<Result<_, _>>()?;
        check_axes(&inputs)?;
        let bounds: Vec<_> = inputs.iter().map(|tile| tile.bounds).collect();
        let mut hasher = KeyHasher::new(program);
        hasher.value("units", &units.to_le_bytes());
        hasher.debug("request", request);
        let reached = plan.reach.map(|reach| near_tiles(&bounds, reach));
        let keys = keys(&inputs, near_tiles(&bounds, plan.border), reached, &hasher);
        Ok(Self { request, reading, border: plan.border, reach: plan.reach, inputs, keys })
    }

    /// The keys of each tile: of what decides its table and what it sees nearby, and of which tiles farther away it sees.
    pub fn keys(&self) -> impl Iterator<Item = [[u8; 16]; 2]> {
        self.keys.iter().map(|keys| [keys.key, keys.far_key])
    }

    /// The number of tiles.
    pub fn n_tiles(&self) -> usize {
        self.inputs.len()
    }

    /// How many tiles do not have all of their files in a folder.
    pub fn n_missing(&self, folder: &Path) -> usize {
        self.missing(folder).iter().flatten().count()
    }

    fn missing(&self, folder: &Path) -> Vec<Option<Missing>> {
        let has = |tile, part| self.path(folder, tile, part).is_file();
        let missing = |tile| match (has(tile, TilePart::Table) && has(tile, TilePart::Near), has(tile, TilePart::Far)) {
            (false, _) => Some(Missing::All),
            (true, false) => Some(Missing::Far),
            (true, true) => None,
        };
        (0..self.inputs.len()).map(missing).collect()
    }

    fn path(&self, folder: &Path, tile: usize, part: TilePart) -> PathBuf {
        let TileKeys { key, far_key, .. } = self.keys[tile];
        let key = if part == TilePart::Far { far_key } else { key };
        folder.join(TileEntry::file_name_of(&self.inputs[tile].plan.name, part, key))
    }

    /// Bakes what is missing in a folder, which is made if it is not there; writes its index, and removes files of tiles that are no longer in it. Files that
    /// are there are as they would be baked now, since their names have the keys of all that decides them: a bake that was stopped goes on.
    ///
    /// Cost: see [`bake_tile`](crate::tile::bake_tile). In memory are the scenes of about as many tiles as are near those under way.
    ///
    /// # Errors
    /// [`WorldBakeError`]: tiles that are whole stay.
    pub fn run(&self, folder: &Path, run: &WorldRun<'_>) -> Result<WorldReport, WorldBakeError> {
        fs::create_dir_all(folder).map_err(|error| WorldBakeError::file(folder, error))?;
        let missing = self.missing(folder);
        self.bake(folder, &missing, run)?;
        self.finish(folder, &missing)
    }

    fn bake(&self, folder: &Path, missing: &[Option<Missing>], run: &WorldRun<'_>) -> Result<(), WorldBakeError> {
        let (units, threads) = (run.runtime.units, n_threads(run.runtime.threads));
        // Tiles that are near each other need the same scenes, so they follow each other.
        let viewers: Vec<Aabb<3>> = self.inputs.iter().map(|tile| tile.bounds.viewers).collect();
        let order: Vec<usize> = BoxTree::build(&viewers, 1).order().iter().map(|&tile| tile as usize).collect();
        let n_to_do = missing.iter().flatten().count();
        // A few tiles have all threads for each; of many, each has one.
        let (at_once, threads) = if n_to_do >= 2 * threads { (threads, 1) } else { (1, threads) };
        let runtime = Runtime { threads, units: Units::default(), ..run.runtime };
        let most_near = self.keys.iter().map(|keys| keys.near.len()).max().unwrap_or(0);
        let room = 2 * (most_near + 1) * at_once + 32;
        let scenes = Scenes::new(&self.inputs, self.reading, (self.request, runtime), room);
        let costs: Vec<f64> = order.iter().map(|&tile| self.cost(tile, missing[tile])).collect();
        let shares = shares_of(&costs);
        let counter = Counter::new(run.tiles, PHASE, order.len()).of(Work::Deciding);
        let one = |unit: usize| -> Result<(), WorldBakeError> {
            let tile = order[unit];
            counter.check()?;
            let mut is_made = false;
            let result = units.get(PHASE, unit, || -> Result<Vec<u8>, WorldBakeError> {
                let Some(missing) = missing[tile] else { return Ok(Vec::new()) };
                is_made = true;
                let begin = Stopwatch::start();
                let of = (&*self.inputs, &self.keys[tile]);
                let files = one::bake(tile, of, &scenes, (self.request, &runtime), missing == Missing::Far)?;
                (run.took)(&self.inputs[tile].plan.name, begin.elapsed());
                if units.are_kept() {
                    return Ok(files.to_bytes());
                }
                self.save(folder, tile, &files)?;
                Ok(Vec::new())
            });
            // What comes from a store is of a job, or of a shard that goes on.
            if let Some(bytes) = result?.filter(|_| units.are_kept() && !is_made && units.has_all(PHASE)) {
                let files = Files::from_bytes(&bytes);
                let files = files.ok_or_else(|| Halt::Store(format!("the kept result of tile {tile} does not fit")))?;
                self.save(folder, tile, &files)?;
            }
            Ok(counter.step_by(shares[unit], !is_made)?)
        };
        // If others have tiles to do, this may end the bake.
        units.through(&Phase::new(PHASE, &costs), || {
            if units.has_all(PHASE) {
                (run.before_writing)()?;
            }
            let is_failed = AtomicBool::new(false);
            let done = on_threads(at_once, order.len(), |unit| {
                if is_failed.load(Relaxed) {
                    return Ok(());
                }
                one(unit).inspect_err(|_| is_failed.store(true, Relaxed))
            });
            done.into_iter().collect()
        })
    }

    /// About how long what is missing of a tile takes.
    fn cost(&self, tile: usize, missing: Option<Missing>) -> f64 {
        let n_triangles = |tile: usize| self.inputs[tile].n_triangles as f64;
        let near: f64 = self.keys[tile].near.iter().map(|&near| n_triangles(near as usize)).sum();
        let share = match missing {
            None => 0.0,
            // A tenth of the rest, about.
            Some(Missing::Far) => 0.1,
            Some(Missing::All) => 1.0,
        };
        share * (1.0 + n_triangles(tile)) * (1000.0 + n_triangles(tile) + near).sqrt()
    }

    fn save(&self, folder: &Path, tile: usize, files: &Files) -> Result<(), WorldBakeError> {
        Ok(files.iter().try_for_each(|(part, bytes)| atomic_write(self.path(folder, tile, part), bytes))?)
    }

    /// Writes the index, and removes files of tiles that are no longer in it.
    fn finish(&self, folder: &Path, missing: &[Option<Missing>]) -> Result<WorldReport, WorldBakeError> {
        let mut report = WorldReport { n_tiles: self.inputs.len(), ..WorldReport::default() };
        let mut index = WorldIndex { border: self.border, reach: self.reach, tiles: Vec::new() };
        for (tile, (input, &TileKeys { key, far_key, .. })) in self.inputs.iter().zip(&self.keys).enumerate() {
            for part in TilePart::ALL {
                let path = self.path(folder, tile, part);
                let found = fs::metadata(&path).map_err(|error| WorldBakeError::file(&path, error))?;
                report.n_bytes += found.len();
            }
            let path = self.path(folder, tile, TilePart::Table);
            let file = File::open(&path).map_err(|error| WorldBakeError::file(&path, error))?;
            let table = Packed::open(file, 0).map_err(|error| WorldBakeError::file(&path, error))?;
            let (n_cells, n_objects) = (table.n_cells() as u32, table.n_objects() as u32);
            let (name, bounds) = (input.plan.name.clone(), input.bounds);
            index.tiles.push(TileEntry { name, bounds, key, far_key, n_cells, n_objects });
            report.n_cells += table.n_cells();
            report.n_objects += table.n_objects();
            *match missing[tile] {
                Some(Missing::All) => &mut report.n_baked,
                Some(Missing::Far) => &mut report.n_far_only,
                None => &mut report.n_kept,
            } += 1;
        }
        let path = folder.join(INDEX_NAME);
        let old = fs::read(&path).ok().and_then(|text| WorldIndex::parse(&text).ok());
        atomic_write(&path, index.to_json().as_bytes())?;
        report.n_removed = remove_others(folder, &index, old.as_ref());
        Ok(report)
    }
}

/// Refuses scenes with other axes or units than the first.
fn check_axes(inputs: &[TileInput]) -> Result<(), WorldBakeError> {
    let first = &inputs[0];
    let Some(other) = inputs.iter().find(|tile| tile.axes != first.axes) else { return Ok(()) };
    let (found, file, expected) = (&other.axes, first.scene.display(), &first.axes);
    let why =
        format!("up is {found}, and in {file} it is {expected}: all scenes of a world have the same axes and units");
    Err(WorldBakeError::file(&other.scene, why))
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
