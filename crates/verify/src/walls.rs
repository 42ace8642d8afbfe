//! Are the walls of a table's cells walls of the scene? Exactly, and area by area.
//!
//! Proofs are about cells and portals. This module checks their relation to the scene: wherever the border of a cell is
//! no portal, sight has to end there, so opaque lines or triangles must cover it; then all lines from cell to cell pass
//! portals. Borders of the convex hull of all cells need no cover, because a line that leaves through it does not come
//! back; in space the box around all cells takes its place.
//!
//! A line or triangle covers a border if it lies on its line or plane, exactly. So borders along walls whose crossings had to be rounded are not
//! found to be covered, although they are. In a plan with joints a line covers what is within the gap, as openings up to that count as closed.

use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use sightlines_cells::{Plan, Scene};
use sightlines_geometry::{Point2, Point3, orient2d};
use sightlines_pvs::{CellId, Table};
use std::collections::BTreeMap;

/// What was found about the borders of cells.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct WallFindings {
    /// Parts of borders of cells that are not portals: the proofs rely on them as walls.
    pub n_walls: u64,
    /// Of `n_walls`, parts that nothing in the scene covers exactly.
    #[cfg_attr(feature = "serde", serde(rename = "n_bare_walls"))]
    pub n_bare: u64,
    /// Some of the bare parts: the cell, and a point with three coordinates.
    #[cfg_attr(feature = "serde", serde(rename = "bare_walls", serialize_with = "crate::as_json::places"))]
    #[cfg_attr(feature = "schemars", schemars(with = "Vec<(u32, [f64; 3])>"))]
    pub bare: Vec<(CellId, Point3)>,
}

impl WallFindings {
    /// Parts that are listed; beyond, they are counted.
    pub const MOST_LISTED: usize = 100;

    fn add(&mut self, cell: usize, bare: Option<Point3>) {
        self.n_walls += 1;
        if let Some(point) = bare {
            self.n_bare += 1;
            if self.bare.len() < Self::MOST_LISTED {
                self.bare.push((CellId(cell as u32), point));
            }
        }
    }
}

/// Checks that every wall of the cells of a table is covered by axis-parallel triangles of a scene that hide, from both sides together. Exact. Cost: for each wall what is on
/// its plane.
pub fn check_walls_in_space(table: &Table, scene: &Scene) -> WallFindings {
    // On each plane those that stop lines towards smaller coordinates, and those that stop lines towards larger ones.
    let mut on_plane: BTreeMap<(usize, u64), [Vec<[Point2; 3]>; 2]> = BTreeMap::new();
    let fronts = scene.front_occluding_triangles().map(|triangle| (triangle, true));
    for (triangle, is_one_sided) in scene.occluding_triangles().map(|triangle| (triangle, false)).chain(fronts) {
        for axis in 0..3 {
            let at = triangle[0][axis];
            let flat = triangle.map(|p| Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]));
            let turn = orient2d(flat[0], flat[1], flat[2]);
            if triangle.iter().all(|p| p[axis] == at) && turn != 0.0 {
                let stopping = on_plane.entry((axis, (at + 0.0).to_bits())).or_default();
                for (way, list) in stopping.iter_mut().enumerate() {
                    if !is_one_sided || (turn > 0.0) == (way == 0) {
                        list.push(flat);
                    }
                }
            }
        }
    }
    let (min, max) = around(table);
    let mut portals: Vec<Vec<[Point3; 2]>> = vec![Vec::new(); table.n_cells()];
    for portal in table.portals() {
        let corners = portal.points.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), p| {
            ([0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k])))
        });
        portal.cells.iter().for_each(|cell| portals[cell.idx()].push([corners.0, corners.1]));
    }
    let mut findings = WallFindings::default();
    for (cell, record) in table.cells().iter().enumerate() {
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            for (at, end) in [(record.min[axis], min[axis]), (record.max[axis], max[axis])] {
                if at == end {
                    continue;
                }
                let mut walls = vec![[record.min[u], record.min[v], record.max[u], record.max[v]]];
                for [low, high] in portals[cell].iter().filter(|[low, high]| low[axis] == at && high[axis] == at) {
                    let hole = [low[u], low[v], high[u], high[v]];
                    walls = walls.into_iter().flat_map(|wall| without(wall, hole)).collect();
                }
                let none = [Vec::new(), Vec::new()];
                let stopping = on_plane.get(&(axis, (at + 0.0).to_bits())).unwrap_or(&none);
                // Mostly nothing has one side.
                let n_ways = if stopping[0] == stopping[1] { 1 } else { 2 };
                for wall in walls {
                    let bare =
                        stopping[..n_ways].iter().find_map(|triangles| uncovered(wall, triangles)).map(|[x, y]| {
                            let mut point = [at; 3];
                            (point[u], point[v]) = (x, y);
                            point
                        });
                    findings.add(cell, bare);
                }
            }
        }
    }
    findings
}

/// The box around all cells.
fn around(table: &Table) -> (Point3, Point3) {
    table.cells().iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), cell| {
        ([0, 1, 2].map(|k| low[k].min(cell.min[k])), [0, 1, 2].map(|k| high[k].max(cell.max[k])))
    })
}

/// A rectangle without another, as at most four rectangles.
fn without([x0, y0, x1, y1]: [f64; 4], [hx0, hy0, hx1, hy1]: [f64; 4]) -> Vec<[f64; 4]> {
    if hx0 >= x1 || hx1 <= x0 || hy0 >= y1 || hy1 <= y0 {
        return vec![[x0, y0, x1, y1]];
    }
    let (low, high) = (hy0.max(y0), hy1.min(y1));
    let parts = [[x0, y0, x1, low], [x0, high, x1, y1], [x0, low, hx0.min(x1), high], [hx1.max(x0), low, x1, high]];
    parts.into_iter().filter(|p| p[0] < p[2] && p[1] < p[3]).collect()
}

type Exact = [BigRational; 2];

fn exact(x: f64, y: f64) -> Option<Exact> {
    Some([BigRational::from_float(x)?, BigRational::from_float(y)?])
}

/// A point of a rectangle that no closed triangle covers, in the middle of a part that is not covered, rounded; `None` if there is no such part.
pub(crate) fn uncovered([x0, y0, x1, y1]: [f64; 4], triangles: &[[Point2; 3]]) -> Option<[f64; 2]> {
    let corners: Option<Vec<Exact>> =
        [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| exact(x, y)).into_iter().collect();
    let mut pieces = vec![corners?];
    for triangle in triangles {
        let apart = |value: fn(&Point2) -> f64, low: f64, high: f64| {
            triangle.iter().all(|p| value(p) <= low) || triangle.iter().all(|p| value(p) >= high)
        };
        if apart(|p| p.x, x0, x1) || apart(|p| p.y, y0, y1) {
            continue;
        }
        let Some(mut corners) = triangle.iter().map(|p| exact(p.x, p.y)).collect::<Option<Vec<Exact>>>() else {
            continue;
        };
        if orient2d(triangle[0], triangle[1], triangle[2]) < 0.0 {
            corners.reverse();
        }
        pieces = pieces.into_iter().flat_map(|piece| outside(piece, &corners)).collect();
        if pieces.is_empty() {
            return None;
        }
    }
    let piece = pieces.first()?;
    let n = BigRational::from_integer(piece.len().into());
    let middle = |k: usize| piece.iter().map(|p| p[k].clone()).sum::<BigRational>() / &n;
    Some([middle(0).to_f64()?, middle(1).to_f64()?])
}

/// Twice the area of a triangle, positive if counter-clockwise.
fn turn(a: &Exact, b: &Exact, c: &Exact) -> BigRational {
    (&b[0] - &a[0]) * (&c[1] - &a[1]) - (&b[1] - &a[1]) * (&c[0] - &a[0])
}

/// The parts of a convex polygon outside of a counter-clockwise triangle.
fn outside(polygon: Vec<Exact>, triangle: &[Exact]) -> Vec<Vec<Exact>> {
    let (mut parts, mut rest) = (Vec::new(), polygon);
    for k in 0..3 {
        let (a, b) = (&triangle[k], &triangle[(k + 1) % 3]);
        let [left, right] = [1, -1].map(|sign| half(&rest, a, b, sign));
        parts.extend(Some(right).filter(|part| has_area(part)));
        rest = left;
        if !has_area(&rest) {
            return parts;
        }
    }
    parts
}

fn has_area(polygon: &[Exact]) -> bool {
    polygon.len() >= 3 && (1..polygon.len() - 1).any(|k| !turn(&polygon[0], &polygon[k], &polygon[k + 1]).is_zero())
}

/// The part of a convex polygon on one side of a line: the left for the sign 1.
fn half(polygon: &[Exact], a: &Exact, b: &Exact, sign: i32) -> Vec<Exact> {
    let n = polygon.len();
    let sides: Vec<BigRational> =
        polygon.iter().map(|p| turn(a, b, p)).map(|s| if sign < 0 { -s } else { s }).collect();
    let mut part = Vec::with_capacity(n + 1);
    for k in 0..n {
        let (p, q, s, t) = (&polygon[k], &polygon[(k + 1) % n], &sides[k], &sides[(k + 1) % n]);
        if !s.is_negative() {
            part.push(p.clone());
        }
        if (s.is_positive() && t.is_negative()) || (s.is_negative() && t.is_positive()) {
            let share = s / (s - t);
            part.push([0, 1].map(|i| &p[i] + &share * (&q[i] - &p[i])));
        }
    }
    part
}

/// Checks that every wall of the cells of a table is covered by opaque lines of a plan. Exact, but for a plan with a [gap](Plan::gap): there what is
/// within the gap of a wall or a joint counts as covered.
///
/// Cost: O(sides of cells * lines) comparisons of boxes.
pub fn check_walls_of_plan(table: &Table, plan: &Plan) -> WallFindings {
    let hull = hull(table);
    let mut portals: Vec<Vec<[Point2; 2]>> = vec![Vec::new(); table.n_cells()];
    for portal in table.portals() {
        if let [[x0, y0, _], [x1, y1, _]] = portal.points[..] {
            let ends = [Point2::new(x0, y0), Point2::new(x1, y1)];
            portal.cells.iter().for_each(|cell| portals[cell.idx()].push(ends));
        }
    }
    let lines: Vec<[Point2; 2]> = plan.walls().map(|wall| [wall.a, wall.b]).collect();
    let mut findings = WallFindings::default();
    for (cell, record) in table.cells().iter().enumerate() {
        let corners: Vec<Point2> = record.polygon.iter().map(|&[x, y]| Point2::new(x, y)).collect();
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            // Along the coordinate that changes more; along one line the order of points is that of either.
            let along = |p: Point2| if (b.x - a.x).abs() >= (b.y - a.y).abs() { p.x } else { p.y };
            let (low, high) = (along(a).min(along(b)), along(a).max(along(b)));
            let is_on = |[p, q]: &[Point2; 2], gap: f64| match gap > 0.0 {
                false => [p, q].iter().all(|&&p| orient2d(a, b, p) == 0.0),
                true => [a, b].iter().all(|&end| orient2d(*p, *q, end).abs() <= gap * p.distance(*q)),
            };
            let cover = |ends: &[Point2; 2], gap: f64| {
                let [p, q] = ends.map(along);
                let range = [p.min(q) - gap, p.max(q) + gap];
                (range[0] < high && range[1] > low && is_on(ends, gap)).then_some(range)
            };
            let portals = portals[cell].iter().filter_map(|ends| cover(ends, 0.0));
            let mut covers: Vec<[f64; 2]> =
                portals.chain(lines.iter().filter_map(|ends| cover(ends, plan.gap()))).collect();
            covers.sort_by(|x, y| x[0].total_cmp(&y[0]));
            let reach = covers.iter().fold(low, |reach, c| if c[0] <= reach { reach.max(c[1]) } else { reach });
            let is_outer = || hull.iter().all(|&p| orient2d(a, b, p) >= 0.0);
            let bare = (reach < high && !is_outer()).then(|| {
                let share = if high > low { (reach - low) / (high - low) } else { 0.0 };
                let (first, last) = if along(a) <= along(b) { (a, b) } else { (b, a) };
                let p = first + (last - first) * share;
                [p.x, p.y, 0.0]
            });
            findings.add(cell, bare);
        }
    }
    findings
}

/// The corners of the convex hull of all cells of a plan, counter-clockwise: Andrew's monotone chain.
fn hull(table: &Table) -> Vec<Point2> {
    let mut points: Vec<Point2> =
        table.cells().iter().flat_map(|cell| &cell.polygon).map(|&[x, y]| Point2::new(x, y)).collect();
    points.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = Point2>| {
        let mut chain: Vec<Point2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..] {
                if orient2d(a, b, p) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain
    };
    let mut corners = half(&mut points.iter().copied());
    corners.extend(half(&mut points.iter().rev().copied()));
    corners.dedup();
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn half_square(x: f64, y: f64, upper: bool) -> [Point2; 3] {
        let p = |dx: f64, dy: f64| Point2::new(x + dx, y + dy);
        if upper { [p(0., 1.), p(0., 0.), p(1., 1.)] } else { [p(0., 0.), p(1., 0.), p(1., 1.)] }
    }

    proptest! {
        /// Against counting: a rectangle of squares is covered if each square has both its halves.
        #[test]
        fn rectangles_are_covered_by_all_their_parts(
            missing in prop::collection::vec(any::<bool>(), 18),
            few in 0usize..20,
        ) {
            let mut triangles = Vec::new();
            for (k, &is_missing) in missing.iter().enumerate() {
                let (x, y) = ((k / 2 % 3) as f64, (k / 6) as f64);
                if !(is_missing && k < few) {
                    let [a, b, c] = half_square(x, y, k.is_multiple_of(2));
                    // Either way round.
                    triangles.push(if k.is_multiple_of(3) { [a, b, c] } else { [a, c, b] });
                }
            }
            let found = uncovered([0., 0., 3., 3.], &triangles);
            prop_assert_eq!(found.is_none(), triangles.len() == 18, "{:?}", found);
            if let Some([x, y]) = found {
                let p = Point2::new(x, y);
                let inside = |t: &[Point2; 3]| {
                    let sides = [0, 1, 2].map(|k| orient2d(t[k], t[(k + 1) % 3], p));
                    sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
                };
                prop_assert!(!triangles.iter().any(inside));
            }
        }
    }

    #[test]
    fn rectangles_lose_holes() {
        assert_eq!(without([0., 0., 3., 3.], [1., 1., 2., 2.]).len(), 4);
        assert_eq!(without([0., 0., 3., 3.], [3., 0., 4., 3.]), [[0., 0., 3., 3.]]);
        assert!(without([0., 0., 3., 3.], [0., -1., 3., 4.]).is_empty());
        let area = |r: &[f64; 4]| (r[2] - r[0]) * (r[3] - r[1]);
        assert_eq!(without([0., 0., 3., 3.], [1., -1., 2., 2.]).iter().map(area).sum::<f64>(), 7.0);
    }
}
