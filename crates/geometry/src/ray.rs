//! Where a ray meets a triangle or a box, in plain doubles: for estimates, never for decisions.
//!
//! Callers choose how to treat edges: these functions return parameters and clip nothing. Code that checks results, and the exact
//! ray caster of `sightlines-visible-surface`, have their own tests on purpose.

use crate::vector::{cross, dot, sub};
use crate::{Aabb, Point3};

/// Where the line `origin + t direction` meets the plane of a triangle: `[x, y, t]` with the point
/// `a + x (b - a) + y (c - a)`, so it lies in the triangle if x and y are at least 0 and their sum is at most 1. Rounded.
///
/// Infinite or NaN for a line parallel to the plane and for a triangle without area: every comparison with NaN is false.
///
/// # Source
/// Möller and Trumbore, "Fast, minimum storage ray/triangle intersection", Journal of Graphics Tools 2(1), 1997.
#[inline]
pub fn ray_triangle([a, b, c]: &[Point3; 3], origin: Point3, direction: Point3) -> [f64; 3] {
    let (u, v, to) = (sub(*b, *a), sub(*c, *a), sub(origin, *a));
    let p = cross(direction, v);
    let determinant = dot(u, p);
    let q = cross(to, u);
    [dot(to, p), dot(direction, q), dot(v, q)].map(|x| x / determinant)
}

/// Between which `[first, last]` multiples of its direction the line from `origin` is in a box; empty, with
/// `first > last`, if it misses. Rounded.
///
/// * `inverse`: the reciprocals of the direction. Along an axis without motion that is infinite: an origin between the box's
///   two sides is inside, and one exactly on a side misses. An axis whose reciprocal is given as NaN is left out.
///
/// # Source
/// Kay and Kajiya, "Ray tracing complex scenes", SIGGRAPH 1986: a box as the intersection of slabs.
#[inline]
pub fn ray_box<const D: usize>(bounds: &Aabb<D>, origin: [f64; D], inverse: [f64; D]) -> [f64; 2] {
    let (mut first, mut last) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..D {
        let (s, t) = ((bounds.min[k] - origin[k]) * inverse[k], (bounds.max[k] - origin[k]) * inverse[k]);
        // `min` and `max` pass over NaN.
        first = first.max(s.min(t));
        last = last.min(s.max(t));
    }
    [first, last]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;

    const TRIANGLE: [Point3; 3] = [[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [0.0, 8.0, 2.0]];

    #[test]
    fn weights_name_the_point_that_is_met() {
        let mut random = Random::new(1);
        for _ in 0..1000 {
            // Small whole numbers: the answer is known before.
            let [x, y] = [0; 2].map(|_| random.below(9) as f64 / 8.0);
            let point = [4.0 * x, 8.0 * y, 2.0];
            let origin = [0; 3].map(|_| random.below(5) as f64 - 7.0);
            let t = [1.0, 2.0, 4.0][random.below(3)];
            let direction = [0, 1, 2].map(|k| (point[k] - origin[k]) / t);
            assert_eq!(ray_triangle(&TRIANGLE, origin, direction), [x, y, t]);
        }
        let parallel = ray_triangle(&TRIANGLE, [1.0, 1.0, 2.0], [1.0, 0.0, 0.0]);
        assert!(parallel.iter().all(|x| x.is_nan()), "{parallel:?}");
    }

    /// Against points of the line: those within the stretch are in the box, those outside of it are not.
    #[test]
    fn stretches_in_boxes_are_those_of_their_points() {
        let (mut random, mut counts) = (Random::new(2), [0, 0]);
        for _ in 0..10_000 {
            let low = [0; 3].map(|_| random.below(8) as f64);
            let bounds = Aabb { min: low, max: low.map(|x| x + 1.0 + random.below(4) as f64) };
            let origin = [0; 3].map(|_| random.below(12) as f64 + 0.5);
            // Towards a place in the box or near it.
            let direction = [0, 1, 2].map(|k| (low[k] + random.below(5) as f64 - 0.5 - origin[k]) / 4.0);
            let [first, last] = ray_box(&bounds, origin, direction.map(|x| 1.0 / x));
            for i in -64..=64 {
                let t = f64::from(i) / 16.0 + 0.003;
                let inside = bounds.contains([0, 1, 2].map(|k| origin[k] + t * direction[k]));
                assert_eq!(inside, first <= t && t <= last, "{bounds:?} {origin:?} {direction:?} {t}");
                counts[usize::from(inside)] += 1;
            }
        }
        assert!(counts.iter().all(|&n| n > 5000), "{counts:?}");
    }

    #[test]
    fn an_axis_without_motion_counts_as_it_is_given() {
        let bounds = Aabb { min: [0.0, 0.0], max: [1.0, 1.0] };
        let on_side = [0.0, -1.0];
        let [first, last] = ray_box(&bounds, on_side, [f64::INFINITY, 1.0]);
        assert!(first > last || first == f64::INFINITY, "{first} {last}");
        assert_eq!(ray_box(&bounds, on_side, [f64::NAN, 1.0]), [1.0, 2.0]);
        assert_eq!(ray_box(&bounds, [0.5, -1.0], [f64::INFINITY, 1.0]), [1.0, 2.0]);
    }
}
