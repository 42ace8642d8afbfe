//! From-region queries, cell by cell.

use super::{MakeMethod, RegionBakeOptions};
use crate::error::BakeError;
use rayon::prelude::*;
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_multifocal::{BackendError, Effort, FromRegion, Occludees, RaySampler, Umbra, Volume, adaptive};
use sightlines_progress::Counter;
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
    pub(super) effort: Effort,
}

/// What one cell may see.
struct CellRow {
    cells: Vec<bool>,
    objects: Vec<bool>,
    /// Cells that a ray reaches, and objects.
    proven: [Vec<bool>; 2],
    effort: Effort,
}

/// Clears what the method proves hidden of what is still visible in `rows` and `objects`.
pub(super) fn see(
    scene: &Targets<'_>,
    make: MakeMethod<'_>,
    options: &RegionBakeOptions<'_>,
    mut rows: BitMatrix,
    mut objects: BitMatrix,
) -> Result<RegionVisibility, BakeError> {
    let n = scene.volumes.len();
    let counter = Counter::new(options.progress, "cells", n);
    let one = |method: &mut Box<dyn FromRegion + Send>, cell: usize| {
        let row = see_from(scene, &mut **method, options, cell, &rows, &objects)?;
        counter.step()?;
        Ok(row)
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build().expect("threads can be started");
    let found: Vec<CellRow> =
        pool.install(|| (0..n).into_par_iter().map_init(make, one).collect::<Result<_, BakeError>>())?;
    let mut effort = Effort::default();
    let mut proven = PairMask { boxes: BitMatrix::new(n, n), objects: BitMatrix::new(n, scene.occludees.len()) };
    for (a, row) in found.iter().enumerate() {
        effort = effort + row.effort;
        for (b, visible) in row.cells.iter().enumerate() {
            // Sight is symmetric: either of the two may have found that there is none.
            if !visible && a != b {
                rows.set(a, b, false);
                rows.set(b, a, false);
            }
        }
        row.objects.iter().enumerate().filter(|(_, visible)| !**visible).for_each(|(o, _)| objects.set(a, o, false));
        let [cells, things] = &row.proven;
        for b in (0..n).filter(|&b| cells[b]) {
            proven.boxes.set(a, b, true);
            proven.boxes.set(b, a, true);
        }
        (0..things.len()).filter(|&o| things[o]).for_each(|o| proven.objects.set(a, o, true));
    }
    Ok(RegionVisibility { rows, objects, proven, effort })
}

fn see_from(
    scene: &Targets<'_>,
    method: &mut dyn FromRegion,
    options: &RegionBakeOptions<'_>,
    cell: usize,
    rows: &BitMatrix,
    objects: &BitMatrix,
) -> Result<CellRow, BackendError> {
    let volume = &scene.volumes[cell];
    let mut of_objects: Vec<bool> = (0..scene.occludees.len()).map(|o| objects.get(cell, o)).collect();
    let mut of_cells: Vec<bool> = (0..scene.volumes.len()).map(|c| rows.get(cell, c)).collect();
    let mut proven = [vec![false; of_cells.len()], vec![false; of_objects.len()]];
    let [cells_reached, objects_reached] = &mut proven;
    let mut see_cells = |umbra: &mut dyn Umbra| {
        for (other, visible) in of_cells.iter_mut().enumerate().filter(|(_, visible)| **visible) {
            let target = scene.volumes[other].bounds();
            cells_reached[other] = scene.witness.sees(volume, target, RAYS_TO_A_CELL);
            *visible = cells_reached[other] || !umbra.hides(target);
        }
    };
    let (occludees, witness, split) = (scene.occludees, scene.witness, &options.split);
    let effort = adaptive::see_and_note(
        method,
        occludees,
        witness,
        volume,
        split,
        &mut of_objects,
        objects_reached,
        &mut see_cells,
    )?;
    Ok(CellRow { cells: of_cells, objects: of_objects, proven, effort })
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
