//! Vectors in doubles.

use sightlines_geometry::Point3;

pub(crate) fn sub(a: Point3, b: Point3) -> Point3 {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn dot(a: Point3, b: Point3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Point3, b: Point3) -> Point3 {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// Area of a triangle, rounded.
pub(crate) fn area([a, b, c]: [Point3; 3]) -> f64 {
    let n = cross(sub(b, a), sub(c, a));
    dot(n, n).sqrt() / 2.0
}

/// The point with these weights of three corners, rounded.
pub(crate) fn weighted(corners: &[Point3; 3], weights: [f64; 3]) -> Point3 {
    std::array::from_fn(|k| (0..3).map(|i| weights[i] * corners[i][k]).sum())
}
