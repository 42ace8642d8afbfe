//! Vectors of three doubles, rounded.

use sightlines_geometry::Point3;

pub(super) use sightlines_geometry::vector::{cross, dot, scale, sub, unit};

/// `a + by * b`.
pub(super) fn along(a: Point3, b: Point3, by: f64) -> Point3 {
    [a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2]]
}

/// The sum of magnitudes. Of three vectors, the product of these bounds the determinant.
pub(super) fn size(a: Point3) -> f64 {
    a[0].abs() + a[1].abs() + a[2].abs()
}
