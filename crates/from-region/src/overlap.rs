//! Whether a triangle meets a box, in doubles, erring towards "yes".
//!
//! Source: Akenine-Möller, "Fast 3D triangle-box overlap testing", Journal of Graphics Tools 6(1), 2001: two convex
//! bodies are apart if and only if an axis separates them, and thirteen axes are enough. Ours: the bounds on
//! rounding.

use sightlines_geometry::vector::sub;
use sightlines_geometry::{Aabb, Point3};

/// What a computed side may be off by, as a part of the sum of the magnitudes of its terms.
///
/// The longest chain of roundings is that of the plane: two differences of coordinates, their product, the
/// difference of two such products, the difference to the middle of the box, one more product, and two sums: 8 roundings on each term,
/// so each term is off by at most `(1 + u)^8 - 1 < 9 u`, `u = 2^-53`. The half sides of the box add the 3 of their
/// own. The magnitudes are summed with roundings too, 11 at most, which the rest of the 32 takes.
/// Nothing under- or overflows: terms are products of at most three differences of coordinates.
const SLACK: f64 = 32.0 * f64::EPSILON;

/// Whether a triangle, with or without area, may meet a closed box.
///
/// False only if the two have no point in common; where rounding leaves that open, true.
pub fn may_meet(triangle: &[Point3; 3], b: &Aabb<3>) -> bool {
    // Sides across the axes: comparisons, so without rounding.
    for k in 0..3 {
        let [p, q, r] = triangle.map(|p| p[k]);
        if p.min(q).min(r) > b.max[k] || p.max(q).max(r) < b.min[k] {
            return false;
        }
    }
    let middle: Point3 = std::array::from_fn(|k| b.min[k] / 2.0 + b.max[k] / 2.0);
    // No smaller than the larger of the two distances, wherever the middle was rounded to.
    let half: Point3 = std::array::from_fn(|k| (b.max[k] - middle[k]).max(middle[k] - b.min[k]));
    let corners = triangle.map(|p| sub(p, middle));
    let edges = [0, 1, 2].map(|i| sub(triangle[(i + 1) % 3], triangle[i]));
    for e in edges {
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let mut axis = [0.0; 3];
            (axis[i], axis[j]) = (e[j], -e[i]);
            if separates(axis, axis.map(f64::abs), &corners, half) {
                return false;
            }
        }
    }
    let (e, f) = (edges[0], edges[1]);
    let normal = std::array::from_fn(|k| e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3]);
    let sizes =
        std::array::from_fn(|k| (e[(k + 1) % 3] * f[(k + 2) % 3]).abs() + (e[(k + 2) % 3] * f[(k + 1) % 3]).abs());
    !separates(normal, sizes, &corners, half)
}

/// Whether all corners are certainly beyond the box around the origin along an axis.
///
/// * `sizes`: sums of the magnitudes of the terms that the axis was computed from
fn separates(axis: Point3, sizes: Point3, corners: &[Point3; 3], half: Point3) -> bool {
    let reach: f64 = (0..3).map(|k| axis[k].abs() * half[k]).sum();
    let sides = corners.map(|p| -> (f64, f64) {
        let side = (0..3).map(|k| axis[k] * p[k]).sum();
        let slack: f64 = (0..3).map(|k| sizes[k] * (p[k].abs() + half[k])).sum();
        (side, reach + SLACK * slack)
    });
    sides.iter().all(|(side, reach)| side > reach) || sides.iter().all(|(side, reach)| -side > *reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use proptest::prelude::*;

    /// The oracle: the triangle clipped by the sides of the box, in fractions.
    fn meets(triangle: &[Point3; 3], b: &Aabb<3>) -> bool {
        let r = |x: f64| BigRational::from_float(x).unwrap();
        let mut polygon: Vec<[BigRational; 3]> = triangle.iter().map(|p| p.map(r)).collect();
        for k in 0..3 {
            for (at, upper) in [(r(b.min[k]), false), (r(b.max[k]), true)] {
                let inside = |p: &[BigRational; 3]| if upper { p[k] <= at } else { p[k] >= at };
                let mut kept = Vec::new();
                for (i, p) in polygon.iter().enumerate() {
                    let q = &polygon[(i + 1) % polygon.len()];
                    if inside(p) {
                        kept.push(p.clone());
                    }
                    if inside(p) != inside(q) {
                        let t = (&at - &p[k]) / (&q[k] - &p[k]);
                        kept.push([0, 1, 2].map(|m| &p[m] + (&q[m] - &p[m]) * &t));
                    }
                }
                polygon = kept;
            }
        }
        !polygon.is_empty()
    }

    fn case() -> impl Strategy<Value = ([Point3; 3], Aabb<3>)> {
        let point = || prop::array::uniform3(-6i32..7);
        (prop::array::uniform3(point()), point(), prop::array::uniform3(0i32..4), -2i32..3, 0u32..3).prop_map(
            |(t, low, size, shift, scale)| {
                let unit = [1.0, 0.1, 1e-9][scale as usize];
                let far = [0.0, 1e3, 1e-9][scale as usize] * f64::from(shift);
                let at = |p: [i32; 3]| p.map(|x| f64::from(x) * unit + far);
                let high = std::array::from_fn(|k| low[k] + size[k]);
                (t.map(at), Aabb { min: at(low), max: at(high) })
            },
        )
    }

    proptest! {
        /// Invariant: what meets is never said to be apart.
        #[test]
        fn nothing_that_meets_is_missed((t, b) in case()) {
            prop_assert!(may_meet(&t, &b) || !meets(&t, &b), "{t:?} {b:?}");
        }
    }

    /// The twin: on whole numbers nothing is rounded but by the slack, so only what touches can be in doubt.
    #[test]
    fn what_is_apart_is_found_apart() {
        let cases = sightlines_testkit::draw(&case(), 3000);
        let apart: Vec<_> = cases.iter().filter(|(t, b)| !meets(t, b)).collect();
        let n_found = apart.iter().filter(|(t, b)| !may_meet(t, b)).count();
        assert!(apart.len() > 500 && n_found * 100 >= apart.len() * 99, "{n_found} of {}", apart.len());
        assert!(cases.len() - apart.len() > 100, "{} meet", cases.len() - apart.len());
    }
}
