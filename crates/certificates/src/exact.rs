//! Exact arithmetic on doubles: a double is a whole number times a power of two, and so are sums and products.

use num_bigint::{BigInt, Sign};
use num_traits::ToPrimitive;
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// Smallest magnitude, besides zero, of a coordinate: 2^-140. Below it, products could underflow.
const SMALLEST: f64 = f64::from_bits((1023 - 140) << 52);
/// Largest magnitude of a coordinate: 2^200. Above it, products could overflow.
const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);

/// Whether a double may be a coordinate: 0, or of a magnitude from 2^-140 to 2^200.
pub(crate) fn is_coordinate(x: f64) -> bool {
    x == 0.0 || (x.is_finite() && (SMALLEST..=LARGEST).contains(&x.abs()))
}

/// `mantissa * 2^exponent`.
#[derive(Debug, Clone)]
pub(crate) struct Dyadic {
    mantissa: BigInt,
    exponent: i32,
}

impl Dyadic {
    /// A double without loss. Callers pass finite doubles only; others count as 0.
    pub(crate) fn new(x: f64) -> Self {
        debug_assert!(x.is_finite());
        let bits = x.to_bits();
        let (field, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
        let (mantissa, exponent) = match field {
            0 => (fraction, -1074),
            0x7ff => (0, 0),
            _ => (fraction | 1 << 52, field - 1075),
        };
        // An odd mantissa, which is short for short numbers. The exponent of 0 has no meaning.
        let zeros = mantissa.trailing_zeros() % 64;
        let mantissa = BigInt::from(mantissa >> zeros);
        Self { mantissa: if x < 0.0 { -mantissa } else { mantissa }, exponent: exponent + zeros as i32 }
    }

    pub(crate) fn whole(mantissa: BigInt) -> Self {
        Self { mantissa, exponent: 0 }
    }

    /// The number as a double, with a relative error of at most 2^-51. For sums of a few products of two coordinates, which are in
    /// the range of doubles.
    pub(crate) fn rounded(&self) -> f64 {
        self.mantissa.to_f64().unwrap_or(0.0) * 2f64.powi(self.exponent)
    }

    pub(crate) fn sign(&self) -> Ordering {
        match self.mantissa.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        }
    }

    /// Whether the mantissa has at most `most` bits, and the exponent a magnitude of at most 64 times as much.
    pub(crate) fn has_bits(&self, most: u64) -> bool {
        self.mantissa.bits() <= most && u64::from(self.exponent.unsigned_abs()) <= 64 * most
    }

    pub(crate) fn magnitude(&self) -> Self {
        Self { mantissa: self.mantissa.magnitude().clone().into(), exponent: self.exponent }
    }

    fn with_exponent(&self, exponent: i32) -> BigInt {
        &self.mantissa << (self.exponent - exponent).max(0) as usize
    }

    fn together(&self, other: &Self, combine: impl FnOnce(BigInt, BigInt) -> BigInt) -> Self {
        let exponent = match [self, other].map(|x| x.mantissa.sign()) {
            [_, Sign::NoSign] => self.exponent,
            [Sign::NoSign, _] => other.exponent,
            _ => self.exponent.min(other.exponent),
        };
        Self { mantissa: combine(self.with_exponent(exponent), other.with_exponent(exponent)), exponent }
    }
}

impl From<f64> for Dyadic {
    fn from(x: f64) -> Self {
        Self::new(x)
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;

    fn add(self, other: Self) -> Dyadic {
        self.together(other, |a, b| a + b)
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;

    fn sub(self, other: Self) -> Dyadic {
        self.together(other, |a, b| a - b)
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;

    fn mul(self, other: Self) -> Dyadic {
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

impl Neg for &Dyadic {
    type Output = Dyadic;

    fn neg(self) -> Dyadic {
        Dyadic { mantissa: -&self.mantissa, exponent: self.exponent }
    }
}

/// On which side of the line from `a` to `b` the point `c` lies: `Greater` is left. Exact for coordinates.
///
/// The determinant is computed in doubles first. Two differences, a product and the last difference round by 2^-53 of
/// themselves each, so the error is less than 2^-50 of the sum of the products' magnitudes; a larger result has the right
/// sign. (Nothing underflows: a difference of two coordinates is 0 or at least 2^-192.)
#[inline]
pub(crate) fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Ordering {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let (value, bound) = (left - right, f64::EPSILON * 4.0 * (left.abs() + right.abs()));
    if value > bound {
        Ordering::Greater
    } else if value < -bound {
        Ordering::Less
    } else {
        turn_in_integers(a, b, c)
    }
}

fn turn_in_integers(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Ordering {
    let d = |x: f64, y: f64| &Dyadic::new(x) - &Dyadic::new(y);
    let left = &d(a[0], c[0]) * &d(b[1], c[1]);
    let right = &d(a[1], c[1]) * &d(b[0], c[0]);
    (&left - &right).sign()
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{Signed, Zero};
    use proptest::prelude::*;

    fn oracle(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Ordering {
        let f = |x: f64| BigRational::from_float(x).unwrap();
        let d = |x: f64, y: f64| f(x) - f(y);
        let value = d(b[0], a[0]) * d(c[1], a[1]) - d(b[1], a[1]) * d(c[0], a[0]);
        if value.is_positive() { Ordering::Greater } else { value.cmp(&BigRational::zero()) }
    }

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            (-4i32..5).prop_map(f64::from),
            (-4i32..5, -60i32..1).prop_map(|(k, e)| f64::from(k) + 2f64.powi(e)),
            (-4i32..5, -140i32..60).prop_map(|(k, e)| f64::from(k) * 2f64.powi(e)),
            -1e3f64..1e3,
        ]
        .prop_filter("a coordinate", |x| is_coordinate(*x))
    }

    proptest! {
        #[test]
        fn turns_are_those_of_fractions(p in prop::array::uniform6(coordinate())) {
            let [a, b, c] = [[p[0], p[1]], [p[2], p[3]], [p[4], p[5]]];
            prop_assert_eq!(turn(a, b, c), oracle(a, b, c));
            prop_assert_eq!(turn_in_integers(a, b, c), oracle(a, b, c));
        }

        #[test]
        fn sums_and_products_are_those_of_fractions(x in coordinate(), y in coordinate(), z in coordinate()) {
            let f = |x: f64| BigRational::from_float(x).unwrap();
            let value = &(&(&Dyadic::new(x) * &Dyadic::new(y)) - &Dyadic::new(z)) + &-&Dyadic::whole(3.into());
            let expected = f(x) * f(y) - f(z) - f(3.0);
            prop_assert_eq!(value.sign(), expected.cmp(&BigRational::zero()));
        }
    }

    #[test]
    fn what_is_no_coordinate_is_refused() {
        assert!([0.0, -0.0, 1.0, -2f64.powi(200), 2f64.powi(-140)].into_iter().all(is_coordinate));
        assert!([f64::NAN, f64::INFINITY, 2f64.powi(201), 2f64.powi(-141)].into_iter().all(|x| !is_coordinate(x)));
    }
}
