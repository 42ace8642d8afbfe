//! Points of space as plain arrays.

pub(super) use sightlines_geometry::Point3;
use sightlines_geometry::vector as geometry;
pub(super) use sightlines_geometry::vector::{add, cross, dot, scale, sub};

/// The vector of length 1 in the direction of `a`; NaN if there is none, with which every comparison is false.
#[inline]
pub(super) fn unit(a: Point3) -> Point3 {
    geometry::unit(a).unwrap_or([f64::NAN; 3])
}
