//! Tables of more cells than a square of bits has room for: rows as runs, written one by one.

use super::row::CellRow;
use super::{CellsFrom, RegionBakeOptions, cells_alone, see, state_objects, targets_of, volumes};
use crate::error::BakeError;
use crate::limit::{LeftOfCell, LimitReport, state_limit};
use crate::reports::RegionReport;
use crate::scene::extents;
use crate::stated::METHOD;
use crate::stopwatch::Stopwatch;
use crate::table::state_file;
use crate::threads;
use sightlines_cells::Scene;
use sightlines_multifocal::WorkDone;
use sightlines_packed::{PackReport, PackWriter, StreamError, StreamOptions};
use sightlines_pvs::bits::ones;
use sightlines_pvs::{CellId, ObjectId, SceneMethods, TableKind, TableParts};
use std::io::Write;
use std::ops::Range;

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
    let start = Stopwatch::start();
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
    let one_way = targets.has_one_way;
    let limit = options.budget.is_limited().then(|| left_of(&rows, &touching, boxes.len(), one_way));
    let limit = limit.filter(LimitReport::is_any);
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
    let mut column = Column::of(&rows, |row| &row.cells);
    for (cell, row) in (0u32..).zip(&rows) {
        column.go_on();
        seen.clear();
        // A cell sees itself, whatever a method says of eyes in it.
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
///
/// * `touching`: for each cell the objects that it sees in any case
fn left_of(rows: &[CellRow], touching: &[Vec<u32>], n_objects: usize, one_way: bool) -> LimitReport {
    let n_in = |runs: &[Range<u32>]| runs.iter().map(|run| run.len()).sum::<usize>();
    let has = |runs: &[Range<u32>], k: u32| {
        let after = runs.partition_point(|run| run.start <= k);
        after > 0 && k < runs[after - 1].end
    };
    let mut seen_anywhere = vec![false; n_objects];
    rows.iter().flat_map(|row| row.objects.iter().cloned().flatten()).for_each(|o| seen_anywhere[o as usize] = true);
    let n_seen = seen_anywhere.into_iter().filter(|seen| *seen).count();
    let (mut seen, mut left) = (Column::of(rows, |row| &row.cells), Column::of(rows, |row| &row.left[0]));
    let of_cell = |(cell, row): (u32, &CellRow)| {
        seen.go_on();
        left.go_on();
        // A pair is left if one of the two cells has not decided it.
        left.join(&row.left[0], true);
        seen.join(&row.cells, one_way);
        let n_cells = left.words.iter().zip(&seen.words).map(|(a, b)| (a & b).count_ones() as usize).sum::<usize>();
        let n_own = usize::from(has(&row.left[0], cell) && seen.has(cell));
        let n_touching = touching[cell as usize].iter().filter(|&&object| has(&row.left[1], object)).count();
        LeftOfCell {
            n_cells: n_cells - n_own,
            n_objects: n_in(&row.left[1]) - n_touching,
            sees_all: n_in(&row.objects) == n_seen,
        }
    };
    LimitReport::counted(rows.len(), (0..).zip(rows).map(of_cell))
}

/// A column of a matrix whose rows are runs: the rows whose set has the current index, as bits. Goes from index to index.
struct Column<'a> {
    rows: &'a [CellRow],
    set: fn(&CellRow) -> &[Range<u32>],
    next: u32,
    /// By index: the first row of a list of those whose sets begin or end a run there, or [`NONE`].
    first: Vec<u32>,
    /// By row: the next one in its list.
    others: Vec<u32>,
    /// By row: how many beginnings and ends of its runs are past.
    past: Vec<u32>,
    bits: Vec<u64>,
    /// What was joined last.
    words: Vec<u64>,
}

const NONE: u32 = u32::MAX;

impl<'a> Column<'a> {
    /// Ready to go to the first column of a square matrix. O(n).
    fn of(rows: &'a [CellRow], set: fn(&CellRow) -> &[Range<u32>]) -> Self {
        let (n, none) = (rows.len(), vec![0; rows.len().div_ceil(64)]);
        let (first, others, past) = (vec![NONE; n], vec![NONE; n], vec![0; n]);
        let mut column = Self { rows, set, next: 0, first, others, past, bits: none.clone(), words: none };
        (0..n as u32).for_each(|row| column.wait(row));
        column
    }

    /// Puts a row into the list of the index where its next run begins or ends.
    fn wait(&mut self, row: u32) {
        let past = self.past[row as usize] as usize;
        let run = (self.set)(&self.rows[row as usize]).get(past / 2);
        let at = run.map(|run| if past.is_multiple_of(2) { run.start } else { run.end });
        // Nothing changes behind the last index.
        if let Some(first) = at.and_then(|at| self.first.get_mut(at as usize)) {
            self.others[row as usize] = std::mem::replace(first, row);
        }
    }

    /// Goes on to the next column. In all O(runs).
    fn go_on(&mut self) {
        let mut row = std::mem::replace(&mut self.first[self.next as usize], NONE);
        while row != NONE {
            let after = self.others[row as usize];
            self.bits[row as usize / 64] ^= 1 << (row % 64);
            self.past[row as usize] += 1;
            self.wait(row);
            row = after;
        }
        self.next += 1;
    }

    /// What a row and the column have in common, or, with `either`, what one of them has; and `own`. Ascending.
    /// O(n / 64 + members).
    fn with(&mut self, row: &[Range<u32>], own: u32, either: bool) -> impl Iterator<Item = u32> {
        self.join(row, either);
        self.words[own as usize / 64] |= 1 << (own % 64);
        ones(&self.words).map(|k| k as u32)
    }

    /// Puts the same into `words`, but for `own`. O(n / 64).
    fn join(&mut self, row: &[Range<u32>], either: bool) {
        self.take(row);
        for (word, &other) in self.words.iter_mut().zip(&self.bits) {
            if either { *word |= other } else { *word &= other }
        }
    }

    /// Whether an index is in what was joined last.
    fn has(&self, index: u32) -> bool {
        self.words[index as usize / 64] >> (index % 64) & 1 == 1
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
        /// Invariant: a pair is left if one of the two has not decided it, and it is visible.
        #[test]
        fn what_is_left_is_what_pairs_say(seen in rows(), seed: u64, one_way: bool) {
            let mut random = sightlines_geometry::Random::new(seed);
            let n = seen.len() as u32;
            // Of what a row sees, a part is not decided.
            let rows: Vec<CellRow> = seen.into_iter().map(|row| {
                let left = row.cells.iter().cloned().flatten().filter(|_| random.below(2) == 0).collect::<Vec<_>>();
                CellRow { left: [runs_of(left), Vec::new()], ..row }
            }).collect();
            let has = |runs: &[Range<u32>], cell: u32| runs.iter().any(|run| run.contains(&cell));
            let is_left = |a: u32, b: u32| {
                let [from, to] = [a, b].map(|cell| &rows[cell as usize]);
                let sees = [has(&from.cells, b), has(&to.cells, a)];
                let is_seen = if one_way { sees[0] || sees[1] } else { sees[0] && sees[1] };
                is_seen && (has(&from.left[0], b) || has(&to.left[0], a))
            };
            let n_pairs = (0..n).flat_map(|a| (0..a).map(move |b| (a, b))).filter(|&(a, b)| is_left(a, b)).count();
            let report = left_of(&rows, &vec![Vec::new(); n as usize], 0, one_way);
            prop_assert_eq!(report.n_cell_pairs, n_pairs as u64);
        }
    }

    proptest! {
        /// Invariant: columns hold what a search through all rows finds.
        #[test]
        fn columns_are_what_rows_say(rows in rows(), one_way: bool) {
            let has = |row: u32, cell: u32| rows[row as usize].cells.iter().any(|run| run.contains(&cell));
            let (mut column, n) = (Column::of(&rows, |row| &row.cells), rows.len() as u32);
            for (cell, row) in (0..n).zip(&rows) {
                column.go_on();
                let both = |other: u32| [has(cell, other), has(other, cell)];
                let is_seen = |other: &u32| match both(*other) {
                    _ if *other == cell => true,
                    [a, b] => if one_way { a || b } else { a && b },
                };
                let expected: Vec<u32> = (0..n).filter(is_seen).collect();
                prop_assert_eq!(column.with(&row.cells, cell, one_way).collect::<Vec<_>>(), expected);
            }
        }
    }
}
