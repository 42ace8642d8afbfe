//! Points of space as plain arrays.

pub(super) use sightlines_geometry::Point3;
pub(super) use sightlines_geometry::vector::{add, cross, dot, scale, sub};

/// The vector of length 1 in the direction of `a`; not a number for zero.
#[inline]
pub(super) fn unit(a: Point3) -> Point3 {
    scale(a, 1.0 / dot(a, a).sqrt())
}
