//! Exact vectors, and the determinant whose sign decides.

use crate::exact::Dyadic;
use std::cmp::Ordering;

/// A point in space, in scene units.
pub type Point = [f64; 3];

/// A vector without rounding.
pub(super) type Exact = [Dyadic; 3];

pub(super) fn exact(p: Point) -> Exact {
    p.map(Dyadic::new)
}

pub(super) fn minus(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|k| &a[k] - &b[k])
}

pub(super) fn plus(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|k| &a[k] + &b[k])
}

pub(super) fn times(a: &Exact, x: &Dyadic) -> Exact {
    std::array::from_fn(|k| &a[k] * x)
}

pub(super) fn cross(a: &Exact, b: &Exact) -> Exact {
    let part = |i: usize, j: usize| &(&a[i] * &b[j]) - &(&a[j] * &b[i]);
    [part(1, 2), part(2, 0), part(0, 1)]
}

pub(super) fn dot(a: &Exact, b: &Exact) -> Dyadic {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

/// A determinant of three differences in doubles, and a bound on its error.
///
/// Differences round by 2^-53 of themselves, products and sums by as much again: less than 8 roundings for each of the six products,
/// so the error is below 2^-49 of the sum of their magnitudes. Nothing underflows: differences of coordinates are 0 or at
/// least 2^-192.
#[inline]
pub(super) fn rough(o: Point, a: Point, b: Point, c: Point) -> (f64, f64) {
    let [a, b, c] = [a, b, c].map(|p| [p[0] - o[0], p[1] - o[1], p[2] - o[2]]);
    let (mut value, mut size) = (0.0, 0.0);
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let (x, y) = (b[j] * c[k], b[k] * c[j]);
        value += a[i] * (x - y);
        size += a[i].abs() * (x.abs() + y.abs());
    }
    (value, size * (8.0 * f64::EPSILON))
}

/// The sign of the determinant of `a - o`, `b - o`, `c - o`. Exact for coordinates.
pub(super) fn turn(o: Point, a: Point, b: Point, c: Point) -> Ordering {
    let (value, wrong) = rough(o, a, b, c);
    if value > wrong {
        Ordering::Greater
    } else if value < -wrong {
        Ordering::Less
    } else {
        let o = exact(o);
        let [a, b, c] = [a, b, c].map(|p| minus(&exact(p), &o));
        dot(&a, &cross(&b, &c)).sign()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{Signed, Zero};
    use proptest::prelude::*;

    fn oracle(o: Point, points: [Point; 3]) -> Ordering {
        let f = |x: f64| BigRational::from_float(x).expect("a coordinate");
        let m = points.map(|p| [0, 1, 2].map(|k| f(p[k]) - f(o[k])));
        // Leibniz' rule, term by term.
        let mut sum = BigRational::zero();
        for (i, j, k, sign) in [(0, 1, 2, 1), (1, 2, 0, 1), (2, 0, 1, 1), (2, 1, 0, -1), (1, 0, 2, -1), (0, 2, 1, -1)] {
            let term = &m[0][i] * &m[1][j] * &m[2][k];
            if sign > 0 { sum += term } else { sum -= term }
        }
        if sum.is_positive() { Ordering::Greater } else { sum.cmp(&BigRational::zero()) }
    }

    fn point() -> impl Strategy<Value = Point> {
        let x = prop_oneof![
            (-3i32..4).prop_map(f64::from),
            (-3i32..4, -45i32..1).prop_map(|(k, e)| f64::from(k) + 2f64.powi(e))
        ];
        prop::array::uniform3(x)
    }

    proptest! {
        #[test]
        fn turns_are_those_of_fractions(o in point(), a in point(), b in point(), c in point()) {
            prop_assert_eq!(turn(o, a, b, c), oracle(o, [a, b, c]));
        }
    }
}
