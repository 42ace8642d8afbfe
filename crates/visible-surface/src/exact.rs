//! Sums and products of doubles without rounding.

use num_bigint::{BigInt, Sign};
use num_traits::Float;
use sightlines_geometry::Point3;
use std::ops::{Add, Mul, Neg, Sub};

/// A whole number times a power of two: what sums and products of doubles are.
#[derive(Debug, Clone)]
pub(crate) struct Dyadic {
    mantissa: BigInt,
    exponent: i32,
}

/// Three of them.
pub(crate) type Dyadic3 = [Dyadic; 3];

impl Dyadic {
    /// A finite double.
    pub(crate) fn new(x: f64) -> Self {
        debug_assert!(x.is_finite(), "only numbers that are checked are computed with");
        let (mantissa, exponent, sign) = x.integer_decode();
        if mantissa == 0 {
            return Self { mantissa: BigInt::ZERO, exponent: 0 };
        }
        let zeros = mantissa.trailing_zeros();
        let mantissa = BigInt::from(mantissa >> zeros) * sign;
        Self { mantissa, exponent: i32::from(exponent) + zeros as i32 }
    }

    /// -1, 0 or 1.
    pub(crate) fn sign(&self) -> i32 {
        match self.mantissa.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }

    /// A double that is off by at most 2^-60 of the number, then rounded; infinite or 0 outside the range of doubles.
    pub(crate) fn rounded(&self) -> f64 {
        let drop = self.mantissa.bits().saturating_sub(62);
        let top = i64::try_from(&self.mantissa >> drop).expect("62 bits fit");
        let exponent = i64::from(self.exponent) + drop as i64;
        // In two steps, so that neither power of two is out of range before the number is.
        let half = (exponent / 2).clamp(-1100, 1100) as i32;
        let rest = (exponent - exponent / 2).clamp(-1100, 1100) as i32;
        top as f64 * 2f64.powi(half) * 2f64.powi(rest)
    }

    /// Both mantissas for the smaller exponent, and that exponent.
    fn aligned(a: &Self, b: &Self) -> (BigInt, BigInt, i32) {
        // The exponent of a zero says nothing, and would only make the other number long.
        let exponent = match (a.sign(), b.sign()) {
            (0, _) => b.exponent,
            (_, 0) => a.exponent,
            _ => a.exponent.min(b.exponent),
        };
        let shifted =
            |x: &Self| if x.sign() == 0 { BigInt::ZERO } else { &x.mantissa << (x.exponent - exponent) as u32 };
        (shifted(a), shifted(b), exponent)
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: &Dyadic) -> Dyadic {
        let (a, b, exponent) = Dyadic::aligned(self, other);
        Dyadic { mantissa: a + b, exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: &Dyadic) -> Dyadic {
        let (a, b, exponent) = Dyadic::aligned(self, other);
        Dyadic { mantissa: a - b, exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: &Dyadic) -> Dyadic {
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

impl Neg for Dyadic {
    type Output = Self;
    fn neg(self) -> Self {
        Self { mantissa: -self.mantissa, ..self }
    }
}

pub(crate) fn point(p: Point3) -> Dyadic3 {
    p.map(Dyadic::new)
}

pub(crate) fn sub(a: &Dyadic3, b: &Dyadic3) -> Dyadic3 {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

pub(crate) fn cross(a: &Dyadic3, b: &Dyadic3) -> Dyadic3 {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &(&a[i] * &b[j]) - &(&a[j] * &b[i]))
}

pub(crate) fn dot(a: &Dyadic3, b: &Dyadic3) -> Dyadic {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

pub(crate) fn times(a: &Dyadic3, s: &Dyadic) -> Dyadic3 {
    [0, 1, 2].map(|k| &a[k] * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use proptest::prelude::*;

    fn rational(x: f64) -> BigRational {
        BigRational::from_float(x).expect("finite")
    }

    fn number() -> impl Strategy<Value = f64> {
        (-1000i32..1000, -140i32..140).prop_map(|(m, e)| f64::from(m) * 2f64.powi(e))
    }

    proptest! {
        #[test]
        fn nothing_is_rounded(x in number(), y in number(), z in number()) {
            let [a, b, c] = [x, y, z].map(Dyadic::new);
            let got = &(&(&a * &b) + &c) - &(&b * &c);
            let want = rational(x) * rational(y) + rational(z) - rational(y) * rational(z);
            let sign = want.cmp(&BigRational::from_integer(0.into())) as i32;
            prop_assert_eq!(got.sign(), sign);
            // The double beside it is as near as is promised.
            let off = rational(got.rounded()) - &want;
            let off = if off < BigRational::from_integer(0.into()) { -off } else { off };
            let size = if sign < 0 { -want } else { want };
            prop_assert!(off <= size * rational(2f64.powi(-52)));
        }
    }

    #[test]
    fn numbers_beyond_doubles_are_kept() {
        let huge = Dyadic::new(2f64.powi(1000));
        let product = &(&huge * &huge) * &Dyadic::new(-3.0);
        assert_eq!(product.sign(), -1);
        assert_eq!(product.rounded(), f64::NEG_INFINITY);
        let tiny = Dyadic::new(2f64.powi(-1000));
        assert_eq!((&(&tiny * &tiny) * &tiny).sign(), 1);
        assert_eq!((&product - &product).sign(), 0);
        assert_eq!(Dyadic::new(0.0).rounded(), 0.0);
    }
}
