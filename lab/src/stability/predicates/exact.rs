//! Signs of determinants in whole numbers of any size: what every predicate is measured by.
//!
//! Coordinates become whole multiples of one power of two, so nothing is rounded. Shares neither code nor method with the
//! predicates of the crates, which sum floating-point expansions.

use num_bigint::{BigInt, Sign};
use sightlines::geometry::Point3;

/// A vector in whole numbers.
pub(crate) type Whole3 = [BigInt; 3];

/// Mantissa and exponent of a finite double: `x = m * 2^e`.
fn parts(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let mantissa = if exponent == 0 { fraction << 1 } else { fraction | 1 << 52 };
    (if x < 0.0 { -mantissa } else { mantissa }, exponent - 1075)
}

/// Points as whole multiples of the same power of two.
pub(crate) fn whole_all(points: &[Point3]) -> Vec<Whole3> {
    let all = points.iter().flatten().map(|&x| parts(x));
    let least = all.filter(|p| p.0 != 0).map(|p| p.1).min().unwrap_or(0);
    let one = |x: f64| {
        let (mantissa, exponent) = parts(x);
        let shift = if mantissa == 0 { 0 } else { exponent - least };
        BigInt::from(mantissa) << usize::try_from(shift).expect("the least exponent is subtracted")
    };
    points.iter().map(|p| p.map(one)).collect()
}

/// The same for some points.
pub(crate) fn whole<const N: usize>(points: [Point3; N]) -> [Whole3; N] {
    whole_all(&points).try_into().expect("as many as were given")
}

fn sign(x: &BigInt) -> i32 {
    match x.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

fn minus(a: &Whole3, b: &Whole3) -> Whole3 {
    std::array::from_fn(|k| &a[k] - &b[k])
}

/// The sign of `(a × b) · c`.
pub(crate) fn product([a, b, c]: [&Whole3; 3]) -> i32 {
    let normal: Whole3 = std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    });
    sign(&(&normal[0] * &c[0] + &normal[1] * &c[1] + &normal[2] * &c[2]))
}

/// 1 if `c` lies to the left of the line from `a` to `b` in the plane of x and y, -1 if to the right, 0 on it.
pub(crate) fn turn([a, b, c]: [Point3; 3]) -> i32 {
    let [a, b, c] = whole([a, b, c]);
    let (u, v) = (minus(&b, &a), minus(&c, &a));
    sign(&(&u[0] * &v[1] - &u[1] * &v[0]))
}

/// 1 if `d` lies on the side of the plane of `a`, `b` and `c` that `(b - a) × (c - a)` points to, -1 on the other, 0 in it.
pub(crate) fn side([a, b, c, d]: [Point3; 4]) -> i32 {
    let [a, b, c, d] = whole([a, b, c, d]);
    product([&minus(&b, &a), &minus(&c, &a), &minus(&d, &a)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_tell_sides_apart() {
        let p = |x: f64, y: f64| [x, y, 0.0];
        assert_eq!(turn([p(0.0, 0.0), p(1.0, 0.0), p(0.5, f64::MIN_POSITIVE)]), 1);
        assert_eq!(turn([p(0.1, 0.1), p(0.3, 0.3), p(1e30, 1e30)]), 0);
        assert_eq!(turn([p(0.1, 0.1), p(0.3, 0.3), p(0.2f64.next_up(), 0.2)]), -1);
        let (o, x, y) = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        assert_eq!([-1e-300, 0.0, 1e300].map(|z| side([o, x, y, [5.0, 7.0, z]])), [-1, 0, 1]);
    }
}
