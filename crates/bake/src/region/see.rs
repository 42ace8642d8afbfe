//! From-region queries, cell by cell.

use super::limited::{Limit, Limited};
use super::{MakeMethod, RegionBakeOptions};
use crate::error::BakeError;
use rayon::prelude::*;
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_multifocal::{BackendError, Effort, FromRegion, Occludees, RaySampler, Umbra, Volume, adaptive};
use sightlines_progress::{Allowance, Counter, Shares, Work, scattered};
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::PairMask;

/// Rays to a cell before its query: most pairs of cells that see each other do so along many lines.
const RAYS_TO_A_CELL: u32 = 24;

/// What the queries of all cells share.
pub(super) struct Targets<'a> {
    pub(super) occludees: &'a Occludees,
    pub(super) witness: &'a RaySampler,
    pub(super) volumes: &'a [Volume],
}

/// What is left visible, and which of it a ray proves.
pub(super) struct RegionVisibility {
    pub(super) rows: BitMatrix,
    pub(super) objects: BitMatrix,
    pub(super) proven: PairMask,
    /// What was not decided because the allowance was over; where the method was stopped, also some of what it would have left visible.
    pub(super) left: PairMask,
    pub(super) effort: Effort,
}

/// What one cell may see.
struct CellRow {
    cells: Vec<bool>,
    objects: Vec<bool>,
    /// Cells that a ray reaches, and objects.
    proven: [Vec<bool>; 2],
    /// Cells that were not decided because the allowance was over, and objects.
    left: [Vec<bool>; 2],
    effort: Effort,
}

/// Most turns of a cell that is not decided in its share of a budget; each begins anew, for what is in doubt.
const MOST_TURNS: u32 = 4;

/// Clears what the method proves hidden of what is still visible in `rows` and `objects`.
///
/// With a limited `allowance` each cell has a fair share of it; what the others do not need goes to those that were not done.
pub(super) fn see(
    scene: &Targets<'_>,
    make: MakeMethod<'_>,
    options: &RegionBakeOptions<'_>,
    allowance: Allowance<'_>,
    rows: BitMatrix,
    objects: BitMatrix,
) -> Result<RegionVisibility, BakeError> {
    let n = scene.volumes.len();
    let n_objects = scene.occludees.len();
    let none = || PairMask { boxes: BitMatrix::new(n, n), objects: BitMatrix::new(n, n_objects) };
    let mut known = RegionVisibility { rows, objects, proven: none(), left: none(), effort: Effort::default() };
    let counter = Counter::new(options.progress, "cells", n).of(Work::Deciding);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build().expect("threads can be started");
    let mut cells: Vec<usize> = scattered(n).collect();
    for turn in 0..MOST_TURNS {
        let shares = Shares::new(allowance, cells.len(), pool.current_num_threads());
        let one = |method: &mut Box<dyn FromRegion + Send>, &cell: &usize| {
            let row = see_from(scene, &mut **method, options, cell, &known, shares.next_unit())?;
            if turn == 0 {
                counter.step()?
            } else {
                counter.check()?
            }
            Ok((cell, row))
        };
        let found: Vec<(usize, CellRow)> =
            pool.install(|| cells.par_iter().map_init(make, one).collect::<Result<_, BakeError>>())?;
        cells = found.iter().filter(|(_, row)| row.left.iter().flatten().any(|left| *left)).map(|f| f.0).collect();
        found.into_iter().for_each(|(cell, row)| known.add(cell, &row));
        if cells.is_empty() || allowance.is_over() {
            break;
        }
    }
    known.forget_decided();
    Ok(known)
}

impl RegionVisibility {
    /// Adds what the last turn of a cell has found.
    fn add(&mut self, a: usize, row: &CellRow) {
        self.effort = self.effort + row.effort;
        // Sight is symmetric: either of the two may have found that there is none.
        for b in (0..row.cells.len()).filter(|&b| !row.cells[b] && a != b) {
            self.rows.set(a, b, false);
            self.rows.set(b, a, false);
        }
        (0..row.objects.len()).filter(|&o| !row.objects[o]).for_each(|o| self.objects.set(a, o, false));
        let [cells, things] = &row.proven;
        for b in (0..cells.len()).filter(|&b| cells[b]) {
            self.proven.boxes.set(a, b, true);
            self.proven.boxes.set(b, a, true);
        }
        (0..things.len()).filter(|&o| things[o]).for_each(|o| self.proven.objects.set(a, o, true));
        let [cells, things] = &row.left;
        (0..cells.len()).for_each(|b| self.left.boxes.set(a, b, cells[b]));
        (0..things.len()).for_each(|o| self.left.objects.set(a, o, things[o]));
    }

    /// What is hidden or proven visible was decided, whichever of two cells it was.
    fn forget_decided(&mut self) {
        for a in 0..self.left.boxes.n_rows() {
            for b in self.left.boxes.iter_ones(a).collect::<Vec<_>>() {
                let open = a != b && self.rows.get(a, b) && !self.proven.boxes.get(a, b);
                self.left.boxes.set(a, b, open);
                self.left.boxes.set(b, a, open);
            }
        }
    }
}

fn see_from(
    scene: &Targets<'_>,
    method: &mut dyn FromRegion,
    options: &RegionBakeOptions<'_>,
    cell: usize,
    known: &RegionVisibility,
    unit: Allowance<'_>,
) -> Result<CellRow, BackendError> {
    let volume = &scene.volumes[cell];
    let mut of_objects: Vec<bool> = (0..scene.occludees.len()).map(|o| known.objects.get(cell, o)).collect();
    let mut of_cells: Vec<bool> = (0..scene.volumes.len()).map(|c| known.rows.get(cell, c)).collect();
    let mut objects_reached: Vec<bool> = (0..of_objects.len()).map(|o| known.proven.objects.get(cell, o)).collect();
    let mut cells_reached: Vec<bool> = (0..of_cells.len()).map(|c| known.proven.boxes.get(cell, c)).collect();
    if unit.is_over() {
        let left = [not_proven(&of_cells, &cells_reached), not_proven(&of_objects, &objects_reached)];
        let proven = [cells_reached, objects_reached];
        return Ok(CellRow { cells: of_cells, objects: of_objects, proven, left, effort: Effort::default() });
    }
    let limit = Limit::new(unit);
    let mut left_cells = vec![false; of_cells.len()];
    let mut see_cells = |umbra: &mut dyn Umbra| {
        // Objects have half of what there is.
        limit.set(unit.part(0.5));
        for (other, visible) in of_cells.iter_mut().enumerate().filter(|(_, visible)| **visible) {
            let target = scene.volumes[other].bounds();
            limit.take_refused();
            let reached = &mut cells_reached[other];
            *reached = *reached || !limit.refuses() && scene.witness.sees(volume, target, RAYS_TO_A_CELL);
            *visible = *reached || !umbra.hides(target);
            left_cells[other] = *visible && !*reached && other != cell && limit.take_refused();
        }
        limit.set(unit);
        limit.take_refused();
    };
    let (occludees, witness, split) = (scene.occludees, scene.witness, &options.split);
    let mut limited = Limited { method, limit: &limit };
    let method: &mut dyn FromRegion = if unit.is_limited() { &mut limited } else { limited.method };
    let effort = adaptive::see_and_note(
        method,
        occludees,
        witness,
        volume,
        split,
        &mut of_objects,
        &mut objects_reached,
        &mut see_cells,
    )?;
    let left_objects = match limit.take_refused() {
        true => not_proven(&of_objects, &objects_reached),
        false => vec![false; of_objects.len()],
    };
    let (proven, left) = ([cells_reached, objects_reached], [left_cells, left_objects]);
    Ok(CellRow { cells: of_cells, objects: of_objects, proven, left, effort })
}

/// What is visible, and not proven to be.
fn not_proven(visible: &[bool], proven: &[bool]) -> Vec<bool> {
    visible.iter().zip(proven).map(|(visible, proven)| *visible && !proven).collect()
}

/// For each cell the objects whose boxes meet it, ascending; touching counts.
pub(super) fn touching(cells: &[Aabb<3>], objects: &[Aabb<3>]) -> Vec<Vec<u32>> {
    let meet = |a: &Aabb<3>, b: &Aabb<3>| (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k]);
    // Nothing is around an object without triangles.
    let (ids, boxes): (Vec<u32>, Vec<Aabb<3>>) = (0..).zip(objects).filter(|(_, b)| !b.is_empty()).unzip();
    let tree = BoxTree::build(&boxes, 8);
    let touched = |cell: &Aabb<3>| {
        let mut found = Vec::new();
        tree.visit(
            |b| meet(b, cell),
            |i| {
                if meet(&boxes[i as usize], cell) {
                    found.push(ids[i as usize]);
                }
            },
        );
        found.sort_unstable();
        found
    };
    cells.par_iter().map(touched).collect()
}

/// Sets the bits of `lists`.
pub(super) fn add(matrix: &mut BitMatrix, lists: &[Vec<u32>]) {
    for (row, list) in lists.iter().enumerate() {
        list.iter().for_each(|&col| matrix.set(row, col as usize, true));
    }
}
