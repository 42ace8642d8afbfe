//! Measures and points of triangles.

use sightlines_geometry::Point3;
use sightlines_geometry::vector::{length, normal};

/// Area of a triangle, rounded.
pub(crate) fn area(triangle: [Point3; 3]) -> f64 {
    length(normal(triangle)) / 2.0
}

/// The point with these weights of three corners, rounded.
pub(crate) fn weighted(corners: &[Point3; 3], weights: [f64; 3]) -> Point3 {
    std::array::from_fn(|k| (0..3).map(|i| weights[i] * corners[i][k]).sum())
}
