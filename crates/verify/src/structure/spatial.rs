//! Cells and portals of scenes in space.

use crate::findings::{Findings, Violation};
use crate::shapes::{middle, turn};
use sightlines_cells::CellId;
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_pvs::{CellRecord, Table, TableKind};

pub(super) fn check(table: &Table, findings: &mut Findings) {
    let boxes: Vec<Aabb<3>> = table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
    let tree = BoxTree::build(&boxes, 4);
    // Given cells may overlap and be flat.
    let given = matches!(table.kind(), TableKind::SceneGivenCells { .. });
    for (id, bounds) in (0u32..).map(CellId).zip(&boxes) {
        if !given && (0..3).any(|k| bounds.min[k] >= bounds.max[k]) {
            findings.add(Violation::NotConvex { cell: id });
        }
        let point = middle(&[bounds.min, bounds.max]);
        if bounds.contains(point) && !table.in_dimension().unwrap().at(point).cells().contains(&id) {
            findings.add(Violation::NotFound { cell: id, point });
        }
        let common = |b: &Aabb<3>| (0..3).all(|k| b.min[k] < bounds.max[k] && bounds.min[k] < b.max[k]);
        let mut overlapping = Vec::new();
        if !given {
            tree.visit(common, |other| {
                if other < id.0 && common(&boxes[other as usize]) {
                    overlapping.push(other);
                }
            });
        }
        overlapping.sort_unstable();
        overlapping.into_iter().for_each(|other| findings.add(Violation::Overlap { cells: [CellId(other), id] }));
    }
    for (portal, record) in table.portals().iter().enumerate() {
        let extent = Aabb::<3>::around(record.points.iter().copied());
        let axis = (0..3).find(|&k| extent.min[k] == extent.max[k]);
        for (own, other) in [(0, 1), (1, 0)] {
            let record_of = |i: usize| &table.cells()[record.cells[i].idx()];
            let is_on = axis.is_some_and(|axis| {
                // As seen from the first cell the corners go round counter-clockwise: clockwise about an axis that leads into the second.
                let is_above = record_of(1).min[axis] >= extent.max[axis];
                let looks_in = turn(&record.points, axis) == Some(if is_above { -1 } else { 1 });
                looks_in && on_wall(record_of(own), record_of(other), axis, &extent)
            });
            if !is_on {
                findings.add(Violation::OffBorder { portal, cell: record.cells[own] });
            }
        }
    }
}

/// Whether a flat box across an axis lies on the wall of a cell towards another.
fn on_wall(cell: &CellRecord, other: &CellRecord, axis: usize, extent: &Aabb<3>) -> bool {
    let within = (0..3).filter(|&k| k != axis).all(|k| cell.min[k] <= extent.min[k] && extent.max[k] <= cell.max[k]);
    let at = extent.min[axis];
    within && ((cell.max[axis] == at && other.min[axis] == at) || (cell.min[axis] == at && other.max[axis] == at))
}
