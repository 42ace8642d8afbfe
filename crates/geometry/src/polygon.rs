//! Convex polygons of the plane, as slices of corners in counter-clockwise order.

use crate::{Point2, orient2d};

/// Consecutive corner pairs, the last with the first.
fn sides(polygon: &[Point2]) -> impl Iterator<Item = (Point2, Point2)> + '_ {
    let n = polygon.len();
    (0..n).map(move |i| (polygon[i], polygon[(i + 1) % n]))
}

/// Whether the corners go round a convex polygon once, counter-clockwise; straight angles are
/// allowed, spikes and repeated corners are not. Exact, O(n).
pub fn is_convex_ccw(polygon: &[Point2]) -> bool {
    let n = polygon.len();
    if n < 3 {
        return false;
    }
    let mut turned = false;
    for i in 0..n {
        let (a, b, c) = (polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]);
        let turn = orient2d(a, b, c);
        let backwards = turn == 0.0 && !crate::along(a, b, c);
        if a == b || turn < 0.0 || backwards || (turn == 0.0 && b == c) {
            return false;
        }
        turned |= turn > 0.0;
    }
    // Left turns only: once round if and only if the direction passes "due east to not east" once.
    let descents = (0..n)
        .filter(|&i| {
            let (a, b, c) = (polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]);
            (b.y < a.y || (b.y == a.y && b.x < a.x)) && !(c.y < b.y || (c.y == b.y && c.x < b.x))
        })
        .count();
    turned && descents == 1
}

/// Whether `p` is inside the convex polygon or on its boundary. Exact, O(n).
pub fn polygon_contains(polygon: &[Point2], p: Point2) -> bool {
    sides(polygon).all(|(a, b)| orient2d(a, b, p) >= 0.0)
}

/// Area in square scene units, positive for counter-clockwise corners; rounded.
pub fn signed_area(polygon: &[Point2]) -> f64 {
    let Some(&origin) = polygon.first() else { return 0.0 };
    0.5 * sides(polygon).map(|(a, b)| (a - origin).perp_dot(b - origin)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(corners: &[(f64, f64)]) -> Vec<Point2> {
        corners.iter().map(|&(x, y)| Point2::new(x, y)).collect()
    }

    #[test]
    fn convexity_is_decided() {
        assert!(is_convex_ccw(&p(&[(0., 0.), (2., 0.), (2., 2.), (0., 2.)])));
        assert!(is_convex_ccw(&p(&[(0., 0.), (1., 0.), (2., 0.), (2., 2.)])));
        assert!(!is_convex_ccw(&p(&[(0., 0.), (0., 2.), (2., 2.), (2., 0.)])), "clockwise");
        assert!(!is_convex_ccw(&p(&[(0., 0.), (2., 0.), (1., 0.), (2., 2.)])), "spike");
        assert!(!is_convex_ccw(&p(&[(0., 0.), (2., 0.), (0.5, 0.5), (0., 2.)])), "dent");
        assert!(!is_convex_ccw(&p(&[(0., 0.), (1., 0.), (2., 0.)])), "flat");
        // A pentagram turns left at each corner, and goes round twice.
        assert!(!is_convex_ccw(&p(&[(0., 0.), (4., 0.), (1., 3.), (2., -2.), (3., 3.)])));
    }

    #[test]
    fn containment_and_area() {
        let square = p(&[(0., 0.), (2., 0.), (2., 2.), (0., 2.)]);
        assert!(polygon_contains(&square, Point2::new(2.0, 1.0)));
        assert!(!polygon_contains(&square, Point2::new(2.0, 2.1)));
        assert_eq!(signed_area(&square), 4.0);
    }
}
