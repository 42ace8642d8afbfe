//! From-region queries, cell by cell.

use super::limited::{Limit, Limited};
use super::row::{CellRow, gaps};
use super::{MakeMethod, RegionBakeOptions, phase};
use crate::error::BakeError;
use crate::threads;
use rayon::prelude::*;
use sightlines_geometry::{Aabb, BoxNode, BoxTree};
use sightlines_multifocal::{BackendError, FromRegion, Occludees, RaySampler, Umbra, Volume, WorkDone, adaptive};
use sightlines_progress::{Allowance, Counter, Shares, Work, scattered};
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::PairMask;
use std::ops::Range;

/// Rays to a cell before its query: most pairs of cells that see each other do so along many lines.
const RAYS_TO_A_CELL: u32 = 24;

/// Rays to a group of cells, for the same reason: what one reaches is not hidden.
const RAYS_TO_A_GROUP: u32 = 4;

/// What the queries of all cells share.
pub(super) struct Targets<'a> {
    pub(super) occludees: &'a Occludees,
    pub(super) witness: &'a RaySampler,
    pub(super) volumes: &'a [Volume],
    /// Whether something hides from one side only: then one cell may see another that does not see it.
    pub(super) has_one_way: bool,
    /// Boxes elsewhere, of which is asked as of cells; they come behind these, list by list.
    pub(super) regions: &'a Regions<'a>,
    /// Of the volumes, and of each list of regions, with the first of their boxes; a leaf for each box. What is found about the boxes of one
    /// does not depend on the others.
    trees: Vec<(usize, BoxTree<3>)>,
}

/// Lists of boxes elsewhere.
pub(crate) type Regions<'a> = [&'a [Aabb<3>]];

impl<'a> Targets<'a> {
    pub(super) fn new(
        (occludees, witness): (&'a Occludees, &'a RaySampler),
        volumes: &'a [Volume],
        has_one_way: bool,
        regions: &'a Regions<'a>,
    ) -> Self {
        let cells: Vec<Aabb<3>> = volumes.iter().map(|volume| *volume.bounds()).collect();
        let mut first = 0;
        let trees = std::iter::once(&cells[..]).chain(regions.iter().copied()).map(|boxes| {
            let at = first;
            first += boxes.len();
            (at, BoxTree::build(boxes, 1))
        });
        let trees = trees.collect();
        Self { occludees, witness, volumes, has_one_way, regions, trees }
    }

    /// How many cells and regions there are.
    fn n_boxes(&self) -> usize {
        self.volumes.len() + self.regions.iter().map(|list| list.len()).sum::<usize>()
    }
}

/// What is left visible, and which of it a ray proves.
pub(super) struct RegionVisibility {
    pub(super) rows: BitMatrix,
    /// Cells by objects, and regions behind them; so are those of the other fields.
    pub(super) objects: BitMatrix,
    pub(super) proven: PairMask,
    /// What was not decided because the allowance was over; where the method was stopped, also some of what it would have left visible.
    pub(super) left: PairMask,
    pub(super) effort: WorkDone,
    /// If something hides from one side only: for each cell those that are hidden from it, though it may not be hidden from them.
    hidden_one_way: Option<BitMatrix>,
}

/// Most turns of a cell that is not decided in its share of a budget; each begins anew, for what is in doubt.
const MOST_TURNS: u32 = 4;

/// The phase of units of work: one for each cell.
const PHASE: &str = "cells";

/// Clears what the method proves hidden of what is still visible in `rows` and `objects`.
///
/// * `objects`: cells by objects, and by regions behind them
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
    let n_things = scene.occludees.len() + scene.n_boxes() - n;
    let none = || PairMask { boxes: BitMatrix::new(n, n), objects: BitMatrix::new(n, n_things) };
    let n_objects = scene.occludees.len();
    let hidden_one_way = scene.has_one_way.then(|| BitMatrix::new(n, n));
    let (proven, left, effort) = (none(), none(), WorkDone::default());
    let mut known = RegionVisibility { rows, objects, proven, left, effort, hidden_one_way };
    if !allowance.is_limited() {
        let found = see_all(scene, make, options, Some(&known))?;
        found.into_iter().enumerate().for_each(|(cell, row)| known.add(cell, &row, n_objects));
        return Ok(known);
    }
    let counter = Counter::new(options.progress, "cells", n).of(Work::Deciding);
    let mut cells: Vec<usize> = scattered(n).collect();
    for turn in 0..MOST_TURNS {
        let shares = Shares::new(allowance, cells.len(), threads::on(options.threads, rayon::current_num_threads));
        let one = |method: &mut Box<dyn FromRegion + Send>, &cell: &usize| {
            let row = see_from(scene, &mut **method, options, cell, Some(&known), shares.next_unit())?;
            if turn == 0 {
                counter.step()?
            } else {
                counter.check()?
            }
            Ok((cell, row))
        };
        let found: Vec<(usize, CellRow)> =
            threads::on(options.threads, || cells.par_iter().map_init(make, one).collect::<Result<_, BakeError>>())?;
        cells = found.iter().filter(|(_, row)| row.left.iter().any(|left| !left.is_empty())).map(|f| f.0).collect();
        found.into_iter().for_each(|(cell, row)| known.add(cell, &row, n_objects));
        if cells.is_empty() || allowance.is_over() {
            break;
        }
    }
    known.forget_decided();
    Ok(known)
}

/// What each cell sees by itself, without a limit: of everything, or of what is `known` to be possible.
pub(super) fn see_all(
    scene: &Targets<'_>,
    make: MakeMethod<'_>,
    options: &RegionBakeOptions<'_>,
    known: Option<&RegionVisibility>,
) -> Result<Vec<CellRow>, BakeError> {
    let n = scene.volumes.len();
    let sizes = [scene.n_boxes() as u32, scene.occludees.len() as u32];
    let costs = threads::on(options.threads, || costs_of(scene, options.units.need_costs()));
    let from_bytes = |bytes: &[u8]| CellRow::from_bytes(bytes, sizes);
    let found = phase::decide(PHASE, &costs, options, (CellRow::to_bytes, from_bytes), |cell| {
        Ok(see_from(scene, &mut *make(), options, cell, known, Allowance::default())?)
    })?;
    let mut rows: Vec<CellRow> = vec![CellRow::default(); n];
    found.into_iter().for_each(|(cell, row)| rows[cell] = row.expect("a phase that ends has all its results"));
    Ok(rows)
}

/// The same within an allowance, and of everything: each cell gets a share of it, and what earlier cells have not used.
pub(super) fn see_all_within(
    scene: &Targets<'_>,
    make: MakeMethod<'_>,
    options: &RegionBakeOptions<'_>,
    allowance: Allowance<'_>,
) -> Result<Vec<CellRow>, BakeError> {
    let n = scene.volumes.len();
    let counter = Counter::new(options.progress, "cells", n).of(Work::Deciding);
    let shares = Shares::new(allowance, n, threads::on(options.threads, rayon::current_num_threads));
    let one = |method: &mut Box<dyn FromRegion + Send>, cell: usize| {
        let row = see_from(scene, &mut **method, options, cell, None, shares.next_unit())?;
        counter.step()?;
        Ok((cell, row))
    };
    let cells: Vec<usize> = scattered(n).collect();
    let found: Vec<(usize, CellRow)> =
        threads::on(options.threads, || cells.into_par_iter().map_init(make, one).collect::<Result<_, BakeError>>())?;
    let mut rows: Vec<CellRow> = vec![CellRow::default(); n];
    found.into_iter().for_each(|(cell, row)| rows[cell] = row);
    Ok(rows)
}

/// The predicted cost of each cell: in proportion to what some rays from it reach; the same for all if that is not needed.
fn costs_of(scene: &Targets<'_>, is_needed: bool) -> Vec<f64> {
    let n_objects = scene.occludees.len();
    let cost = |volume: &Volume| {
        let mut reached = vec![false; n_objects];
        scene.witness.see(volume, RAYS_TO_PREDICT, &vec![true; n_objects], &mut reached);
        1.0 + reached.iter().filter(|reached| **reached).count() as f64
    };
    if is_needed { scene.volumes.par_iter().map(cost).collect() } else { vec![1.0; scene.volumes.len()] }
}

/// Rays by which the cost of a cell is predicted.
const RAYS_TO_PREDICT: u32 = 64;

impl RegionVisibility {
    /// Adds what the last turn of a cell has found.
    fn add(&mut self, a: usize, row: &CellRow, n_objects: usize) {
        self.effort = self.effort + row.effort;
        let n = self.rows.n_cols();
        let n_boxes = n + self.objects.n_cols() - n_objects;
        // Regions are columns behind the objects.
        let column = |region: usize| n_objects + region - n;
        for b in gaps(&row.cells, n_boxes as u32).flatten().map(|b| b as usize).filter(|&b| a != b) {
            if b < n {
                // Sight is symmetric, and either of the two may have found that there is none; but not past what hides from one side.
                let is_hidden = self.hidden_one_way.as_mut().is_none_or(|hidden| {
                    hidden.set(a, b, true);
                    hidden.get(b, a)
                });
                if is_hidden {
                    self.rows.set(a, b, false);
                    self.rows.set(b, a, false);
                }
            } else {
                self.objects.set(a, column(b), false);
            }
        }
        gaps(&row.objects, n_objects as u32).flatten().for_each(|o| self.objects.set(a, o as usize, false));
        let [boxes, things] = &row.proven;
        for b in boxes.iter().cloned().flatten().map(|b| b as usize) {
            if b < n {
                self.proven.boxes.set(a, b, true);
                self.proven.boxes.set(b, a, true);
            } else {
                self.proven.objects.set(a, column(b), true);
            }
        }
        things.iter().cloned().flatten().for_each(|o| self.proven.objects.set(a, o as usize, true));
        self.left.boxes.row_mut(a).fill(0);
        self.left.objects.row_mut(a).fill(0);
        let [boxes, things] = &row.left;
        for b in boxes.iter().cloned().flatten().map(|b| b as usize) {
            if b < n {
                self.left.boxes.set(a, b, true);
            } else {
                self.left.objects.set(a, column(b), true);
            }
        }
        things.iter().cloned().flatten().for_each(|o| self.left.objects.set(a, o as usize, true));
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

/// Whether two boxes do not overlap along some axis.
fn apart(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).any(|k| a.max[k] < b.min[k] || b.max[k] < a.min[k])
}

fn see_from(
    scene: &Targets<'_>,
    method: &mut dyn FromRegion,
    options: &RegionBakeOptions<'_>,
    cell: usize,
    known: Option<&RegionVisibility>,
    unit: Allowance<'_>,
) -> Result<CellRow, BackendError> {
    let volume = &scene.volumes[cell];
    let (n_boxes, n_objects) = (scene.n_boxes(), scene.occludees.len());
    if known.is_none() && unit.is_over() {
        return Ok(CellRow::undecided([n_boxes as u32, n_objects as u32]));
    }
    let split = |cells: &BitMatrix, objects: &BitMatrix| -> [Vec<bool>; 2] {
        let of_row = |matrix: &BitMatrix, columns: Range<usize>| columns.map(|k| matrix.get(cell, k)).collect();
        let mut of_cells: Vec<bool> = of_row(cells, 0..cells.n_cols());
        let mut of_objects: Vec<bool> = of_row(objects, 0..objects.n_cols());
        of_cells.extend(of_objects.drain(n_objects..));
        [of_cells, of_objects]
    };
    let [mut of_cells, mut of_objects] =
        known.map_or_else(|| [n_boxes, n_objects].map(|n| vec![true; n]), |known| split(&known.rows, &known.objects));
    let [mut cells_reached, mut objects_reached] = known.map_or_else(
        || [n_boxes, n_objects].map(|n| vec![false; n]),
        |known| split(&known.proven.boxes, &known.proven.objects),
    );
    if unit.is_over() {
        let left = [not_proven(&of_cells, &cells_reached), not_proven(&of_objects, &objects_reached)];
        return Ok(CellRow::new([of_cells, of_objects], [cells_reached, objects_reached], left, WorkDone::default()));
    }
    let limit = Limit::new(unit);
    let mut left_cells = vec![false; of_cells.len()];
    let mut see_cells = |umbra: &mut dyn Umbra| {
        // Objects have half of what there is.
        limit.set(unit.part(0.5));
        // What is found of one list must not depend on the others.
        let forget = |umbra: &mut dyn Umbra| {
            if !scene.regions.is_empty() {
                umbra.forget();
            }
        };
        for (first, tree) in scene.trees.iter().filter(|(_, tree)| !tree.order().is_empty()) {
            let members = |node: &BoxNode<3>| {
                tree.order()[node.start as usize..node.end as usize].iter().map(|&member| first + member as usize)
            };
            forget(umbra);
            // Groups of cells first: what hides the box of a group hides all of it.
            let mut pending = vec![0u32];
            while let Some(k) = pending.pop() {
                let node = &tree.nodes()[k as usize];
                if members(node).all(|other| !of_cells[other]) {
                    continue;
                }
                if !node.is_leaf() {
                    let may_be_hidden = apart(volume.bounds(), &node.bounds)
                        && !limit.refuses()
                        && !members(node).any(|other| cells_reached[other])
                        && !scene.witness.sees(volume, &node.bounds, RAYS_TO_A_GROUP);
                    if may_be_hidden && umbra.hides(&node.bounds) {
                        members(node).for_each(|other| of_cells[other] = false);
                    } else {
                        pending.extend(tree.children(k));
                    }
                    continue;
                }
                // A leaf has one box, its own.
                for other in members(node) {
                    limit.take_refused();
                    let reached = cells_reached[other]
                        || !limit.refuses() && scene.witness.sees(volume, &node.bounds, RAYS_TO_A_CELL);
                    let visible = reached || !umbra.hides(&node.bounds);
                    left_cells[other] = visible && !reached && other != cell && limit.take_refused();
                    (cells_reached[other], of_cells[other]) = (reached, visible);
                }
            }
        }
        forget(umbra);
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
    Ok(CellRow::new([of_cells, of_objects], proven, left, effort))
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
