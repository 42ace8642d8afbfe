//! Cells and portals of plans.

use crate::exact::{insides_apart, strictly_in_polygon};
use crate::findings::{Findings, Violation};
use crate::shapes::{ends, middle, outlines};
use sightlines_cells::{CellId, Plan};
use sightlines_geometry::{Aabb, BoxTree, Point2, is_convex_ccw, orient2d};
use sightlines_pvs::Table;

pub(super) fn check(table: &Table, plan: &Plan, findings: &mut Findings) {
    let Some(cells) = outlines(table) else { return };
    let boxes: Vec<Aabb<2>> = cells.iter().map(|c| Aabb::around(c.iter().map(|p| [p.x, p.y]))).collect();
    let tree = BoxTree::build(&boxes, 4);
    let extent = extent(plan);
    for (id, (cell, bounds)) in (0u32..).map(CellId).zip(cells.iter().zip(&boxes)) {
        if !is_convex_ccw(cell) {
            findings.add(Violation::NotConvex { cell: id });
            continue;
        }
        if !extent.contains(bounds.min) || !extent.contains(bounds.max) {
            findings.add(Violation::OutOfScene { cell: id });
        }
        let point = middle(&cell.iter().map(|p| [p.x, p.y]).collect::<Vec<_>>());
        if strictly_in_polygon(cell, Point2::from(point))
            && !table.in_dimension().unwrap().at(point).cells().contains(&id)
        {
            findings.add(Violation::NotFound { cell: id, point: [point[0], point[1], 0.0] });
        }
        let mut overlapping = Vec::new();
        let common = |b: &Aabb<2>| (0..2).all(|k| b.min[k] < bounds.max[k] && bounds.min[k] < b.max[k]);
        tree.visit(common, |other| {
            if other < id.0 && !insides_apart(cell, &cells[other as usize]) {
                overlapping.push(other);
            }
        });
        overlapping.sort_unstable();
        overlapping.into_iter().for_each(|other| findings.add(Violation::Overlap { cells: [CellId(other), id] }));
    }
    portals(table, plan, &cells, findings);
}

/// The box around the plan. Who names groups may have the surroundings cut too, so these tables reach further: as far
/// as the plan is large.
fn extent(plan: &Plan) -> Aabb<2> {
    let bounds = plan.bounds();
    if plan.n_groups() == 0 {
        return bounds;
    }
    let size: [f64; 2] = std::array::from_fn(|k| bounds.max[k] - bounds.min[k]);
    let size = size[0].max(size[1]);
    Aabb { min: bounds.min.map(|x| x - size), max: bounds.max.map(|x| x + size) }
}

fn portals(table: &Table, plan: &Plan, cells: &[Vec<Point2>], findings: &mut Findings) {
    let walls: Vec<[Point2; 2]> = plan.walls().map(|wall| [wall.a, wall.b]).collect();
    let boxes: Vec<Aabb<2>> = walls.iter().map(|w| Aabb::around(w.map(|p| [p.x, p.y]))).collect();
    let tree = BoxTree::build(&boxes, 4);
    for (portal, record) in table.portals().iter().enumerate() {
        let [left, right] = ends(record);
        for (cell, (from, to)) in record.cells.into_iter().zip([(right, left), (left, right)]) {
            if !on_border(&cells[cell.idx()], from, to) {
                findings.add(Violation::OffBorder { portal, cell });
            }
        }
        let around = Aabb::around([left, right].map(|p| [p.x, p.y]));
        let meets = |b: &Aabb<2>| (0..2).all(|k| b.min[k] <= around.max[k] && around.min[k] <= b.max[k]);
        let mut is_walled = false;
        tree.visit(meets, |w| is_walled |= walls_in(left, right, walls[w as usize]));
        findings.remarks.portals_in_walls += u64::from(is_walled);
    }
}

/// Whether `from` to `to` runs along a side of the polygon, with the polygon to the left. Exact.
fn on_border(polygon: &[Point2], from: Point2, to: Point2) -> bool {
    let on_line = || polygon.iter().filter(|&&c| orient2d(from, to, c) == 0.0);
    let reach = Aabb::around(on_line().map(|c| [c.x, c.y]));
    from != to
        && polygon.iter().all(|&c| orient2d(from, to, c) >= 0.0)
        && on_line().count() >= 2
        && [from, to].iter().all(|p| reach.contains([p.x, p.y]))
}

/// Whether a wall crosses an open portal properly, or runs along a part of it. Exact.
fn walls_in(left: Point2, right: Point2, [a, b]: [Point2; 2]) -> bool {
    let (sa, sb) = (orient2d(left, right, a), orient2d(left, right, b));
    if sa == 0.0 && sb == 0.0 {
        // On one line: do the open segments overlap?
        let k = usize::from((left.x - right.x).abs() < (left.y - right.y).abs());
        let along = |p: Point2| [p.x, p.y][k];
        let [lo, hi] = [along(left).min(along(right)), along(left).max(along(right))];
        return along(a).min(along(b)) < hi && lo < along(a).max(along(b));
    }
    let opposite = |s: f64, t: f64| (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0);
    opposite(sa, sb) && opposite(orient2d(a, b, left), orient2d(a, b, right))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_in_portals_are_reported() {
        let p = |x: f64, y: f64| Point2::new(x, y);
        let (left, right) = (p(0.0, 4.0), p(0.0, 0.0));
        for wall in [[p(-1.0, 2.0), p(1.0, 2.0)], [p(0.0, 3.0), p(0.0, 9.0)], [p(0.0, -1.0), p(0.0, 9.0)]] {
            assert!(walls_in(left, right, wall), "{wall:?}");
        }
        for wall in [[p(-1.0, 4.0), p(1.0, 4.0)], [p(0.0, 4.0), p(0.0, 9.0)], [p(1.0, 2.0), p(2.0, 2.0)]] {
            assert!(!walls_in(left, right, wall), "{wall:?}");
        }
    }
}
