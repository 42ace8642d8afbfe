//! The shapes of cells and portals that a table records.

use sightlines_geometry::Point2;
use sightlines_pvs::{PortalRecord, Table, TableKind};

/// The cells' outlines; `None` if the table does not have them, and its boxes are not the cells.
pub(crate) fn outlines(table: &Table) -> Option<Vec<Vec<Point2>>> {
    let boxes_are_cells = table.kind() == TableKind::PlanKdTree;
    let outline = |c: &sightlines_pvs::CellRecord| {
        let corners = [[c.min[0], c.min[1]], [c.max[0], c.min[1]], [c.max[0], c.max[1]], [c.min[0], c.max[1]]];
        match c.polygon.is_empty() {
            false => Some(c.polygon.iter().map(|&p| Point2::from(p)).collect()),
            true if boxes_are_cells => Some(corners.map(Point2::from).to_vec()),
            true => None,
        }
    };
    table.cells().iter().map(outline).collect()
}

/// The ends of a portal of a plan, as seen from its first cell.
pub(crate) fn ends(record: &PortalRecord) -> [Point2; 2] {
    let point = |i: usize| record.points.get(i).map_or(Point2::ZERO, |p| Point2::new(p[0], p[1]));
    [point(0), point(1)]
}

/// The middle of some points, rounded.
pub(crate) fn middle<const D: usize>(points: &[[f64; D]]) -> [f64; D] {
    std::array::from_fn(|k| points.iter().map(|p| p[k] / points.len() as f64).sum())
}
