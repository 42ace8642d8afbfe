//! Convex polygons in the plane: cuts in doubles, and the exact test of the result.

use sightlines_geometry::{Point2, orient2d};

/// Twice the area, positive for counter-clockwise loops.
pub(super) fn twice_area(polygon: &[Point2]) -> f64 {
    let Some(&o) = polygon.first() else { return 0.0 };
    polygon.windows(2).map(|w| (w[0] - o).perp_dot(w[1] - o)).sum()
}

/// Replaces a convex `polygon` by its part to the left of the line from `p` to `q`, approximately. Coordinates on
/// axis-parallel lines do not change.
pub(super) fn cut(polygon: &mut Vec<Point2>, out: &mut Vec<Point2>, p: Point2, q: Point2) {
    out.clear();
    let d = q - p;
    let g = |x: Point2| d.perp_dot(x - p);
    let n = polygon.len();
    for i in 0..n {
        let (a, b) = (polygon[i], polygon[(i + 1) % n]);
        let (ga, gb) = (g(a), g(b));
        if ga >= 0.0 {
            out.push(a);
        }
        if (ga > 0.0 && gb < 0.0) || (ga < 0.0 && gb > 0.0) {
            let mut x = a + (b - a) * (ga / (ga - gb));
            // Where both lines are parallel to axes the crossing has a coordinate of each.
            if d.x == 0.0 {
                x.x = p.x;
            }
            if d.y == 0.0 {
                x.y = p.y;
            }
            out.push(x);
        }
    }
    std::mem::swap(polygon, out);
}

/// Area of the part of a loop from which all its edges are on the left: all of it where it is convex.
pub(super) fn kernel_area(outline: &[Point2], polygon: &mut Vec<Point2>, out: &mut Vec<Point2>) -> f64 {
    let (low, high) = outline.iter().fold((Point2::INFINITY, Point2::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    polygon.clear();
    polygon.extend([low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)]);
    for i in 0..outline.len() {
        cut(polygon, out, outline[i], outline[(i + 1) % outline.len()]);
        if polygon.len() < 3 {
            return 0.0;
        }
    }
    twice_area(polygon) / 2.0
}

/// Whether a loop of at least three corners turns left at each corner, and once around in all. Exact.
pub(super) fn is_strictly_convex(polygon: &[Point2]) -> bool {
    let n = polygon.len();
    let turns_left = |i: usize| orient2d(polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]) > 0.0;
    // Once around: every corner is to the left of the first edge's line, and of the other edges at its ends.
    n >= 3
        && (0..n).all(turns_left)
        && (0..n).all(|i| {
            (0..n).all(|k| k == i || k == (i + 1) % n || orient2d(polygon[i], polygon[(i + 1) % n], polygon[k]) > 0.0)
        })
}

/// Whether a segment certainly stays out of the interior of a strictly convex polygon. Exact: if the two are apart, one of
/// their lines is between them.
pub(super) fn stays_out(polygon: &[Point2], a: Point2, b: Point2) -> bool {
    let n = polygon.len();
    let beyond = |i: usize| {
        let (p, q) = (polygon[i], polygon[(i + 1) % n]);
        orient2d(p, q, a) <= 0.0 && orient2d(p, q, b) <= 0.0
    };
    let sides = || polygon.iter().map(|&p| orient2d(a, b, p));
    sides().all(|s| s >= 0.0) || sides().all(|s| s <= 0.0) || (0..n).any(beyond)
}

/// Whether a point is strictly to the left of all edges: in the interior, for a strictly convex polygon. Exact.
pub(super) fn is_inside(polygon: &[Point2], p: Point2) -> bool {
    (0..polygon.len()).all(|i| orient2d(polygon[i], polygon[(i + 1) % polygon.len()], p) > 0.0)
}
