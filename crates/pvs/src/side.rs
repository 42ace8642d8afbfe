//! Is a point in a convex polygon? Decided in plain doubles with an error bound.
//!
//! This crate ships with games and contains no exact arithmetic. It needs none: where the bound leaves open on which
//! side of a line a point lies, the point counts as inside. So a point that is inside or on the boundary is always
//! found there, and a point outside, but within rounding of the boundary, may be found there too: answers can only gain
//! cells by it.

/// Whether `c` is certainly to the right of the directed line from `a` to `b`.
///
/// Errs towards `false`. Holds for all doubles: overflow makes the bound infinite or the comparison one with NaN, and
/// both give `false`.
///
/// Source: Shewchuk 1997, bound A: the rounding error of the determinant is below
/// (3 + 16 u) u (|left| + |right|) with u = 2^-53, as long as nothing underflows. Subtractions never
/// underflow inexactly; each of the three products (one of them in the bound itself) may lose 2^-1075,
/// which the smallest normal number, 2^-1022, outweighs.
#[inline]
pub(crate) fn certainly_right(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> bool {
    const RELATIVE: f64 = (3.0 + 8.0 * f64::EPSILON) * (0.5 * f64::EPSILON);
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let bound = RELATIVE * (left.abs() + right.abs()) + f64::MIN_POSITIVE;
    left - right < -bound
}

/// Whether `p` may be in the closed convex polygon with these counter-clockwise corners; `true` if there are none.
///
/// Errs towards `true`, near the lines through the sides only. O(corners).
#[inline]
pub fn polygon_may_contain(corners: impl IntoIterator<Item = [f64; 2]>, p: [f64; 2]) -> bool {
    let mut ends: Option<([f64; 2], [f64; 2])> = None;
    for corner in corners {
        if ends.is_some_and(|(_, last)| certainly_right(last, corner, p)) {
            return false;
        }
        ends = Some((ends.map_or(corner, |(first, _)| first), corner));
    }
    !ends.is_some_and(|(first, last)| certainly_right(last, first, p))
}

/// Whether the closed box from `min` to `max` may touch the closed convex polygon with these counter-clockwise corners,
/// judging by the lines through the polygon's sides; `true` if there are none. Together with the polygon's own box
/// these lines decide completely.
///
/// Errs towards `true`, near those lines only. O(corners).
#[inline]
pub(crate) fn polygon_may_touch_box(polygon: &[[f64; 2]], min: [f64; 2], max: [f64; 2]) -> bool {
    !sides(polygon).any(|(a, b)| {
        // The corner of the box that is farthest to the left of the side; chosen without rounding.
        let x = if b[1] >= a[1] { min[0] } else { max[0] };
        let y = if b[0] >= a[0] { max[1] } else { min[1] };
        certainly_right(a, b, [x, y])
    })
}

/// The first corner at which the polygon certainly is not convex and counter-clockwise, if any.
///
/// Finds right turns beyond rounding, and polygons that do not wind exactly once, by comparing coordinates. Every
/// exactly convex polygon passes, with repeated corners or not.
pub(crate) fn first_defect(polygon: &[[f64; 2]]) -> Option<usize> {
    let n = polygon.len();
    let corner = |i: usize| polygon[i % n];
    if let Some(i) = (0..n).find(|&i| certainly_right(corner(i), corner(i + 1), corner(i + 2))) {
        return Some((i + 1) % n);
    }
    // With left turns only, each winding passes once from going down to not going down.
    let down: Vec<bool> =
        sides(polygon).filter(|(a, b)| a != b).map(|(a, b)| b[1] < a[1] || (b[1] == a[1] && b[0] < a[0])).collect();
    let rounds = (0..down.len()).filter(|&i| down[i] && !down[(i + 1) % down.len()]).count();
    (n > 0 && rounds != 1).then_some(0)
}

/// Consecutive corner pairs, the last with the first.
fn sides(polygon: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The oracle: the determinant of integers up to 2^60, without rounding.
    fn exact(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i128 {
        let d = |p: i64, q: i64| i128::from(p) - i128::from(q);
        d(a[0], c[0]) * d(b[1], c[1]) - d(a[1], c[1]) * d(b[0], c[0])
    }

    fn float(p: [i64; 2]) -> [f64; 2] {
        p.map(|x| x as f64)
    }

    fn small() -> impl Strategy<Value = [i64; 2]> {
        [-4i64..5, -4i64..5]
    }

    /// The nearest integer that is a double.
    fn rounded(x: i64) -> i64 {
        x as f64 as i64
    }

    /// The points `a + v`, `a + v t`, moved by `nudge` and rounded to doubles, after `a`: nearly collinear.
    fn in_line(a: [i64; 2], v: [i64; 2], t: i64, nudge: [i64; 2]) -> [[i64; 2]; 3] {
        let at = |t: i64, k: usize| rounded(a[k] + v[k] * t);
        [a, [at(1, 0), at(1, 1)], [rounded(at(t, 0) + nudge[0]), rounded(at(t, 1) + nudge[1])]]
    }

    fn nearly_collinear() -> impl Strategy<Value = [[i64; 2]; 3]> {
        let start = -1000i64..1000;
        let large = -(1i64 << 50)..(1i64 << 50);
        ([start.clone(), start], [large.clone(), large], -500i64..500, [-200i64..300, -200i64..300], 0u32..40)
            .prop_map(|(a, v, t, nudge, scale)| in_line(a, v, t, nudge.map(|x| x << scale)))
    }

    proptest! {
        /// Invariant: what counts as right is right; on a small grid, the converse holds as well.
        #[test]
        fn sides_small_grid_is_exact(a in small(), b in small(), c in small(), k in 0u32..20) {
            let [p, q, r] = [a, b, c].map(|p| float(p.map(|x| x << k)));
            prop_assert_eq!(certainly_right(p, q, r), exact(a, b, c) < 0);
        }

        #[test]
        fn sides_soundness_certain_is_true([a, b, c] in nearly_collinear()) {
            if certainly_right(float(a), float(b), float(c)) {
                prop_assert!(exact(a, b, c) < 0, "{:?} {:?} {:?}", a, b, c);
            }
        }

        /// The tightness twin: only cases within rounding are left undecided.
        #[test]
        fn sides_tightness_clear_is_certain([a, b, c] in nearly_collinear()) {
            let d = |p: i64, q: i64| i128::from(p) - i128::from(q);
            let size = (d(a[0], c[0]) * d(b[1], c[1])).abs() + (d(a[1], c[1]) * d(b[0], c[0])).abs();
            if exact(a, b, c) < -(size >> 49) {
                prop_assert!(certainly_right(float(a), float(b), float(c)), "{:?} {:?} {:?}", a, b, c);
            }
        }

        #[test]
        fn sides_extreme_numbers_are_not_certain_by_mistake(a in small(), b in small(), c in small(), e in -1074i32..1024) {
            // Scaling by a power of two is exact here, unless it over- or underflows.
            let scale = if e < -1022 { f64::from_bits(1 << (e + 1074)) } else { f64::from_bits(((e + 1023) as u64) << 52) };
            let [p, q, r] = [a, b, c].map(|p| float(p).map(|x| x * scale));
            if [p, q, r].iter().flatten().all(|x| x.is_finite()) && certainly_right(p, q, r) {
                prop_assert!(exact(a, b, c) < 0);
            }
        }
    }

    /// The impostor: without the bound, the plain formula reports points to the right of a line that are not.
    #[test]
    fn sides_plain_doubles_are_not_sound() {
        let plain =
            |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0]) < 0.0;
        let v = [(1 << 50) - 12_345, (1 << 49) + 6_789];
        let wrong = (-500..500).filter(|&t| {
            let [a, b, c] = in_line([7, 300], v, t, [0, 0]);
            plain(float(a), float(b), float(c)) && exact(a, b, c) >= 0
        });
        assert!(wrong.count() > 0);
    }

    /// The other impostor: without the bound's constant term, underflow decides. The exact determinant is
    /// (0.7 + 6e-19) 5 - (0.5 - 1e-17) 7 > 0 smallest doubles, but the products round to 3 and 4 of them.
    #[test]
    fn sides_underflow_is_not_certain() {
        let (a, b, c) = ([0.7, 7.0 * 5e-324], [0.5 - 4.5e-17, 5.0 * 5e-324], [-4.5e-17, 0.0]);
        let (left, right) = ((a[0] - c[0]) * (b[1] - c[1]), (a[1] - c[1]) * (b[0] - c[0]));
        assert_eq!((left, right), (3.0 * 5e-324, 4.0 * 5e-324));
        assert!(!certainly_right(a, b, c));
    }

    proptest! {
        /// Invariant: a box touches a triangle if no axis and no side separates the two, in integers.
        #[test]
        fn sides_boxes_touch_as_in_whole_numbers(t in [small(), small(), small()], min in small(), size in [0i64..4, 0i64..4]) {
            let [a, b, c] = t;
            prop_assume!(exact(a, b, c) != 0);
            let [a, b, c] = if exact(a, b, c) > 0 { [a, b, c] } else { [a, c, b] };
            let max = [min[0] + size[0], min[1] + size[1]];
            let corners = [min, [max[0], min[1]], max, [min[0], max[1]]];
            let apart = [(a, b), (b, c), (c, a)].iter().any(|&(p, q)| corners.iter().all(|&v| exact(p, q, v) < 0));
            prop_assert_eq!(polygon_may_touch_box(&[a, b, c].map(float), float(min), float(max)), !apart);
        }
    }

    #[test]
    fn defects_are_found() {
        assert_eq!(first_defect(&[[0., 0.], [2., 0.], [2., 2.], [0., 2.]]), None);
        assert_eq!(first_defect(&[[0., 0.], [1., 0.], [2., 0.], [2., 0.], [2., 2.]]), None);
        assert_eq!(first_defect(&[]), None);
        assert!(first_defect(&[[0., 0.], [0., 2.], [2., 2.], [2., 0.]]).is_some(), "clockwise");
        assert_eq!(first_defect(&[[0., 0.], [2., 0.], [0.5, 0.5], [0., 2.]]), Some(2), "a dent");
        assert!(first_defect(&[[1., 1.]; 3]).is_some(), "one point");
        // A pentagram turns left at each corner and winds twice.
        assert_eq!(first_defect(&[[0., 0.], [4., 0.], [1., 3.], [2., -2.], [3., 3.]]), Some(0));
    }
}
