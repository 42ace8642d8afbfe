//! The orientation predicate, with a short way for the edges that are most common: those along an axis.

use sightlines_geometry::vector::{cross, dot, sub};
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

/// Rounding of `det` of three differences, as a share of the sum of magnitudes of its products.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// `orient3d(a, b, c, d)` in doubles, and how far it may be from that of every point within `radius` of `d`.
pub(crate) fn height([a, b, c]: [Point3; 3], d: Point3, radius: Point3) -> [f64; 2] {
    let (u, v, w) = (sub(b, a), sub(c, a), sub(d, a));
    let normal = cross(u, v);
    let part = |i: usize, j: usize| (u[i] * v[j]).abs() + (u[j] * v[i]).abs();
    let weight = [part(1, 2), part(2, 0), part(0, 1)];
    let bound = (0..3).map(|k| ROUNDING * weight[k] * w[k].abs()).sum::<f64>();
    let slack = (0..3).map(|k| 1.01 * (normal[k].abs() + ROUNDING * weight[k]) * radius[k]).sum::<f64>();
    [dot(normal, w), bound + slack]
}

/// The sign of `orient3d(a, b, c, d)` for every `d` within `radius`; 0 if it is not the same for all, or zero.
pub(crate) fn sign(a: Point3, b: Point3, c: Point3, d: Point3, radius: Point3) -> i8 {
    let [value, error] = height([a, b, c], d, radius);
    if value.abs() > error {
        return if value > 0.0 { 1 } else { -1 };
    }
    if radius != [0.0; 3] {
        return 0;
    }
    let exact = orient(a, b, c, d);
    i8::from(exact > 0.0) - i8::from(exact < 0.0)
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
