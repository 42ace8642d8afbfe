//! Vectors of space in plain doubles: each result is rounded as its expression says, from left to right, and the same on every machine.
//!
//! For constructions and estimates. What is decided is decided by predicates ([`orient3d`](crate::orient3d) and the like).

use crate::Point3;

/// `a + b`.
#[inline]
pub fn add(a: Point3, b: Point3) -> Point3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
#[inline]
pub fn sub(a: Point3, b: Point3) -> Point3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a` times a number.
#[inline]
pub fn scale(a: Point3, by: f64) -> Point3 {
    [a[0] * by, a[1] * by, a[2] * by]
}

/// The scalar product.
#[inline]
pub fn dot(a: Point3, b: Point3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product, by the right-hand rule.
#[inline]
pub fn cross(a: Point3, b: Point3) -> Point3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length.
#[inline]
pub fn length(a: Point3) -> f64 {
    dot(a, a).sqrt()
}

/// The vector of length 1 in the direction of `a`; `None` if its length is 0, infinite or NaN.
///
/// Squares of components must not leave the range of doubles; [`unit_of_any_size`] has no such limit.
#[inline]
pub fn unit(a: Point3) -> Option<Point3> {
    let length = length(a);
    (length > 0.0 && length.is_finite()).then(|| scale(a, 1.0 / length))
}

/// The vector of length 1 in the direction of `a`, without overflow or underflow; `None` if all components are 0 or one is not
/// finite. Rounded differently from [`unit()`], and slower.
pub fn unit_of_any_size(a: Point3) -> Option<Point3> {
    let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    // `max` passes over NaN.
    if largest == 0.0 || !a.iter().all(|x| x.is_finite()) {
        return None;
    }
    let scaled = a.map(|x| x / largest);
    let length = length(scaled);
    Some(scaled.map(|x| x / length))
}

/// The normal of a triangle by the right-hand rule, twice its area long.
#[inline]
pub fn normal([a, b, c]: [Point3; 3]) -> Point3 {
    cross(sub(b, a), sub(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_are_right_handed() {
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!([cross(x, y), cross(y, z), cross(z, x)], [z, x, y]);
        assert_eq!(normal([x, y, z]), [1.0; 3]);
        assert_eq!(unit([0.0, 0.0, -3.0]), Some([0.0, 0.0, -1.0]));
        assert_eq!(unit_of_any_size([0.0, 1e-300, 0.0]), Some(y));
        let bad = [[0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]];
        assert!(bad.iter().all(|&v| unit(v).is_none() && unit_of_any_size(v).is_none()));
        assert_eq!((dot(add(x, scale(y, 3.0)), sub(y, z)), length([2.0, 3.0, 6.0])), (3.0, 7.0));
    }
}
