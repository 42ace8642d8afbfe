//! Vectors in plain doubles.

use sightlines_geometry::Point3;

pub(crate) use sightlines_geometry::vector::{cross, dot, sub};

/// The cross product of the magnitudes, with sums in the place of differences: what the rounding of [`cross`] is measured by.
pub(crate) fn cross_size(a: Point3, b: Point3) -> Point3 {
    let [a, b] = [a.map(f64::abs), b.map(f64::abs)];
    [a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]]
}

/// The scalar product of the magnitudes.
pub(crate) fn dot_size(a: Point3, b: Point3) -> f64 {
    (a[0] * b[0]).abs() + (a[1] * b[1]).abs() + (a[2] * b[2]).abs()
}
