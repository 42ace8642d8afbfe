//! Tables of more cells than a square of bits has room for: rows as runs, written one by one.

use super::row::CellRow;
use super::{CellsFrom, RegionBakeOptions, cells_alone, see, state_objects, targets_of, volumes};
use crate::error::BakeError;
use crate::reports::RegionReport;
use crate::scene::extents;
use crate::stated::METHOD;
use crate::table::state_file;
use crate::threads;
use sightlines_cells::Scene;
use sightlines_multifocal::WorkDone;
use sightlines_packed::{PackReport, PackWriter, StreamError, StreamOptions};
use sightlines_pvs::{CellId, ObjectId, SceneMethods, TableKind, TableParts};
use std::collections::BTreeMap;
use std::io::Write;
use std::ops::Range;
use std::time::Instant;

/// Why a table was not written row by row.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackRegionsError {
    /// It cannot be baked.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// It cannot be written, or is not sound: a defect of this crate.
    #[error(transparent)]
    Write(#[from] StreamError),
    /// What needs all pairs at once.
    #[error(
        "only cells without portals, and not at the height of eyes, decided by a from-region method alone and without a limit, can be written row by row"
    )]
    NeedsPairs,
}

/// As [`bake_regions`](super::bake_regions) for cells without portals and a from-region method alone, and writes a packed table of the large class
/// instead of making one in memory: [`PackWriter`].
///
/// The visibility is the same, pair by pair. Memory: the rows as runs of cells, some hundreds of bytes for each cell in a city.
///
/// * `state`: adds to the parts of the table what the caller knows
///
/// # Errors
/// [`PackRegionsError`]
pub fn pack_regions<W: Write + Send>(
    scene: &Scene,
    options: &RegionBakeOptions<'_>,
    state: &(dyn Fn(&mut TableParts) + Sync),
    out: W,
) -> Result<(W, RegionReport, PackReport), PackRegionsError> {
    pack_regions_around(scene, options, &[], state, out)
}

/// The same, where all cells see the objects `around` the scene, of which it has no triangles.
pub(crate) fn pack_regions_around<W: Write + Send>(
    scene: &Scene,
    options: &RegionBakeOptions<'_>,
    around: &[u32],
    state: &(dyn Fn(&mut TableParts) + Sync),
    out: W,
) -> Result<(W, RegionReport, PackReport), PackRegionsError> {
    threads::on(options.threads, || pack_here(scene, options, around, state, out))
}

/// The same, on the threads that call it.
fn pack_here<W: Write>(
    scene: &Scene,
    options: &RegionBakeOptions<'_>,
    around: &[u32],
    state: &(dyn Fn(&mut TableParts) + Sync),
    out: W,
) -> Result<(W, RegionReport, PackReport), PackRegionsError> {
    let start = Instant::now();
    let make = options.method.filter(|_| !options.sightlines && !options.budget.is_limited());
    let by_row = !options.cells.have_portals() && !matches!(options.cells, CellsFrom::EyeLevel(_));
    let make = make.filter(|_| by_row).ok_or(PackRegionsError::NeedsPairs)?;
    let boxes = extents(scene);
    let cut = cells_alone(scene, options, options.cells)?;
    let (cells, mut parts) = (cut.cells, cut.parts);
    let volumes = volumes(&cells)?;
    let touching = see::touching(&cells, &boxes);
    let cut_time = start.elapsed();
    let made = make();
    let (method, only_in_air) = (made.name(), made.only_in_air());
    drop(made);
    let (occludees, witness) = targets_of(scene, &boxes);
    let targets = see::Targets::new((&occludees, &witness), &volumes, !scene.front_occluders().is_empty(), &[]);
    let rows = see::see_all(&targets, make, options, None)?;
    let seen_one_way = if targets.has_one_way { seen_one_way(&rows) } else { BTreeMap::new() };
    state_objects(&mut parts, scene, &boxes);
    parts.cell_objects = touching.iter().map(|list| list.iter().copied().map(ObjectId).collect()).collect();
    parts.kind =
        TableKind::SceneGivenCells { hidden_by: SceneMethods { sightlines: false, from_region: true, only_in_air } };
    parts.info.push((METHOD.to_owned(), method.clone()));
    parts.info.sort();
    state_file(&mut parts, options.file);
    parts.digest = Some(scene.digest());
    state(&mut parts);
    let mut writer = PackWriter::new(out, &parts, &StreamOptions { objects_seen: true })?;
    drop(parts);
    let (mut n_visible_pairs, mut n_objects_seen, mut effort) = (0, 0, WorkDone::default());
    let (mut seen, mut things): (Vec<CellId>, Vec<ObjectId>) = (Vec::new(), Vec::new());
    for (cell, row) in (0u32..).zip(&rows) {
        seen.clear();
        if targets.has_one_way {
            seen.extend(row.cells.iter().cloned().flatten().chain([cell]).map(CellId));
            seen.extend(seen_one_way.get(&cell).into_iter().flatten().copied().map(CellId));
            seen.sort_unstable();
            seen.dedup();
        } else {
            seen.extend(both_ways(cell, row, &rows).map(CellId));
        }
        things.clear();
        things.extend(row.objects.iter().cloned().flatten().map(ObjectId));
        things.extend(touching[cell as usize].iter().chain(around).copied().map(ObjectId));
        things.sort_unstable();
        things.dedup();
        writer.push(&seen, Some(&things))?;
        n_visible_pairs += seen.len() as u64 - 1;
        n_objects_seen += things.len() as u64;
        effort = effort + row.effort;
    }
    let (out, packed) = writer.finish()?;
    let report = RegionReport {
        places: cut.places,
        eye_level: cut.eye_level,
        n_assumed: 0,
        method: Some(method),
        effort,
        doors: Vec::new(),
        n_visible_pairs: n_visible_pairs / 2,
        n_objects_seen,
        limit: None,
        cut_time,
        time: start.elapsed(),
    };
    Ok((out, report, packed))
}

/// The cells that a cell may see and that may see it, ascending; itself among them.
fn both_ways<'a>(cell: u32, row: &'a CellRow, rows: &'a [CellRow]) -> impl Iterator<Item = u32> + 'a {
    // A cell sees itself, whatever a method says of eyes in it.
    let below = row.cells.iter().cloned().flatten().filter(move |&other| other < cell);
    let above = row.cells.iter().cloned().flatten().filter(move |&other| other > cell);
    let others =
        |of: Box<dyn Iterator<Item = u32> + 'a>| of.filter(move |&other| has(&rows[other as usize].cells, cell));
    others(Box::new(below)).chain([cell]).chain(others(Box::new(above)))
}

/// For cells that see fewer cells than see them, those others, ascending: where something hides from one side only.
fn seen_one_way(rows: &[CellRow]) -> BTreeMap<u32, Vec<u32>> {
    let mut all: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (cell, row) in (0u32..).zip(rows) {
        for other in row.cells.iter().cloned().flatten().filter(|&other| !has(&rows[other as usize].cells, cell)) {
            all.entry(other).or_default().push(cell);
        }
    }
    all
}

fn has(runs: &[Range<u32>], cell: u32) -> bool {
    let after = runs.partition_point(|run| run.start <= cell);
    after > 0 && cell < runs[after - 1].end
}
