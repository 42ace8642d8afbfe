//! Vectors in plain doubles, for what promises nothing by itself.

use sightlines_geometry::Point3;

pub(crate) fn minus(p: Point3, q: Point3) -> Point3 {
    [0, 1, 2].map(|k| p[k] - q[k])
}

pub(crate) fn dot(p: Point3, q: Point3) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

pub(crate) fn cross(u: Point3, v: Point3) -> Point3 {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

pub(crate) fn length(v: Point3) -> f64 {
    dot(v, v).sqrt()
}

/// A normal of a triangle, twice its area long.
pub(crate) fn normal(&[a, b, c]: &[Point3; 3]) -> Point3 {
    cross(minus(b, a), minus(c, a))
}
