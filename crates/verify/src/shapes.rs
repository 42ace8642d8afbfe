//! The shapes of cells and portals that a table records.

use sightlines_geometry::{Point2, Point3, orient2d};
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

/// Which way the corners of a rectangle across an axis go round: 1 if counter-clockwise about the axis, -1 if clockwise. `None` if the points are not
/// the four corners of a rectangle along the other axes, in turn.
pub(crate) fn turn(points: &[Point3], axis: usize) -> Option<i32> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let &[a, b, c, d] = points else { return None };
    let is_flat = [b, c, d].iter().all(|p| p[axis] == a[axis]);
    // Two corners next to each other differ along one axis, and the axes alternate.
    let along = |p: Point3, q: Point3, k: usize, other: usize| p[k] != q[k] && p[other] == q[other];
    let around = |k: usize, other: usize| {
        along(a, b, k, other) && along(b, c, other, k) && along(c, d, k, other) && along(d, a, other, k)
    };
    if !is_flat || !(around(u, v) || around(v, u)) {
        return None;
    }
    let flat = |p: Point3| Point2::new(p[u], p[v]);
    Some(if orient2d(flat(a), flat(b), flat(c)) > 0.0 { 1 } else { -1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_have_four_corners_in_turn() {
        let square = [[5.0, 0.0, 0.0], [5.0, 2.0, 0.0], [5.0, 2.0, 3.0], [5.0, 0.0, 3.0]];
        assert_eq!(turn(&square, 0), Some(1), "from y to z is counter-clockwise about x");
        let mut other = square;
        other.reverse();
        assert_eq!(turn(&other, 0), Some(-1));
        other.swap(0, 1);
        assert_eq!(turn(&other, 0), None, "corners crosswise");
        assert_eq!([turn(&square[..3], 0), turn(&square, 1), turn(&[], 0)], [None; 3]);
        let mut bent = square;
        bent[2][1] = 1.5;
        assert_eq!(turn(&bent, 0), None);
    }
}
