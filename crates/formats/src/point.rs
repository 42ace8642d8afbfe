//! Points of files in space, as predicates take them.

use crate::error::Malformed;
use sightlines_cells::Point3;
use sightlines_geometry::coordinate::MIN_MAGNITUDE;
use sightlines_geometry::{Point2, check_coordinate, orient2d};

/// Whether three points lie on one line, exactly: they do in all three projections.
pub(crate) fn are_collinear([a, b, c]: [Point3; 3]) -> bool {
    let flat = |u: usize, v: usize| {
        let [a, b, c] = [a, b, c].map(|p| Point2::new(p[u], p[v]));
        orient2d(a, b, c) == 0.0
    };
    flat(0, 1) && flat(1, 2) && flat(2, 0)
}

/// A point with accepted coordinates. What is nearer to zero than a coordinate may be becomes zero: such numbers are
/// what rounding leaves of zeros, when a file was written or where transforms are composed.
pub(crate) fn check_point(p: Point3) -> Result<Point3, Malformed> {
    let [x, y, z] = p.map(|x| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x });
    Ok([check_coordinate(x)?, check_coordinate(y)?, check_coordinate(z)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collinear_is_exact() {
        let line = |t: f64| [1.0 + t, 2.0 - 3.0 * t, 0.5 * t];
        assert!(are_collinear([line(0.0), line(1.0), line(-7.0)]));
        assert!(are_collinear([line(0.0), line(0.0), [9.0, 8.0, 7.0]]));
        // One unit in the last place off a line along an axis, at any distance.
        let off = 1e7_f64.next_up();
        assert!(!are_collinear([[0.0, 1e7, 1e7], [1.0, 1e7, 1e7], [2.0, 1e7, off]]));
        assert!(!are_collinear([[1e7, 0.0, 0.0], [1e7, 0.0, 5.0], [off, 0.0, 9.0]]));
    }

    #[test]
    fn coordinates_are_checked() {
        assert_eq!(check_point([1.0, -1e-45, -0.0]).unwrap().map(f64::to_bits), [1.0, 0.0, 0.0].map(f64::to_bits));
        assert!(check_point([1.0, f64::NAN, 0.0]).is_err() && check_point([1e300, 0.0, 0.0]).is_err());
    }
}
