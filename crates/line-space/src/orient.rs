//! The orientation predicate, with a short way for the edges that are most common: those along an axis.

use sightlines_geometry::{Point2, Point3, orient2d, orient3d};

/// `orient3d(a, b, c, d)`. Exact. Where two of the points are one, it is zero. Where `a` and `b`, or `c` and `d`, differ along one axis only, it
/// is a determinant of the plane, which is quicker where it is zero or nearly so.
pub(crate) fn orient(a: Point3, b: Point3, c: Point3, d: Point3) -> f64 {
    if d == a || d == b || d == c || c == a || c == b {
        return 0.0;
    }
    let flat = |p: Point3, u: usize| Point2::new(p[(u + 1) % 3], p[(u + 2) % 3]);
    // With b - a = l e, the determinant of b - a, c - a and d - a is l times the one of the other two without the axis e.
    if let Some(u) = axis_along(a, b) {
        let side = orient2d(flat(a, u), flat(c, u), flat(d, u));
        return if b[u] > a[u] { side } else { -side };
    }
    if let Some(u) = axis_along(c, d) {
        let side = orient2d(flat(a, u), flat(b, u), flat(c, u));
        return if d[u] > c[u] { side } else { -side };
    }
    orient3d(a, b, c, d)
}

/// The axis along which two points differ, if that is the only one.
fn axis_along(a: Point3, b: Point3) -> Option<usize> {
    match [a[0] != b[0], a[1] != b[1], a[2] != b[2]] {
        [true, false, false] => Some(0),
        [false, true, false] => Some(1),
        [false, false, true] => Some(2),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point3> {
        [-3i32..4, -3i32..4, -3i32..4].prop_map(|p| p.map(|x| f64::from(x) * 0.7))
    }

    proptest! {
        /// Invariant: the short way has the sign of the long one.
        #[test]
        fn both_ways_agree(a in point(), c in point(), k in 0usize..3, by in -3i32..4, b in point(), which in 0u8..4) {
            let moved = |p: Point3| { let mut p = p; p[k] += f64::from(by) * 0.3; p };
            let (b, d) = match which { 0 => (moved(a), b), 1 => (b, moved(c)), 2 => (c, b), _ => (b, moved(b)) };
            let sign = |x: f64| i32::from(x > 0.0) - i32::from(x < 0.0);
            prop_assert_eq!(sign(orient(a, b, c, d)), sign(orient3d(a, b, c, d)), "{:?} {:?} {:?} {:?}", a, b, c, d);
        }
    }
}
