//! Tables of more cells than a square of bits has room for: rows as runs, written one by one.

use super::row::CellRow;
use super::{CellsFrom, RegionBakeOptions, cells_alone, see, state_objects, targets_of, volumes};
use crate::error::BakeError;
use crate::limit::{LeftOfCell, LimitReport, state_limit};
use crate::reports::RegionReport;
use crate::scene::extents;
use crate::stated::METHOD;
use crate::table::state_file;
use crate::threads;
use sightlines_cells::Scene;
use sightlines_multifocal::WorkDone;
use sightlines_packed::{PackReport, PackWriter, StreamError, StreamOptions};
use sightlines_pvs::bits::ones;
use sightlines_pvs::{CellId, ObjectId, SceneMethods, TableKind, TableParts};
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
        "only cells without portals, and not at the height of eyes, decided by a from-region method alone, can be written row by row"
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
    let make = options.method.filter(|_| !options.sightlines);
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
    let budget = options.budget;
    let rows = if budget.is_limited() {
        see::see_all_within(&targets, make, options, budget)?
    } else {
        see::see_all(&targets, make, options, None)?
    };
    let columns = Columns::of(&rows);
    let limit = budget
        .is_limited()
        .then(|| left_of(&rows, &columns, boxes.len(), targets.has_one_way))
        .filter(LimitReport::is_any);
    state_objects(&mut parts, scene, &boxes);
    parts.cell_objects = touching.iter().map(|list| list.iter().copied().map(ObjectId).collect()).collect();
    parts.kind =
        TableKind::SceneGivenCells { hidden_by: SceneMethods { sightlines: false, from_region: true, only_in_air } };
    parts.info.push((METHOD.to_owned(), method.clone()));
    parts.info.sort();
    limit.iter().for_each(|limit| state_limit(&mut parts, limit));
    state_file(&mut parts, options.file);
    parts.digest = Some(scene.digest());
    state(&mut parts);
    let mut writer = PackWriter::new(out, &parts, &StreamOptions { objects_seen: true })?;
    drop(parts);
    let (mut n_visible_pairs, mut n_objects_seen, mut effort) = (0, 0, WorkDone::default());
    let (mut seen, mut things): (Vec<CellId>, Vec<ObjectId>) = (Vec::new(), Vec::new());
    let mut column = columns.first();
    for (cell, row) in (0u32..).zip(&rows) {
        column.go_on();
        seen.clear();
        // A cell sees itself, whatever a method says of eyes in it.
        let one_way = targets.has_one_way;
        seen.extend(column.with(&row.cells, cell, one_way).map(CellId));
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
        limit,
        cut_time,
        time: start.elapsed(),
    };
    Ok((out, report, packed))
}

/// What of the rows was not decided, and counts as visible.
fn left_of(rows: &[CellRow], columns: &Columns, n_objects: usize, one_way: bool) -> LimitReport {
    let n_in = |runs: &[Range<u32>]| runs.iter().map(|run| run.len()).sum::<usize>();
    let mut seen_anywhere = vec![false; n_objects];
    rows.iter().flat_map(|row| row.objects.iter().cloned().flatten()).for_each(|o| seen_anywhere[o as usize] = true);
    let n_seen = seen_anywhere.into_iter().filter(|seen| *seen).count();
    let mut column = columns.first();
    let of_cell = |row: &CellRow| {
        column.go_on();
        // What the other of the two hides is decided.
        let n_cells = if one_way { n_in(&row.left[0]) } else { column.n_common(&row.left[0]) };
        LeftOfCell { n_cells, n_objects: n_in(&row.left[1]), sees_all: n_in(&row.objects) == n_seen }
    };
    LimitReport::counted(rows.len(), rows.iter().map(of_cell))
}

/// By whom each cell is seen, cell after cell: the columns of the rows.
struct Columns {
    n: usize,
    /// Where runs of rows begin, and where they end: the index, and the row. Ascending.
    edges: [Vec<(u32, u32)>; 2],
}

/// One column, as a set of bits.
struct Column<'a> {
    of: &'a Columns,
    next: u32,
    at: [usize; 2],
    bits: Vec<u64>,
    /// Those that were asked for last.
    words: Vec<u64>,
}

impl Columns {
    /// O(n log n) of runs.
    fn of(rows: &[CellRow]) -> Self {
        let runs = || (0u32..).zip(rows).flat_map(|(row, of)| of.cells.iter().map(move |run| (run, row)));
        let mut edges =
            [runs().map(|(run, row)| (run.start, row)).collect(), runs().map(|(run, row)| (run.end, row)).collect()];
        edges.iter_mut().for_each(|edges: &mut Vec<(u32, u32)>| edges.sort_unstable());
        Self { n: rows.len(), edges }
    }

    /// Before the first column.
    fn first(&self) -> Column<'_> {
        let none = vec![0; self.n.div_ceil(64)];
        Column { of: self, next: 0, at: [0; 2], bits: none.clone(), words: none }
    }
}

impl Column<'_> {
    /// Goes on to the next column. In all O(runs).
    fn go_on(&mut self) {
        for (edges, at) in self.of.edges.iter().zip(&mut self.at) {
            while let Some(&(_, row)) = edges.get(*at).filter(|(index, _)| *index == self.next) {
                self.bits[row as usize / 64] ^= 1 << (row % 64);
                *at += 1;
            }
        }
        self.next += 1;
    }

    /// The members of a row, ascending: those that are in the column too, or, where sight is `one_way`, all and those of the column; and `own`.
    /// O(n / 64 + members).
    fn with(&mut self, row: &[Range<u32>], own: u32, one_way: bool) -> impl Iterator<Item = u32> {
        self.take(row);
        for (word, &other) in self.words.iter_mut().zip(&self.bits) {
            if one_way { *word |= other } else { *word &= other }
        }
        self.words[own as usize / 64] |= 1 << (own % 64);
        ones(&self.words).map(|k| k as u32)
    }

    /// How many of these are in the column. O(n / 64).
    fn n_common(&mut self, row: &[Range<u32>]) -> usize {
        self.take(row);
        self.words.iter().zip(&self.bits).map(|(a, b)| (a & b).count_ones() as usize).sum()
    }

    /// Takes runs as bits.
    fn take(&mut self, row: &[Range<u32>]) {
        self.words.fill(0);
        for run in row {
            let (first, last) = (run.start as usize / 64, (run.end as usize - 1) / 64);
            for (k, word) in (first..).zip(&mut self.words[first..=last]) {
                let low = if k == first { run.start % 64 } else { 0 };
                let high = if k == last { (run.end - 1) % 64 } else { 63 };
                *word |= (u64::MAX >> (63 - high)) & (u64::MAX << low);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sightlines_pvs::runs::runs_of;

    /// Rows of up to 150 cells, with runs of all lengths.
    fn rows() -> impl Strategy<Value = Vec<CellRow>> {
        (1u32..150).prop_flat_map(|n| {
            let run = (0..n, 1u32..80).prop_map(move |(start, length)| start..(start + length).min(n));
            let row = prop::collection::vec(run, 0..4).prop_map(|runs| {
                let mut cells: Vec<u32> = runs.into_iter().flatten().collect();
                cells.sort_unstable();
                cells.dedup();
                CellRow { cells: runs_of(cells), ..CellRow::default() }
            });
            prop::collection::vec(row, n as usize)
        })
    }

    proptest! {
        /// Invariant: columns hold what a search through all rows finds.
        #[test]
        fn columns_are_what_rows_say(rows in rows(), one_way: bool) {
            let has = |row: u32, cell: u32| rows[row as usize].cells.iter().any(|run| run.contains(&cell));
            let columns = Columns::of(&rows);
            let (mut column, n) = (columns.first(), rows.len() as u32);
            for (cell, row) in (0..n).zip(&rows) {
                column.go_on();
                let both = |other: u32| [has(cell, other), has(other, cell)];
                let is_seen = |other: &u32| match both(*other) {
                    _ if *other == cell => true,
                    [a, b] => if one_way { a || b } else { a && b },
                };
                let expected: Vec<u32> = (0..n).filter(is_seen).collect();
                prop_assert_eq!(column.with(&row.cells, cell, one_way).collect::<Vec<_>>(), expected);
                let n_common = (0..n).filter(|&other| both(other) == [true, true]).count();
                prop_assert_eq!(column.n_common(&row.cells), n_common);
            }
        }
    }
}
