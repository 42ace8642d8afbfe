//! Segments between two boxes: their positions, and what they cross.

use sightlines_geometry::{Aabb, Point3, check_coordinate, orient3d, ray_triangle};

/// Number of segments tried before a walk: if one passes freely, or meets other pieces than the others, nothing is hidden.
pub(super) const N_SEGMENTS: u32 = 8;

/// Segment `i` between two boxes, between inner points: spread by fractional parts of roots, so that few edges are hit.
pub(super) fn segment(v: &Aabb<3>, e: &Aabb<3>, i: u32) -> Option<[Point3; 2]> {
    // The fractional parts of the square roots of the first primes, and of multiples of them.
    const ROOTS: [f64; 6] = [0.414_213_562, 0.732_050_808, 0.236_067_977, 0.645_751_311, 0.316_624_790, 0.605_551_275];
    // The first one is near the middle.
    let part = |k: usize| if i == 0 { 0.45 + 0.1 * ROOTS[k] } else { 0.01 + 0.98 * (f64::from(i) * ROOTS[k]).fract() };
    Some([inner_point(v, [part(0), part(1), part(2)])?, inner_point(e, [part(3), part(4), part(5)])?])
}

/// A point of the relative interior; `None` if no double lies between two ends.
fn inner_point(b: &Aabb<3>, at: [f64; 3]) -> Option<Point3> {
    let p: Point3 = std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) * at[k]);
    let inside = |k: usize| b.min[k] < p[k] && p[k] < b.max[k] || b.min[k] == b.max[k] && p[k] == b.min[k];
    ((0..3).all(inside) && p.iter().all(|&x| check_coordinate(x).is_ok())).then_some(p)
}

/// Whether a segment crosses a triangle in its interior, from one side to the other; `None` if it touches an edge, ends
/// on the triangle's plane or lies in it. Exact.
pub(super) fn crosses(bounds: &Aabb<3>, [a, b, c]: [Point3; 3], &[p, q]: &[Point3; 2]) -> Option<bool> {
    if (0..3).any(|k| p[k].max(q[k]) < bounds.min[k] || p[k].min(q[k]) > bounds.max[k]) {
        return Some(false);
    }
    let sides = [orient3d(a, b, p, q), orient3d(b, c, p, q), orient3d(c, a, p, q)];
    let [any_positive, any_negative] = [sides.iter().any(|&s| s > 0.0), sides.iter().any(|&s| s < 0.0)];
    if any_positive && any_negative {
        return Some(false);
    }
    let ends = [orient3d(a, b, c, p), orient3d(a, b, c, q)];
    if sides.contains(&0.0) || ends.contains(&0.0) {
        return None;
    }
    Some((ends[0] > 0.0) != (ends[1] > 0.0))
}

/// The parameter at which the segment from `p` along `d` meets a triangle.
pub(super) fn meet(triangle: [Point3; 3], p: Point3, d: Point3) -> Option<f64> {
    const SLACK: f64 = 1e-9;
    let [x, y, t] = ray_triangle(&triangle, p, d);
    (x >= -SLACK && y >= -SLACK && x + y <= 1.0 + SLACK && (0.0..=1.0).contains(&t)).then_some(t)
}
