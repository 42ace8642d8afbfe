//! What cells see that share faces: by shadows that are propagated from cell to cell.

use super::parts::ones;
use super::{RegionBakeOptions, phase};
use crate::error::BakeError;
use crate::eye_level::GROUPS;
use crate::propagation::{Propagation, Solved};
use crate::threads;
use sightlines_cells::{ANYWHERE, Scene};
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_line_space::{FaceTarget, Surface};
use sightlines_multifocal::{Occludees, QueryCounts, RaySampler, WorkDone};
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::PairMask;
use std::sync::Arc;

/// The phase of units of work: one for each object, and for each group of cells.
const PHASE: &str = "shadows";

/// So many cells at least are asked about together, as a box around them.
const GROUP: usize = 8;

/// What is left visible.
pub(super) struct Tiled {
    pub(super) rows: BitMatrix,
    pub(super) objects: BitMatrix,
    /// What was not decided because the allowance was over.
    pub(super) left: PairMask,
    pub(super) effort: WorkDone,
}

/// What may be hidden from cells.
struct Wanted {
    /// The object, if it is one.
    object: Option<u32>,
    target: FaceTarget,
    /// The columns that it stands for: an object, or cells.
    columns: Vec<u32>,
}

/// Decides from which cells objects and other cells are hidden.
///
/// * `extents`: the boxes of the objects
pub(super) fn see(
    (scene, surface): (&Scene, Arc<Surface>),
    cells: &[Aabb<3>],
    (occludees, rays): (&Occludees, &RaySampler),
    extents: &[Aabb<3>],
    options: &RegionBakeOptions<'_>,
) -> Result<Tiled, BakeError> {
    let (n, n_objects) = (cells.len(), occludees.len());
    let propagation =
        threads::on(options.threads, || Propagation::new(cells.to_vec(), rays, surface, n_objects, options.progress))?;
    let wanted = wanted(cells, occludees, extents);
    let costs: Vec<f64> = wanted.iter().map(|of| 100.0 + of.target.triangles().len() as f64).collect();
    let from_bytes = |bytes: &[u8]| Solved::from_bytes(bytes, n as u32);
    let found = phase::decide(PHASE, &costs, options, (Solved::to_bytes, from_bytes), |unit| {
        let Wanted { object, target, .. } = &wanted[unit];
        let is_culled = object.is_some_and(|object| scene.is_single_sided(object));
        Ok(propagation.solve(*object, target, is_culled, &[]))
    })?;
    let mut tiled = Tiled {
        rows: ones(n, n),
        objects: ones(n, extents.len()),
        left: PairMask { boxes: BitMatrix::new(n, n), objects: BitMatrix::new(n, extents.len()) },
        effort: WorkDone::default(),
    };
    // Cells by cells: those in a row are hidden from the cell of the row.
    let mut hidden = BitMatrix::new(n, n);
    let mut counts = QueryCounts::default();
    for (unit, solved) in found {
        let Wanted { object, columns, .. } = &wanted[unit];
        let matrix = if object.is_some() { &mut tiled.left.objects } else { &mut tiled.left.boxes };
        let Some(solved) = solved else {
            (0..n).for_each(|row| columns.iter().for_each(|&column| matrix.set(row, column as usize, true)));
            continue;
        };
        counts.boxes += solved.n_asked;
        counts.triangles += solved.n_cells;
        for row in solved.hidden.iter().cloned().flatten().map(|cell| cell as usize) {
            for &column in columns {
                match object {
                    Some(_) => tiled.objects.set(row, column as usize, false),
                    None => hidden.set(row, column as usize, true),
                }
            }
        }
    }
    // Sight is symmetric but past what hides from one side: there a pair has to be hidden both ways.
    let is_one_way = !scene.front_occluders().is_empty();
    for row in 0..n {
        for column in hidden.iter_ones(row).collect::<Vec<_>>() {
            if row != column && (!is_one_way || hidden.get(column, row)) {
                tiled.rows.set(row, column, false);
                tiled.rows.set(column, row, false);
            }
        }
    }
    // Nothing is drawn of an object without triangles.
    let nothing = (0..n_objects).filter(|&object| extents[object].is_empty());
    nothing.for_each(|object| (0..n).for_each(|row| tiled.objects.set(row, object, false)));
    tiled.effort = WorkDone { n_volumes: n as u64, queries: counts };
    Ok(tiled)
}

/// The objects that are somewhere and have an extent, and groups of cells.
fn wanted(cells: &[Aabb<3>], occludees: &Occludees, extents: &[Aabb<3>]) -> Vec<Wanted> {
    let mut wanted = Vec::new();
    for (object, extent) in extents.iter().enumerate().take(occludees.len()) {
        let target = FaceTarget::new(occludees.triangles(object)).filter(|_| *extent != ANYWHERE);
        let of = |target| Wanted { object: Some(object as u32), target, columns: vec![object as u32] };
        wanted.extend(target.map(of));
    }
    let tree = BoxTree::build(cells, (cells.len() / GROUPS).max(GROUP));
    for leaf in tree.nodes().iter().filter(|node| node.is_leaf() && !node.is_empty()) {
        let columns = tree.order()[leaf.start as usize..leaf.end as usize].to_vec();
        wanted.extend(FaceTarget::of_box(&leaf.bounds).map(|target| Wanted { object: None, target, columns }));
    }
    wanted
}
